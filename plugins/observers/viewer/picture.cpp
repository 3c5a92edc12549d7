// SPDX-License-Identifier: BSD-3-Clause
#include "picture.hpp"

#include <algorithm>

namespace holdfast::viewer_plugin {

namespace {

/// Log-odds of motion from which on a cell is drawn at full strength.
constexpr float certain = 4.0F;
constexpr std::uint8_t most_classes = 6, unknown_class = 7;

std::uint8_t class_number(std::uint8_t label) {
  if (label == CellMask::background) return 0;
  if (label == CellMask::unknown) return unknown_class;
  return static_cast<std::uint8_t>((label - 1) % most_classes + 1);
}

}  // namespace

PictureMaker::PictureMaker(const Camera& camera)
    : grid_(CoarseSampler(camera).grid()),
      columns_((camera.width + cell - 1) / cell),
      rows_((camera.height + cell - 1) / cell) {
  cells_.reserve(static_cast<std::size_t>(columns_ * rows_));
  for (int row = 0; row < rows_; ++row)
    for (int column = 0; column < columns_; ++column) {
      const Eigen::Vector2d raw((column + 0.5) * cell - 0.5, (row + 0.5) * cell - 0.5);
      const Eigen::Vector2d pixel = camera.undistort(raw);
      cells_.push_back(grid_.cell_of(static_cast<float>(pixel.x()), static_cast<float>(pixel.y())));
    }
}

std::vector<std::uint8_t> PictureMaker::mask(const CoarseView& coarse) const {
  const auto size = static_cast<std::size_t>(grid_.size());
  const bool has_labels = coarse.mask.labels.size() == size, has_motion = coarse.static_log_odds.size() == size;
  if (!(coarse.grid == grid_) || (!has_labels && !has_motion)) return {};
  const bool has_instances = coarse.mask.instances.size() == size;
  std::vector<std::uint8_t> mask;
  mask.reserve(cells_.size());
  for (const std::int32_t index : cells_) {
    std::uint8_t value = 0;
    if (index >= 0) {
      const auto i = static_cast<std::size_t>(index);
      if (has_labels) value = class_number(coarse.mask.labels[i]);
      if (has_instances && coarse.mask.instances[i] != 0)
        value = static_cast<std::uint8_t>((coarse.mask.instances[i] - 1) % most_classes + 1);
      if (has_motion && coarse.static_log_odds[i] < 0.0F)
        value = static_cast<std::uint8_t>(
            value | (1 + static_cast<int>(14.0F * std::min(1.0F, -coarse.static_log_odds[i] / certain))) << 4);
    }
    mask.push_back(value);
  }
  return mask;
}

ViewedPicture PictureMaker::make(const SensorFrame& sensor_frame, const Frame& frame, const FrameResult& result) const {
  ViewedPicture picture;
  picture.index = sensor_frame.index;
  picture.colour = sensor_frame.colour.clone();
  picture.features.reserve(frame.size());
  for (std::size_t i = 0; i < frame.size(); ++i) {
    const bool shows_point = i < frame.map_points.size() && frame.map_points[i].valid();
    const float probability = i < frame.static_probability.size() ? frame.static_probability[i] : 1.0F;
    picture.features.push_back({frame.features.x[i], frame.features.y[i], probability, shows_point});
    if (shows_point) picture.points.push_back(frame.map_points[i]);
    if (probability < 0.5F && result.T_world_camera && i < frame.depth.size() && frame.has_depth(i))
      picture.moving_features.push_back((*result.T_world_camera * frame.camera_point(i)).cast<float>());
  }
  picture.mask = mask(frame.coarse);
  picture.mask_columns = columns_;
  return picture;
}

}  // namespace holdfast::viewer_plugin
