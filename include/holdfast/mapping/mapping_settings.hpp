// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "holdfast/plugin/parameter_table.hpp"

namespace holdfast {

/// The `mapping` section of a configuration.
struct MappingSettings {
  double close_depth_factor = 40.0;
  int minimum_depth_points = 100;
  int neighbours = 10;
  int second_neighbours = 5;
  double weak_found_ratio = 0.25;
  int probation_keyframes = 3;
  double moving_log_odds = -2.0;
  double redundant_share = 0.9;
  int bundle_keyframes = 20;
  int bundle_robust_iterations = 5;
  int bundle_final_iterations = 10;
  int covisibility_minimum = 15;

  static void describe(ParameterTable<MappingSettings>& table) {
    using S = MappingSettings;
    table
        .add("close_depth_factor", &S::close_depth_factor,
             "depth up to this many baselines makes a map point at once; farther points are triangulated")
        .range(1, 10000);
    table
        .add("minimum_depth_points", &S::minimum_depth_points,
             "points made from depth in each keyframe, at least, even when they are far")
        .range(0, 100000);
    table.add("neighbours", &S::neighbours, "covisible keyframes to triangulate and fuse points with").range(1, 100);
    table.add("second_neighbours", &S::second_neighbours, "of each of these, the neighbours to fuse points with")
        .range(0, 100);
    table
        .add("weak_found_ratio", &S::weak_found_ratio,
             "a new point found in less than this share of the frames that should see it is removed")
        .range(0, 1);
    table
        .add("moving_log_odds", &S::moving_log_odds,
             "a map point whose measured log-odds of standing still are lower than this moves and is removed")
        .range(-100, 0);
    table.add("probation_keyframes", &S::probation_keyframes, "keyframes during which a new point can be removed")
        .range(1, 100);
    table
        .add(
            "redundant_share", &S::redundant_share,
            "a keyframe is removed when this share of its points is seen by three others at the same or a finer scale; "
            "1 = keep all")
        .range(0.1, 1);
    table.add("bundle_keyframes", &S::bundle_keyframes, "keyframes that a local bundle adjustment moves, at most")
        .range(2, 200);
    table.add("bundle_robust_iterations", &S::bundle_robust_iterations, "iterations with a robust cost").range(1, 100);
    table.add("bundle_final_iterations", &S::bundle_final_iterations, "iterations after outliers were set aside")
        .range(0, 100);
    table.add("covisibility_minimum", &S::covisibility_minimum, "shared points that make two keyframes neighbours")
        .range(1, 1000);
  }
};

}  // namespace holdfast
