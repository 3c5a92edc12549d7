// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "heat_map.hpp"
#include "holdfast/core/module.hpp"
#include "holdfast/inference/onnx_net.hpp"
#include "holdfast/interfaces/feature_extractor.hpp"
#include "holdfast/settings/onnx_features.hpp"

namespace holdfast::onnx_features_plugin {

/// Features of a network in ONNX format, such as SuperPoint, ALIKED or XFeat. It reads a grey image and gives either
///
///   - a heat map of scores (see heat_map_of()) and a map of descriptors, 1 x length x rows x columns, which is read
///     between its pixels by bilinear interpolation; or
///   - keypoints (n x 2 or 1 x n x 2, column and row in pixels of the input), their scores (n) and descriptors (n x
///     length).
///
/// Features have one octave and no angle.
class OnnxFeatures final : public FeatureExtractor {
 public:
  /// Throws InputError as OnnxNet, and for a network whose inputs or outputs have other shapes.
  explicit OnnxFeatures(const OnnxFeaturesSettings& settings, const CreationContext& context = {});

  void extract(const cv::Mat& grey, const cv::Mat& ignore, Features& out) override;
  void set_budget(double factor) override { budget_ = factor; }
  const ScalePyramid& pyramid() const override { return pyramid_; }
  DescriptorType descriptor_type() const override { return type_; }
  bool has_angles() const override { return false; }

 private:
  void choose_input();
  void choose_descriptors();
  void fill_input(const cv::Mat& grey);
  std::vector<HeatPoint> find_keypoints() const;
  std::vector<HeatPoint> read_keypoints() const;
  /// Writes the descriptor of keypoint i, or returns false for one without direction, which nothing can be compared to.
  bool describe(const HeatPoint& point, std::size_t i, std::span<float> descriptor) const;
  [[noreturn]] void fail(const std::string& message) const;

  OnnxFeaturesSettings settings_;
  double budget_ = 1.0;
  OnnxNet net_;
  ScalePyramid pyramid_{1, 2.0};
  DescriptorType type_;
  int channels_ = 1, width_ = 0, height_ = 0;  // of the input
  cv::Mat resized_, input_;
  std::vector<std::string> output_names_;
  std::vector<cv::Mat> outputs_;  // scores, descriptors, keypoints if any
};

}  // namespace holdfast::onnx_features_plugin
