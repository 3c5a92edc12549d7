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
/// A loaded map begins as lost. "Judged" is: with depth, the first mask has confirmed the start; with one camera, the
/// map has settled for half a second. Only one camera gives a map up that was lost or found weak right after its start.
enum class TrackerState {
  waiting,      ///< there is no map
  provisional,  ///< the camera is tracked; frames are kept to be tracked again once the start has been judged
  tracking,     ///< the camera is tracked
  lost,         ///< there is a map, and the last frame has no pose in it
  unconfirmed,  ///< found after a loss by few inliers; no keyframes, and the poses may be withdrawn
};

/// Whether the last frame has a pose.
inline bool has_pose(TrackerState state) { return state != TrackerState::waiting && state != TrackerState::lost; }

}  // namespace holdfast
