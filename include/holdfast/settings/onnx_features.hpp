// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>

#include "holdfast/plugin/choice.hpp"

namespace holdfast {

class FeatureExtractor;
template <class Settings>
class ParameterTable;

/// How descriptors of numbers are compared: by the cosine of their angle, for which they are brought to unit length, or
/// by the length of their difference.
enum class NumberMetric { cosine, euclidean };

template <>
inline constexpr Choice<NumberMetric> choice_table<NumberMetric>[] = {{"cosine", NumberMetric::cosine},
                                                                      {"euclidean", NumberMetric::euclidean}};

/// Settings of the feature extractor `onnx_features`. Ranges and units: `holdfast modules onnx_features`.
/// Thread: any.
struct OnnxFeaturesSettings {
  using Interface = FeatureExtractor;
  static constexpr const char* module = "onnx_features";

  std::filesystem::path model;  ///< ONNX file with float32 weights; required
  int width = 0;                ///< width of the network input [px]; 0 = as declared by the model
  int height = 0;               ///< height of the network input [px]; 0 = as declared by the model
  /// Input = pixel * scale + offset with grey values from 0 to 255; a network with three channels gets grey thrice.
  double scale = 1.0 / 255.0;
  double offset = 0.0;
  std::string scores = "scores";            ///< output with the scores, dense or of keypoints
  std::string descriptors = "descriptors";  ///< output with the descriptors, dense or of keypoints
  std::string keypoints;                    ///< output with the keypoints; empty = scores are a heat map
  int count = 1000;                         ///< number of features to extract; the best are kept
  double threshold = 0.005;                 ///< minimum score
  int suppression_radius = 4;               ///< a feature of a heat map is the maximum of this neighbourhood [px]
  int border = 4;                           ///< no feature is so near to the border of the input [px]
  bool subpixel = true;                     ///< refine the positions of a heat map
  NumberMetric metric = NumberMetric::cosine;
  double strict_distance = 0.25;  ///< recommended for matches without a prediction
  double loose_distance = 0.45;   ///< recommended for matches near their prediction

  static void describe(ParameterTable<OnnxFeaturesSettings>& table);
};

}  // namespace holdfast
