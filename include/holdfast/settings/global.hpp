// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "holdfast/settings/onnx.hpp"

namespace holdfast {

class LoopDetector;

/// Settings of the loop detector `global`. Ranges and units: `holdfast modules global`. Thread: any.
struct GlobalSettings {
  using Interface = LoopDetector;
  static constexpr const char* module = "global";

  std::filesystem::path model;                  ///< ONNX file with float32 weights; required
  int width = 0;                                ///< width of the network input [px]; 0 = as declared by the model
  int height = 0;                               ///< height of the network input [px]; 0 = as declared by the model
  ColourOrder colour_order = ColourOrder::rgb;  ///< of the input
  /// Input = (pixel * scale - mean) / standard_deviation with pixels from 0 to 255. The defaults are those of networks
  /// that were trained on ImageNet first, as NetVLAD and CosPlace.
  double scale = 1.0 / 255.0;
  std::vector<double> mean = {0.485, 0.456, 0.406};                ///< per channel, in colour_order
  std::vector<double> standard_deviation = {0.229, 0.224, 0.225};  ///< per channel, in colour_order
  std::string output_name;          ///< name of the output; needed if the model has several
  double minimum_similarity = 0.5;  ///< cosine of the angle between two vectors below which places do not match
  /// Classes whose pixels count little, by the segmenter's names: pixels of a class with a weight below 0.5 are
  /// replaced as moving ones are.
  std::vector<std::pair<std::string, double>> class_weights;

  static void describe(ParameterTable<GlobalSettings>& table);
};

}  // namespace holdfast
