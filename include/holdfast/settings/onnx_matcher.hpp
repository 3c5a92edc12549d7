// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>

namespace holdfast {

class FeatureMatcher;
template <class Settings>
class ParameterTable;

/// Settings of the matcher `onnx_matcher`. Ranges and units: `holdfast modules onnx_matcher`.
/// Thread: any.
struct OnnxMatcherSettings {
  using Interface = FeatureMatcher;
  static constexpr const char* module = "onnx_matcher";

  std::filesystem::path model;  ///< ONNX file with float32 weights; required
  int count = 0;                ///< features of each image that the network takes; 0 = as declared by the model
  std::string keypoints0 = "keypoints0", keypoints1 = "keypoints1";          ///< names of inputs, 1 x count x 2
  std::string descriptors0 = "descriptors0", descriptors1 = "descriptors1";  ///< names of inputs, 1 x count x length
  /// Name of the output: 1 x count x count, or one row and column more for features without a partner.
  std::string scores = "scores";
  /// Scores are numbers of any size, over which a softmax is taken in both directions (the dual softmax of Sun et al.
  /// 2021); otherwise they are logarithms of probabilities, as of SuperGlue and LightGlue.
  bool dual_softmax = false;
  double temperature = 1.0;  ///< divisor of scores before the dual softmax; 0.1 in Sun et al. 2021
  double threshold = 0.1;    ///< minimum probability of a match

  static void describe(ParameterTable<OnnxMatcherSettings>& table);
};

}  // namespace holdfast
