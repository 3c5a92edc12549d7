// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace holdfast {

struct TwoViewMap;

/// Request of the tracker to the owner of the map after a frame. All kinds except `none` and `give_up` make the frame a
/// keyframe.
struct MapRequest {
  enum class Kind {
    none,
    keyframe,        ///< insert the frame
    first_keyframe,  ///< insert the frame as the first keyframe of a new or restarted map
    two_views,       ///< insert `two_views`, call Tracker::map_begun(), then insert the frame
    new_submap,      ///< insert the frame as the first keyframe of a new submap
    give_up          ///< remove the whole map and call Tracker::forget_map()
  };
  Kind kind = Kind::none;
  std::uint32_t submap = 0;  ///< submap in which the camera is tracked, before a `new_submap` is created
  /// The frame should be segmented although it has no confirmed pose, because relocalisation, a new submap or a
  /// monocular initialisation need its static features.
  bool wants_mask = false;
  bool follows_loss = false;  ///< recovered within found_time: objects that fill the view may have caused the loss
  const TwoViewMap* two_views = nullptr;  ///< valid until the next frame
};

}  // namespace holdfast
