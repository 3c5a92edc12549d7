// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/tracking/feature_flow.hpp"

#include <utility>

#include "holdfast/matching/frame_features.hpp"

namespace holdfast {

namespace {

constexpr PointFlowSettings flow_settings{.iterations = 15, .precision = 0.02F, .largest_difference = 20.0F};
constexpr float margin = 11.0F;  // so that the window lies in the image [px]
constexpr std::size_t least_found = 30;

}  // namespace

void FeatureFlow::add_image(const cv::Mat& grey) {
  std::swap(image_, last_image_);
  image_.build(grey);
}

void FeatureFlow::set_template(const Frame& frame) {
  std::swap(template_, last_image_);
  camera_ = frame.camera;
  T_world_template_ = frame.T_world_camera();
  points_.clear(), rays_.clear(), has_depth_.clear(), x_.clear(), y_.clear();
  features_.resize(0, frame.features.descriptors.type());
  for (std::size_t i = 0; i < frame.size(); ++i) {
    if (!frame.map_points[i].valid() || !is_static(frame, i)) continue;
    points_.push_back(frame.map_points[i]);
    has_depth_.push_back(frame.has_depth(i) ? 1 : 0);
    rays_.emplace_back(
        (frame.has_depth(i) ? frame.camera_point(i) : frame.camera->back_project(frame.x[i], frame.y[i], 1.0))
            .cast<float>());
    x_.push_back(frame.x[i]), y_.push_back(frame.y[i]);
    features_.x.push_back(frame.features.x[i]), features_.y.push_back(frame.features.y[i]);
    features_.angle.push_back(frame.features.angle[i]);
    features_.response.push_back(frame.features.response[i]);
    features_.octave.push_back(frame.features.octave[i]);
    features_.descriptors.append(frame.features.descriptors, i);
  }
}

void FeatureFlow::predict(const Eigen::Isometry3d& T_camera_template) {
  const Eigen::Matrix3f rotation = T_camera_template.linear().cast<float>();
  const Eigen::Vector3f translation = T_camera_template.translation().cast<float>();
  const auto fx = static_cast<float>(camera_->fx), fy = static_cast<float>(camera_->fy);
  const auto cx = static_cast<float>(camera_->cx), cy = static_cast<float>(camera_->cy);
  for (std::size_t i = 0; i < points_.size(); ++i) {
    flow_.from_x[i] = flow_.to_x[i] = features_.x[i], flow_.from_y[i] = flow_.to_y[i] = features_.y[i];
    Eigen::Vector3f point = rotation * rays_[i];
    if (has_depth_[i] != 0) point += translation;
    if (point.z() < 0.01F * rays_[i].z()) continue;
    // The lens moves both ends of so short a way alike.
    flow_.to_x[i] += fx * point.x() / point.z() + cx - x_[i];
    flow_.to_y[i] += fy * point.y() / point.z() + cy - y_[i];
  }
}

bool FeatureFlow::follow(const Eigen::Isometry3d& T_camera_world, const cv::Mat& ignore, Features& features) {
  found_points_.clear();
  features.resize(0, features_.descriptors.type());
  const std::size_t count = points_.size();
  if (count < least_found) return false;
  flow_.resize(count);
  predict(T_camera_world * T_world_template_);
  follow_points(template_, image_, flow_settings, flow_);
  for (std::size_t i = 0; i < count; ++i) {
    if (flow_.found[i] == 0) continue;
    const float x = flow_.to_x[i], y = flow_.to_y[i];
    if (!(x >= margin && y >= margin && x <= static_cast<float>(camera_->width - 1) - margin &&
          y <= static_cast<float>(camera_->height - 1) - margin))
      continue;
    if (!ignore.empty() && ignore.at<std::uint8_t>(static_cast<int>(y), static_cast<int>(x)) != 0) continue;
    found_points_.push_back(points_[i]);
    features.x.push_back(x), features.y.push_back(y);
    features.angle.push_back(features_.angle[i]);
    features.response.push_back(features_.response[i]);
    features.octave.push_back(features_.octave[i]);
    features.descriptors.append(features_.descriptors, i);
  }
  return features.size() >= least_found;
}

}  // namespace holdfast
