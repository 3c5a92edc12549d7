// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <string>
#include <vector>

#include "holdfast/core/camera.hpp"
#include "holdfast/core/sensor_frame.hpp"
#include "holdfast/interfaces/segmenter.hpp"

namespace holdfast::conformance {

/// The scene of the tests: a wall, a floor and a static box, all with many corners, and in front of them a block that
/// moves to the right and represents a person. The camera moves slightly. It is exact and identical on every call.
class Scene {
 public:
  explicit Scene(const Camera& camera) : camera_(camera) {}

  static const std::vector<std::string>& classes();  // background, person, box
  static constexpr double interval = 0.1;            // s between frames
  static constexpr std::uint8_t person = 1;

  const Camera& camera() const { return camera_; }
  static Eigen::Isometry3d T_world_camera(std::uint64_t index);
  /// How far the person has moved since frame 0 [m].
  static Eigen::Vector3d moved(std::uint64_t index) { return {0.05 * static_cast<double>(index), 0.0, 0.0}; }

  /// What the ray through a pixel meets.
  struct Hit {
    double depth = 0.0;
    std::uint8_t label = 0;
    Eigen::Vector3d point = Eigen::Vector3d::Zero();  // world
    std::uint8_t blue = 0, green = 0, red = 0;
  };
  Hit look(std::uint64_t index, double x, double y) const;

  /// With depth and truth.
  SensorFrame frame(std::uint64_t index) const;
  /// The colour image as grey.
  static cv::Mat grey(const SensorFrame& frame);

 private:
  Camera camera_;
};

/// A digest of an image's pixels, row by row, without the padding between rows; 0 for an empty image.
std::uint64_t digest(const cv::Mat& image);
/// Of everything in a frame that a module could write to.
std::uint64_t digest(const SensorFrame& frame);
/// A copy of the frame whose images lie inside larger ones, so that their rows are not contiguous.
SensorFrame with_gaps(const SensorFrame& frame);
cv::Mat with_gaps(const cv::Mat& image);

}  // namespace holdfast::conformance
