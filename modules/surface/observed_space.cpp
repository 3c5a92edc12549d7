// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/surface/observed_space.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "integrator.hpp"

namespace holdfast {

ObservedSpace::ObservedSpace(SurfaceViews views, const Map& map) : views_(std::move(views)) {
  for (const KeptView& view : views_.views)
    T_camera_world_.push_back(view.T_world_view(map.pose_of(view.keyframe)).inverse());
}

bool ObservedSpace::is_free(const Eigen::Vector3d& point) const {
  for (std::size_t i = 0; i < views_.views.size(); ++i)
    if (looks_through(views_.views[i], T_camera_world_[i] * point)) return true;
  return false;
}

bool ObservedSpace::looks_through(const KeptView& view, const Eigen::Vector3d& point) const {
  constexpr double nearest = 0.1;  // [m]
  const SurfaceSettings& settings = views_.settings;
  const Camera& camera = view.only_carves() ? *view.coarse_camera : views_.camera;
  if (point.z() < nearest || point.z() > settings.maximum_depth) return false;
  const double x = std::round(camera.fx * point.x() / point.z() + camera.cx);
  const double y = std::round(camera.fy * point.y() / point.z() + camera.cy);
  if (!(x >= 1.0 && y >= 1.0 && x < camera.width - 1 && y < camera.height - 1)) return false;
  using surface::ViewGeometry;
  const double margin = static_cast<double>(ViewGeometry::constant_margin) +
                        static_cast<double>(ViewGeometry::quadratic_margin) * point.z() * point.z();
  const double least = point.z() + std::max(settings.truncation * settings.voxel, margin);
  for (int row = static_cast<int>(y) - 1; row <= static_cast<int>(y) + 1; ++row)
    for (int column = static_cast<int>(x) - 1; column <= static_cast<int>(x) + 1; ++column)
      if (view.depth_at(column, row) < least) return false;
  return true;
}

}  // namespace holdfast
