// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/simulation/renderer.hpp"

#include "holdfast/core/error.hpp"
#include "posed_world.hpp"
#include "shading.hpp"
#include "visibility.hpp"

namespace holdfast::simulation {

struct Renderer::Parts {
  Parts(const World& rendered, const Camera& camera)
      : world(rendered), visibility(ray_grid(camera)), shader(camera, visibility.grid()) {}

  PosedWorld world;
  VisibilityBuffer visibility;
  Shader shader;
};

Renderer::Renderer(const World& world, const Camera& camera) : parts_(std::make_unique<Parts>(world, camera)) {
  HOLDFAST_CHECK(world.objects.size() < 65535, "objects " << world.objects.size());
}

Renderer::~Renderer() = default;

RenderedFrame Renderer::render(const Eigen::Isometry3d& T_world_camera, double time) {
  parts_->world.pose(time);
  parts_->visibility.draw(parts_->world, T_world_camera);
  RenderedFrame frame;
  parts_->shader.shade(parts_->visibility, frame);
  return frame;
}

}  // namespace holdfast::simulation
