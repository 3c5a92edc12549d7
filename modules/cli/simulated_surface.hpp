// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "holdfast/simulation/simulator.hpp"
#include "holdfast/surface/triangle_mesh.hpp"

namespace holdfast {

/// True surfaces of a simulated scene in its world frame [m], people excluded and moved objects where they are at the
/// end.
struct SimulatedSurface {
  TriangleMesh all;
  /// What the camera sees from the front at a depth of at most `depth`: divided into triangles with sides of at most
  /// 4 cm, those whose centre it sees.
  TriangleMesh seen;
};

/// Renders ten frames a second for what is seen.
SimulatedSurface simulated_surface(simulation::Simulator& simulator, double depth);

}  // namespace holdfast
