// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace holdfast {

class Segmenter;
template <class Settings>
class ParameterTable;

/// The segmenter `onnx`: what each value means, and its range, is in the reference (`holdfast modules onnx`).
struct OnnxSettings {
  using Interface = Segmenter;
  static constexpr const char* module = "onnx";

  std::filesystem::path model;
  int width = 0;
  int height = 0;
  std::string colour_order = "rgb";
  double scale = 1.0 / 255.0;
  std::vector<double> mean = {0.0, 0.0, 0.0};
  std::vector<double> standard_deviation = {1.0, 1.0, 1.0};
  std::string layout = "nchw";
  std::string output = "logits";
  std::string output_name;
  std::vector<std::string> classes = {"background", "person"};
  std::vector<std::string> movable;
  int threads = 0;

  static void describe(ParameterTable<OnnxSettings>& table);
};

}  // namespace holdfast
