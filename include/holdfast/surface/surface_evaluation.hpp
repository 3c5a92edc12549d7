// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <string>

#include "holdfast/surface/triangle_mesh.hpp"

namespace holdfast {

/// Thresholds and sampling of a comparison of surfaces.
struct SurfaceEvaluationOptions {
  double threshold = 0.05;       ///< distance up to which a point counts as right, for the ratios and the F-score [m]
  double ghost_distance = 0.15;  ///< estimated surface farther from the truth is a ghost [m]
  /// Reach of the thickness along the normal of the truth, to both sides [m]; 0 = it is not measured.
  double thickness_reach = 0.0;
  double spacing = 0.02;  ///< of the points at which distances are measured [m]: one per square of this side
};

/// Agreement of an estimated surface with the true one, from points spread evenly over both.
struct SurfaceEvaluation {
  double accuracy = 0.0;           ///< mean distance from the estimate to the truth [m]
  double accuracy_median = 0.0;    ///< [m]
  double completion = 0.0;         ///< mean distance from the truth to the estimate [m]
  double completion_median = 0.0;  ///< [m]
  double precision = 0.0;          ///< share of the estimate within the threshold of the truth, 0 to 1
  double completion_ratio = 0.0;   ///< share of the truth within the threshold of the estimate, 0 to 1
  double f_score = 0.0;            ///< harmonic mean of both shares, 0 to 1
  double chamfer = 0.0;            ///< mean of accuracy and completion [m]
  double normal_agreement = 0.0;   ///< mean absolute cosine of the angle between the normals, within the threshold
  double ghosts = 0.0;             ///< share of the estimate farther from the truth than ghost_distance, 0 to 1
  double unobserved = 0.0;         ///< share of the estimate that was not compared, 0 to 1: see evaluate_surface()
  /// Distance between the outermost of the estimated surfaces that lie along the normal of the truth within
  /// thickness_reach, and face the same side: 0 = one surface. Of the thickness_points points of `seen` at which the
  /// truth has one surface, and the estimate has one at least [m]; NaN if there are none.
  double thickness_mean = 0.0, thickness_99 = 0.0;
  double doubled = 0.0;  ///< share of these points at which there are two surfaces or more, 0 to 1; NaN without them
  std::size_t thickness_points = 0;
  double truth_area = 0.0, estimate_area = 0.0;  ///< [m^2]
  std::size_t truth_points = 0, estimate_points = 0;
  SurfaceEvaluationOptions options;
};

/// Compares surfaces in one world frame. Distances are exact, from points to triangles (Knapitsch et al., Tanks and
/// Temples, TOG 2017, with triangles in place of points). `seen` is the part of the truth that an estimate could
/// contain, for completion; accuracy and ghosts refer to all of `truth`. Deterministic. Throws Error for a mesh without
/// area.
///
/// A truth that was measured itself, such as the surface of another run, has borders where its own views end. With
/// `is_free`, which says whether they looked through a point, the estimate beyond these borders does not count (as in
/// Schoeps et al., ETH3D, CVPR 2017): points farther than the threshold whose nearest point of the truth is on its
/// border (Turk and Levoy, SIGGRAPH 1994), and that are not free.
SurfaceEvaluation evaluate_surface(const TriangleMesh& truth, const TriangleMesh& seen, const TriangleMesh& estimate,
                                   const SurfaceEvaluationOptions& options,
                                   const std::function<bool(const Eigen::Vector3d&)>& is_free = {});

/// Colours the vertices of a mesh by their distance to the truth: blue 0, green half of `scale`, red `scale` [m] and
/// more.
void colour_by_error(TriangleMesh& mesh, const TriangleMesh& truth, double scale);

/// Formats the figures as a table for a terminal; ends with a newline.
std::string to_text(const SurfaceEvaluation& evaluation);
/// Formats the figures as JSON in full precision.
std::string to_json(const SurfaceEvaluation& evaluation);
/// Formats the figures as CSV: "name,value" lines.
std::string to_csv(const SurfaceEvaluation& evaluation);

}  // namespace holdfast
