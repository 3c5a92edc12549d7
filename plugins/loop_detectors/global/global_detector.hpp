// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "holdfast/core/descriptor_distance.hpp"
#include "holdfast/inference/network.hpp"
#include "holdfast/interfaces/loop_detector.hpp"
#include "holdfast/settings/global.hpp"

namespace holdfast::global_plugin {

/// Place recognition by one vector per image, which a network in ONNX format computes, such as NetVLAD (Arandjelovic et
/// al., "NetVLAD: CNN architecture for weakly supervised place recognition", CVPR 2016) or CosPlace (Berton, Masone,
/// Caputo, "Rethinking visual geo-localization for large-scale applications", CVPR 2022). The network takes one colour
/// image; its output, of any shape, is read as one vector and brought to unit length.
///
/// Pixels of what moves are replaced by the mean colour of the others before. An image of which they leave less than a
/// tenth has no description, and neither has one for which the network gives zeros: no place is recognised by it.
///
/// With c the cosine of the angle between two vectors and m the setting minimum_similarity, the score of a keyframe is
/// (c - m) / (1 - m); keyframes with c < m are omitted. All keyframes are compared: 4096 numbers of 1000 keyframes take
/// about a millisecond.
class GlobalDetector final : public LoopDetector {
 public:
  /// Throws InputError as Network, and for a network that cannot be run or whose output has no finite numbers. Runs the
  /// network once, because only that tells the length of the vector.
  explicit GlobalDetector(const GlobalSettings& settings, const CreationContext& context = {});

  std::optional<DescriptorType> image_descriptor() const override { return type_; }
  /// Throws InputError for an output that is not finite.
  DescriptorBlock describe(const cv::Mat& image, const cv::Mat& moving) override;
  std::vector<std::pair<std::string, double>> class_weights() const override { return settings_.class_weights; }

  /// Throws CheckError if the keyframe is already in the database, for descriptors of another type, and for more than
  /// one.
  void add(KeyFrameId keyframe, const DescriptorView& descriptors) override;
  void remove(KeyFrameId keyframe) override;
  std::vector<PlaceMatch> query(const DescriptorView& descriptors, int max_count) const override;

 private:
  /// The output for an image, of unit length; empty for zeros.
  DescriptorBlock vector_of(const cv::Mat& colour);
  void check(const DescriptorView& descriptors) const;

  GlobalSettings settings_;
  Network network_;
  DescriptorType type_;
  std::optional<DescriptorDistances> distances_;
  std::vector<KeyFrameId> keyframes_;
  DescriptorBlock vectors_;               // one for each keyframe; zeros for one without description
  std::vector<std::uint8_t> has_vector_;  // for each keyframe
};

}  // namespace holdfast::global_plugin
