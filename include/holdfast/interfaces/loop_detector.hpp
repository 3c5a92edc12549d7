// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <mutex>
#include <span>
#include <vector>

#include "holdfast/core/descriptor.hpp"
#include "holdfast/core/id.hpp"
#include "holdfast/core/module.hpp"

namespace holdfast {

/// A keyframe that looks like the query; larger scores look more alike.
struct PlaceMatch {
  KeyFrameId keyframe;
  double score = 0.0;
};

/// Recognises places by the descriptors of keyframes. Used by one thread at a time.
class LoopDetector : public Module {
 public:
  static constexpr const char* kind = "loop_detector";

  /// A keyframe that is not known yet, with any number of descriptors.
  virtual void add(KeyFrameId keyframe, std::span<const Descriptor> descriptors) = 0;
  /// Forgets a keyframe; one that is not known is ignored.
  virtual void remove(KeyFrameId keyframe) = 0;
  /// Up to `most` of the known keyframes, none twice, best first; equal scores by rising id. Scores are finite. The
  /// same calls in the same order give the same matches, and asking changes no later answer.
  virtual std::vector<PlaceMatch> query(std::span<const Descriptor> descriptors, int most) const = 0;
};

/// Recognises nothing: `loop_detector: none`, the default.
class NullLoopDetector final : public LoopDetector {
 public:
  void add(KeyFrameId, std::span<const Descriptor>) override {}
  void remove(KeyFrameId) override {}
  std::vector<PlaceMatch> query(std::span<const Descriptor>, int) const override { return {}; }
};

/// Another detector behind a mutex, so that tracking can ask while loop closing adds.
class SharedLoopDetector final : public LoopDetector {
 public:
  /// The detector must outlive this one.
  explicit SharedLoopDetector(LoopDetector& detector) : detector_(detector) {}

  void add(KeyFrameId keyframe, std::span<const Descriptor> descriptors) override {
    const std::lock_guard lock(mutex_);
    detector_.add(keyframe, descriptors);
  }
  void remove(KeyFrameId keyframe) override {
    const std::lock_guard lock(mutex_);
    detector_.remove(keyframe);
  }
  std::vector<PlaceMatch> query(std::span<const Descriptor> descriptors, int most) const override {
    const std::lock_guard lock(mutex_);
    return detector_.query(descriptors, most);
  }

 private:
  LoopDetector& detector_;
  mutable std::mutex mutex_;
};

}  // namespace holdfast
