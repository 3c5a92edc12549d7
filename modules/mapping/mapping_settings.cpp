// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/mapping/mapping_settings.hpp"

#include "holdfast/plugin/parameter_table.hpp"

namespace holdfast {

void MappingSettings::describe(ParameterTable<MappingSettings>& table) {
  using S = MappingSettings;
  table
      .add("minimum_depth_points", &S::minimum_depth_points,
           "minimum number of points created from depth in each keyframe, even if they are far")
      .range(0, 100000);
  table.add("neighbours", &S::neighbours, "number of covisible keyframes for triangulation and fusion of points")
      .range(1, 100);
  table
      .add(
          "far_parallax", &S::far_parallax,
          "parallax above which features of one camera that were not triangulated with 1.15 degrees become points, for "
          "cameras that turn more than they move; 1.15 = none of them")
      .unit("deg")
      .range(0.01, 1.15);
  table
      .add("second_neighbours", &S::second_neighbours,
           "number of neighbours of each of these keyframes for fusion of points")
      .range(0, 100);
  table
      .add("weak_found_ratio", &S::weak_found_ratio,
           "a new point that is matched in less than this fraction of the frames that should observe it is removed")
      .range(0, 1);
  table
      .add("moving_log_odds", &S::moving_log_odds,
           "a map point with measured static log-odds below this value is moving and is removed")
      .range(-100, 0);
  table
      .add("probation_keyframes", &S::probation_keyframes,
           "number of keyframes after its creation in which a point can be removed")
      .range(1, 100);
  table
      .add("redundant_share", &S::redundant_share,
           "a keyframe is removed if this fraction of its points is observed by three others at the same or a finer "
           "scale; only close points count, unless there are few of them and 200 keyframes have followed, after which "
           "points found below weak_found_ratio of the mean do not count either, nor is one kept that has other "
           "points at fewer than 2 % of its features; 1 = keep all")
      .range(0.1, 1);
  table.add("bundle_keyframes", &S::bundle_keyframes, "maximum number of free keyframes of a local bundle adjustment")
      .range(2, 200);
  table
      .add("bundle_robust_iterations", &S::bundle_robust_iterations,
           "iterations of local bundle adjustment with the robust cost")
      .range(1, 100);
  table
      .add("bundle_final_iterations", &S::bundle_final_iterations,
           "iterations of local bundle adjustment after the removal of outliers")
      .range(0, 100);
  table
      .add("covisibility_minimum", &S::covisibility_minimum,
           "minimum number of shared points of two covisible keyframes")
      .range(1, 1000);
  table.add("inertia", &S::inertia,
            "with tracking.inertia, whether inertial measurements link the keyframes in adjustments of the whole map, "
            "after loops and at the end of the run, and smooth the frames between them at its end");
  table
      .add(
          "final_rounds", &S::final_rounds,
          "rounds at the end of the run, after an adjustment of the whole map, in which its points are searched in the "
          "neighbours of every keyframe again and the whole map is adjusted; 0 = none, and no such adjustment")
      .range(0, 10);
}

}  // namespace holdfast
