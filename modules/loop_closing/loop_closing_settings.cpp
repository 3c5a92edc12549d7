// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/loop_closing/loop_closing_settings.hpp"

#include "holdfast/plugin/parameter_table.hpp"

namespace holdfast {

void LoopClosingSettings::describe(ParameterTable<LoopClosingSettings>& table) {
  using S = LoopClosingSettings;
  table
      .add("candidates", &S::candidates,
           "maximum number of similar keyframes requested from the loop detector, in addition to covisible ones")
      .range(1, 1000);
  table.add("minimum_gap", &S::minimum_gap, "minimum number of keyframes between a place and its revisit")
      .range(1, 10000);
  table.add("pause", &S::pause, "number of keyframes after a loop closure in which no other loop is searched")
      .range(0, 10000);
  table
      .add("score_share", &S::score_share,
           "minimum score of a candidate, relative to the lowest score of a covisible neighbour")
      .range(0, 1);
  table
      .add("group_share", &S::group_share,
           "minimum score of a group of covisible candidates, relative to the best group")
      .range(0, 1);
  table
      .add("consistent_keyframes", &S::consistent_keyframes,
           "number of consecutive keyframes with candidates at the same place before it is verified")
      .range(1, 20);
  table
      .add("neighbours", &S::neighbours,
           "number of covisible keyframes of a candidate whose points take part in the geometric check")
      .range(0, 100);
  table
      .add(
          "match_distance", &S::match_distance,
          "maximum distance between the descriptors of feature and point, in the unit of the extractor; 0 = a fifth of "
          "the way from its strict to its loose distance (orb: 60 bits)")
      .range(0, 1e6);
  table
      .add("match_ratio", &S::match_ratio,
           "maximum ratio of nearest to second-nearest distance of the first matches; adjacent points count as one")
      .range(0.1, 1);
  table.add("alignment_threshold", &S::alignment_threshold, "inlier threshold of the rigid alignment")
      .unit("m")
      .range(0.001, 1);
  table.add("alignment_iterations", &S::alignment_iterations, "maximum number of RANSAC samples of the rigid alignment")
      .range(10, 100000);
  table.add("minimum_aligned", &S::minimum_aligned, "minimum number of inliers of the rigid alignment").range(3, 1000);
  table
      .add("search_radius", &S::search_radius,
           "radius of the guided search for the points of the place, at the finest level")
      .unit("px")
      .range(1, 100);
  table
      .add("minimum_inliers", &S::minimum_inliers,
           "minimum number of points of the place that are matched in the keyframe")
      .range(6, 10000);
  table
      .add("minimum_share", &S::minimum_share,
           "minimum fraction of these matches among the points that are predicted to be visible")
      .range(0, 1);
  table
      .add("minimum_cells", &S::minimum_cells,
           "minimum number of cells of a 4 x 4 grid over the image with at least two matches each")
      .range(1, 16);
  table
      .add("class_agreement", &S::class_agreement,
           "minimum mean share of the votes of matched points for the classes of their features; compared only with "
           "`class_weights` of the loop detector; 0 = never")
      .range(0, 1);
  table.add("drift_constant", &S::drift_constant, "plausible correction for a path of zero length between the places")
      .unit("m")
      .range(0, 100);
  table
      .add("drift_per_metre", &S::drift_per_metre,
           "additional plausible correction per metre (and radian) of the path between the places")
      .unit("m")
      .range(0, 1);
  table
      .add("drift_per_metre_mono", &S::drift_per_metre_mono,
           "the same with one camera, whose scale drifts and with it the length of the path")
      .unit("m")
      .range(0, 10);
  table
      .add("largest_scale_drift", &S::largest_scale_drift,
           "with one camera, factor by which the scale may have drifted around a loop, at most")
      .range(1, 100);
  table.add("turn_constant", &S::turn_constant, "plausible rotation for a path of zero length between the places")
      .unit("deg")
      .range(0, 180);
  table
      .add("turn_per_metre", &S::turn_per_metre,
           "additional plausible rotation per metre (and radian) of the path between the places")
      .unit("deg")
      .range(0, 90);
  table
      .add("essential_weight", &S::essential_weight,
           "minimum number of shared points of a covisibility edge in the essential graph")
      .range(15, 10000);
  table.add("graph_iterations", &S::graph_iterations, "maximum iterations of the pose graph").range(1, 1000);
  table.add("keep_vertical", &S::keep_vertical,
            "with inertial measurements, keyframes get the roll and pitch that these say, and the pose graph has four "
            "degrees of freedom");
  table.add("full_adjustment", &S::full_adjustment, "run full bundle adjustment after a loop closure");
  table
      .add("full_robust_iterations", &S::full_robust_iterations,
           "maximum iterations of full bundle adjustment with the robust cost")
      .range(1, 100);
  table
      .add("full_final_iterations", &S::full_final_iterations,
           "maximum iterations of full bundle adjustment after the removal of outliers")
      .range(0, 100);
  table
      .add("full_tolerance", &S::full_tolerance,
           "relative decrease of the cost at which full bundle adjustment ends; small, because the deformation of a "
           "long loop changes the cost little and converges slowly")
      .range(1e-12, 0.1);
}

}  // namespace holdfast
