// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "holdfast/plugin/parameter_table.hpp"

namespace holdfast {

/// The `tracking` section of a configuration.
struct TrackingSettings {
  int minimum_start_points = 100;
  double close_depth_factor = 40.0;
  double motion_window = 15.0;
  double local_map_window = 3.0;
  double descriptor_ratio = 0.8;
  int sure_distance = 50;
  int possible_distance = 100;
  int minimum_matches = 20;
  int minimum_inliers = 30;
  double maximum_deviation = 0.02;
  int local_keyframes = 80;
  double keyframe_minimum_interval = 0.0;
  double keyframe_maximum_interval = 1.0;
  double keyframe_tracked_ratio = 0.8;
  double keyframe_mask_age = 0.5;
  int keyframe_close_tracked = 100;
  int keyframe_close_possible = 70;
  double depth_edge_ratio = 0.0;
  double coasting_time = 1.0;
  int relocalisation_candidates = 5;
  int relocalisation_inliers = 50;
  double relocalisation_speed = 3.0;

  static void describe(ParameterTable<TrackingSettings>& table) {
    using S = TrackingSettings;
    table.add("minimum_start_points", &S::minimum_start_points, "points with depth that the first frame must have")
        .range(10, 100000);
    table
        .add("close_depth_factor", &S::close_depth_factor,
             "depth up to this many baselines is trusted alone; farther points are triangulated")
        .range(1, 10000);
    table.add("motion_window", &S::motion_window, "search radius around a predicted feature, at level 0")
        .range(1, 200)
        .unit("px");
    table.add("local_map_window", &S::local_map_window, "factor of the search radius around projected map points")
        .range(0.5, 20);
    table.add("descriptor_ratio", &S::descriptor_ratio, "best to second best descriptor distance, at most")
        .range(0.1, 1);
    table.add("sure_distance", &S::sure_distance, "descriptor distance of a match that needs no context, at most")
        .range(1, 256)
        .unit("bits");
    table.add("possible_distance", &S::possible_distance, "descriptor distance of a match near its prediction, at most")
        .range(1, 256)
        .unit("bits");
    table.add("minimum_matches", &S::minimum_matches, "matches with the previous frame for a pose to be tried")
        .range(4, 10000);
    table.add("minimum_inliers", &S::minimum_inliers, "map points that must agree with a pose for it to be believed")
        .range(6, 10000);
    table
        .add("maximum_deviation", &S::maximum_deviation,
             "standard deviation of the position, as the inliers determine it, above which a pose is not believed")
        .range(1e-4, 1000)
        .unit("m");
    table.add("local_keyframes", &S::local_keyframes, "keyframes whose points make the local map, at most")
        .range(1, 1000);
    table
        .add("keyframe_minimum_interval", &S::keyframe_minimum_interval,
             "time between keyframes, at least, unless tracking is about to be lost")
        .range(0, 1000)
        .unit("s");
    table.add("keyframe_maximum_interval", &S::keyframe_maximum_interval, "time after which a keyframe is due")
        .range(0.03, 1000)
        .unit("s");
    table
        .add("keyframe_tracked_ratio", &S::keyframe_tracked_ratio,
             "a keyframe is due when less than this share of the reference keyframe's points is tracked")
        .range(0, 1);
    table
        .add("keyframe_mask_age", &S::keyframe_mask_age,
             "with a segmenter, a keyframe is due when the mask carried along is this old")
        .range(0.03, 1000)
        .unit("s");
    table
        .add("keyframe_close_tracked", &S::keyframe_close_tracked,
             "a keyframe is due when fewer close points are tracked, and ...")
        .range(0, 100000);
    table.add("keyframe_close_possible", &S::keyframe_close_possible, "... more than this many new ones could be made")
        .range(0, 100000);
    table
        .add("depth_edge_ratio", &S::depth_edge_ratio,
             "depth is not trusted where it varies around a feature by more than this share of itself; 0 = trust all")
        .range(0, 1);
    table
        .add("coasting_time", &S::coasting_time,
             "a lost camera is looked for where its last velocity takes it for this long")
        .range(0, 100)
        .unit("s");
    table
        .add("relocalisation_candidates", &S::relocalisation_candidates,
             "places that a lost camera compares itself with in each frame, at most; 0 = the last keyframes only")
        .range(0, 100);
    table
        .add("relocalisation_inliers", &S::relocalisation_inliers,
             "map points that must agree before a recognised place is believed")
        .range(6, 10000);
    table
        .add("relocalisation_speed", &S::relocalisation_speed,
             "a lost camera is not believed to have moved faster than this, plus 1 m")
        .range(0.01, 1000)
        .unit("m/s");
  }
};

}  // namespace holdfast
