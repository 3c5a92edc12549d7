// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>

#include "holdfast/plugin/choice.hpp"
#include "holdfast/settings/network_engine.hpp"

namespace holdfast {

class Segmenter;
template <class Settings>
class ParameterTable;

/// Size of the input of the U-Net: small is 224x192 pixels, base is 384x288, large is 512x384.
enum class UnetSize { small, base, large };
template <>
inline constexpr Choice<UnetSize> choice_table<UnetSize>[] = {
    {"small", UnetSize::small}, {"base", UnetSize::base}, {"large", UnetSize::large}};

/// Settings of the segmenter `unet`. Ranges and units: `holdfast modules unet`.
struct UnetSettings {
  using Interface = Segmenter;
  static constexpr const char* module = "unet";

  UnetSize size = UnetSize::base;  ///< small takes half the time of base, large twice
  int width = 0;                   ///< of the network input, a multiple of 32 [px]; 0 = given by `size`
  int height = 0;                  ///< the same of its height [px]; 0 = given by `size`
  /// Average the scores of the image and its mirror image; doubles the time and improves the masks slightly.
  bool mirror = false;
  /// Look again at the part of the image in which the network is least certain; up to twice the time.
  bool second_look = false;
  double region_confidence = 0.0;  ///< a region of people counts if a pixel of it is as certain; 0 = all count
  std::filesystem::path model;     ///< ONNX file with other weights; empty = the weights of the library
  NetworkEngine engine = NetworkEngine::automatic;      ///< what computes the network
  NetworkPrecision precision = NetworkPrecision::fp32;  ///< bf16: with onednn, where the processor has it
  std::string provider = "cpu";                         ///< of ONNX Runtime: what it computes on
  /// ONNX Runtime's library, or its folder; empty = the variable HOLDFAST_ONNXRUNTIME, otherwise the usual places.
  std::filesystem::path engine_library;
  /// OpenCV: for the whole process, 0 = unchanged; other engines: for this network, 0 = 1.
  int threads = 0;

  static void describe(ParameterTable<UnetSettings>& table);
};

}  // namespace holdfast
