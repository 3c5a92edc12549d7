// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/tracking/tracking_settings.hpp"

#include "holdfast/plugin/parameter_table.hpp"

namespace holdfast {

namespace {

using S = TrackingSettings;

void describe_start(ParameterTable<S>& table) {
  table
      .add("minimum_start_points", &S::minimum_start_points,
           "points with depth that the first frame must have; with one camera, matches of the first two keyframes")
      .range(10, 100000);
  table
      .add("start_depth", &S::start_depth,
           "with one camera, the median depth that the first points get, which sets the unit of the map: parameters in "
           "metres are in this unit then")
      .range(0.5, 100);
  table
      .add("start_deviation", &S::start_deviation,
           "with one camera, standard deviation of the direction of motion between the first two views above which the "
           "map does not begin yet, as where people leave a small part of the image; 0 = off")
      .range(0, 90)
      .unit("deg");
  table
      .add("start_support", &S::start_support,
           "with one camera, share of a frame's static features that are found in the map start_support_age to "
           "start_settling_time after its start, "
           "times the share of those that agree with the pose; a map with less is given up, and another one begins; "
           "half is "
           "enough for each further start; 0 = off")
      .range(0, 1);
  table
      .add("start_settling_time", &S::start_settling_time,
           "with one camera, time for which a new map is provisional; then start_support judges it")
      .range(0, 100)
      .unit("s");
  table
      .add("start_support_age", &S::start_support_age,
           "time after the start from which frames count for start_support; before, a right map is small too")
      .range(0, 100)
      .unit("s");
  table
      .add("provisional_frames", &S::provisional_frames,
           "frames that are kept, at most, while the first mask is awaited; if it refutes the start, they are tracked "
           "anew")
      .range(0, 1000);
  table
      .add("close_depth_factor", &S::close_depth_factor,
           "depth up to this many baselines is trusted alone; farther points are triangulated")
      .range(1, 10000);
}

void describe_matching(ParameterTable<S>& table) {
  table.add("motion_window", &S::motion_window, "search radius around a predicted feature, at level 0")
      .range(1, 200)
      .unit("px");
  table
      .add("motion_window_retry", &S::motion_window_retry,
           "factor on motion_window for a second try when the first finds too few matches")
      .range(1, 20);
  table.add("local_map_window", &S::local_map_window, "factor of the search radius around projected map points")
      .range(0.5, 20);
  table.add("descriptor_ratio", &S::descriptor_ratio, "best to second best descriptor distance, at most").range(0.1, 1);
  table
      .add(
          "strict_distance", &S::strict_distance,
          "descriptor distance of a match without a prediction, at most, in the unit of the extractor (orb: bits); 0 = "
          "as the extractor recommends (orb: 50)")
      .range(0, 1e6);
  table
      .add("loose_distance", &S::loose_distance,
           "descriptor distance of a match near its prediction, at most; 0 = as the extractor recommends (orb: 100)")
      .range(0, 1e6);
  table.add("minimum_matches", &S::minimum_matches, "matches with the previous frame for a pose to be tried")
      .range(4, 10000);
  table
      .add("alignment_threshold", &S::alignment_threshold,
           "distance up to which a point agrees with a rigid alignment to a keyframe")
      .range(0.001, 10)
      .unit("m");
}

void describe_extraction(ParameterTable<S>& table) {
  table.add(
      "between_keyframes", &S::between_keyframes,
      "features: every frame is tracked by features of its own; flow: frames that do not become keyframes are "
      "tracked by the features of an earlier frame, which optical flow follows, as long as these agree with a pose "
      "(not with stereo)");
  table.add("flow_frames", &S::flow_frames, "frames in a row that are tracked by flow, at most").range(1, 1000);
  table
      .add("flow_share", &S::flow_share,
           "share of the followed map points that must agree with a pose by flow; otherwise the frame gets features")
      .range(0.1, 1);
  table
      .add("crowd_features", &S::feature_boost,
           "factor on the extractor's number of features, at most, where moving things leave few static ones; 1 = off")
      .range(1, 10);
  table
      .add("crowd_share", &S::feature_boost_below,
           "share of the previous frame's features that were static, below which there are more of them: so many that "
           "the number of static ones stays at this share of the extractor's")
      .range(0, 1);
}

void describe_acceptance(ParameterTable<S>& table) {
  table.add("minimum_inliers", &S::minimum_inliers, "map points that must agree with a pose for it to be accepted")
      .range(6, 10000);
  table
      .add("maximum_deviation", &S::maximum_deviation,
           "standard deviation of the position, as the inliers determine it, above which a pose is rejected")
      .range(1e-4, 1000)
      .unit("m");
  table
      .add("jump_distance", &S::jump_distance,
           "a pose with fewer inliers than four times minimum_inliers is rejected if it is farther than this from the "
           "prediction of constant velocity, per 1/30 s")
      .range(0.001, 1000)
      .unit("m");
  table.add("jump_angle", &S::jump_angle, "the same for the rotation").range(0.01, 360).unit("deg");
  table
      .add("odometry_time", &S::odometry_time,
           "time for which poses can be based on the previous frame alone, because too little of the map is in view; "
           "0 = never")
      .range(0, 100)
      .unit("s");
  table
      .add("depth_only_time", &S::depth_only_time,
           "time for which poses can be based on dense depth alone, because matches do not determine them")
      .range(0, 100)
      .unit("s");
  table.add("local_keyframes", &S::local_keyframes, "keyframes whose points make the local map, at most")
      .range(1, 1000);
}

void describe_trust(ParameterTable<S>& table) {
  table
      .add("ample_inliers", &S::ample_inliers,
           "times minimum_inliers: with so many inliers, a pose needs no confirmation by motion or later frames")
      .range(1, 1000);
  table
      .add("support_age", &S::support_age,
           "with one camera, age of the map from which a pose needs minimum_support; before, a right map is small too")
      .range(0, 100)
      .unit("s");
  table
      .add("minimum_support", &S::minimum_support,
           "with one camera, share of a frame's static features that must agree with its pose; without people it is "
           "0.12 and more, on a person who fills the view 0.02 to 0.05; 0 = any")
      .range(0, 1);
  table
      .add("established_age", &S::established_age,
           "with one camera, time since a point was first seen after which it is established: where established points "
           "determine a pose, newer ones that contradict it are outliers. People walk past a camera in about this time")
      .range(0, 100)
      .unit("s");
  table.add("established_points", &S::established_points, "established points that must agree to determine a pose")
      .range(6, 10000);
  table
      .add("new_point_factor", &S::new_point_factor,
           "factor on the 95 % bound of the squared reprojection error of a newer point, because the pose and the "
           "point are uncertain too")
      .range(1, 1000);
  table
      .add("confirming_frames", &S::confirming_frames,
           "frames in a row after which a pose that was found again with few inliers is confirmed; a loss before "
           "withdraws their poses")
      .range(1, 1000);
}

void describe_keyframes(ParameterTable<S>& table) {
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
      .add("keyframe_first_ratio", &S::keyframe_first_ratio,
           "like keyframe_tracked_ratio, at most, while the map has one keyframe")
      .range(0, 1);
  table
      .add("keyframe_due_ratio", &S::keyframe_due_ratio,
           "like keyframe_tracked_ratio, once keyframe_maximum_interval has passed")
      .range(0, 1);
  table
      .add("keyframe_mask_age", &S::keyframe_mask_age,
           "with a segmenter, a keyframe is due when the propagated mask is this old")
      .range(0.03, 1000)
      .unit("s");
  table
      .add("keyframe_close_tracked", &S::keyframe_close_tracked,
           "a keyframe is due when fewer close points are tracked, and ...")
      .range(0, 100000);
  table.add("keyframe_close_possible", &S::keyframe_close_possible, "... more than this many new ones could be made")
      .range(0, 100000);
}

void describe_corrections(ParameterTable<S>& table) {
  table
      .add("depth_edge_ratio", &S::depth_edge_ratio,
           "depth is not trusted where it varies around a feature by more than this share of itself; 0 = trust all")
      .range(0, 1);
  table.add("depth_alignment", &S::depth_alignment,
            "whether the depth of features is corrected for the motion of the camera between the exposures of the "
            "colour and the depth image, where the source knows both times");
  table.add(
      "rolling_shutter", &S::rolling_shutter,
      "whether features are corrected for the motion of the camera while its rows are exposed one after another: "
      "fixed = by the readout time of the camera; estimated = the same, and the time is estimated while tracking");
}

void describe_inertia(ParameterTable<S>& table) {
  table.add("inertia", &S::inertia,
            "whether inertial measurements predict poses and bridge views that do not determine them, once gravity, "
            "biases and velocity are known; experimental, since a wrong prediction can drift by metres");
  table
      .add("inertial_time", &S::inertial_time,
           "time for which poses can be predicted by inertial measurements, because the images do not determine them, "
           "and between tracked frames, at the end of a run, for others without a pose; 0 = never")
      .range(0, 100)
      .unit("s");
  table
      .add("inertial_deviation", &S::inertial_deviation,
           "standard deviation of the position above which such a pose is not used")
      .range(0.001, 1000)
      .unit("m");
}

void describe_losses(ParameterTable<S>& table) {
  table
      .add("young_map_time", &S::young_map_time,
           "a camera that is lost so soon after its map began, for longer than half of the time tracked until then "
           "(young_map_share), begins the map anew where the motion model puts it; 0 = never")
      .range(0, 100)
      .unit("s");
  table
      .add("young_map_patience", &S::young_map_patience,
           "how long such a camera is lost, at least: the next frames or a mask that is on its way may help")
      .range(0, 100)
      .unit("s");
  table
      .add("young_map_share", &S::young_map_share,
           "how long such a camera is lost, at least, as a share of the time tracked")
      .range(0, 100);
  table
      .add("return_interval", &S::return_interval,
           "after a new submap began, interval of the frames that are searched for in the submap that was left")
      .range(1, 1000)
      .unit("frames");
  table
      .add("found_time", &S::found_time,
           "time after a loss for which a view that shows little of the map is not taken for a new place, because what "
           "fills "
           "it may have caused the loss")
      .range(0, 100)
      .unit("s");
  table
      .add("restart_time", &S::restart_time,
           "a camera that is lost for longer than this begins a new submap where the motion model puts it; "
           "the first place that is seen in both joins it with the rest, and frames of submaps that nothing joins have "
           "no pose in the end; 0 = never (always so with one camera)")
      .range(0, 1000)
      .unit("s");
  table
      .add("backward_frames", &S::backward_frames,
           "frames without a pose that are kept, at most, to be tracked backwards from the next frame that has one; "
           "their poses come with the trajectory of the run; 0 = none")
      .range(0, 1000);
  table
      .add("backward_steps", &S::backward_steps,
           "kept frames that are tracked backwards with each new frame, at most, so that tracking does not stall")
      .range(1, 1000);
  table
      .add("backward_mask_frames", &S::backward_mask_frames,
           "frames for which a keyframe with its mask is awaited before kept frames are tracked backwards from it")
      .range(0, 1000);
  table
      .add("backward_patience", &S::backward_patience,
           "frames in a row without a pose after which tracking backwards ends")
      .range(1, 1000);
  table
      .add("late_frames", &S::late_frames,
           "frames without a pose whose features are kept, at most, to be located in the map at the end of the run "
           "(0.2 MB each); 0 = none")
      .range(0, 100000);
  table.add("smooth_trajectory", &S::smooth_trajectory,
            "whether errors that change from frame to frame are removed from the trajectory at the end of the run, as "
            "far as the accelerations of the camera allow; poses during the run and the map do not change");
  table
      .add("start_share", &S::start_share,
           "when the first mask shows that less than this share of the first keyframe's features is static, the map "
           "began on what moves and begins anew; 0 = never (always so with one camera, which waits for the mask)")
      .range(0, 1);
}

void describe_relocalisation(ParameterTable<S>& table) {
  table.add("coasting_time", &S::coasting_time, "a lost camera is searched for along its last velocity for this long")
      .range(0, 100)
      .unit("s");
  table
      .add("coasting_shares", &S::coasting_shares,
           "shares of the last velocity that are tried in this order: the camera goes on, slows down, or stops")
      .range(-1, 10);
  table
      .add("coasting_window", &S::coasting_window,
           "factor on local_map_window for the first search along the last velocity")
      .range(1, 20);
  table.add("recovery_keyframes", &S::recovery_keyframes, "last keyframes that a lost camera is compared with, at most")
      .range(0, 100);
  table
      .add("relocalisation_candidates", &S::relocalisation_candidates,
           "places that a lost camera is compared with in each frame, at most; 0 = the last keyframes only")
      .range(0, 100);
  table
      .add("relocalisation_inliers", &S::relocalisation_inliers,
           "map points that must agree before a recognised place is accepted")
      .range(6, 10000);
  table
      .add("relocalisation_window", &S::relocalisation_window,
           "factor on local_map_window for the first search around a recognised place")
      .range(1, 20);
  table
      .add("relocalisation_speed", &S::relocalisation_speed,
           "poses that a lost camera could only have reached faster than this are rejected")
      .range(0.01, 1000)
      .unit("m/s");
  table
      .add(
          "relocalisation_chance", &S::relocalisation_chance,
          "with one camera, share of the matches of a wide search that must agree with a pose: near a wrong one, up to "
          "a seventh agree by chance")
      .range(0, 1);
  table
      .add("relocalisation_tolerance", &S::relocalisation_tolerance,
           "distance that is added to what relocalisation_speed allows, for poses that had gone astray before the "
           "loss")
      .range(0, 1000)
      .unit("m");
}

}  // namespace

void TrackingSettings::describe(ParameterTable<TrackingSettings>& table) {
  describe_start(table);
  describe_matching(table);
  describe_extraction(table);
  describe_acceptance(table);
  describe_trust(table);
  describe_keyframes(table);
  describe_corrections(table);
  describe_inertia(table);
  describe_losses(table);
  describe_relocalisation(table);
}

}  // namespace holdfast
