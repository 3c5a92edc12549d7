// SPDX-License-Identifier: BSD-3-Clause
#include "pyramid.hpp"

#include <algorithm>
#include <cmath>

namespace holdfast::orb_plugin {

void ImagePyramid::plan(int width, int height, int minimum_size) {
  planned_.clear();
  ratio_x_.clear();
  ratio_y_.clear();
  row_.assign(static_cast<std::size_t>(width) + 32, 0);
  for (int i = 0; i < scales_.levels(); ++i) {
    const int level_width = static_cast<int>(std::lround(width * static_cast<double>(scales_.inverse_scale[i])));
    const int level_height = static_cast<int>(std::lround(height * static_cast<double>(scales_.inverse_scale[i])));
    if (std::min(level_width, level_height) < minimum_size) break;
    Level& level = planned_.emplace_back();
    level.width = level_width;
    level.height = level_height;
    ratio_x_.push_back(static_cast<float>(width) / static_cast<float>(level_width));
    ratio_y_.push_back(static_cast<float>(height) / static_cast<float>(level_height));
    if (i == 0) continue;
    level.columns.build(planned_[i - 1].width, level_width);
    level.rows.build(planned_[i - 1].height, level_height);
    level.pixels.resize(static_cast<std::size_t>(level_width) * level_height);
  }
}

void ImagePyramid::build(const cv::Mat& grey, int minimum_size) {
  views_.clear();
  if (std::min(grey.cols, grey.rows) < minimum_size) return;
  if (planned_.empty() || planned_[0].width != grey.cols || planned_[0].height != grey.rows)
    plan(grey.cols, grey.rows, minimum_size);
  views_.push_back({grey.data, static_cast<std::ptrdiff_t>(grey.step), grey.cols, grey.rows});
  for (std::size_t i = 1; i < planned_.size(); ++i) {
    Level& level = planned_[i];
    const ImageView& finer = views_[i - 1];
    kernels_.resize(finer, level.columns, level.rows, row_.data(), {level.pixels.data(), level.width});
    views_.push_back({level.pixels.data(), level.width, level.width, level.height});
  }
}

}  // namespace holdfast::orb_plugin
