// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "holdfast/plugin/choice.hpp"

namespace holdfast {

template <class Settings>
class ParameterTable;

/// How frames are tracked that do not become keyframes: by features of their own, or by those of an earlier frame that
/// are followed by optical flow.
enum class BetweenKeyframes { features, flow };

/// Whether features are corrected for the time between the exposures of the rows of an image, and whether that time is
/// the camera's or estimated during the run, beginning with the camera's.
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
  int minimum_start_points = 100;  ///< points with depth in the first frame; fewer make a map too weak to track by
  double start_depth = 1.5;        ///< one camera: median depth of the first points; sets the unit of the map
  /// One camera: standard deviation of the direction of motion between the first two views above which the start waits
  /// [deg]; 0 = off. What people leave of an image may hardly tell translation from rotation.
  double start_deviation = 0.0;
  /// One camera: after start_support_age to start_settling_time, the share of a frame's static features that are found
  /// in the map, times the share of those that agree with the pose; a map with less is given up. Maps that were begun
  /// with people, or with points that hardly determine their shape, have 0.05 to 0.1, others 0.08 to 0.5. Half is
  /// enough for each further start. 0 = off.
  double start_support = 0.0;
  double close_depth_factor = 40.0;  ///< baselines; beyond it, noise of depth exceeds that of triangulation (ORB-SLAM2)
  double depth_edge_ratio = 0.05;    ///< share of the depth; features at larger steps of depth have none; 0 = off
  bool depth_alignment = true;       ///< depth of features is corrected for the ego-motion between colour and depth
  RollingShutterMode rolling_shutter = RollingShutterMode::estimated;
  double motion_window = 15.0;       ///< search radius around a prediction, at level 0 [px]
  double motion_window_retry = 2.0;  ///< factor on motion_window for the second try, after a sudden motion
  int minimum_matches = 20;          ///< with the previous frame; half as many inliers accept the first pose
  double alignment_threshold =
      0.06;  ///< inlier distance of the RANSAC alignment [m]; 2.3 standard deviations of a Kinect at 4 m

  // Local map.
  double local_map_window = 3.0;  ///< factor on the search radius of LocalMap::project
  double descriptor_ratio = 0.8;  ///< best to second best distance, after Lowe 2004
  double strict_distance = 0.0;   ///< of descriptors, of a match without any prediction; 0 = the extractor's
  double loose_distance = 0.0;    ///< of descriptors, of a match near its prediction; 0 = the extractor's
  double feature_boost = 2.0;     ///< factor on the number of features where people leave few of them, at most; 1 = off
  double feature_boost_below = 0.8;  ///< share of static features below which there are more of them
  int minimum_inliers = 30;          ///< map points that must agree with a pose
  double maximum_deviation = 0.02;   ///< standard deviation of the position [m]
  double jump_distance = 0.06;       ///< [m] from constant velocity in 1/30 s: 54 m/s^2
  double jump_angle = 3.0;           ///< [deg], the same
  int local_keyframes = 80;          ///< whose points make the local map
  double odometry_time = 0.3;        ///< how long poses can be based on the previous frame, without the map [s]
  double depth_only_time = 1.0;      ///< how long poses can be based on dense depth alone [s]

  // Inertial measurements.
  bool inertia = true;               ///< they are used if frames have them
  double inertial_time = 4.0;        ///< how long poses can be predicted by them alone [s]
  double inertial_deviation = 0.15;  ///< standard deviation of the position up to which such a pose is used [m]

  // Optical flow.
  BetweenKeyframes between_keyframes = BetweenKeyframes::features;
  int flow_frames = 4;      ///< frames in a row that are tracked by flow, at most
  double flow_share = 0.7;  ///< of the followed map points that must agree with the pose of a frame

  // Keyframes.
  double keyframe_minimum_interval = 0.0;  ///< [s]
  double keyframe_maximum_interval = 1.0;  ///< [s]
  double keyframe_tracked_ratio = 0.8;     ///< share of the reference keyframe's points
  double keyframe_first_ratio = 0.4;  ///< the same for the second keyframe: the first one has no established points
  double keyframe_due_ratio = 0.9;    ///< the same after keyframe_maximum_interval: a camera at rest needs none
  double keyframe_mask_age = 0.5;     ///< [s]; half of the time in which a mask's confidence halves
  int keyframe_close_tracked = 100;   ///< features
  int keyframe_close_possible = 70;   ///< features

  // Which poses are believed, and for how long.
  int ample_inliers = 4;             ///< times minimum_inliers: what determines a pose beyond doubt
  double support_age = 0.5;          ///< [s]; before, a right map of one camera is small too
  double minimum_support = 0.06;     ///< without people, 0.12 and more; on a person who fills the view, 0.02 to 0.05
  double established_age = 1.0;      ///< [s]; somebody who walks past the camera is in view for about as long
  int established_points = 50;       ///< that agree with each other
  double new_point_factor = 4.0;     ///< on chi-square; the established pose and the points are uncertain as well
  double start_settling_time = 0.5;  ///< [s]
  double start_support_age = 0.3;    ///< [s]; before, a right map is small too
  int provisional_frames = 30;       ///< as long as a mask may take
  int confirming_frames = 8;         ///< in a row
  double young_map_patience = 0.1;   ///< [s]; the next frames or a mask that is on its way may help
  double young_map_share = 0.5;      ///< of the time tracked: a longer map is worth waiting longer for
  int return_interval = 3;           ///< frames; the search takes as long as tracking
  double found_time = 0.5;           ///< [s]

  // Relocalisation.
  double restart_time = 0.0;                              ///< [s]; a camera lost for longer begins a new submap
  int backward_frames = 60;                               ///< kept, of those without a pose
  int backward_steps = 2;                                 ///< for each frame, so that tracking does not stall
  int backward_mask_frames = 8;                           ///< as long as a mask usually takes
  int backward_patience = 3;                              ///< frames in a row without a pose
  double start_share = 0.6;                               ///< of the first keyframe's features
  double young_map_time = 1.0;                            ///< [s]; a map lost so soon after its start begins anew
  double coasting_time = 1.0;                             ///< [s]
  std::vector<double> coasting_shares = {1.0, 0.5, 0.0};  ///< of the last velocity: it goes on, slows down, or stops
  double coasting_window = 3.0;                           ///< factor on local_map_window
  int recovery_keyframes = 5;                             ///< compared in each frame of a loss
  int relocalisation_candidates = 5;                      ///< places of the loop detector
  int relocalisation_inliers = 50;                        ///< map points
  double relocalisation_window = 2.0;                     ///< factor on local_map_window
  double relocalisation_speed = 3.0;                      ///< [m/s]; a running person
  /// Of the matches of a wide search near a wrong pose of one camera, up to a seventh agree with it after an
  /// adjustment.
  double relocalisation_chance = 1.0 / 6.0;
  double relocalisation_tolerance = 1.0;  ///< [m]; for poses that had gone astray before the loss

  static void describe(ParameterTable<TrackingSettings>& table);
};

}  // namespace holdfast
