// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "holdfast/simulation/simulator.hpp"
#include "holdfast/surface/triangle_mesh.hpp"

namespace holdfast {

/// True surfaces of a simulated scene in its world frame [m] at one time, people excluded.
struct SimulatedSurface {
  TriangleMesh all;
  /// What the camera has seen by then from the front at a depth of at most `depth`: divided into triangles with sides
  /// of at most 4 cm, those whose centre it sees.
  TriangleMesh seen;
};

/// Renders ten frames a second for what is seen. `until`: time of the surfaces [s], otherwise that of the last frame.
SimulatedSurface simulated_surface(simulation::Simulator& simulator, double depth, std::optional<double> until = {});

}  // namespace holdfast
