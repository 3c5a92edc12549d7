// SPDX-License-Identifier: BSD-3-Clause
// A camera of one's own: whatever gives colour and depth images with rising time stamps. This one slides along a wall.
#include <cmath>
#include <iostream>
#include <opencv2/core.hpp>

#include "holdfast/holdfast.hpp"
#include "holdfast/settings/all.hpp"

class SlidingCamera final : public holdfast::FrameSource {
 public:
  SlidingCamera() : wall_(480, 640 + 2 * frames, CV_8UC3) { cv::RNG(1).fill(wall_, cv::RNG::UNIFORM, 0, 256); }

  holdfast::SourceDescription describe() const override {
    holdfast::SourceDescription description;
    description.name = "a wall";
    description.has_depth = true;
    description.can_read_ahead = true;        // frames do not depend on what happens between two calls of next()
    description.camera = holdfast::Camera{};  // 640 x 480 pixels, focal length 525 px
    return description;
  }
  std::optional<holdfast::SensorFrame> next() override {
    if (index_ == frames) return std::nullopt;
    holdfast::SensorFrame frame;
    frame.index = static_cast<std::uint64_t>(index_);
    frame.timestamp = index_ / 30.0;
    frame.colour = wall_(cv::Rect(2 * index_, 0, 640, 480));
    frame.depth = cv::Mat(480, 640, CV_32FC1, cv::Scalar(distance));
    ++index_;
    return frame;
  }

  static constexpr int frames = 30;
  static constexpr double distance = 2.0;  // of the wall [m]

 private:
  cv::Mat wall_;
  int index_ = 0;
};

int main() try {
  SlidingCamera source;
  holdfast::Pipeline pipeline = holdfast::PipelineBuilder()
                                    .source(source.describe())
                                    .features(holdfast::OrbSettings{})
                                    .optimizer(holdfast::CeresSettings{})
                                    .build();
  while (const auto frame = source.next()) pipeline.feed(*frame);
  pipeline.finish();
  const double way = pipeline.trajectory().back().T_world_camera.translation().x();
  const double truth = 2.0 * (SlidingCamera::frames - 1) * SlidingCamera::distance / pipeline.camera().fx;
  std::cout << "the camera went " << way << " m to the right, in truth " << truth << " m\n";
  return std::abs(way - truth) < 0.01 ? 0 : 1;
} catch (const holdfast::Error& error) {
  std::cerr << error.what() << '\n';
  return 1;
}
