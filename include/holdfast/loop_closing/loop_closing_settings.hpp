// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "holdfast/plugin/parameter_table.hpp"

namespace holdfast {

/// The `loop_closing` section of a configuration.
struct LoopClosingSettings {
  int candidates = 30;
  int minimum_gap = 20;
  int pause = 10;
  double score_share = 0.8;
  double group_share = 0.6;
  int consistent_keyframes = 3;
  int neighbours = 10;
  int match_distance = 60;
  double match_ratio = 0.8;
  double alignment_threshold = 0.08;
  int alignment_iterations = 300;
  int minimum_aligned = 15;
  double search_radius = 8.0;
  int minimum_inliers = 40;
  double minimum_share = 0.12;
  int minimum_cells = 5;
  double drift_constant = 0.15;
  double drift_per_metre = 0.02;
  double turn_constant = 5.0;
  double turn_per_metre = 0.5;
  int essential_weight = 100;
  int graph_iterations = 30;
  bool full_adjustment = true;
  int full_robust_iterations = 20;
  int full_final_iterations = 40;
  double full_tolerance = 1e-7;

  static void describe(ParameterTable<LoopClosingSettings>& table) {
    using S = LoopClosingSettings;
    table.add("candidates", &S::candidates, "look-alike keyframes to ask the loop detector for, neighbours aside")
        .range(1, 1000);
    table
        .add("minimum_gap", &S::minimum_gap,
             "keyframes that must have been made between a place and its revisit for it to be a loop")
        .range(1, 10000);
    table.add("pause", &S::pause, "keyframes after a loop in which no other one is looked for").range(0, 10000);
    table
        .add("score_share", &S::score_share,
             "a candidate must score this share of what the least alike covisible neighbour scores")
        .range(0, 1);
    table
        .add("group_share", &S::group_share,
             "a group of covisible candidates must score this share of what the best group scores")
        .range(0, 1);
    table
        .add("consistent_keyframes", &S::consistent_keyframes,
             "consecutive keyframes that must point to the same place before it is looked at")
        .range(1, 20);
    table.add("neighbours", &S::neighbours, "covisible keyframes of a candidate whose points take part in the check")
        .range(0, 100);
    table.add("match_distance", &S::match_distance, "bits in which the descriptors of a feature and a point may differ")
        .unit("bits")
        .range(1, 256);
    table
        .add("match_ratio", &S::match_ratio,
             "nearest to second nearest descriptor of the first matches; points at one spot count as one")
        .range(0.1, 1);
    table
        .add("alignment_threshold", &S::alignment_threshold,
             "distance up to which a matched point agrees with a rigid alignment")
        .unit("m")
        .range(0.001, 1);
    table.add("alignment_iterations", &S::alignment_iterations, "samples of the rigid alignment, at most")
        .range(10, 100000);
    table.add("minimum_aligned", &S::minimum_aligned, "matched points that must agree with the rigid alignment")
        .range(3, 1000);
    table
        .add("search_radius", &S::search_radius,
             "window in which the points of the place are looked for, at the finest level")
        .unit("px")
        .range(1, 100);
    table.add("minimum_inliers", &S::minimum_inliers, "points of the place that must be found in the keyframe")
        .range(6, 10000);
    table
        .add("minimum_share", &S::minimum_share,
             "share that these must have of all points of the place that the keyframe should show")
        .range(0, 1);
    table
        .add("minimum_cells", &S::minimum_cells,
             "cells of 4 by 4 over the image that must hold two of them each: a place fills the view")
        .range(1, 16);
    table.add("drift_constant", &S::drift_constant, "correction that is believed whatever the way between the places")
        .unit("m")
        .range(0, 100);
    table
        .add("drift_per_metre", &S::drift_per_metre,
             "correction that is believed in addition for each metre (and each radian) of the way between the places")
        .unit("m")
        .range(0, 1);
    table.add("turn_constant", &S::turn_constant, "turn that is believed whatever the way between the places")
        .unit("deg")
        .range(0, 180);
    table
        .add("turn_per_metre", &S::turn_per_metre,
             "turn that is believed in addition for each metre (and each radian) of the way between the places")
        .unit("deg")
        .range(0, 90);
    table
        .add("essential_weight", &S::essential_weight,
             "shared points that make an edge of the covisibility graph one of the pose graph")
        .range(15, 10000);
    table.add("graph_iterations", &S::graph_iterations, "iterations of the pose graph, at most").range(1, 1000);
    table.add("full_adjustment", &S::full_adjustment, "adjust the whole map after a loop");
    table.add("full_robust_iterations", &S::full_robust_iterations, "its iterations with a robust cost, at most")
        .range(1, 100);
    table.add("full_final_iterations", &S::full_final_iterations, "its iterations after outliers were set aside")
        .range(0, 100);
    table
        .add("full_tolerance", &S::full_tolerance,
             "it ends when an iteration lowers the cost by less than this share: the bend of a long loop costs little, "
             "and straightens slowly")
        .range(1e-12, 0.1);
  }
};

}  // namespace holdfast
