// SPDX-License-Identifier: BSD-3-Clause
#include "foxglove_messages.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <opencv2/imgcodecs.hpp>
#include <span>

#include "holdfast/core/error.hpp"
#include "holdfast/core/health_reason_names.hpp"

namespace holdfast::mcap {

namespace {

/// RFC 4648, section 4.
std::string base64(std::span<const std::uint8_t> bytes) {
  constexpr const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t left = bytes.size() - i;
    const std::uint32_t group = bytes[i] << 16U | (left > 1 ? bytes[i + 1] << 8U : 0U) | (left > 2 ? bytes[i + 2] : 0U);
    for (int k = 0; k < 4; ++k) text += static_cast<std::size_t>(k) <= left ? digits[group >> (18 - 6 * k) & 63U] : '=';
  }
  return text;
}

Json time_of(double seconds) {
  const auto whole = std::floor(seconds);
  const auto nanoseconds = std::min(std::llround((seconds - whole) * 1e9), 999'999'999LL);
  return {{"sec", static_cast<std::int64_t>(whole)}, {"nsec", nanoseconds}};
}

Json vector_of(const Eigen::Vector3d& v) { return {{"x", v.x()}, {"y", v.y()}, {"z", v.z()}}; }

Json rotation_of(const Eigen::Quaterniond& q) { return {{"x", q.x()}, {"y", q.y()}, {"z", q.z()}, {"w", q.w()}}; }

Json pose_of(const Eigen::Isometry3d& T) {
  return {{"position", vector_of(T.translation())}, {"orientation", rotation_of(Eigen::Quaterniond(T.linear()))}};
}

Json encoded(double time, const cv::Mat& image, const std::string& format, const std::vector<int>& options) {
  std::vector<std::uint8_t> bytes;
  if (!cv::imencode("." + format, image, bytes, options))
    throw Error("this OpenCV cannot write " + format + " images; set `image_every` of the observer to 0");
  return {{"timestamp", time_of(time)}, {"frame_id", camera_frame}, {"format", format}, {"data", base64(bytes)}};
}

}  // namespace

Json pose_message(double time, const Eigen::Isometry3d& T_world_camera) {
  return {{"timestamp", time_of(time)}, {"frame_id", world_frame}, {"pose", pose_of(T_world_camera)}};
}

Json transform_message(double time, const char* parent, const char* child, const Eigen::Isometry3d& T_parent_child) {
  return {{"timestamp", time_of(time)},
          {"parent_frame_id", parent},
          {"child_frame_id", child},
          {"translation", vector_of(T_parent_child.translation())},
          {"rotation", rotation_of(Eigen::Quaterniond(T_parent_child.linear()))}};
}

Json path_message(double time, const std::vector<MapSnapshot::KeyFrame>& keyframes) {
  Json poses = Json::array();
  for (const MapSnapshot::KeyFrame& keyframe : keyframes) poses.push_back(pose_of(keyframe.T_world_camera));
  return {{"timestamp", time_of(time)}, {"frame_id", world_frame}, {"poses", std::move(poses)}};
}

Json cloud_message(double time, const std::vector<MapSnapshot::Point>& points) {
  constexpr int float32 = 7;
  std::vector<float> data;
  for (const MapSnapshot::Point& point : points)
    if (point.static_log_odds >= 0.0F)
      for (const double value : point.position) data.push_back(static_cast<float>(value));
  Json fields = Json::array();
  for (const char* name : {"x", "y", "z"})
    fields.push_back({{"name", name}, {"offset", 4 * fields.size()}, {"type", float32}});
  return {{"timestamp", time_of(time)},
          {"frame_id", world_frame},
          {"pose", pose_of(Eigen::Isometry3d::Identity())},
          {"point_stride", 12},
          {"fields", std::move(fields)},
          {"data", base64({reinterpret_cast<const std::uint8_t*>(data.data()), data.size() * sizeof(float)})}};
}

Json image_message(double time, const cv::Mat& image, int quality) {
  return encoded(time, image, "jpeg", {cv::IMWRITE_JPEG_QUALITY, quality});
}

Json calibration_message(double time, const Camera& camera) {
  const char* model = camera.distortion.lens == Lens::fisheye ? "kannala_brandt"
                      : camera.distortion.is_rational()       ? "rational_polynomial"
                                                              : "plumb_bob";
  return {{"timestamp", time_of(time)},
          {"frame_id", camera_frame},
          {"width", camera.width},
          {"height", camera.height},
          {"distortion_model", model},
          {"D", camera.distortion.coefficients()},
          {"K", {camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1}},
          {"R", {1, 0, 0, 0, 1, 0, 0, 0, 1}},
          {"P", {camera.fx, 0, camera.cx, 0, 0, camera.fy, camera.cy, 0, 0, 0, 1, 0}}};
}

Json log_message(double time, const FrameHealth& health) {
  constexpr int information = 2, warning = 3, error = 4;
  int level = warning;
  if (health.state == HealthState::good) level = information;
  if (health.state == HealthState::lost || health.state == HealthState::stalled) level = error;
  std::string text = to_string(health.state);
  for (const std::string& reason : names_of(health.reasons))
    text += (text.find(':') == std::string::npos ? ": " : ", ") + reason;
  if (health.jump > 0.0) text += ", the pose moved by " + std::to_string(health.jump) + " m";
  return {{"timestamp", time_of(time)}, {"level", level}, {"message", std::move(text)},
          {"name", "health"},           {"file", ""},     {"line", 0}};
}

Json moving_message(double time, const CoarseView& view) {
  constexpr std::uint8_t moving = 255, masked = 128;
  cv::Mat cells(view.grid.rows, view.grid.columns, CV_8UC1, cv::Scalar(0));
  const auto count = cells.total();
  for (std::size_t i = 0; i < count; ++i) {
    const bool is_masked = view.mask.labels.size() == count && CellMask::is_object(view.mask.labels[i]);
    const bool is_moving = view.static_log_odds.size() == count && view.static_log_odds[i] < 0.0F;
    cells.data[i] = is_moving ? moving : is_masked ? masked : 0;
  }
  return encoded(time, cells, "png", {});
}

Json objects_message(double time, const std::vector<MovingObject>& objects) {
  const Json red = {{"r", 1.0}, {"g", 0.25}, {"b", 0.2}, {"a", 0.4}};
  const Json grey = {{"r", 0.6}, {"g", 0.6}, {"b", 0.6}, {"a", 0.4}};
  Json entities = Json::array();
  for (const MovingObject& object : objects) {
    const Json& colour = object.moving ? red : grey;
    Eigen::Isometry3d centre = object.T_world_object;
    centre.translation() = object.T_world_object * object.box.center().cast<double>();
    Json entity = {{"timestamp", time_of(time)}, {"frame_id", world_frame}, {"id", std::to_string(object.id)}};
    entity["lifetime"] = time_of(0.2);
    entity["frame_locked"] = false;
    entity["metadata"] = Json::array();
    entity["cubes"] = Json::array(
        {{{"pose", pose_of(centre)}, {"size", vector_of(object.box.sizes().cast<double>())}, {"color", colour}}});
    entity["arrows"] = Json::array();
    if (object.moving && object.speed() > 0.0) {
      Eigen::Isometry3d arrow = centre;  // Foxglove's arrows point along x
      arrow.linear() = Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitX(), object.velocity).toRotationMatrix();
      entity["arrows"].push_back({{"pose", pose_of(arrow)},
                                  {"shaft_length", object.speed()},
                                  {"shaft_diameter", 0.03},
                                  {"head_length", 0.1},
                                  {"head_diameter", 0.08},
                                  {"color", colour}});
    }
    entity["texts"] = Json::array({{{"pose", pose_of(centre)},
                                    {"billboard", true},
                                    {"font_size", 0.1},
                                    {"scale_invariant", false},
                                    {"color", {{"r", 1.0}, {"g", 1.0}, {"b", 1.0}, {"a", 1.0}}},
                                    {"text", object.class_name + " " + std::to_string(object.id)}}});
    for (const char* unused : unused_shapes) entity[unused] = Json::array();
    entities.push_back(std::move(entity));
  }
  return {{"deletions", Json::array()}, {"entities", std::move(entities)}};
}

Json status_message(const FrameResult& result) {
  Json covariance = Json::array();
  if (result.covariance)
    for (Eigen::Index i = 0; i < 36; ++i) covariance.push_back((*result.covariance)(i / 6, i % 6));
  return {{"timestamp", time_of(result.timestamp)},
          {"index", result.index},
          {"health", to_string(result.health.state)},
          {"reasons", names_of(result.health.reasons)},
          {"jump", result.health.jump},
          {"covariance", std::move(covariance)},
          {"status", to_string(result.status)},
          {"method", to_string(result.method)},
          {"fallback", to_string(result.fallback)},
          {"failure", to_string(result.failure)},
          {"features", result.features},
          {"static_features", result.static_features},
          {"matches", result.matches},
          {"inliers", result.inliers},
          {"is_keyframe", result.is_keyframe},
          {"tracking_ms", result.tracking_seconds * 1e3}};
}

}  // namespace holdfast::mcap
