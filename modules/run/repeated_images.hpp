// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <string>

#include "holdfast/run/run_record.hpp"

namespace holdfast {

/// A hash of the bytes of an image; 0 for an empty image and for one whose rows are all alike, as when the lens is
/// covered, which is no repetition.
std::uint64_t image_fingerprint(const cv::Mat& image);

/// Finds repeated images among the frames of a run.
class RepeatFinder {
 public:
  /// To be called for each frame in turn; a fingerprint of 0 is like no other.
  void add(double timestamp, std::uint64_t fingerprint);
  const RepeatedImages& found() const { return found_; }

 private:
  RepeatedImages found_;
  std::uint64_t fingerprint_ = 0;  // of the frame before
  double begin_ = 0.0;             // of its image
};

/// What repeated images mean and what to do, in whole sentences; empty where they are too few to matter.
std::string repetition_warning(const RepeatedImages& repeated, std::size_t frames);

}  // namespace holdfast
