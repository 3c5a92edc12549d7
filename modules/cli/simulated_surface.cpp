// SPDX-License-Identifier: BSD-3-Clause
#include "simulated_surface.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace holdfast {

namespace {

constexpr float longest_side = 0.04F;  // [m]

/// Triangles with the number of their object (index plus one, as in RenderedFrame::object_ids), in parts of limited
/// size.
class Divider {
 public:
  explicit Divider(float longest_side) : longest_side_(longest_side) {}

  TriangleMesh mesh;
  std::vector<std::uint16_t> objects;

  void add(const Eigen::Vector3f& a, const Eigen::Vector3f& b, const Eigen::Vector3f& c, std::uint16_t object) {
    const std::array<float, 3> sides = {(b - a).norm(), (c - b).norm(), (a - c).norm()};
    const auto longest = std::max_element(sides.begin(), sides.end()) - sides.begin();
    if (sides[static_cast<std::size_t>(longest)] > longest_side_) {  // halves the longest side
      const std::array<Eigen::Vector3f, 3> p = longest == 0   ? std::array{a, b, c}
                                               : longest == 1 ? std::array{b, c, a}
                                                              : std::array{c, a, b};
      const Eigen::Vector3f middle = 0.5F * (p[0] + p[1]);
      add(p[0], middle, p[2], object);
      add(middle, p[1], p[2], object);
      return;
    }
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (const Eigen::Vector3f& corner : {a, b, c}) mesh.vertices.push_back({corner, {}, 200, 200, 200});
    mesh.triangles.push_back({first, first + 1, first + 2});
    objects.push_back(object);
  }

 private:
  float longest_side_;  // [m]
};

Divider divided_world(const simulation::World& world, double time, float longest_side) {
  Divider divider(longest_side);
  std::vector<simulation::PosedVertex> posed;
  for (std::size_t i = 0; i < world.objects.size(); ++i) {
    const simulation::Object& object = world.objects[i];
    if (object.class_name == "person") continue;
    pose_vertices(object, time, posed);
    // Clockwise from outside there, counter-clockwise here.
    for (const simulation::Triangle& t : object.mesh.triangles)
      divider.add(posed[t.a].position, posed[t.c].position, posed[t.b].position, static_cast<std::uint16_t>(i + 1));
  }
  return divider;
}

}  // namespace

SimulatedSurface simulated_surface(simulation::Simulator& simulator, double depth, std::optional<double> until) {
  std::uint64_t frames = simulator.frame_count();
  while (until && frames > 1 && simulator.timestamp(frames - 1) > *until) --frames;
  const double end = simulator.timestamp(frames - 1);
  const Divider divider = divided_world(simulator.world(), end, longest_side);
  const TriangleMesh& all = divider.mesh;
  const Camera& camera = simulator.camera();
  std::vector<bool> seen(all.triangles.size(), false);
  const auto stride = static_cast<std::uint64_t>(std::max(1L, std::lround(simulator.scene().frame_rate / 10.0)));
  for (std::uint64_t frame = 0; frame < frames; frame += stride) {
    const simulation::RenderedFrame rendered = simulator.render(frame);
    const Eigen::Isometry3d T_camera_world = simulator.T_world_camera(frame).inverse();
    for (std::size_t i = 0; i < seen.size(); ++i) {
      if (seen[i]) continue;
      const Eigen::Vector3d centre = (all.corner(i, 0) + all.corner(i, 1) + all.corner(i, 2)).cast<double>() / 3.0;
      const Eigen::Vector3d point = T_camera_world * centre;
      if (point.z() < 0.1 || point.z() > depth) continue;
      if ((T_camera_world.linear() * all.area_vector(i)).dot(point) >= 0.0) continue;  // from behind
      const Eigen::Vector2d pixel = camera.project(point);
      if (!(pixel.x() > -0.5 * camera.width && pixel.y() > -0.5 * camera.height && pixel.x() < 1.5 * camera.width &&
            pixel.y() < 1.5 * camera.height))
        continue;
      const Eigen::Vector2d raw = camera.distort(pixel);
      const int x = static_cast<int>(std::lround(raw.x())), y = static_cast<int>(std::lround(raw.y()));
      if (x < 0 || y < 0 || x >= camera.width || y >= camera.height) continue;
      if (rendered.object_ids.at<std::uint16_t>(y, x) != divider.objects[i]) continue;
      seen[i] = std::abs(static_cast<double>(rendered.depth.at<float>(y, x)) - point.z()) < 0.02 + 0.01 * point.z();
    }
  }
  SimulatedSurface surface{divided_world(simulator.world(), end, std::numeric_limits<float>::infinity()).mesh,
                           {all.vertices, {}}};
  for (std::size_t i = 0; i < seen.size(); ++i)
    if (seen[i]) surface.seen.triangles.push_back(all.triangles[i]);
  compute_normals(surface.all);
  compute_normals(surface.seen);
  remove_small_parts(surface.seen, 0.0);
  return surface;
}

}  // namespace holdfast
