// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "holdfast/tracking/tracking_context.hpp"

/// Choice between rigid motions that explain a frame of a stereo pair. A vehicle in front that keeps its distance
/// supports a standing camera, often with more features than the road. Rival poses are found by PnP among the matches
/// that contradict the pose so far. Of the matches that support one of two poses only, those of the static scene are
/// spread over more of the image.
namespace holdfast {

/// Tests the pose of a frame without a velocity against rivals: the road may move farther between two frames than the
/// search near the previous pose reaches. Rivals are poses by descriptor matches with the reference keyframe, and those
/// of a camera that drives forward by up to 4 m. If one wins, pose and matches of the current frame become its own;
/// otherwise they are left as they are. Features that support a refuted motion alone may lose their weight, as below.
void test_start_motion(TrackingContext& context);

/// Tests the pose that was adjusted last against `began` (T_camera_world), with which the adjustment began, if it is
/// 0.25 m away or more, and against rivals among its outliers, if these are many. Returns whether one of them has won;
/// then the frame has its pose, and the matches that it explains. `began`, or a rival where the velocity predicts it,
/// wins unless the other motion is much wider.
/// Features that support a refuted motion alone get no weight (Frame::static_probability), whether it was the frame's
/// or a rival's.
bool test_local_motion(TrackingContext& context, const Eigen::Isometry3d& began);

}  // namespace holdfast
