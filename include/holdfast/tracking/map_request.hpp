// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace holdfast {

struct TwoViewMap;

/// What the tracker asks of the map's owner after a frame. Every kind but `none` and `give_up` makes the frame a
/// keyframe.
struct MapRequest {
  enum class Kind {
    none,
    keyframe,        ///< insert the frame
    first_keyframe,  ///< insert the frame; the map begins with it, or begins anew in its first submap
    two_views,       ///< insert `two_views`, call Tracker::map_begun(), then insert the frame
    new_submap,      ///< insert the frame as the first keyframe of a new submap
    give_up          ///< remove the whole map and call Tracker::forget_map()
  };
  Kind kind = Kind::none;
  std::uint32_t submap = 0;  ///< in which the camera is tracked; not yet that of `new_submap`
  /// A mask of this frame is needed although it has no pose or an unconfirmed one: static features find the camera
  /// again, begin a new submap, or begin the map of one camera.
  bool wants_mask = false;
  bool follows_loss = false;              ///< found within found_time: what fills the view may have caused the loss
  const TwoViewMap* two_views = nullptr;  ///< valid until the next frame
};

}  // namespace holdfast
