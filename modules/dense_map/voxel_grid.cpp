// SPDX-License-Identifier: BSD-3-Clause
#include "voxel_grid.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace holdfast::dense_map {

namespace {

constexpr int axis_bits = 21;
constexpr std::int64_t axis_offset = std::int64_t{1} << (axis_bits - 1), axis_mask = (std::int64_t{1} << axis_bits) - 1;

std::uint64_t mixed(std::uint64_t key) {  // the finaliser of MurmurHash3
  key = (key ^ (key >> 33)) * 0xff51afd7ed558ccdULL;
  key = (key ^ (key >> 33)) * 0xc4ceb9fe1a85ec53ULL;
  return key ^ (key >> 33);
}

void add_view(const StaticScene& scene, std::size_t number, const Eigen::Isometry3d& T_world_camera, VoxelGrid& grid) {
  const KeptView& view = scene.views()[number];
  const Camera& camera = scene.camera();
  const double farthest = scene.settings().maximum_depth;
  const auto id = static_cast<std::uint16_t>(number);
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x) {
      const std::uint16_t bits = view.depth.ptr<std::uint16_t>(y)[x];
      const double depth = bits * KeptView::depth_unit;
      if (bits == 0 || (bits & KeptView::moves_bit) != 0 || depth > farthest) continue;
      const Eigen::Vector3d point = T_world_camera * camera.back_project(x, y, depth);
      const std::uint64_t key = grid.key_of(point);
      Voxel& voxel = grid.at(key);
      const Eigen::Vector3d inside = point - grid.corner_of(key);
      const cv::Vec3b& colour = view.colour.ptr<cv::Vec3b>(y)[x];
      voxel.x += static_cast<float>(inside.x());
      voxel.y += static_cast<float>(inside.y());
      voxel.z += static_cast<float>(inside.z());
      voxel.blue += colour[0], voxel.green += colour[1], voxel.red += colour[2];
      if (voxel.points++ == 0) voxel.first_view = id;
      if (voxel.views == 0 || voxel.last_view != id) ++voxel.views;
      voxel.last_view = id;
    }
}

void look_through(const StaticScene& scene, std::size_t number, const Eigen::Isometry3d& T_world_camera,
                  double voxel_size, int minimum_views, VoxelGrid& grid) {
  const Camera& camera = scene.camera();
  // The nearest depth around each pixel, or none where one is missing: edges look through nothing.
  cv::Mat nearest = scene.views()[number].depth & cv::Scalar(KeptView::depth_bits);
  cv::erode(nearest, nearest, cv::Mat::ones(3, 3, CV_8U));
  const Eigen::Isometry3d T_camera_world = T_world_camera.inverse();
  const Eigen::Matrix3f rotation = T_camera_world.linear().cast<float>();
  const Eigen::Vector3f centre =
      (T_camera_world.translation() + T_camera_world.linear() * Eigen::Vector3d::Constant(voxel_size / 2))
          .cast<float>();
  const auto fx = static_cast<float>(camera.fx), fy = static_cast<float>(camera.fy);
  const auto cx = static_cast<float>(camera.cx + 0.5), cy = static_cast<float>(camera.cy + 0.5);
  const auto margin = static_cast<float>(scene.settings().see_through_margin);
  constexpr auto unit = static_cast<float>(KeptView::depth_unit);
  constexpr float quadratic = 0.01F;  // [1/m]; the noise of depth from disparity grows with its square
  for (Voxel& voxel : grid.voxels()) {
    if (voxel.first_view >= number || voxel.views < minimum_views) continue;
    const Eigen::Vector3f point = rotation * grid.corner_of(voxel.key).cast<float>() + centre;
    if (point.z() < 0.05F) continue;
    const float u = fx * point.x() / point.z() + cx, v = fy * point.y() / point.z() + cy;
    if (!(u >= 0.0F && v >= 0.0F && u < static_cast<float>(camera.width) && v < static_cast<float>(camera.height)))
      continue;
    const float depth = unit * nearest.ptr<std::uint16_t>(static_cast<int>(v))[static_cast<int>(u)];
    if (depth <= point.z() + margin + quadratic * point.z() * point.z()) continue;
    ++voxel.looks_through;
    if (voxel.last_view < number) ++voxel.looks_through_last;
  }
}

}  // namespace

VoxelGrid::VoxelGrid(double voxel_size) : size_(voxel_size), slots_(1U << 16) {}

std::uint64_t VoxelGrid::key_of(const Eigen::Vector3d& point) const {
  std::uint64_t key = 0;
  for (int i = 0; i < 3; ++i) {
    const auto cell = static_cast<std::int64_t>(std::floor(point[i] / size_)) + axis_offset;
    key = (key << axis_bits) | static_cast<std::uint64_t>(std::clamp<std::int64_t>(cell, 0, axis_mask));
  }
  return key;
}

Eigen::Vector3d VoxelGrid::corner_of(std::uint64_t key) const {
  const auto axis = [&](int shift) {
    return static_cast<double>((static_cast<std::int64_t>(key >> shift) & axis_mask) - axis_offset) * size_;
  };
  return {axis(2 * axis_bits), axis(axis_bits), axis(0)};
}

std::size_t VoxelGrid::slot_of(std::uint64_t key) const {
  const std::size_t mask = slots_.size() - 1;
  std::size_t slot = mixed(key) & mask;
  while (slots_[slot] != 0 && voxels_[slots_[slot] - 1].key != key) slot = (slot + 1) & mask;
  return slot;
}

void VoxelGrid::grow() {
  slots_.assign(slots_.size() * 2, 0);
  for (std::size_t i = 0; i < voxels_.size(); ++i) slots_[slot_of(voxels_[i].key)] = static_cast<std::uint32_t>(i + 1);
}

Voxel& VoxelGrid::at(std::uint64_t key) {
  std::size_t slot = slot_of(key);
  if (slots_[slot] == 0) {
    if (2 * voxels_.size() >= slots_.size()) {
      grow();
      slot = slot_of(key);
    }
    voxels_.push_back({.key = key});
    slots_[slot] = static_cast<std::uint32_t>(voxels_.size());
  }
  return voxels_[slots_[slot] - 1];
}

const Voxel* VoxelGrid::find(std::uint64_t key) const {
  const std::size_t slot = slot_of(key);
  return slots_[slot] == 0 ? nullptr : &voxels_[slots_[slot] - 1];
}

std::vector<Eigen::Isometry3d> poses_of(const StaticScene& scene, const Map& map) {
  std::vector<Eigen::Isometry3d> poses;
  poses.reserve(scene.views().size());
  for (const KeptView& view : scene.views()) poses.push_back(view.T_world_view(map.pose_of(view.keyframe)));
  return poses;
}

VoxelGrid fuse(const StaticScene& scene, const std::vector<Eigen::Isometry3d>& poses, int minimum_views) {
  const double size = scene.settings().voxel_size;
  VoxelGrid grid(size);
  for (std::size_t i = 0; i < poses.size(); ++i) add_view(scene, i, poses[i], grid);
  for (std::size_t i = 0; i < poses.size(); ++i) look_through(scene, i, poses[i], size, minimum_views, grid);
  return grid;
}

}  // namespace holdfast::dense_map
