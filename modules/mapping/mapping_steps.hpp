// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <cstddef>
#include <vector>

#include "holdfast/core/map.hpp"
#include "holdfast/core/map_mutex.hpp"
#include "holdfast/interfaces/feature_matcher.hpp"
#include "holdfast/interfaces/optimizer.hpp"
#include "holdfast/mapping/mapping_settings.hpp"

/// The steps of LocalMapper, which owns their common state. Functions with a MapMutex acquire it for short intervals;
/// the others know of no threads.
namespace holdfast {

/// Triangulates points from features without a point of the keyframe and of its covisible keyframes (Mur-Artal et al.
/// 2015, section VI-C), up to MappingSettings::neighbours of them. Those that are left over with one camera are
/// triangulated with less parallax (MappingSettings::far_parallax), with the most distant keyframes first. Returns the
/// new points.
std::vector<MapPointId> triangulate_points(Map& map, MapMutex& mutex, KeyFrameId keyframe,
                                           const MappingSettings& settings);

/// Searches the points of the keyframe in its neighbours and theirs in the keyframe; adds observations, and fuses
/// duplicate points. Returns the number of fused points.
std::size_t fuse_with_neighbours(Map& map, MapMutex& mutex, KeyFrameId keyframe, const MappingSettings& settings,
                                 const FeatureMatcher& matcher);

/// Number of observations and points that a bundle adjustment removed.
struct BundleRemovals {
  std::size_t observations = 0, points = 0;
};
/// Local bundle adjustment around the keyframe; the mutex is not held while solving. Free are its strongest neighbours
/// or, with `frees_latest`, the latest keyframes of its submap, covisible or not.
BundleRemovals adjust_bundle(Map& map, MapMutex& mutex, KeyFrameId keyframe, bool frees_latest,
                             const MappingSettings& settings, Optimizer& optimizer, const std::atomic<bool>& stop);

/// Removes the observations of a keyframe whose features are more likely moving than static, and returns their points.
std::vector<MapPointId> drop_moving_features(Map& map, KeyFrameId keyframe);
/// With one camera, removes a point that has lost an observation and has fewer than three left (as in ORB-SLAM);
/// returns whether it did. Only the thread of LocalMapper::refine() may call it, which relies on the existence of
/// points.
bool drop_weak_point(Map& map, MapPointId point);
/// Removes points with measured static log-odds below the limit, and returns their number.
std::size_t remove_moving_points(Map& map, double moving_log_odds);
/// Culls recent points that are rarely found, or not confirmed by later keyframes (Mur-Artal et al. 2015, section
/// VI-B); returns their number. `recent_points` loses them and those whose probation has ended.
std::size_t remove_weak_points(Map& map, KeyFrameId keyframe, const MappingSettings& settings, bool expects_masks,
                               std::vector<MapPointId>& recent_points);
/// Removes covisible keyframes most of whose points are redundant, and old keyframes that add few others, and returns
/// them.
std::vector<KeyFrameId> remove_redundant_keyframes(Map& map, KeyFrameId keyframe, const MappingSettings& settings,
                                                   double close_depth_factor);

}  // namespace holdfast
