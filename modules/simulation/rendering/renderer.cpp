// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/simulation/renderer.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "holdfast/core/error.hpp"
#include "posed_world.hpp"
#include "shading.hpp"
#include "visibility.hpp"

namespace holdfast::simulation {

using Eigen::Isometry3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

struct Renderer::Parts {
  Parts(const World& rendered, const Camera& of_frame)
      : camera(of_frame), world(rendered), visibility(ray_grid(camera)), shader(camera, visibility.grid()) {}

  void draw(const Isometry3d& T_world_camera, double time) {
    world.pose(time);
    visibility.draw(world, T_world_camera);
  }

  Camera camera;
  PosedWorld world;
  VisibilityBuffer visibility;
  Shader shader;
  cv::Mat part;                         // colour of a sub-frame
  std::vector<PosedVertex> start, end;  // of an object that moves, when the shutter opens and closes
};

Renderer::Renderer(const World& world, const Camera& camera) : parts_(std::make_unique<Parts>(world, camera)) {
  HOLDFAST_CHECK(world.objects.size() < 65535, "objects " << world.objects.size());
}

Renderer::~Renderer() = default;

RenderedFrame Renderer::render(const Isometry3d& T_world_camera, double time) {
  parts_->draw(T_world_camera, time);
  RenderedFrame frame;
  parts_->shader.shade(parts_->visibility, parts_->world.shadows(), T_world_camera, frame);
  return frame;
}

RenderedFrame Renderer::render(const std::function<Isometry3d(double)>& T_world_camera, double time, double exposure) {
  RenderedFrame frame = render(T_world_camera(time), time);
  if (exposure <= 0.0) return frame;
  constexpr double motion_per_part = 1.5;  // [px]
  constexpr int most_parts = 16;
  const double motion = image_motion(frame, T_world_camera, time, exposure);
  const int count = static_cast<int>(std::clamp(std::ceil(motion / motion_per_part), 1.0, double(most_parts)));
  if (count == 1) return frame;

  std::vector<std::uint16_t> sums(frame.colour.total() * 3, 0);
  for (int k = 0; k < count; ++k) {
    const bool middle = 2 * k + 1 == count;
    if (!middle) {
      const double then = time + exposure * ((k + 0.5) / count - 0.5);
      const Isometry3d T_world_then = T_world_camera(then);
      parts_->draw(T_world_then, then);
      parts_->shader.shade_colour(parts_->visibility, parts_->world.shadows(), T_world_then, parts_->part);
    }
    const std::uint8_t* values = middle ? frame.colour.data : parts_->part.data;
    for (std::size_t i = 0; i < sums.size(); ++i) sums[i] = static_cast<std::uint16_t>(sums[i] + values[i]);
  }
  const auto divisor = static_cast<std::uint16_t>(count), half = static_cast<std::uint16_t>(count / 2);
  for (std::size_t i = 0; i < sums.size(); ++i)
    frame.colour.data[i] = static_cast<std::uint8_t>((sums[i] + half) / divisor);
  return frame;
}

double Renderer::image_motion(const RenderedFrame& frame, const std::function<Isometry3d(double)>& T_world_camera,
                              double time, double exposure) {
  const Camera& camera = parts_->camera;
  const double opens = time - 0.5 * exposure, closes = time + 0.5 * exposure;
  const Isometry3d T_world_now = T_world_camera(time);
  const Isometry3d T_opens_world = T_world_camera(opens).inverse(), T_closes_world = T_world_camera(closes).inverse();
  const auto distance = [&](const Vector3d& start, const Vector3d& end) -> std::optional<double> {
    const Vector3d from = T_opens_world * start, to = T_closes_world * end;
    if (from.z() < 0.1 || to.z() < 0.1) return std::nullopt;
    const Vector2d a = camera.project(from), b = camera.project(to), middle = 0.5 * (a + b);
    if (middle.x() < 0 || middle.y() < 0 || middle.x() >= camera.width || middle.y() >= camera.height)
      return std::nullopt;
    return (a - b).norm();
  };

  // What stands still, at points spread over the image; and which of the things that move are in it.
  constexpr int spacing = 12;
  const std::vector<Object>& objects = parts_->world.world().objects;
  std::vector<bool> seen(objects.size() + 1, false);
  double most = 0.0;
  for (int y = spacing / 2; y < camera.height; y += spacing)
    for (int x = spacing / 2; x < camera.width; x += spacing) {
      const std::uint16_t id = frame.object_ids.at<std::uint16_t>(y, x);
      if (id == 0) continue;
      seen[id] = true;
      if (objects[id - 1].moves()) continue;
      const Vector2d pixel = camera.undistort({x, y});
      const Vector3d point = T_world_now * camera.back_project(pixel.x(), pixel.y(), frame.depth.at<float>(y, x));
      most = std::max(most, distance(point, point).value_or(0.0));
    }
  for (std::size_t id = 1; id < seen.size(); ++id) {
    const Object& object = objects[id - 1];
    if (!seen[id] || !object.moves()) continue;
    const std::size_t stride = std::max<std::size_t>(1, object.mesh.vertices.size() / 128);
    pose_vertices(object, opens, parts_->start, stride);
    pose_vertices(object, closes, parts_->end, stride);
    for (std::size_t i = 0; i < parts_->start.size(); ++i) {
      const Vector3d start = parts_->start[i].position.cast<double>(), end = parts_->end[i].position.cast<double>();
      most = std::max(most, distance(start, end).value_or(0.0));
    }
  }
  return most;
}

}  // namespace holdfast::simulation
