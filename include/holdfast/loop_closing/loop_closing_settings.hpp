// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace holdfast {

template <class Settings>
class ParameterTable;

/// Settings of loop closing: the section `loop_closing` of a configuration.
struct LoopClosingSettings {
  /// Maximum number of similar keyframes requested from the loop detector, in addition to the covisible ones.
  int candidates = 30;
  int minimum_gap = 20;  ///< minimum number of keyframes between a place and its revisit
  /// Number of keyframes after a loop closure in which no other loop is searched; 10 as in ORB-SLAM2.
  int pause = 10;
  double score_share = 0.8;  ///< minimum score of a candidate, relative to the lowest score of a covisible neighbour
  double group_share = 0.6;  ///< minimum score of a group of covisible candidates, relative to the best group
  /// Number of consecutive keyframes with consistent candidates; 3 as in ORB-SLAM (section VII-A).
  int consistent_keyframes = 3;
  /// Number of covisible keyframes of a candidate whose points take part in the geometric check.
  int neighbours = 10;
  /// Maximum distance between the descriptors of feature and point; 0 = the extractor's strict distance plus a fifth of
  /// the difference to its loose distance, 60 bits for ORB.
  double match_distance = 0.0;
  /// Maximum ratio of nearest to second-nearest descriptor distance (ratio test). Adjacent map points are not compared
  /// with each other.
  double match_ratio = 0.8;
  double alignment_threshold = 0.08;  ///< inlier threshold of the rigid alignment [m]
  int alignment_iterations = 300;     ///< maximum number of RANSAC samples of the rigid alignment; 300 as in ORB-SLAM2
  int minimum_aligned = 15;           ///< minimum number of inliers of the rigid alignment
  double search_radius = 8.0;  ///< radius of the guided search for the candidate's points, at the finest level [px]
  /// Minimum number of the candidate's points that are matched in the keyframe; 40 as in ORB-SLAM2.
  int minimum_inliers = 40;
  double minimum_share = 0.12;  ///< minimum fraction that these matches have of the points predicted to be visible
  int minimum_cells = 5;  ///< minimum number of cells of a 4 x 4 grid over the image with at least two matches each
  /// Minimum mean share of the votes of matched points (Map::class_votes()) for the classes of their features. It is
  /// compared only if the loop detector weights classes; 0 = never.
  double class_agreement = 0.5;
  double drift_constant = 0.15;  ///< plausible correction for a loop of zero length [m]
  /// Additional plausible correction for each metre (and each radian) of the path around the loop [m].
  double drift_per_metre = 0.02;
  double drift_per_metre_mono = 0.15;  ///< the same in monocular mode, where scale drift also distorts the path
  double largest_scale_drift = 2.0;    ///< maximum scale drift around a loop in monocular mode, as a factor
  double turn_constant = 5.0;          ///< plausible rotation of the correction for a loop of zero length [deg]
  /// Additional plausible rotation for each metre (and each radian) of the path around the loop [deg].
  double turn_per_metre = 0.5;
  /// Minimum covisibility weight of an edge of the essential graph; 100 as in ORB-SLAM (section III-D).
  int essential_weight = 100;
  int graph_iterations = 30;  ///< maximum iterations of the pose graph
  /// With inertial measurements, keyframes get the roll and pitch that these say, in the world of the oldest one with a
  /// vertical, and the pose graph has four degrees of freedom. A submap in which fewer than four fifths of the
  /// keyframes have a vertical keeps six.
  bool keep_vertical = false;
  bool full_adjustment = true;      ///< whether full bundle adjustment follows a loop closure
  int full_robust_iterations = 20;  ///< its maximum iterations with the robust cost
  int full_final_iterations = 40;   ///< its maximum iterations after the removal of outliers
  /// Convergence tolerance of its relative cost decrease; small, because the deformation of a long loop converges
  /// slowly.
  double full_tolerance = 1e-7;

  static void describe(ParameterTable<LoopClosingSettings>& table);
};

}  // namespace holdfast
