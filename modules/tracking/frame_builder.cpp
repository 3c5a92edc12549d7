// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/tracking/frame_builder.hpp"

#include <opencv2/imgproc.hpp>
#include <string>

#include "holdfast/core/error.hpp"
#include "holdfast/core/size_text.hpp"

namespace holdfast {

namespace {

/// The camera of frames, whose features are where an image exposed at once would show them.
Camera exposed_at_once(Camera camera) {
  camera.readout = 0.0;
  return camera;
}

/// Where the camera cannot use its image; empty if there is no such place.
cv::Mat unusable_pixels(const Camera& camera) {
  if (camera.distortion.lens != Lens::fisheye) return {};
  cv::Mat mask(camera.height, camera.width, CV_8UC1, cv::Scalar(0));
  bool any = false;
  for (int row = 0; row < camera.height; ++row)
    for (int column = 0; column < camera.width; ++column) {
      const bool usable = camera.is_usable({static_cast<double>(column), static_cast<double>(row)});
      mask.ptr<std::uint8_t>(row)[column] = usable ? 0 : 255;
      any = any || !usable;
    }
  return any ? mask : cv::Mat();
}

}  // namespace

FrameBuilder::FrameBuilder(const Camera& camera, FeatureExtractor& extractor, DepthProvider& depth)
    : camera_(std::make_shared<const Camera>(exposed_at_once(camera))),
      pyramid_(std::make_shared<const ScalePyramid>(extractor.pyramid())),
      extractor_(extractor),
      depth_(depth),
      undistortion_(camera),
      coarse_sampler_(camera),
      unusable_(unusable_pixels(camera)) {
  camera.undistorted_bounds(minimum_, maximum_);
}

void FrameBuilder::check_images(const SensorFrame& sensor_frame) const {
  const cv::Mat& colour = sensor_frame.colour;
  if ((colour.type() != CV_8UC1 && colour.type() != CV_8UC3) || colour.cols != camera_->width ||
      colour.rows != camera_->height)
    throw InputError({"frame " + std::to_string(sensor_frame.index)},
                     "the colour image is " + size_text(colour.cols, colour.rows) + " with " +
                         std::to_string(colour.channels()) + " channels; expected " +
                         size_text(camera_->width, camera_->height) +
                         " with 1 or 3 channels of 8 bit, as the camera says");
  depth_.check_images(sensor_frame);
}

void FrameBuilder::begin(const SensorFrame& sensor_frame, Frame& frame, StageTimes& times) {
  check_images(sensor_frame);
  const cv::Mat& colour = sensor_frame.colour;
  const bool is_grey = colour.type() == CV_8UC1;
  const StageTimer timer(times, "frame");
  frame.index = sensor_frame.index;
  frame.timestamp = sensor_frame.timestamp;
  frame.camera = camera_;
  frame.pyramid = pyramid_;
  frame.T_camera_world.setIdentity();
  frame.image_descriptor.clear();
  if (!is_grey) cv::cvtColor(colour, converted_, cv::COLOR_BGR2GRAY);
  grey_ = is_grey ? colour : converted_;
  coarse_sampler_.sample_depth(depth_.begin(sensor_frame, grey_), frame.coarse);
}

void FrameBuilder::find_features(const SensorFrame& sensor_frame, const cv::Mat& ignore, Frame& frame,
                                 StageTimes& times) {
  {
    const StageTimer timer(times, "features");
    if (!ignore.empty() && !unusable_.empty()) cv::bitwise_or(ignore, unusable_, ignored_);
    const cv::Mat& without = unusable_.empty() ? ignore : ignore.empty() ? unusable_ : ignored_;
    depth_.extract(grey_, without, extractor_, frame);
  }
  complete(sensor_frame, frame, times);
}

void FrameBuilder::set_budget(double factor) {
  extractor_.set_budget(factor);
  depth_.set_budget(factor);
}

void FrameBuilder::place_features(const SensorFrame& sensor_frame, const FrameMotion& motion, bool aligns_depth,
                                  const RollingShutter& shutter, const Map& map, Frame& frame,
                                  StageTimes& times) const {
  if (!depth_.allows_motion_compensation() || (!aligns_depth && !shutter.is_active())) return;
  const StageTimer timer(times, "frame");
  // Depth is measured row by row as well, almost at the same pace, so that it is read where the rows show it.
  if (shutter.is_active()) undistortion_.undistort(frame.features.x, frame.features.y, frame.x, frame.y);
  if (aligns_depth)
    depth_.align(sensor_frame, motion.during(sensor_frame.depth_delay), frame);
  else
    depth_.read(sensor_frame, frame);
  if (!shutter.is_active()) return;
  shutter.correct(motion, map, frame);
  build_grid(frame);
}

void FrameBuilder::build_grid(Frame& frame) const {
  frame.grid.build(frame.x, frame.y,
                   {static_cast<float>(minimum_.x()), static_cast<float>(minimum_.y()),
                    static_cast<float>(maximum_.x()), static_cast<float>(maximum_.y())});
}

void FrameBuilder::complete(const SensorFrame& sensor_frame, Frame& frame, StageTimes& times) {
  const StageTimer timer(times, "frame");
  undistortion_.undistort(frame.features.x, frame.features.y, frame.x, frame.y);
  depth_.read(sensor_frame, frame);
  frame.map_points.assign(frame.size(), MapPointId());
  frame.static_probability.assign(frame.size(), 1.0F);
  frame.measured_log_odds.assign(frame.size(), 0.0F);
  build_grid(frame);
}

}  // namespace holdfast
