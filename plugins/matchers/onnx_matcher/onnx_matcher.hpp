// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <mutex>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "holdfast/core/module.hpp"
#include "holdfast/inference/onnx_net.hpp"
#include "holdfast/interfaces/feature_matcher.hpp"
#include "holdfast/settings/onnx_matcher.hpp"

namespace holdfast::onnx_matcher_plugin {

/// Matches the features of two images by a network in ONNX format, such as LightGlue or SuperGlue with inputs of a
/// fixed number of features: keypoints, brought to -1 to 1 by the longer side of the image, and descriptors of float32.
/// The strongest features are taken where an image has more, and zeros fill up where it has fewer. Matches with
/// predictions, and with points of a map, which no single image shows, are those of NearestMatcher. Calls wait for each
/// other.
class OnnxMatcher final : public NearestMatcher {
 public:
  /// Throws InputError as OnnxNet, and for a network whose inputs have other shapes.
  explicit OnnxMatcher(const OnnxMatcherSettings& settings, const CreationContext& context = {});

  /// Throws InputError for descriptors that do not fit the network.
  std::string incompatibility(const DescriptorType& type) const override;
  void match(const MatchSide& queries, const MatchSide& references, const MatchLimits& limits,
             std::vector<FeatureMatch>& matches) const override;

 private:
  /// One image's half of the input.
  struct Half {
    std::string keypoints_name, descriptors_name;
    cv::Mat keypoints, descriptors;
    std::vector<std::uint32_t> taken;  // features, in the order of the input
  };

  void choose_inputs();
  void fill(const MatchSide& side, Half& half) const;
  [[noreturn]] void fail(const std::string& message) const;

  OnnxMatcherSettings settings_;
  int count_ = 0, length_ = 0;  // features, and numbers of a descriptor
  mutable std::mutex mutex_;    // of everything below
  mutable OnnxNet net_;
  mutable Half queries_, references_;
  mutable std::vector<cv::Mat> outputs_;
};

}  // namespace holdfast::onnx_matcher_plugin
