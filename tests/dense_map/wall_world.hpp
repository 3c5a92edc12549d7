// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <optional>
#include <vector>

#include "holdfast/core/map.hpp"
#include "holdfast/dense_map/static_scene.hpp"

namespace holdfast::test {

/// A wall at z = 2 m whose colour changes smoothly with the place, and a pure green square in front of it at z = 1 m,
/// where one is asked for. Seen without rotation.
struct WallWorld {
  static constexpr double wall_z = 2.0, square_z = 1.0, half_size = 0.25;

  Camera camera;
  Map map;
  std::vector<KeyFrameId> keyframes;

  explicit WallWorld(double k1 = 0.0) {
    camera.width = 160;
    camera.height = 120;
    camera.fx = camera.fy = 130;
    camera.cx = 79.5;
    camera.cy = 59.5;
    camera.distortion.k1 = k1;
  }

  static cv::Vec3b wall_colour(double x, double y) {
    return {static_cast<std::uint8_t>(std::lround(120.0 + 60.0 * x)), 40,
            static_cast<std::uint8_t>(std::lround(120.0 + 60.0 * y))};
  }
  static constexpr int square_green = 250;

  /// Adds the keyframe to the map.
  KeyFrameId keyframe(double camera_x, std::uint64_t index) {
    Frame frame;
    frame.index = index;
    frame.timestamp = static_cast<double>(index) * 0.1;
    frame.camera = std::make_shared<Camera>(camera);
    frame.T_camera_world.translation().x() = -camera_x;
    keyframes.push_back(map.add_keyframe(std::move(frame)));
    return keyframes.back();
  }

  SensorFrame images(double camera_x, std::uint64_t index, std::optional<double> square_x,
                     cv::Mat* labels = nullptr) const {
    SensorFrame frame;
    frame.index = index;
    frame.timestamp = static_cast<double>(index) * 0.1;
    frame.colour.create(camera.height, camera.width, CV_8UC3);
    frame.depth.create(camera.height, camera.width, CV_32FC1);
    if (labels != nullptr) *labels = cv::Mat::zeros(camera.height, camera.width, CV_8UC1);
    for (int row = 0; row < camera.height; ++row)
      for (int column = 0; column < camera.width; ++column) {
        const Eigen::Vector2d pixel = camera.undistort({column, row});
        const Eigen::Vector3d ray = camera.back_project(pixel.x(), pixel.y(), 1.0);
        const Eigen::Vector2d on_square(camera_x + ray.x() * square_z, ray.y() * square_z);
        if (square_x && std::abs(on_square.x() - *square_x) < half_size && std::abs(on_square.y()) < half_size) {
          frame.colour.at<cv::Vec3b>(row, column) = {0, square_green, 0};
          frame.depth.at<float>(row, column) = static_cast<float>(square_z);
          if (labels != nullptr) labels->at<std::uint8_t>(row, column) = 1;
        } else {
          frame.colour.at<cv::Vec3b>(row, column) = wall_colour(camera_x + ray.x() * wall_z, ray.y() * wall_z);
          frame.depth.at<float>(row, column) = static_cast<float>(wall_z);
        }
      }
    return frame;
  }

  /// A keyframe of the map that is also kept in a scene; masked where the square is, or not.
  void show(StaticScene& scene, double camera_x, std::optional<double> square_x, bool masked) {
    const std::uint64_t index = keyframes.size();
    const KeyFrameId id = keyframe(camera_x, index);
    cv::Mat labels;
    const SensorFrame frame = images(camera_x, index, square_x, &labels);
    scene.add(id, frame, {}, masked ? labels : cv::Mat(), {false, true});
  }
};

inline int count_green(const std::vector<CloudPoint>& cloud) {
  int count = 0;
  for (const CloudPoint& point : cloud) count += point.green > 150 ? 1 : 0;
  return count;
}

}  // namespace holdfast::test
