// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <memory>
#include <opencv2/core.hpp>
#include <vector>

#include "holdfast/core/camera.hpp"
#include "holdfast/core/random.hpp"
#include "holdfast/core/sensor_frame.hpp"
#include "holdfast/interfaces/feature_extractor.hpp"

namespace holdfast::test {

/// A world of points, each with its own descriptor: geometry without images. The frame's index tells the extractor
/// which pose to see the points from; the depth image holds each point's depth at its pixel.
class PointWorld {
 public:
  explicit PointWorld(Camera camera, int points = 1500, std::uint64_t seed = 5)
      : camera_(std::move(camera)), random_(seed) {
    for (int i = 0; i < points; ++i) {
      const double z = random_.uniform(1.2, 4.0), y = random_.uniform(-1.8, 1.8), x = random_.uniform(-2.5, 2.5);
      points_.emplace_back(x, y, z);
      Descriptor256 descriptor;
      for (std::uint64_t& word : descriptor.words) word = random_.next();
      descriptors_.push_back(descriptor);
    }
  }

  const Camera& camera() const { return camera_; }

  /// Images of the world from a pose; nothing is in them unless `visible`.
  SensorFrame frame(std::uint64_t index, double timestamp, const Eigen::Isometry3d& T_world_camera,
                    bool visible = true) {
    SensorFrame frame;
    frame.index = index;
    frame.timestamp = timestamp;
    frame.colour = cv::Mat::zeros(camera_.height, camera_.width, CV_8UC3);
    frame.depth = cv::Mat::zeros(camera_.height, camera_.width, CV_32FC1);
    seen_.clear();
    if (!visible) return frame;
    const Eigen::Isometry3d T_camera_world = T_world_camera.inverse();
    cv::Mat owner(camera_.height, camera_.width, CV_32SC1, cv::Scalar(-1));
    for (std::size_t i = 0; i < points_.size(); ++i) {
      const Eigen::Vector3d p = T_camera_world * points_[i];
      if (p.z() < 0.3) continue;
      const Eigen::Vector2d pixel = camera_.distort(camera_.project(p));
      const int column = static_cast<int>(std::lround(pixel.x())), row = static_cast<int>(std::lround(pixel.y()));
      if (column < 1 || row < 1 || column >= camera_.width - 1 || row >= camera_.height - 1) continue;
      if (owner.at<int>(row, column) >= 0) continue;
      owner.at<int>(row, column) = static_cast<int>(i);
      // Depth around the point, too, so that a noisy feature still has some.
      constexpr int reach = 3;
      for (int r = std::max(row - reach, 0); r <= std::min(row + reach, camera_.height - 1); ++r)
        for (int c = std::max(column - reach, 0); c <= std::min(column + reach, camera_.width - 1); ++c)
          if (frame.depth.at<float>(r, c) == 0.0F || (r == row && c == column))
            frame.depth.at<float>(r, c) = static_cast<float>(p.z());
      // Octaves follow the distance, as those of real features do.
      const int octave = std::clamp(static_cast<int>(std::lround(std::log(4.0 / p.norm()) / std::log(1.2))), 0, 7);
      seen_.push_back({i, pixel.x(), pixel.y(), octave});
    }
    return frame;
  }

  struct Seen {
    std::size_t point;
    double x, y;
    int octave;
  };
  const std::vector<Seen>& seen() const { return seen_; }
  const Descriptor256& descriptor(std::size_t point) const { return descriptors_[point]; }
  Random& random() { return random_; }

 private:
  Camera camera_;
  Random random_;
  std::vector<Eigen::Vector3d> points_;
  std::vector<Descriptor256> descriptors_;
  std::vector<Seen> seen_;
};

/// "Extracts" what the world last showed: exact positions plus noise, descriptors with a few flipped bits.
class PointExtractor final : public FeatureExtractor {
 public:
  explicit PointExtractor(PointWorld& world, double pixel_noise = 0.0) : world_(world), pixel_noise_(pixel_noise) {}

  void extract(const cv::Mat&, const cv::Mat&, Features& out) override {
    out.resize(world_.seen().size());
    for (std::size_t i = 0; i < out.size(); ++i) {
      const PointWorld::Seen& seen = world_.seen()[i];
      const double noise = pixel_noise_ * pyramid_.scale[static_cast<std::size_t>(seen.octave)];
      out.x[i] = static_cast<float>(seen.x + noise * world_.random().normal());
      out.y[i] = static_cast<float>(seen.y + noise * world_.random().normal());
      out.angle[i] = 1.0F;
      out.response[i] = 1.0F;
      out.octave[i] = static_cast<std::uint8_t>(seen.octave);
      out.descriptors.of_256_bits()[i] = world_.descriptor(seen.point);
      for (int flips = 0; flips < 8; ++flips) {
        const std::uint32_t bit = world_.random().below(256);
        out.descriptors.of_256_bits()[i].words[bit / 64] ^= std::uint64_t{1} << (bit % 64);
      }
    }
  }
  const ScalePyramid& pyramid() const override { return pyramid_; }

 private:
  PointWorld& world_;
  double pixel_noise_;
  ScalePyramid pyramid_;
};

/// A smooth path that starts at the identity: side to side, up and down, turning a little.
inline Eigen::Isometry3d path_pose(double time) {
  Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();
  T_world_camera.translation() =
      Eigen::Vector3d(0.4 * std::sin(0.8 * time), 0.15 * std::sin(1.3 * time), 0.2 - 0.2 * std::cos(0.7 * time));
  T_world_camera.linear() =
      Eigen::AngleAxisd(0.12 * std::sin(0.9 * time), Eigen::Vector3d::UnitY()).toRotationMatrix() *
      Eigen::AngleAxisd(0.06 * std::sin(1.1 * time), Eigen::Vector3d::UnitX()).toRotationMatrix();
  return T_world_camera;
}

}  // namespace holdfast::test
