// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "holdfast/plugin/choice.hpp"

namespace holdfast {

template <class Settings>
class ParameterTable;

/// Tracking of frames between keyframes: by extracted features, or by optical flow of the features of an earlier frame.
enum class BetweenKeyframes { features, flow };

/// Correction of the rolling shutter: none, by the readout time of the camera, or by an online estimate with that value
/// as initial value.
enum class RollingShutterMode { off, fixed, estimated };

template <>
inline constexpr Choice<RollingShutterMode> choice_table<RollingShutterMode>[] = {
    {"off", RollingShutterMode::off},
    {"fixed", RollingShutterMode::fixed},
    {"estimated", RollingShutterMode::estimated}};

template <>
inline constexpr Choice<BetweenKeyframes> choice_table<BetweenKeyframes>[] = {{"features", BetweenKeyframes::features},
                                                                              {"flow", BetweenKeyframes::flow}};

/// The `tracking` section of a configuration.
struct TrackingSettings {
  // Start and first pose.
  int minimum_start_points = 100;  ///< minimum number of points with depth in the first frame
  double start_depth = 1.5;        ///< monocular: median depth of the initial points; sets the unit of the map
  /// Monocular: maximum standard deviation of the direction of translation between the first two views [deg]; 0 = off.
  /// In images mostly covered by people, translation and rotation are hard to distinguish.
  double start_deviation = 0.0;
  /// Monocular: minimum support of a new map, from start_support_age to start_settling_time: the share of static
  /// features that are matched with the map, times the inlier share of these. A map with less is discarded. Typical
  /// values are 0.05 to 0.1 for maps of people or of degenerate geometry, and 0.08 to 0.5 for others. The limit is
  /// halved for each further start. 0 = off.
  double start_support = 0.0;
  double close_depth_factor = 40.0;  ///< maximum depth of close points, in baselines (ORB-SLAM2)
  double depth_edge_ratio = 0.05;    ///< relative depth step at a feature above which its depth is ignored; 0 = off
  bool depth_alignment = true;       ///< compensate the ego-motion between colour and depth image
  RollingShutterMode rolling_shutter = RollingShutterMode::estimated;
  double motion_window = 15.0;       ///< search radius around a prediction, at level 0 [px]
  double motion_window_retry = 2.0;  ///< factor on motion_window for a second attempt
  int minimum_matches = 20;  ///< minimum matches with the previous frame; an initial pose needs half as many inliers
  double alignment_threshold =
      0.06;  ///< inlier distance of the RANSAC alignment [m]; 2.3 standard deviations of a Kinect at 4 m

  // Local map.
  double local_map_window = 3.0;     ///< factor on the search radius of LocalMap::project
  double descriptor_ratio = 0.8;     ///< maximum ratio of best to second best descriptor distance (Lowe 2004)
  double strict_distance = 0.0;      ///< maximum descriptor distance without a prediction; 0 = the extractor's
  double loose_distance = 0.0;       ///< maximum descriptor distance near a prediction; 0 = the extractor's
  double feature_boost = 2.0;        ///< maximum factor on the number of features to extract if few are static; 1 = off
  double feature_boost_below = 0.8;  ///< share of static features in the last frame below which the factor applies
  int minimum_inliers = 30;          ///< minimum number of inliers of a pose
  double maximum_deviation = 0.02;   ///< maximum standard deviation of the position [m]
  double jump_distance = 0.06;       ///< maximum deviation from constant velocity in 1/30 s [m]: 54 m/s^2
  double jump_angle = 3.0;           ///< the same for the rotation [deg]
  int local_keyframes = 80;          ///< maximum number of keyframes of the local map
  double odometry_time = 0.3;        ///< maximum duration of odometry without the map [s]; 0 = never
  double depth_only_time = 1.0;      ///< maximum duration of poses from dense depth alone [s]

  // Inertial measurements.
  bool inertia = false;              ///< they predict poses and bridge views, if frames have them
  double inertial_time = 4.0;        ///< how long poses can be predicted by them alone [s]; 0 = never
  double inertial_deviation = 0.15;  ///< standard deviation of the position up to which such a pose is used [m]

  // Optical flow.
  BetweenKeyframes between_keyframes = BetweenKeyframes::features;
  int flow_frames = 4;      ///< maximum number of consecutive frames tracked by flow
  double flow_share = 0.7;  ///< minimum inlier share of the map points tracked by flow

  // Keyframes.
  double keyframe_minimum_interval = 0.0;  ///< minimum time between keyframes [s]
  double keyframe_maximum_interval = 1.0;  ///< time after which a keyframe is due [s]
  double keyframe_tracked_ratio = 0.8;     ///< a keyframe is due below this tracked share of the reference keyframe
  double keyframe_first_ratio = 0.4;       ///< the same for the second keyframe, as the first has no established points
  double keyframe_due_ratio = 0.9;   ///< the same after keyframe_maximum_interval; avoids keyframes of a camera at rest
  double keyframe_mask_age = 0.5;    ///< age of the mask from which a keyframe is due [s]
  int keyframe_close_tracked = 100;  ///< tracked close points below which a keyframe is due, with the next condition
  int keyframe_close_possible =
      70;  ///< unmatched close features above which a keyframe is due, with the last condition

  // Acceptance and confirmation of poses and maps.
  int ample_inliers = 4;             ///< inliers that need no other check, as a multiple of minimum_inliers
  double support_age = 0.5;          ///< age of a monocular map from which minimum_support applies [s]
  double minimum_support = 0.06;     ///< minimum share of static features explained by a monocular map; without people
                                     ///< 0.12 and more, on a person who fills the view 0.02 to 0.05; 0 = any
  double established_age = 1.0;      ///< age of established points [s]; a passing person is in view for about as long
  int established_points = 50;       ///< minimum number of consistent established points
  double new_point_factor = 4.0;     ///< factor on the chi-square limit of newer points
  double start_settling_time = 0.5;  ///< age at which a monocular map is accepted [s]
  double start_support_age = 0.3;    ///< age of a map from which start_support is measured [s]
  int provisional_frames = 30;       ///< maximum number of frames kept while waiting for the first mask
  int confirming_frames = 8;         ///< consecutive frames that confirm an uncertain pose after a loss
  double young_map_patience = 0.1;   ///< minimum duration of a loss before a young map is restarted [s]
  double young_map_share = 0.5;      ///< the same as a share of the time tracked before
  int return_interval = 3;           ///< interval of the attempts to return to the earlier submap [frames]
  double found_time = 0.5;           ///< time after a recovery in which MapRequest::follows_loss holds [s]

  // Relocalisation.
  double restart_time = 0.0;      ///< duration of a loss after which a new submap begins [s]; 0 = never
  int backward_frames = 60;       ///< maximum number of frames kept for backward tracking; 0 = none
  int backward_steps = 2;         ///< frames tracked backwards per new frame
  int backward_mask_frames = 8;   ///< frames to wait for the mask of the first keyframe after a recovery
  int backward_patience = 3;      ///< consecutive failures after which backward tracking ends
  int late_frames = 0;            ///< maximum number of frames kept for the end of the run, see LateTracker; 0 = none
  bool smooth_trajectory = true;  ///< whether the trajectory is smoothed at the end of the run
  double start_share = 0.6;       ///< minimum static share of the first keyframe's features; 0 = any
  double young_map_time = 1.0;    ///< age up to which a lost map is restarted [s]; 0 = never
  double coasting_time = 1.0;     ///< duration of the extrapolation after a loss [s]
  std::vector<double> coasting_shares = {1.0, 0.5, 0.0};  ///< fractions of the last velocity that are extrapolated
  double coasting_window = 3.0;                           ///< factor on local_map_window
  int recovery_keyframes = 5;                             ///< keyframes compared with each frame after a loss
  int relocalisation_candidates = 5;                      ///< candidates of the loop detector, at most; 0 = none
  int relocalisation_inliers = 50;                        ///< minimum number of inliers
  double relocalisation_window = 2.0;                     ///< factor on local_map_window
  double relocalisation_speed = 3.0;  ///< maximum speed of the camera during a loss [m/s]; a running person
  /// Monocular: minimum inlier share of the matches of relocalisation. A wide search near a wrong pose gives up to 1/7
  /// after the optimization.
  double relocalisation_chance = 1.0 / 6.0;
  double relocalisation_tolerance = 1.0;  ///< tolerance of the reachable area [m], for erroneous poses before the loss

  static void describe(ParameterTable<TrackingSettings>& table);
};

}  // namespace holdfast
