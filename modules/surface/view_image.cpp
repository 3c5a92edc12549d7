// SPDX-License-Identifier: BSD-3-Clause
#include "view_image.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "holdfast/dense_map/kept_view.hpp"
#include "slopes.hpp"

namespace holdfast::surface {

namespace {

float depth_of(std::uint16_t bits) {
  return static_cast<float>(bits & KeptView::depth_bits) * static_cast<float>(KeptView::depth_unit);
}

}  // namespace

ViewImage::ViewImage(const KeptView& view, const Camera& kept, const SurfaceSettings& settings)
    : camera_(view.only_carves() ? *view.coarse_camera : kept), only_carves_(view.only_carves()) {
  const Camera& camera = camera_;
  if (only_carves_) {
    read_carving_depth(view);
    return;
  }
  tile_columns_ = (camera.width + tile - 1) / tile;
  tiles_.assign(static_cast<std::size_t>(tile_columns_ * ((camera.height + tile - 1) / tile)), 0.0F);
  pixels_.resize(static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height));
  for (int x = 0; x < camera.width; ++x) rays_x_.push_back(static_cast<float>((x - camera.cx) / camera.fx));
  for (int y = 0; y < camera.height; ++y) rays_y_.push_back(static_cast<float>((y - camera.cy) / camera.fy));
  const cv::Mat depths = read_depth(view, static_cast<float>(settings.maximum_depth));
  labels_ = view.labels.isContinuous() ? view.labels : view.labels.clone();
  set_slopes(depths, rays_x_, rays_y_, pixels_.data());
}

void ViewImage::read_carving_depth(const KeptView& view) {
  near_.reserve(static_cast<std::size_t>(camera_.width) * static_cast<std::size_t>(camera_.height));
  for (int y = 0; y < camera_.height; ++y)
    for (int x = 0; x < camera_.width; ++x) near_.push_back(depth_of(view.depth.ptr<std::uint16_t>(y)[x]));
}

cv::Mat ViewImage::read_depth(const KeptView& view, float maximum_depth) {
  // A pixel counts as dynamic if all around it are: the masks have margins, in which much of the room lies.
  constexpr int margin = 6;  // [px]
  cv::Mat depths(camera_.height, camera_.width, CV_32FC1), nearest, moves;
  cv::erode(view.depth & cv::Scalar(KeptView::depth_bits), nearest, cv::Mat::ones(3, 3, CV_8U));
  cv::erode(view.depth >= KeptView::moves_bit, moves, cv::Mat::ones(2 * margin + 1, 2 * margin + 1, CV_8U));
  Pixel* pixel = pixels_.data();
  for (int y = 0; y < camera_.height; ++y)
    for (int x = 0; x < camera_.width; ++x, ++pixel) {
      pixel->near = depth_of(nearest.ptr<std::uint16_t>(y)[x]);
      const std::uint16_t bits = view.depth.ptr<std::uint16_t>(y)[x];
      const float depth = depths.ptr<float>(y)[x] = depth_of(bits);
      extend_tile(x, y, std::max(depth, pixel->near));
      if (depth > maximum_depth) continue;
      const bool is_static = (bits & KeptView::moves_bit) == 0;
      if (is_static || moves.ptr<std::uint8_t>(y)[x] != 0) pixel->depth = is_static ? depth : -depth;
      if (!is_static) continue;
      const cv::Vec3b& colour = view.colour.ptr<cv::Vec3b>(y)[x];
      pixel->blue = colour[0], pixel->green = colour[1], pixel->red = colour[2];
    }
  return depths;
}

float ViewImage::farthest(int left, int top, int right, int bottom) const {
  const int first_column = std::max(left, 0) / tile, last_column = std::min(right, camera_.width - 1) / tile;
  const int first_row = std::max(top, 0) / tile, last_row = std::min(bottom, camera_.height - 1) / tile;
  float farthest = 0.0F;
  for (int row = first_row; row <= last_row; ++row)
    for (int column = first_column; column <= last_column; ++column)
      farthest = std::max(farthest, tiles_[static_cast<std::size_t>(row * tile_columns_ + column)]);
  return farthest;
}

std::pair<float, float> ViewImage::near_range(int left, int top, int right, int bottom) const {
  const bool is_inside = left >= 0 && top >= 0 && right < camera_.width && bottom < camera_.height;
  float smallest = is_inside ? std::numeric_limits<float>::infinity() : 0.0F, largest = 0.0F;
  for (int y = std::max(top, 0); y <= std::min(bottom, camera_.height - 1); ++y) {
    const float* const row = near_.data() + y * camera_.width;
    for (int x = std::max(left, 0); x <= std::min(right, camera_.width - 1); ++x) {
      smallest = std::min(smallest, row[x]);
      largest = std::max(largest, row[x]);
    }
  }
  return {smallest, largest};
}

}  // namespace holdfast::surface
