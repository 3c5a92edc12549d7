// SPDX-License-Identifier: BSD-3-Clause
#include "painter.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <opencv2/imgproc.hpp>

#include "holdfast/core/cell_mask.hpp"
#include "holdfast/core/error.hpp"

namespace holdfast::overlay_plugin {

namespace {

using Tint = std::array<int, 3>;  // blue, green, red

constexpr std::array<Tint, 5> class_tints{
    {{255, 120, 0}, {200, 0, 200}, {200, 200, 0}, {0, 140, 255}, {120, 220, 120}}};
constexpr Tint moving_tint{0, 0, 255};
/// A tint's share in 256ths at full strength.
constexpr int strongest = 130;
/// Log-odds from which on the red tint has its full strength.
constexpr float certain = 4.0F;

void blend(std::uint8_t* pixel, const Tint& tint, int share) {
  for (int c = 0; c < 3; ++c)
    pixel[c] = static_cast<std::uint8_t>((pixel[c] * (256 - share) + tint[static_cast<std::size_t>(c)] * share) >> 8);
}

/// What becomes of the pixels of a cell.
struct CellTint {
  std::uint8_t label = 0;
  std::uint8_t moving_share = 0;
  std::uint16_t instance = 0;
};

}  // namespace

cv::Scalar feature_colour(float static_probability) {
  const double p = std::clamp(static_cast<double>(static_probability), 0.0, 1.0);
  return {0.0, 255.0 * std::min(1.0, 2.0 * p), 255.0 * std::min(1.0, 2.0 * (1.0 - p))};
}

std::string status_text(const FrameResult& result) {
  char text[160];
  std::snprintf(text, sizeof(text), "frame %llu   %.3f s   %s%s   inliers %d   static %d of %d",
                static_cast<unsigned long long>(result.index), result.timestamp, to_string(result.status),
                result.is_keyframe ? ", keyframe" : "", result.inliers, result.static_features, result.features);
  return text;
}

std::string object_text(const MovingObject& object) {
  char speed[32];
  std::snprintf(speed, sizeof(speed), " %.2f m/s", object.speed());
  return std::to_string(object.id) + (object.class_name.empty() ? "" : " " + object.class_name) + speed;
}

Painter::Painter(const Camera& camera, bool side_by_side) : camera_(camera), grid_(CoarseSampler(camera).grid()) {
  cell_.reserve(static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height));
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x) {
      const Eigen::Vector2d pixel = camera.undistort({x, y});
      cell_.push_back(grid_.cell_of(static_cast<float>(pixel.x()), static_cast<float>(pixel.y())));
    }
  picture_.create(camera.height + text_height, side_by_side ? 2 * camera.width : camera.width, CV_8UC3);
}

void Painter::tint(const cv::Mat& colour, const CoarseView& coarse, cv::Mat& out) const {
  colour.copyTo(out);
  const auto cells = static_cast<std::size_t>(grid_.size());
  const bool has_labels = coarse.mask.labels.size() == cells, has_log_odds = coarse.static_log_odds.size() == cells;
  if (!(coarse.grid == grid_) || (!has_labels && !has_log_odds)) return;
  const bool has_instances = coarse.mask.instances.size() == cells;
  std::vector<CellTint> tints(cells);
  for (std::size_t i = 0; i < cells; ++i) {
    if (has_labels) tints[i].label = coarse.mask.labels[i];
    if (has_instances) tints[i].instance = coarse.mask.instances[i];
    if (has_log_odds && coarse.static_log_odds[i] < 0.0F)
      tints[i].moving_share =
          static_cast<std::uint8_t>(strongest * (0.4F + 0.6F * std::min(1.0F, -coarse.static_log_odds[i] / certain)));
  }
  for (int y = 0; y < out.rows; ++y) {
    std::uint8_t* pixel = out.ptr(y);
    const std::int32_t* cell = &cell_[static_cast<std::size_t>(y) * static_cast<std::size_t>(camera_.width)];
    for (int x = 0; x < out.cols; ++x, pixel += 3, ++cell) {
      if (*cell < 0) continue;
      const CellTint& tint = tints[static_cast<std::size_t>(*cell)];
      if (tint.label == CellMask::unknown)
        blend(pixel, {0, 0, 0}, 80);
      else if (tint.label != 0)
        blend(pixel, class_tints[((tint.instance != 0 ? tint.instance : tint.label) - 1U) % class_tints.size()],
              strongest);
      if (tint.moving_share != 0) blend(pixel, moving_tint, tint.moving_share);
    }
  }
}

void Painter::name_instances(const CoarseView& coarse, cv::Mat& out) const {
  if (coarse.mask.instances.size() != static_cast<std::size_t>(grid_.size()) || !(coarse.grid == grid_)) return;
  struct Sum {
    double x = 0.0, y = 0.0, cells = 0.0;
  };
  std::map<std::uint16_t, Sum> sums;
  for (std::size_t i = 0; i < coarse.mask.instances.size(); ++i) {
    if (coarse.mask.instances[i] == 0) continue;
    Sum& sum = sums[coarse.mask.instances[i]];
    sum.x += grid_.x_of(static_cast<int>(i) % grid_.columns), sum.y += grid_.y_of(static_cast<int>(i) / grid_.columns);
    ++sum.cells;
  }
  constexpr double least_cells = 40.0;  // enough for its number
  for (const auto& [instance, sum] : sums) {
    if (sum.cells < least_cells) continue;
    const Eigen::Vector2d raw = camera_.distort({sum.x / sum.cells, sum.y / sum.cells});
    const cv::Point place(static_cast<int>(raw.x()) - 8, static_cast<int>(raw.y()) + 5);
    const std::string text = "#" + std::to_string(instance);
    cv::putText(out, text, place, cv::FONT_HERSHEY_SIMPLEX, 0.5, {0, 0, 0}, 3, cv::LINE_AA);
    cv::putText(out, text, place, cv::FONT_HERSHEY_SIMPLEX, 0.5, {255, 255, 255}, 1, cv::LINE_AA);
  }
}

void Painter::draw(const MovingObject& object, const FrameResult& result, cv::Mat& out) const {
  if (!result.T_world_camera) return;
  const Eigen::Isometry3d T_camera_object = result.T_world_camera->inverse() * object.T_world_object;
  constexpr double nearest = 0.2;  // m
  const auto pixel = [&](const Eigen::Vector3d& in_camera) {
    const Eigen::Vector2d raw = camera_.distort(camera_.project(in_camera));
    return cv::Point(static_cast<int>(std::lround(std::clamp(raw.x(), -9999.0, 9999.0))),
                     static_cast<int>(std::lround(std::clamp(raw.y(), -9999.0, 9999.0))));
  };
  // Colours by id, far from those of features; what stands is thin, what is hidden grey.
  constexpr std::array<Tint, 4> colours{{{255, 255, 0}, {255, 0, 255}, {255, 255, 255}, {255, 160, 90}}};
  const bool hidden = object.last_seen < result.timestamp;
  const Tint& tint = colours[object.id % colours.size()];
  const cv::Scalar colour = hidden ? cv::Scalar(160, 160, 160) : cv::Scalar(tint[0], tint[1], tint[2]);
  std::array<Eigen::Vector3d, 8> corners;
  for (unsigned i = 0; i < 8; ++i)
    corners[i] = T_camera_object * object.box.corner(static_cast<Eigen::AlignedBox3f::CornerType>(i)).cast<double>();
  for (unsigned i = 0; i < 8; ++i)
    for (unsigned axis = 1; axis < 8; axis *= 2)
      if ((i & axis) == 0 && corners[i].z() > nearest && corners[i | axis].z() > nearest)
        cv::line(out, pixel(corners[i]), pixel(corners[i | axis]), colour, 1, cv::LINE_AA);
  const Eigen::Vector3d centre = T_camera_object.translation();
  const Eigen::Vector3d ahead = centre + result.T_world_camera->linear().transpose() * object.velocity;
  if (centre.z() <= nearest) return;
  const cv::Point place = pixel(centre);
  if (object.moving && ahead.z() > nearest) cv::arrowedLine(out, place, pixel(ahead), colour, 2, cv::LINE_AA, 0, 0.15);
  const cv::Point written(std::clamp(place.x - 40, 2, std::max(2, out.cols - 140)),
                          std::clamp(place.y + 5, 12, out.rows - 4));
  cv::putText(out, object_text(object), written, cv::FONT_HERSHEY_SIMPLEX, 0.45, {0, 0, 0}, 3, cv::LINE_AA);
  cv::putText(out, object_text(object), written, cv::FONT_HERSHEY_SIMPLEX, 0.45, colour, 1, cv::LINE_AA);
}

const cv::Mat& Painter::paint(const SensorFrame& sensor_frame, const Frame& frame, const FrameResult& result) {
  const cv::Mat& colour = sensor_frame.colour;
  HOLDFAST_CHECK(colour.type() == CV_8UC3 && colour.cols == camera_.width && colour.rows == camera_.height,
                 colour.cols << "x" << colour.rows << ", type " << colour.type());
  const bool side_by_side = picture_.cols > colour.cols;
  cv::Mat right = picture_(cv::Rect(picture_.cols - colour.cols, 0, colour.cols, colour.rows));
  if (side_by_side) colour.copyTo(picture_(cv::Rect(0, 0, colour.cols, colour.rows)));
  tint(colour, frame.coarse, right);
  for (std::size_t i = 0; i < frame.size(); ++i) {
    const cv::Point place(static_cast<int>(std::lround(frame.features.x[i])),
                          static_cast<int>(std::lround(frame.features.y[i])));
    const bool shows_point = i < frame.map_points.size() && frame.map_points[i].valid();
    const float probability = i < frame.static_probability.size() ? frame.static_probability[i] : 1.0F;
    cv::circle(right, place, shows_point ? 2 : 3, feature_colour(probability), shows_point ? cv::FILLED : 1);
  }
  name_instances(frame.coarse, right);
  for (const MovingObject& object : result.objects) draw(object, result, right);
  cv::Mat line = picture_.rowRange(colour.rows, picture_.rows);
  line.setTo(cv::Scalar(32, 32, 32));
  cv::putText(line, status_text(result), {8, text_height - 8}, cv::FONT_HERSHEY_SIMPLEX, 0.42, {255, 255, 255}, 1,
              cv::LINE_AA);
  return picture_;
}

}  // namespace holdfast::overlay_plugin
