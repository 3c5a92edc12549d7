// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <mutex>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "holdfast/core/descriptor.hpp"
#include "holdfast/core/id.hpp"
#include "holdfast/core/module.hpp"

namespace holdfast {

/// A keyframe similar to the query; a larger score means greater similarity.
struct PlaceMatch {
  KeyFrameId keyframe;
  double score = 0.0;
};

/// Place recognition by the descriptors of keyframes: local descriptors of their features, or global descriptors that
/// the detector computes from whole images. Callers pass those of static features, and mask moving pixels of images, so
/// that a place is not recognised by the people in it (Zeng et al. 2023, section 3.3). Used by one thread at a time,
/// but for describe().
class LoopDetector : public Module {
 public:
  static constexpr const char* kind = "loop_detector";

  /// Type of the global descriptors of describe(). Empty, the default, is for a detector that recognises places by the
  /// descriptors of features; describe() is then never called.
  virtual std::optional<DescriptorType> image_descriptor() const { return std::nullopt; }
  /// Describes a whole image by any number of descriptors, usually one. `image`: 8UC1, or 8UC3 in the order blue,
  /// green, red. `moving`: 8UC1 of the same size, not 0 where something moves that does not belong to the place, or
  /// empty. The same image gives the same descriptors. One thread at a time calls it, beside another that calls the
  /// functions below.
  virtual DescriptorBlock describe(const cv::Mat& /*image*/, const cv::Mat& /*moving*/) { return {}; }

  /// Weights from 0 to 1 of the features of some classes of the segmenter, by name; features of other classes have the
  /// weight 1. Names that the segmenter does not have are an error before the first frame. With weights, loop
  /// candidates are also verified by classes (LoopClosingSettings::class_agreement). Constant after construction;
  /// empty, the default, for a detector that knows no classes.
  virtual std::vector<std::pair<std::string, double>> class_weights() const { return {}; }

  /// Adds a keyframe with any number of descriptors, of its static features or from describe(). The keyframe must not
  /// be in the database yet.
  virtual void add(KeyFrameId keyframe, const DescriptorView& descriptors) = 0;
  /// Removes a keyframe from the database; an unknown id is ignored.
  virtual void remove(KeyFrameId keyframe) = 0;
  /// Returns up to `max_count` keyframes of the database by decreasing score, equal scores by increasing id, without
  /// duplicates. Scores are finite. The same calls in the same order give the same matches, and a query does not affect
  /// later results.
  virtual std::vector<PlaceMatch> query(const DescriptorView& descriptors, int max_count) const = 0;
  /// The same with a weight from 0 to 1 for each descriptor: one with the weight 0 does not affect scores. Without
  /// weights, and with weights of 1, equal to query(). The default ignores them. Called only if class_weights() is not
  /// empty.
  virtual std::vector<PlaceMatch> query_weighted(const DescriptorView& descriptors, std::span<const float> /*weights*/,
                                                 int max_count) const {
    return query(descriptors, max_count);
  }
};

/// Null object without matches: `loop_detector: none`, the default.
class NullLoopDetector final : public LoopDetector {
 public:
  void add(KeyFrameId, const DescriptorView&) override {}
  void remove(KeyFrameId) override {}
  std::vector<PlaceMatch> query(const DescriptorView&, int) const override { return {}; }
};

/// Serialises access to another detector with a mutex, so that tracking can query while loop closing adds. Another
/// mutex serialises describe(), which may take long.
class SharedLoopDetector final : public LoopDetector {
 public:
  /// The detector must outlive this object.
  explicit SharedLoopDetector(LoopDetector& detector) : detector_(detector) {}

  std::optional<DescriptorType> image_descriptor() const override { return detector_.image_descriptor(); }
  DescriptorBlock describe(const cv::Mat& image, const cv::Mat& moving) override {
    const std::lock_guard lock(description_mutex_);
    return detector_.describe(image, moving);
  }
  void add(KeyFrameId keyframe, const DescriptorView& descriptors) override {
    const std::lock_guard lock(mutex_);
    detector_.add(keyframe, descriptors);
  }
  void remove(KeyFrameId keyframe) override {
    const std::lock_guard lock(mutex_);
    detector_.remove(keyframe);
  }
  std::vector<PlaceMatch> query(const DescriptorView& descriptors, int max_count) const override {
    const std::lock_guard lock(mutex_);
    return detector_.query(descriptors, max_count);
  }
  std::vector<std::pair<std::string, double>> class_weights() const override { return detector_.class_weights(); }
  std::vector<PlaceMatch> query_weighted(const DescriptorView& descriptors, std::span<const float> weights,
                                         int max_count) const override {
    const std::lock_guard lock(mutex_);
    return detector_.query_weighted(descriptors, weights, max_count);
  }

 private:
  LoopDetector& detector_;
  mutable std::mutex mutex_;
  std::mutex description_mutex_;
};

}  // namespace holdfast
