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

FrameBuilder::FrameBuilder(const Camera& camera, FeatureExtractor& extractor, double depth_edge_ratio)
    : camera_(std::make_shared<const Camera>(exposed_at_once(camera))),
      pyramid_(std::make_shared<const ScalePyramid>(extractor.pyramid())),
      extractor_(extractor),
      depth_reader_(camera_, depth_edge_ratio),
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
  const cv::Mat& depth = sensor_frame.depth;
  if (!depth.empty() && (depth.type() != CV_32FC1 || depth.size() != colour.size()))
    throw InputError({"frame " + std::to_string(sensor_frame.index)},
                     "the depth image is " + size_text(depth.cols, depth.rows) +
                         "; expected one 32 bit float channel [m] of the colour image's size");
  const cv::Mat& right = sensor_frame.right;
  if (stereo_ && ((right.type() != CV_8UC1 && right.type() != CV_8UC3) || right.size() != colour.size()))
    throw InputError({"frame " + std::to_string(sensor_frame.index)},
                     right.empty() ? std::string("has no right image; expected one in every frame of a stereo pair")
                                   : "the right image is " + size_text(right.cols, right.rows) + " with " +
                                         std::to_string(right.channels()) +
                                         " channels; expected 1 or 3 channels of 8 bit, of the left image's size");
}

void FrameBuilder::begin(const SensorFrame& sensor_frame, Frame& frame, StageTimes& times) {
  check_images(sensor_frame);
  const cv::Mat& colour = sensor_frame.colour;
  const cv::Mat& depth = sensor_frame.depth;
  const cv::Mat& right = sensor_frame.right;
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
  if (!stereo_) {
    coarse_sampler_.sample_depth(depth, frame.coarse);
    return;
  }
  if (right.channels() == 3) cv::cvtColor(right, converted_right_, cv::COLOR_BGR2GRAY);
  grey_right_ = right.channels() == 3 ? converted_right_ : right;
  pair_depth_.reset();
  coarse_sampler_.sample_depth(stereo_->is_dense() ? pair_depth() : cv::Mat(), frame.coarse);
}

const cv::Mat& FrameBuilder::pair_depth() {
  if (!pair_depth_) pair_depth_ = stereo_->depth_image(grey_, grey_right_);
  return *pair_depth_;
}

void FrameBuilder::find_features(const SensorFrame& sensor_frame, const cv::Mat& ignore, Frame& frame,
                                 StageTimes& times) {
  {
    const StageTimer timer(times, "features");
    if (!ignore.empty() && !unusable_.empty()) cv::bitwise_or(ignore, unusable_, ignored_);
    const cv::Mat& without = unusable_.empty() ? ignore : ignore.empty() ? unusable_ : ignored_;
    if (stereo_)
      stereo_->extract(grey_, grey_right_, without, extractor_, frame);
    else
      extractor_.extract(grey_, without, frame.features);
  }
  complete(sensor_frame, frame, times);
}

void FrameBuilder::set_budget(double factor) {
  extractor_.set_budget(factor);
  if (stereo_) stereo_->set_budget(factor);
}

void FrameBuilder::place_features(const SensorFrame& sensor_frame, const FrameMotion& motion, bool aligns_depth,
                                  const RollingShutter& shutter, const Map& map, Frame& frame,
                                  StageTimes& times) const {
  if (stereo_ || (!aligns_depth && !shutter.is_active())) return;
  const StageTimer timer(times, "frame");
  // Depth is measured row by row as well, almost at the same pace, so that it is read where the rows show it.
  if (shutter.is_active()) undistortion_.undistort(frame.features.x, frame.features.y, frame.x, frame.y);
  if (aligns_depth)
    depth_reader_.align(sensor_frame.depth, motion.during(sensor_frame.depth_delay), frame);
  else
    depth_reader_.read(sensor_frame.depth, frame);
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
  if (stereo_)
    stereo_->depth(grey_, grey_right_, frame);
  else
    depth_reader_.read(sensor_frame.depth, frame);
  frame.map_points.assign(frame.size(), MapPointId());
  frame.static_probability.assign(frame.size(), 1.0F);
  frame.measured_log_odds.assign(frame.size(), 0.0F);
  build_grid(frame);
}

}  // namespace holdfast
