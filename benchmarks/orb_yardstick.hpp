// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "holdfast/core/stage_times.hpp"
#include "processor_time.hpp"

namespace holdfast {

/// What other times are compared with: cv::ORB with 1000 features, on the same image and in the same process. A ratio
/// says the same on fast, slow and busy machines.
class OrbYardstick {
 public:
  /// Time for one colour frame, its conversion to grey left out [s].
  double seconds(const cv::Mat& colour) {
    cv::cvtColor(colour, grey_, cv::COLOR_BGR2GRAY);
    const Stopwatch watch;
    detect();
    return watch.seconds();
  }
  /// The same in processor time of the calling thread, added to `times`.
  void add_thread_seconds(const cv::Mat& colour, std::vector<double>& times) {
    cv::cvtColor(colour, grey_, cv::COLOR_BGR2GRAY);
    time(times, [this] { detect(); });
  }

 private:
  void detect() { orb_->detectAndCompute(grey_, cv::noArray(), keypoints_, descriptors_); }

  cv::Ptr<cv::ORB> orb_ = cv::ORB::create(1000);
  cv::Mat grey_, descriptors_;
  std::vector<cv::KeyPoint> keypoints_;
};

}  // namespace holdfast
