// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "holdfast/plugin/choice.hpp"
#include "holdfast/settings/network_engine.hpp"

namespace holdfast {

class Segmenter;
template <class Settings>
class ParameterTable;

/// Order of the channels of a colour image.
enum class ColourOrder { rgb, bgr };
/// Layout of the network's input and output: channels first or channels last.
enum class TensorLayout { nchw, nhwc };
/// Output of a network for segmentation: scores before softmax, probabilities, or class indices.
enum class NetworkOutput { logits, probabilities, labels };

template <>
inline constexpr Choice<ColourOrder> choice_table<ColourOrder>[] = {{"rgb", ColourOrder::rgb},
                                                                    {"bgr", ColourOrder::bgr}};
template <>
inline constexpr Choice<TensorLayout> choice_table<TensorLayout>[] = {{"nchw", TensorLayout::nchw},
                                                                      {"nhwc", TensorLayout::nhwc}};
template <>
inline constexpr Choice<NetworkOutput> choice_table<NetworkOutput>[] = {{"logits", NetworkOutput::logits},
                                                                        {"probabilities", NetworkOutput::probabilities},
                                                                        {"labels", NetworkOutput::labels}};

/// Settings of the segmenter `onnx`. Ranges and units: `holdfast modules onnx`.
struct OnnxSettings {
  using Interface = Segmenter;
  static constexpr const char* module = "onnx";

  std::filesystem::path model;                  ///< ONNX file with float32 weights; required
  int width = 0;                                ///< width of the network input [px]; 0 = as declared by the model
  int height = 0;                               ///< height of the network input [px]; 0 = as declared by the model
  ColourOrder colour_order = ColourOrder::rgb;  ///< of the input
  /// Input = (pixel * scale - mean) / standard_deviation with pixels from 0 to 255; 1/255 maps them to [0, 1].
  double scale = 1.0 / 255.0;
  std::vector<double> mean = {0.0, 0.0, 0.0};                ///< per channel, in colour_order
  std::vector<double> standard_deviation = {1.0, 1.0, 1.0};  ///< per channel, in colour_order
  TensorLayout layout = TensorLayout::nchw;
  NetworkOutput output = NetworkOutput::logits;
  std::string output_name;  ///< name of the output; needed if the model has several
  /// Class names by channel or label; the first is the background.
  std::vector<std::string> classes = {"background", "person"};
  std::vector<std::string> movable;                     ///< the subset of classes that can move; empty = not specified
  NetworkEngine engine = NetworkEngine::opencv;         ///< what computes the network
  NetworkPrecision precision = NetworkPrecision::fp32;  ///< bf16: with onednn, where the processor has it
  /// OpenCV: for the whole process, 0 = unchanged; oneDNN: for this network, 0 = 1.
  int threads = 0;

  static void describe(ParameterTable<OnnxSettings>& table);
};

}  // namespace holdfast
