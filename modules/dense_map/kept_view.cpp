// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/dense_map/kept_view.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "holdfast/core/cell_mask.hpp"
#include "holdfast/core/error.hpp"
#include "holdfast/core/sensor_frame.hpp"

namespace holdfast {

namespace {

std::uint16_t to_units(float depth) {
  if (!is_measured_depth(depth)) return 0;
  const double units = depth / KeptView::depth_unit;
  return units >= KeptView::depth_bits ? std::uint16_t{0} : static_cast<std::uint16_t>(std::lround(units));
}

}  // namespace

bool is_left_out(std::uint8_t label, const std::vector<bool>& left_out) {
  return label == CellMask::unknown || (label < left_out.size() && left_out[label]);
}

std::size_t densest_view(const std::vector<KeptView>& views) {
  std::size_t least = views.size() - 1;
  double smallest = 1e300;
  for (std::size_t i = 1; i + 1 < views.size(); ++i) {
    const double gap = views[i + 1].timestamp - views[i - 1].timestamp;
    if (gap < smallest) smallest = gap, least = i;
  }
  return least;
}

ViewSampler::ViewSampler(const Camera& camera, const DenseMapSettings& settings, bool keeps_labels)
    : raw_(camera),
      small_(camera),
      step_(settings.step),
      reach_((std::max(settings.dilate, settings.edge) + settings.step - 1) / settings.step),
      edge_((settings.edge + settings.step - 1) / settings.step),
      margin_(static_cast<int>(std::lround(settings.depth_margin / KeptView::depth_unit))),
      keeps_labels_(keeps_labels),
      grid_(CoarseSampler(camera).grid()) {
  small_.distortion = {};
  small_.width = camera.width / step_;
  small_.height = camera.height / step_;
  small_.fx = camera.fx / step_;
  small_.fy = camera.fy / step_;
  // A kept pixel has the position and the depth of a central pixel of those that it represents.
  const int middle = (step_ - 1) / 2;
  small_.cx = (camera.cx - middle) / step_;
  small_.cy = (camera.cy - middle) / step_;
  HOLDFAST_CHECK(small_.width > 2 && small_.height > 2, small_.width << "x" << small_.height);
  for (int row = 0; row < small_.height; ++row)
    for (int column = 0; column < small_.width; ++column) {
      const Eigen::Vector2d pixel(column * step_ + middle, row * step_ + middle);
      const Eigen::Vector2d raw = camera.distort(pixel);
      const int x = static_cast<int>(std::lround(raw.x())), y = static_cast<int>(std::lround(raw.y()));
      raw_pixel_.push_back(x < 0 || y < 0 || x >= camera.width || y >= camera.height ? -1 : y * camera.width + x);
      cell_.push_back(grid_.cell_of(static_cast<float>(pixel.x()), static_cast<float>(pixel.y())));
    }
}

KeptView ViewSampler::sample(KeyFrameId keyframe, const SensorFrame& frame, const CoarseView& coarse,
                             const cv::Mat& labels, const std::vector<bool>& left_out) const {
  const auto fits = [&](const cv::Mat& image, int type) {
    return image.type() == type && image.cols == raw_.width && image.rows == raw_.height;
  };
  const auto check = [&](const char* name, const cv::Mat& image, int type) {
    HOLDFAST_CHECK(fits(image, type), name << " " << image.cols << "x" << image.rows << ", type " << image.type());
  };
  check("colour", frame.colour, CV_8UC3);
  if (!frame.depth.empty()) check("depth", frame.depth, CV_32FC1);
  if (!labels.empty()) check("labels", labels, CV_8UC1);
  const bool fits_coarse = coarse.grid == grid_;
  const auto cells = static_cast<std::size_t>(grid_.size());
  const bool has_log_odds = fits_coarse && coarse.static_log_odds.size() == cells;
  const bool has_coarse_labels = labels.empty() && fits_coarse && coarse.mask.labels.size() == cells;

  KeptView view{
      .keyframe = keyframe, .frame_index = frame.index, .timestamp = frame.timestamp, .colour = {}, .depth = {}};
  if (frame.depth_delay != 0.0) view.T_view_keyframe = coarse.T_view_camera;
  view.colour.create(small_.height, small_.width, CV_8UC3);
  view.depth.create(small_.height, small_.width, CV_16UC1);
  std::size_t i = 0;
  for (int row = 0; row < small_.height; ++row)
    for (int column = 0; column < small_.width; ++column, ++i) {
      auto& colour = view.colour.at<cv::Vec3b>(row, column);
      auto& depth = view.depth.at<std::uint16_t>(row, column);
      if (raw_pixel_[i] < 0) {
        colour = {0, 0, 0};
        depth = KeptView::moves_bit;
        continue;
      }
      const int x = raw_pixel_[i] % raw_.width, y = raw_pixel_[i] / raw_.width;
      depth = frame.depth.empty() ? std::uint16_t{0} : to_units(frame.depth.ptr<float>(y)[x]);
      // The mean of the pixels that this one represents.
      const int left = std::clamp(x - (step_ - 1) / 2, 0, raw_.width - step_);
      const int top = std::clamp(y - (step_ - 1) / 2, 0, raw_.height - step_);
      int sum[3] = {0, 0, 0};
      for (int r = top; r < top + step_; ++r) {
        const std::uint8_t* value = frame.colour.ptr<std::uint8_t>(r) + 3 * left;
        for (int k = 0; k < 3 * step_; ++k) sum[k % 3] += value[k];
      }
      for (int c = 0; c < 3; ++c) colour[c] = static_cast<std::uint8_t>((sum[c] + step_ * step_ / 2) / (step_ * step_));

      const bool has_cell = cell_[i] >= 0;
      const auto cell = static_cast<std::size_t>(std::max(cell_[i], 0));
      if ((!labels.empty() && is_left_out(labels.ptr<std::uint8_t>(y)[x], left_out)) ||
          (has_cell && has_coarse_labels && is_left_out(coarse.mask.labels[cell], left_out)) ||
          (has_cell && has_log_odds && coarse.static_log_odds[cell] < 0.0F))
        depth |= KeptView::moves_bit;
    }
  spread(view.depth);
  if (keeps_labels_ && !labels.empty()) view.labels = sample_labels(labels);
  return view;
}

cv::Mat ViewSampler::sample_labels(const cv::Mat& labels) const {
  cv::Mat kept(small_.height, small_.width, CV_8UC1);
  std::size_t i = 0;
  for (int row = 0; row < kept.rows; ++row)
    for (int column = 0; column < kept.cols; ++column, ++i)
      kept.at<std::uint8_t>(row, column) =
          raw_pixel_[i] < 0 ? CellMask::unknown
                            : labels.ptr<std::uint8_t>(raw_pixel_[i] / raw_.width)[raw_pixel_[i] % raw_.width];
  return kept;
}

void ViewSampler::spread(cv::Mat& depth) const {
  const cv::Mat before = depth.clone();
  const auto spread_from = [&](int column, int row) {
    const int own = before.at<std::uint16_t>(row, column) & KeptView::depth_bits;
    const int bottom = std::min(row + reach_, depth.rows - 1), right = std::min(column + reach_, depth.cols - 1);
    for (int r = std::max(row - reach_, 0); r <= bottom; ++r)
      for (int c = std::max(column - reach_, 0); c <= right; ++c) {
        auto& other = depth.at<std::uint16_t>(r, c);
        const bool is_edge = std::abs(r - row) <= edge_ && std::abs(c - column) <= edge_;
        // A dynamic pixel without depth does not limit its own extent in depth.
        if (is_edge || other == 0 || (own != 0 && std::abs(other - own) <= margin_)) other |= KeptView::moves_bit;
      }
  };
  // From the rim only: what lies inside is marked already.
  const auto is_moving = [&](int column, int row) {
    return (before.at<std::uint16_t>(row, column) & KeptView::moves_bit) != 0;
  };
  std::size_t i = 0;
  for (int row = 0; row < depth.rows; ++row)
    for (int column = 0; column < depth.cols; ++column, ++i) {
      if (raw_pixel_[i] < 0 || !is_moving(column, row)) continue;
      if ((column > 0 && !is_moving(column - 1, row)) || (column + 1 < depth.cols && !is_moving(column + 1, row)) ||
          (row > 0 && !is_moving(column, row - 1)) || (row + 1 < depth.rows && !is_moving(column, row + 1)))
        spread_from(column, row);
    }
}

}  // namespace holdfast
