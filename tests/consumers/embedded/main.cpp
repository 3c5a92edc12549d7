// SPDX-License-Identifier: BSD-3-Clause
#include <iostream>

#include "holdfast/core/camera.hpp"
#include "holdfast/plugin/registry.hpp"

int main() {
  const holdfast::Camera camera = holdfast::find_camera("tum_fr3").value();
  const Eigen::Vector2d centre = camera.project({0.0, 0.0, 2.0});
  const holdfast::Registry registry;
  std::cout << "centre " << centre.transpose() << ", modules of " << registry.kinds().size() << " kinds\n";
  return centre == Eigen::Vector2d(camera.cx, camera.cy) && registry.kinds().empty() ? 0 : 1;
}
