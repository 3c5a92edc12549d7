// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <map>
#include <vector>

#include "holdfast/core/keyframe.hpp"
#include "holdfast/core/map_point.hpp"
#include "holdfast/core/slot_map.hpp"

namespace holdfast {

/// A whole map as plain values, for Map::restore(). Ids inside it name entries by position: slot i, generation 0 is
/// entry i.
struct MapContent {
  std::vector<KeyFrame> keyframes;  ///< by rising sequence; Frame::grid is left out
  std::vector<MapPoint> points;
  std::uint64_t next_sequence = 0;  ///< greater than every keyframe's sequence
};

/// Keyframes and map points, named by ids, with everything that links them kept consistent: a feature of a keyframe
/// names a point exactly when the point lists that observation. Not synchronised; see MapMutex.
class Map {
 public:
  using KeyFrames = SlotMap<KeyFrame, KeyFrameTag>;
  using MapPoints = SlotMap<MapPoint, MapPointTag>;

  const KeyFrames& keyframes() const { return keyframes_; }
  const MapPoints& points() const { return points_; }
  KeyFrame& keyframe(KeyFrameId id) { return keyframes_.at(id); }
  const KeyFrame& keyframe(KeyFrameId id) const { return keyframes_.at(id); }
  MapPoint& point(MapPointId id) { return points_.at(id); }
  const MapPoint& point(MapPointId id) const { return points_.at(id); }
  KeyFrame* find_keyframe(KeyFrameId id) { return keyframes_.find(id); }
  const KeyFrame* find_keyframe(KeyFrameId id) const { return keyframes_.find(id); }
  MapPoint* find_point(MapPointId id) { return points_.find(id); }
  const MapPoint* find_point(MapPointId id) const { return points_.find(id); }

  /// Stores a copy of the frame as a keyframe and registers it with every map point that the frame names; names of
  /// points that are gone are cleared. Call update_covisibility next.
  KeyFrameId add_keyframe(Frame frame);

  /// Makes a point without observations; add them with add_observation and finish with update_point.
  MapPointId add_point(const Eigen::Vector3d& position, std::uint64_t created_at);

  /// Links a feature of a keyframe to a point; the feature must be free and the point not yet seen by that keyframe.
  void add_observation(MapPointId point, KeyFrameId keyframe, std::uint32_t feature);
  /// Unlinks; a point left without observations is removed.
  void remove_observation(MapPointId point, KeyFrameId keyframe);
  /// The feature by which a keyframe sees a point, or -1.
  int feature_of(MapPointId point, KeyFrameId keyframe) const;

  /// Recomputes descriptor, viewing direction and distance range of a point from its observations
  /// (Mur-Artal et al. 2015, section III-C).
  void update_point(MapPointId point);
  /// Only viewing direction and distance range: after the point or its keyframes moved.
  void update_point_geometry(MapPointId point);

  /// Gives the observations of `from` to `to` and removes `from`; where a keyframe sees both, `to` keeps its own.
  void fuse_points(MapPointId from, MapPointId to);
  void remove_point(MapPointId point);

  /// Recounts the points that a keyframe shares with others and updates the edges of both sides; edges need
  /// `minimum_weight` shared points, the best neighbour is kept in any case. Gives a new keyframe its parent.
  void update_covisibility(KeyFrameId keyframe, int minimum_weight = 15);
  /// Removes a keyframe, its observations and edges; its children find new parents among their neighbours, and its pose
  /// stays available through its parent (see pose_of). Its loop edges go with it.
  void remove_keyframe(KeyFrameId keyframe);

  /// Remembers that a loop was closed between two keyframes, on both sides; twice is once.
  void add_loop_edge(KeyFrameId first, KeyFrameId second);

  /// Ids of all keyframes, oldest first.
  std::vector<KeyFrameId> keyframes_by_age() const;
  /// The up to `most` strongest neighbours.
  std::vector<KeyFrameId> best_covisible(KeyFrameId keyframe, int most) const;

  /// T_camera_world of a keyframe, also of a removed one (from the pose relative to its parent at the time of removal).
  Eigen::Isometry3d pose_of(KeyFrameId keyframe) const;

  /// Sequence number that the next keyframe will get.
  std::uint64_t next_sequence() const { return next_sequence_; }

  /// Rises with touch(): whoever copies from the map sees by it whether the copy is old.
  std::uint64_t version() const { return version_; }
  /// To be called after a change that others should notice: new keyframes, moved poses or points.
  void touch() { ++version_; }

  void clear();

  /// Replaces everything by `content`, whose positions become the ids. Feature grids are built anew. The content must
  /// keep what Map keeps: observations agree on both sides, every point has some and its reference keyframe is among
  /// them, edges are symmetric and sorted, parents are older than their children and list them. Throws Error, which
  /// says what is wrong, and leaves the map as it was. Positions of features must be finite.
  void restore(MapContent content);

 private:
  struct Removed {
    KeyFrameId parent;
    Eigen::Isometry3d T_camera_parent;
  };
  void set_edge(KeyFrame& keyframe, KeyFrameId neighbour, int weight);
  void erase_edge(KeyFrame& keyframe, KeyFrameId neighbour);
  void find_new_parents(KeyFrameId removed);

  KeyFrames keyframes_;
  MapPoints points_;
  std::map<KeyFrameId, Removed> removed_keyframes_;
  std::uint64_t next_sequence_ = 0;
  std::uint64_t version_ = 0;
};

}  // namespace holdfast
