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
  tile_columns_ = (camera.width + tile - 1) / tile;
  tiles_.assign(static_cast<std::size_t>(tile_columns_ * ((camera.height + tile - 1) / tile)), 0.0F);
  pixels_.resize(static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height));
  for (int x = 0; x < camera.width; ++x) rays_x_.push_back(static_cast<float>((x - camera.cx) / camera.fx));
  for (int y = 0; y < camera.height; ++y) rays_y_.push_back(static_cast<float>((y - camera.cy) / camera.fy));
  const cv::Mat depths = read_depth(view, static_cast<float>(settings.maximum_depth));
  if (only_carves_) return;
  labels_ = view.labels.isContinuous() ? view.labels : view.labels.clone();
  set_slopes(depths, rays_x_, rays_y_, pixels_.data());
}

cv::Mat ViewImage::read_depth(const KeptView& view, float maximum_depth) {
  cv::Mat depths(camera_.height, camera_.width, CV_32FC1);
  cv::Mat nearest = view.depth & cv::Scalar(KeptView::depth_bits);
  if (!only_carves_) cv::erode(nearest, nearest, cv::Mat::ones(3, 3, CV_8U));
  Pixel* pixel = pixels_.data();
  for (int y = 0; y < camera_.height; ++y)
    for (int x = 0; x < camera_.width; ++x, ++pixel) {
      pixel->near = depth_of(nearest.ptr<std::uint16_t>(y)[x]);
      const std::uint16_t bits = view.depth.ptr<std::uint16_t>(y)[x];
      const float depth = depths.ptr<float>(y)[x] = depth_of(bits);
      float& farthest = tiles_[static_cast<std::size_t>(y / tile * tile_columns_ + x / tile)];
      farthest = std::max({farthest, depth, pixel->near});
      if (only_carves_ || (bits & KeptView::moves_bit) != 0 || depth > maximum_depth) continue;
      pixel->depth = depth;
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

float ViewImage::nearest(int left, int top, int right, int bottom) const {
  if (left < 0 || top < 0 || right >= camera_.width || bottom >= camera_.height) return 0.0F;
  float nearest = std::numeric_limits<float>::infinity();
  for (int y = top; y <= bottom; ++y)
    for (int x = left; x <= right; ++x) nearest = std::min(nearest, at(x, y).near);
  return nearest;
}

}  // namespace holdfast::surface
