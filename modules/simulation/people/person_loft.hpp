// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "holdfast/simulation/mesh.hpp"
#include "holdfast/simulation/skeleton.hpp"

namespace holdfast::simulation {

/// A closed cross-section of a part of the body: a superellipse, deeper before or behind its centre as asked. Its
/// vertices run from behind (angle 0) over -across (a quarter) and the front (a half) to +across.
struct Ring {
  Eigen::Vector3f centre = Eigen::Vector3f::Zero();
  float width = 0.0F;  ///< half, along `across` [m]
  float front = 0.0F;  ///< against `behind` [m]
  float back = 0.0F;
  float power = 2.0F;  ///< 2 = ellipse, more = boxier
  Eigen::Vector3f across = Eigen::Vector3f::UnitX();
  Eigen::Vector3f behind = Eigen::Vector3f::UnitY();
};

/// A grid of points on a smooth surface, row by row from top to bottom; seen from outside columns run to the right. In
/// a closed one the last column repeats the first.
struct Grid {
  int columns = 0;  ///< points in a row
  std::vector<Eigen::Vector3f> points;
  std::vector<float> rows;  ///< of the texture [any unit], by row of points, rising
  bool closed = true;
};

/// Adds the grid with `area` spread over it and smooth normals.
void add_grid(Mesh& mesh, const Grid& grid, const TextureArea& area,
              const std::function<SkinWeights(const Eigen::Vector3f&)>& weights);

/// A skin over rings from top to bottom (against across x behind), with smooth normals.
struct Loft {
  std::vector<Ring> rings;
  int facets = 12;
  float seam = 0.0F;  ///< where the texture's left and right meet, as a share of a turn
  std::function<SkinWeights(const Eigen::Vector3f&)> weights;
  /// Moves a vertex outwards [m]; arguments: share of a turn in [0, 1) and number of the ring. May be empty.
  std::function<float(float, std::size_t)> bulge;
};

/// How far down the skin each ring lies [m], as the texture counts rows: from 0.
std::vector<float> ring_rows(const std::vector<Ring>& rings);
/// Size of the skin laid flat [m]: x the longest way around, y down.
Eigen::Vector2f flat_size(const std::vector<Ring>& rings);

/// Adds the skin with `area` wrapped once around as one smooth surface.
void add_loft(Mesh& mesh, const Loft& loft, const TextureArea& area);

/// Weights along a chain of bones; `position` counts along it, each joint is blended over `half_blend` to both sides.
struct ChainJoint {
  float position;
  float half_blend;
  Bone after;
};
SkinWeights chain_weights(float position, Bone first, std::initializer_list<ChainJoint> joints);

/// 0 at `from`, 1 at `to`, smooth between.
float smooth_step(float from, float to, float value);

}  // namespace holdfast::simulation
