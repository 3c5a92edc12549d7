// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <numbers>
#include <vector>

#include "holdfast/core/map.hpp"
#include "holdfast/core/random.hpp"
#include "holdfast/geometry/se3.hpp"
#include "support/brute_force_detector.hpp"

namespace holdfast::test {

/// A camera that walks inside a ring of walls and looks outwards, an odometry that drifts, and the map that tracking
/// and mapping would make of it: points are matched with those of the last few keyframes only, so that a place seen
/// again is mapped again.
class RingWorld {
 public:
  explicit RingWorld(double drift_per_keyframe = 0.004, std::uint64_t seed = 3) : random_(seed) {
    camera_ = std::make_shared<Camera>(find_camera("tum_fr3").value());
    pyramid_ = std::make_shared<ScalePyramid>();
    // Turning too far and sinking: the end of a round misses its beginning by the sum. A drift along the walls would
    // make a ring of another size instead, which no loop can tell.
    drift_ = Eigen::Isometry3d::Identity();
    drift_.linear() = Eigen::AngleAxisd(0.3 * drift_per_keyframe, Eigen::Vector3d::UnitY()).toRotationMatrix();
    drift_.translation() = Eigen::Vector3d(0, drift_per_keyframe, 0);
  }

  /// Points on the wall between two angles [rad]; `twin_of` repeats the descriptors of an earlier call's points and
  /// their positions, turned to begin at `from`.
  void add_wall(double from, double to, int count) {
    for (int i = 0; i < count; ++i) {
      const double angle = random_.uniform(from, to), radius = random_.uniform(3.2, 4.4);
      points_.emplace_back(radius * std::sin(angle), random_.uniform(-1.2, 1.2), radius * std::cos(angle));
      descriptors_.push_back(random_descriptor());
    }
  }
  /// The points of a stretch of wall once more, turned by an angle about the middle: a place that looks the same.
  void repeat_wall(double from, double to, double turn) {
    const std::size_t count = points_.size();
    for (std::size_t i = 0; i < count; ++i) {
      double angle = std::atan2(points_[i].x(), points_[i].z());
      if (angle < 0) angle += 2.0 * std::numbers::pi;
      if (angle < from || angle >= to) continue;
      points_.push_back(Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitY()) * points_[i]);
      descriptors_.push_back(descriptors_[i]);
    }
  }
  /// New positions for all points, the same descriptors: alike and yet another place.
  void scramble() {
    for (std::size_t i = points_.size(); i > 1; --i)
      std::swap(points_[i - 1], points_[random_.below(static_cast<std::uint32_t>(i))]);
  }

  static Eigen::Isometry3d pose_at(double angle) {
    Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();
    T_world_camera.linear() = Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitY()).toRotationMatrix();
    T_world_camera.translation() = T_world_camera.linear() * Eigen::Vector3d(0, 0, 1.5);
    return T_world_camera;
  }

  /// The next keyframe, where the camera stands at an angle [rad]; its pose has drifted on from the last one's.
  KeyFrameId add_keyframe(Map& map, double angle) {
    const Eigen::Isometry3d truth = pose_at(angle);
    Frame frame = frame_at(truth);
    if (!last_.valid()) {
      frame.T_camera_world = truth.inverse();
    } else {
      const Eigen::Isometry3d T_last_this = truth_.at(last_).inverse() * truth * drift_;
      frame.T_camera_world =
          geometry::orthonormalised((map.pose_of(last_).inverse() * T_last_this * mistake_).inverse());
      mistake_ = Eigen::Isometry3d::Identity();
    }
    frame.timestamp = hidden_seconds_ + static_cast<double>(map.next_sequence());
    constexpr std::uint64_t memory = 6;  // keyframes
    for (std::size_t i = 0; i < frame.size(); ++i) {
      const auto known = latest_.find(shown_[i]);
      if (known == latest_.end() || map.find_point(known->second.point) == nullptr) continue;
      if (known->second.sequence + memory >= map.next_sequence()) frame.map_points[i] = known->second.point;
    }
    const KeyFrameId id = map.add_keyframe(frame);
    map.keyframe(id).submap = submap_;
    const KeyFrame& keyframe = map.keyframe(id);
    for (std::uint32_t i = 0; i < keyframe.frame.size(); ++i) {
      MapPointId point = keyframe.frame.map_points[i];
      if (!point.valid()) {
        point = map.add_point(keyframe.frame.T_world_camera() * keyframe.frame.camera_point(i), keyframe.sequence);
        map.add_observation(point, id, i);
      }
      map.update_point(point);
      latest_[shown_[i]] = {point, keyframe.sequence};
    }
    map.update_covisibility(id);
    if (last_.valid() && map.keyframe(id).submap == map.keyframe(last_).submap && !map.keyframe(id).parent.valid())
      map.set_parent(id, last_);
    last_ = id;
    truth_[id] = truth;
    return id;
  }

  /// The next keyframe begins a new submap, with a pose that is off by `mistake` and none of the points.
  void begin_submap(Map& map, const Eigen::Isometry3d& mistake) {
    latest_.clear();
    mistake_ = mistake;
    submap_ = map.new_submap();
  }

  /// The view is hidden for some seconds: the next keyframe sees none of the points, and its pose is off by `mistake`.
  void hide_view(const Eigen::Isometry3d& mistake, double seconds) {
    latest_.clear();
    mistake_ = mistake;
    hidden_seconds_ += seconds;
  }

  /// Largest distance of a keyframe from where it truly is.
  double largest_error(const Map& map) const {
    double largest = 0.0;
    map.keyframes().for_each([&](KeyFrameId id, const KeyFrame& keyframe) {
      largest = std::max(largest, (keyframe.frame.T_world_camera().translation() - truth_.at(id).translation()).norm());
    });
    return largest;
  }
  double error_of(const Map& map, KeyFrameId id) const {
    return (map.pose_of(id).inverse().translation() - truth_.at(id).translation()).norm();
  }

 private:
  struct Known {
    MapPointId point;
    std::uint64_t sequence = 0;
  };

  Descriptor256 random_descriptor() {
    Descriptor256 descriptor;
    for (std::uint64_t& word : descriptor.words) word = random_.next();
    return descriptor;
  }

  Frame frame_at(const Eigen::Isometry3d& T_world_camera) {
    Frame frame;
    frame.camera = camera_;
    frame.pyramid = pyramid_;
    shown_.clear();
    const Eigen::Isometry3d T_camera_world = T_world_camera.inverse();
    for (std::size_t i = 0; i < points_.size(); ++i) {
      const Eigen::Vector3d p = T_camera_world * points_[i];
      if (p.z() < 0.5) continue;
      const Eigen::Vector2d pixel = camera_->project(p);
      if (pixel.x() < 1 || pixel.y() < 1 || pixel.x() > camera_->width - 2 || pixel.y() > camera_->height - 2) continue;
      const int octave = std::clamp(static_cast<int>(std::lround(std::log(4.0 / p.norm()) / std::log(1.2))), 0, 7);
      const double noise = 0.3 * pyramid_->scale[static_cast<std::size_t>(octave)];
      shown_.push_back(i);
      frame.x.push_back(static_cast<float>(pixel.x() + noise * random_.normal()));
      frame.y.push_back(static_cast<float>(pixel.y() + noise * random_.normal()));
      const double right = camera_->right_x(frame.x.back(), p.z()) + noise * random_.normal();
      frame.depth.push_back(static_cast<float>(camera_->fx * camera_->baseline / (frame.x.back() - right)));
      frame.right_x.push_back(static_cast<float>(right));
      frame.features.octave.push_back(static_cast<std::uint8_t>(octave));
      Descriptor256 descriptor = descriptors_[i];
      for (int flips = 0; flips < 8; ++flips) {
        const std::uint32_t bit = random_.below(256);
        descriptor.words[bit / 64] ^= std::uint64_t{1} << (bit % 64);
      }
      frame.features.descriptors.push_back(descriptor);
    }
    frame.features.x = frame.x;
    frame.features.y = frame.y;
    frame.features.angle.assign(shown_.size(), 1.0F);
    frame.features.response.assign(shown_.size(), 1.0F);
    frame.map_points.assign(shown_.size(), MapPointId());
    frame.static_probability.assign(shown_.size(), 1.0F);
    frame.grid.build(frame.x, frame.y, {0, 0, static_cast<float>(camera_->width), static_cast<float>(camera_->height)});
    return frame;
  }

  Random random_;
  std::shared_ptr<const Camera> camera_;
  std::shared_ptr<const ScalePyramid> pyramid_;
  Eigen::Isometry3d drift_;
  Eigen::Isometry3d mistake_ = Eigen::Isometry3d::Identity();
  std::uint32_t submap_ = 0;
  double hidden_seconds_ = 0.0;
  std::vector<Eigen::Vector3d> points_;
  std::vector<Descriptor256> descriptors_;
  std::vector<std::size_t> shown_;  // of the last frame
  std::map<std::size_t, Known> latest_;
  std::map<KeyFrameId, Eigen::Isometry3d> truth_;
  KeyFrameId last_;
};

}  // namespace holdfast::test
