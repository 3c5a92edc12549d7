// SPDX-License-Identifier: BSD-3-Clause
#include "scene.hpp"

#include <array>
#include <cmath>
#include <limits>

#include "holdfast/core/random.hpp"

namespace holdfast::conformance {

namespace {

struct Block {
  Eigen::Vector3d centre, half_size;
  std::uint8_t label;
};

/// A surface of squares of two sizes with different brightness, which has corners at their borders.
std::array<std::uint8_t, 3> texture(double u, double v, std::uint64_t surface) {
  const auto square = [&](double size, std::uint64_t stream) {
    const auto column = static_cast<std::int64_t>(std::floor(u / size)),
               row = static_cast<std::int64_t>(std::floor(v / size));
    return Random(surface * 0x9e3779b9U + stream)
        .fork(static_cast<std::uint64_t>(column + 4096))
        .fork(static_cast<std::uint64_t>(row + 4096))
        .next();
  };
  const std::uint64_t coarse = square(0.17, 1), fine = square(0.06, 2);
  const auto channel = [&](int shift) {
    return static_cast<std::uint8_t>(30 + ((coarse >> shift) & 127) + ((fine >> 8) & 63));
  };
  return {channel(0), channel(3), channel(5)};
}

}  // namespace

const std::vector<std::string>& Scene::classes() {
  static const std::vector<std::string> names{"background", "person", "box"};
  return names;
}

Eigen::Isometry3d Scene::T_world_camera(std::uint64_t index) {
  const double time = interval * static_cast<double>(index);
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() = Eigen::Vector3d(0.08 * std::sin(0.9 * time), 0.03 * std::sin(1.7 * time), 0.05 * time);
  pose.linear() = Eigen::AngleAxisd(0.04 * std::sin(time), Eigen::Vector3d::UnitY()).toRotationMatrix();
  return pose;
}

Scene::Hit Scene::look(std::uint64_t index, double x, double y) const {
  const Eigen::Isometry3d T_world_camera = Scene::T_world_camera(index);
  const Eigen::Vector3d origin = T_world_camera.translation();
  const Eigen::Vector3d ray = T_world_camera.linear() * camera_.back_project(x, y, 1.0);
  double nearest = std::numeric_limits<double>::infinity();
  int surface = -1, axis = 2;
  const auto offer = [&](double depth, int of, int normal) {
    if (depth > 0.05 && depth < nearest) nearest = depth, surface = of, axis = normal;
  };
  if (ray.z() > 0.0) offer((3.2 - origin.z()) / ray.z(), 0, 2);
  if (ray.y() > 0.0) offer((0.9 - origin.y()) / ray.y(), 1, 1);
  const std::array<Block, 2> blocks{{{Eigen::Vector3d(0.1, 0.1, 1.9) + moved(index), {0.2, 0.6, 0.12}, person},
                                     {{-0.8, 0.5, 2.3}, {0.3, 0.4, 0.25}, 2}}};
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    double enter = 0.0, leave = std::numeric_limits<double>::infinity();
    int side = 2;
    for (int a = 0; a < 3; ++a) {
      const double first = (blocks[i].centre[a] - blocks[i].half_size[a] - origin[a]) / ray[a];
      const double second = (blocks[i].centre[a] + blocks[i].half_size[a] - origin[a]) / ray[a];
      if (std::min(first, second) > enter) enter = std::min(first, second), side = a;
      leave = std::min(leave, std::max(first, second));
    }
    if (enter <= leave) offer(enter, static_cast<int>(i) + 2, side);
  }
  Hit hit;
  if (surface < 0) return hit;
  hit.depth = nearest;
  hit.point = origin + nearest * ray;
  Eigen::Vector3d on_surface = hit.point;
  if (surface >= 2) {
    const Block& block = blocks[static_cast<std::size_t>(surface - 2)];
    hit.label = block.label;
    on_surface -= block.centre;
  }
  const auto colour = texture(on_surface[(axis + 1) % 3], on_surface[(axis + 2) % 3],
                              static_cast<std::uint64_t>(3 * surface + axis + 1));
  hit.blue = colour[0], hit.green = colour[1], hit.red = colour[2];
  return hit;
}

SensorFrame Scene::frame(std::uint64_t index) const {
  SensorFrame frame;
  frame.index = index;
  frame.timestamp = interval * static_cast<double>(index);
  frame.colour = cv::Mat(camera_.height, camera_.width, CV_8UC3);
  frame.depth = cv::Mat(camera_.height, camera_.width, CV_32FC1);
  auto truth = std::make_shared<FrameTruth>();
  truth->T_world_camera = T_world_camera(index);
  truth->class_labels = cv::Mat(camera_.height, camera_.width, CV_8UC1);
  for (int y = 0; y < camera_.height; ++y)
    for (int x = 0; x < camera_.width; ++x) {
      const Hit hit = look(index, x, y);
      std::uint8_t* pixel = frame.colour.ptr<std::uint8_t>(y) + 3 * x;
      pixel[0] = hit.blue, pixel[1] = hit.green, pixel[2] = hit.red;
      frame.depth.at<float>(y, x) = static_cast<float>(hit.depth);
      truth->class_labels.at<std::uint8_t>(y, x) = hit.label;
    }
  truth->object_mask = truth->class_labels;
  truth->moving_objects = {person};
  frame.truth = std::move(truth);
  return frame;
}

cv::Mat Scene::grey(const SensorFrame& frame) {
  cv::Mat grey(frame.colour.size(), CV_8UC1);
  for (int y = 0; y < grey.rows; ++y)
    for (int x = 0; x < grey.cols; ++x) {
      const std::uint8_t* pixel = frame.colour.ptr<std::uint8_t>(y) + 3 * x;
      grey.at<std::uint8_t>(y, x) = static_cast<std::uint8_t>((pixel[0] + 2 * pixel[1] + pixel[2]) / 4);
    }
  return grey;
}

std::uint64_t digest(const cv::Mat& image) {
  if (image.empty()) return 0;
  std::uint64_t sum = 0xcbf29ce484222325ULL;  // FNV-1a
  const auto add = [&](std::uint8_t byte) { sum = (sum ^ byte) * 0x100000001b3ULL; };
  const std::size_t row_bytes = static_cast<std::size_t>(image.cols) * image.elemSize();
  for (int y = 0; y < image.rows; ++y)
    for (std::size_t i = 0; i < row_bytes; ++i) add(image.ptr<std::uint8_t>(y)[i]);
  return sum;
}

std::uint64_t digest(const SensorFrame& frame) {
  std::uint64_t sum = digest(frame.colour) ^ (3 * digest(frame.depth));
  if (frame.truth) sum ^= 5 * digest(frame.truth->class_labels) ^ 7 * digest(frame.truth->object_mask);
  return sum;
}

cv::Mat with_gaps(const cv::Mat& image) {
  if (image.empty()) return image;
  cv::Mat larger(image.rows + 3, image.cols + 5, image.type(), cv::Scalar::all(77));
  cv::Mat inside = larger(cv::Rect(2, 1, image.cols, image.rows));
  image.copyTo(inside);
  return inside;
}

SensorFrame with_gaps(const SensorFrame& frame) {
  SensorFrame copy = frame;
  copy.colour = with_gaps(frame.colour);
  copy.depth = with_gaps(frame.depth);
  return copy;
}

}  // namespace holdfast::conformance
