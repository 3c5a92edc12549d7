// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/tracking/feature_flow.hpp"

#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

#include "holdfast/matching/frame_features.hpp"

namespace holdfast {

namespace {

constexpr int levels = 2;  // above the half resolution
const cv::Size window(11, 11);
constexpr float largest_error = 20.0F;  // mean grey level between the patches
constexpr float margin = 11.0F;         // so that the window lies in the image [px]
constexpr std::size_t least_found = 30;

/// Pixels of the half resolution: centres of pixels lie at whole numbers in both.
cv::Point2f to_half(float x, float y) { return {0.5F * x - 0.25F, 0.5F * y - 0.25F}; }

}  // namespace

void FeatureFlow::add_image(const cv::Mat& grey) {
  cv::swap(half_, last_half_);
  cv::resize(grey, half_, cv::Size(grey.cols / 2, grey.rows / 2), 0, 0, cv::INTER_AREA);
  // Only the template is differentiated.
  cv::buildOpticalFlowPyramid(half_, pyramid_, window, levels, false, cv::BORDER_REFLECT_101, cv::BORDER_CONSTANT,
                              false);
}

void FeatureFlow::set_template(const Frame& frame) {
  cv::buildOpticalFlowPyramid(last_half_, template_pyramid_, window, levels, true, cv::BORDER_REFLECT_101,
                              cv::BORDER_CONSTANT, false);
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
    before_[i] = after_[i] = to_half(features_.x[i], features_.y[i]);
    Eigen::Vector3f point = rotation * rays_[i];
    if (has_depth_[i] != 0) point += translation;
    if (point.z() < 0.01F * rays_[i].z()) continue;
    // The lens moves both ends of so short a way alike.
    after_[i].x += 0.5F * (fx * point.x() / point.z() + cx - x_[i]);
    after_[i].y += 0.5F * (fy * point.y() / point.z() + cy - y_[i]);
  }
}

bool FeatureFlow::follow(const Eigen::Isometry3d& T_camera_world, const cv::Mat& ignore, Features& features) {
  found_points_.clear();
  features.resize(0, features_.descriptors.type());
  const std::size_t count = points_.size();
  if (count < least_found) return false;
  before_.resize(count), after_.resize(count);
  predict(T_camera_world * T_world_template_);
  cv::calcOpticalFlowPyrLK(template_pyramid_, pyramid_, before_, after_, found_, error_, window, levels,
                           cv::TermCriteria(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 15, 0.02),
                           cv::OPTFLOW_USE_INITIAL_FLOW, 1e-4);
  for (std::size_t i = 0; i < count; ++i) {
    if (found_[i] == 0 || !(error_[i] < largest_error)) continue;
    const float x = 2.0F * after_[i].x + 0.5F, y = 2.0F * after_[i].y + 0.5F;
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
