// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace holdfast {

/// State of a Tracker between two frames:
///
///                     start                        judged
///      +---------+ ----------> +-------------+ -----------> +----------+
///      | waiting |             | provisional |              | tracking |
///      +---------+ <---------- +-------------+              +----------+
///           ^        refuted      |      ^                    |      ^
///           |                lost |      | found, or     lost |      | found, or
///           |                     |      | map begun anew     |      | new submap
///           |      given up       v      |                    v      |
///           +------------------- +--------------------------------------+
///                                |                 lost                 |
///                                +--------------------------------------+
///                            found by few inliers |         ^ lost again: poses withdrawn
///                                                 v         |
///                                            +-------------+
///                                            | unconfirmed | --> tracking: ample inliers, or eight frames
///                                            +-------------+
///
/// With a loaded map the initial state is lost. The transition "judged" requires the first mask if features have depth,
/// and half a second of tracking in monocular mode. "Given up" exists in monocular mode only, for maps that are lost or
/// found weak right after their start.
enum class TrackerState {
  waiting,      ///< there is no map
  provisional,  ///< the camera is tracked; frames are kept for backward tracking after the verification of the start
  tracking,     ///< the camera is tracked
  lost,         ///< there is a map, and the last frame has no pose in it
  unconfirmed,  ///< recovered with few inliers; no keyframes are created, and the poses may be withdrawn
};

/// Whether the last frame has a pose.
inline bool has_pose(TrackerState state) { return state != TrackerState::waiting && state != TrackerState::lost; }

}  // namespace holdfast
