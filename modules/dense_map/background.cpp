// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/dense_map/background.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "holdfast/core/error.hpp"
#include "voxel_grid.hpp"

namespace holdfast {

namespace {

/// Depths that differ by less than this share (and at least the same in metres) are one surface.
constexpr float same_surface = 0.03F;
const cv::Vec3b unknown_colour{255, 0, 255};

/// How unlike two views are: an angle of 1 rad, 1 m and 30 s count alike.
double unlikeness(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b, double seconds) {
  const double cosine = std::clamp(a.linear().col(2).dot(b.linear().col(2)), -1.0, 1.0);
  return std::acos(cosine) + (a.translation() - b.translation()).norm() + std::abs(seconds) / 30.0;
}

}  // namespace

struct BackgroundPainter::Canvas {
  cv::Mat colour;   // 8UC3
  cv::Mat depth;    // 32FC1 [m], 0 = nothing yet
  cv::Mat nearest;  // 32FC1 [m]: what is nearer than this hides what is to be replaced, and cannot be behind it
};

BackgroundPainter::BackgroundPainter(const StaticScene& scene, const Map& map)
    : scene_(scene), T_world_camera_(dense_map::poses_of(scene, map)) {
  const dense_map::VoxelGrid grid = dense_map::fuse(scene, T_world_camera_, 1);
  const Camera& camera = scene.camera();
  for (std::size_t i = 0; i < scene.views().size(); ++i) {
    const KeptView& view = scene.views()[i];
    cv::Mat& uses = uses_.emplace_back(camera.height, camera.width, CV_8UC1, cv::Scalar(as_it_is));
    for (int y = 0; y < camera.height; ++y)
      for (int x = 0; x < camera.width; ++x) {
        auto& use = uses.at<std::uint8_t>(y, x);
        if (view.moves(x, y)) use = replaced;
        if (use == replaced || view.depth_at(x, y) == 0.0) continue;
        const Eigen::Vector3d point = T_world_camera_[i] * camera.back_project(x, y, view.depth_at(x, y));
        // What lies beyond the cloud's depth has no voxel, and serves as far background.
        const dense_map::Voxel* voxel = grid.find(grid.key_of(point));
        use = voxel != nullptr && voxel->has_left() ? replaced : source;
      }
  }
}

BackgroundPainter::~BackgroundPainter() = default;

void BackgroundPainter::project(std::size_t from, std::size_t into, Canvas& canvas) const {
  const KeptView& view = scene_.views()[from];
  const Camera& camera = scene_.camera();
  const Eigen::Isometry3f T_target_source = (T_world_camera_[into].inverse() * T_world_camera_[from]).cast<float>();
  const auto fx = static_cast<float>(camera.fx), fy = static_cast<float>(camera.fy);
  const auto cx = static_cast<float>(camera.cx), cy = static_cast<float>(camera.cy);
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x) {
      if (uses_[from].ptr<std::uint8_t>(y)[x] != source) continue;
      const auto depth = static_cast<float>(view.depth_at(x, y));
      const Eigen::Vector3f point = T_target_source * Eigen::Vector3f((static_cast<float>(x) - cx) / fx * depth,
                                                                      (static_cast<float>(y) - cy) / fy * depth, depth);
      if (point.z() < 0.05F) continue;
      const float u = fx * point.x() / point.z() + cx, v = fy * point.y() / point.z() + cy;
      if (!(u > -1.0F && v > -1.0F && u < static_cast<float>(camera.width) && v < static_cast<float>(camera.height)))
        continue;
      const int left = static_cast<int>(std::floor(u)), top = static_cast<int>(std::floor(v));
      for (int row = std::max(top, 0); row <= std::min(top + 1, camera.height - 1); ++row)
        for (int column = std::max(left, 0); column <= std::min(left + 1, camera.width - 1); ++column) {
          if (uses_[into].ptr<std::uint8_t>(row)[column] != replaced ||
              point.z() < canvas.nearest.ptr<float>(row)[column])
            continue;
          float& known = canvas.depth.ptr<float>(row)[column];
          // Views come by falling likeness: a later one only brings what hides the earlier.
          if (known != 0.0F && point.z() > known - same_surface * std::max(1.0F, known)) continue;
          known = point.z();
          canvas.colour.ptr<cv::Vec3b>(row)[column] = view.colour.ptr<cv::Vec3b>(y)[x];
        }
    }
}

BackgroundPicture BackgroundPainter::paint(std::size_t number) const {
  HOLDFAST_CHECK(number < scene_.views().size(), "view " << number << " of " << scene_.views().size());
  const KeptView& view = scene_.views()[number];
  const Camera& camera = scene_.camera();
  const auto is_replaced = [&](int x, int y) { return uses_[number].at<std::uint8_t>(y, x) == replaced; };
  Canvas canvas{view.colour.clone(), cv::Mat::zeros(camera.height, camera.width, CV_32FC1),
                cv::Mat::zeros(camera.height, camera.width, CV_32FC1)};
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x)
      if (is_replaced(x, y)) canvas.nearest.at<float>(y, x) = static_cast<float>(view.depth_at(x, y));

  std::vector<std::size_t> others(scene_.views().size());
  std::iota(others.begin(), others.end(), std::size_t{0});
  std::erase(others, number);
  std::vector<double> cost(scene_.views().size());
  for (const std::size_t other : others)
    cost[other] =
        unlikeness(T_world_camera_[number], T_world_camera_[other], view.timestamp - scene_.views()[other].timestamp);
  std::stable_sort(others.begin(), others.end(), [&](std::size_t a, std::size_t b) { return cost[a] < cost[b]; });
  for (const std::size_t other : others) project(other, number, canvas);

  BackgroundPicture picture;
  picture.before = view.colour.clone();
  picture.after.create(camera.height, camera.width, CV_8UC4);
  const auto is_known = [&](int x, int y) { return !is_replaced(x, y) || canvas.depth.at<float>(y, x) != 0.0F; };
  int replaced_pixels = 0, unknown_pixels = 0;
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x) {
      cv::Vec3i sum(0, 0, 0);
      int around = 0;
      bool known = is_known(x, y);
      cv::Vec3b colour = canvas.colour.at<cv::Vec3b>(y, x);
      if (!known) {  // a crack has most of its neighbours
        for (int r = std::max(y - 1, 0); r <= std::min(y + 1, camera.height - 1); ++r)
          for (int c = std::max(x - 1, 0); c <= std::min(x + 1, camera.width - 1); ++c)
            if (is_replaced(c, r) && is_known(c, r)) sum += cv::Vec3i(canvas.colour.at<cv::Vec3b>(r, c)), ++around;
        known = around >= 5;
        colour = known ? cv::Vec3b(sum / around) : unknown_colour;
      }
      if (is_replaced(x, y)) ++(known ? replaced_pixels : unknown_pixels);
      picture.after.at<cv::Vec4b>(y, x) = {colour[0], colour[1], colour[2], static_cast<std::uint8_t>(known ? 255 : 0)};
    }
  const double pixels = static_cast<double>(camera.width) * camera.height;
  picture.replaced = replaced_pixels / pixels;
  picture.unknown = unknown_pixels / pixels;
  return picture;
}

}  // namespace holdfast
