// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "holdfast/core/map_defaults.hpp"

namespace holdfast {

template <class Settings>
class ParameterTable;

/// Settings of local mapping: the section `mapping` of a configuration.
struct MappingSettings {
  /// Minimum number of points that a keyframe creates from depth, close or not; 100 as in ORB-SLAM2.
  int minimum_depth_points = 100;
  /// Number of covisible keyframes for triangulation and fusion of points; 10 as in ORB-SLAM2 for RGB-D.
  int neighbours = 10;
  /// Parallax [degrees] above which features of one camera that were not triangulated with 1.15 degrees become points.
  /// A camera that turns more than it moves sees far points below 1.15 degrees, unless errors of match and pose make
  /// them appear nearer than they are: with that limit alone, only these errors become points.
  double far_parallax = 1.15;
  int second_neighbours = 5;  ///< number of neighbours of each neighbour that take part in fusion; 5 as in ORB-SLAM2
  /// Found ratio below which a new point is culled; 0.25 as in ORB-SLAM (Mur-Artal et al. 2015, section VI-B).
  double weak_found_ratio = 0.25;
  /// Number of keyframes after its creation in which a point can be culled; 3 as in ORB-SLAM.
  int probation_keyframes = 3;
  double moving_log_odds = -2.0;  ///< measured static log-odds below which a map point is moving and removed
  /// A keyframe is culled if this fraction of its points is observed by three other keyframes at the same or a finer
  /// scale; 0.9 as in ORB-SLAM (section VI-E). Once 200 keyframes have followed, points found less often than
  /// weak_found_ratio of these do not count, and it is culled, too, if fewer than 2 % of its features have other ones.
  double redundant_share = 0.9;
  int bundle_keyframes = 20;         ///< maximum number of free keyframes of a local bundle adjustment; bounds its time
  int bundle_robust_iterations = 5;  ///< iterations with the robust cost; 5 as in ORB-SLAM2
  int bundle_final_iterations = 10;  ///< iterations after the removal of outliers; 10 as in ORB-SLAM2
  /// Minimum number of shared points of a covisibility edge, in local mapping and loop closing alike (Map).
  int covisibility_minimum = default_covisibility_minimum;
  /// Where tracking uses inertial measurements (TrackingSettings::inertia): whether these link the keyframes in
  /// adjustments of the whole map, after loops and at the end of the run, and smooth the frames between them at its
  /// end.
  bool inertia = true;
  /// Rounds at the end of a run, after an adjustment of the whole map: its points are searched again in the neighbours
  /// of every keyframe, whose poses now are better than when they were made, and the whole map is adjusted; 0 = none.
  int final_rounds = 0;

  static void describe(ParameterTable<MappingSettings>& table);
};

}  // namespace holdfast
