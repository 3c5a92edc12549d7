// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "holdfast/core/keyframe.hpp"
#include "holdfast/core/map_defaults.hpp"
#include "holdfast/core/map_features.hpp"
#include "holdfast/core/map_inertia.hpp"
#include "holdfast/core/map_point.hpp"
#include "holdfast/core/sensor.hpp"
#include "holdfast/core/slot_map.hpp"

namespace holdfast {

/// The content of a map as plain values, for Map::restore(). Ids inside it refer to entries by position: slot i with
/// generation 0 is entry i.
struct MapContent {
  std::vector<KeyFrame> keyframes;  ///< by increasing sequence; Frame::grid is not set
  std::vector<MapPoint> points;
  std::uint64_t next_sequence = 0;  ///< greater than every keyframe's sequence
  Sensor sensor = Sensor::rgbd;
  MapFeatures features;
  std::vector<std::string> classes;  ///< names that MapPoint::label refers to
  std::optional<MapInertia> inertia;
};

/// Keyframes and map points, referred to by ids. The map keeps all links between them consistent: a feature of a
/// keyframe refers to a map point if and only if the point lists that observation. Not synchronised; see MapMutex.
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

  /// Inserts the frame as a keyframe and adds an observation to every map point that the frame refers to; references
  /// to points that no longer exist are cleared. The caller must call update_covisibility() next.
  KeyFrameId add_keyframe(Frame frame);

  /// Creates a point [m, world] without observations. The caller adds observations with add_observation() and then
  /// calls update_point(). `created_at` is the sequence number of the keyframe that creates it.
  MapPointId add_point(const Eigen::Vector3d& position, std::uint64_t created_at);

  /// Links a feature of a keyframe to a point. The feature must not be linked yet, and the keyframe must not observe
  /// the point yet.
  void add_observation(MapPointId point, KeyFrameId keyframe, std::uint32_t feature);
  /// Removes the observation of a point by a keyframe; a point without observations is removed.
  void remove_observation(MapPointId point, KeyFrameId keyframe);
  /// The feature with which a keyframe observes a point, or -1.
  int feature_of(MapPointId point, KeyFrameId keyframe) const;

  /// Recomputes descriptor, viewing direction and distance range of a point from its observations
  /// (Mur-Artal et al. 2015, section III-C).
  void update_point(MapPointId point);
  /// Recomputes viewing direction and distance range only; sufficient after the point or its keyframes have moved.
  void update_point_geometry(MapPointId point);

  /// Merges `from` into `to`: moves its observations and removes it. If a keyframe observes both, `to` keeps its own
  /// observation. Their static log-odds are summed, within the evidence limit, and so are their earlier votes; `to`
  /// keeps its class if it has one.
  void fuse_points(MapPointId from, MapPointId to);
  void remove_point(MapPointId point);

  /// Recounts the points that a keyframe shares with others and updates the covisibility edges on both sides. Edges
  /// below the minimum weight (set_covisibility_minimum()) are removed, except that to the strongest neighbour. Sets
  /// the spanning-tree parent of a new keyframe.
  void update_covisibility(KeyFrameId keyframe);
  /// Makes `older` the spanning-tree parent of a keyframe without one. Needed for a keyframe that is not covisible with
  /// any older one, because its pose was estimated without the map.
  void set_parent(KeyFrameId keyframe, KeyFrameId older);
  /// Removes a keyframe with its observations, covisibility edges and loop edges. Its children in the spanning tree get
  /// new parents among their neighbours. Its pose stays available relative to its parent; see pose_of().
  void remove_keyframe(KeyFrameId keyframe);

  /// Number of a new submap (KeyFrame::submap).
  std::uint32_t new_submap() { return ++last_submap_; }
  /// Submap of a keyframe; for a removed keyframe, that of its parent. Nothing for a keyframe of a removed submap.
  std::optional<std::uint32_t> submap_of(KeyFrameId keyframe) const;
  /// Merges two submaps under the lower of their numbers. Their relative pose must have been corrected before.
  void join_submaps(std::uint32_t first, std::uint32_t second);
  /// Keyframes of all other submaps, oldest first.
  std::vector<KeyFrameId> keyframes_outside(std::uint32_t submap) const;
  /// Number of keyframes of a submap.
  std::size_t keyframes_in(std::uint32_t submap) const;
  /// Removes the keyframes and points of all other submaps. pose_of() is invalid for these keyframes afterwards.
  void keep_submap(std::uint32_t submap);

  /// Adds a loop edge between two keyframes, on both sides. Adding it again has no effect.
  void add_loop_edge(KeyFrameId first, KeyFrameId second);

  /// Ids of all keyframes, oldest first.
  std::vector<KeyFrameId> keyframes_by_age() const;
  /// Up to `max_count` neighbours with the largest covisibility weights, strongest first.
  std::vector<KeyFrameId> best_covisible(KeyFrameId keyframe, int max_count) const;

  /// T_camera_world of a keyframe. For a removed keyframe, it is composed from the current pose of its parent and the
  /// relative pose at the time of removal.
  Eigen::Isometry3d pose_of(KeyFrameId keyframe) const;
  /// KeyFrame::scale of a keyframe. For a removed one, its scale at removal times the later scale change of its parent.
  double scale_of(KeyFrameId keyframe) const;

  /// Magnitude to which fuse_points() clamps the static log-odds of a point (EvidenceSettings::limit). It is a setting
  /// of the run: map files do not contain it, and clear() and restore() do not change it.
  void set_evidence_limit(float log_odds) { evidence_limit_ = log_odds; }
  float evidence_limit() const { return evidence_limit_; }

  /// Minimum number of shared points of a covisibility edge (MappingSettings::covisibility_minimum). It is a setting of
  /// the run, like the evidence limit.
  void set_covisibility_minimum(int points) { covisibility_minimum_ = points; }

  /// Sequence number of the next keyframe.
  std::uint64_t next_sequence() const { return next_sequence_; }

  /// The sensor that made the map.
  Sensor sensor() const { return sensor_; }
  void set_sensor(Sensor sensor) { sensor_ = sensor; }
  /// Type of the features of the keyframes.
  const MapFeatures& features() const { return features_; }
  void set_features(MapFeatures features) { features_ = std::move(features); }
  /// Names of the classes that points can have, by MapPoint::label; empty = points have no classes.
  const std::vector<std::string>& classes() const { return classes_; }
  /// Replaces the class names; names beyond the 255th are dropped. Labels of points are remapped by name; labels of
  /// removed names become unknown.
  void set_classes(std::vector<std::string> names);
  /// Histogram of the classes of a point: the labels of the masks at its observations, and its earlier votes.
  ClassVotes class_votes(const MapPoint& point) const;
  /// Sets the class of each point to the most frequent label of class_votes(); of equal counts, the lower label. A
  /// point without votes keeps its class.
  void classify_points();

  /// Estimates from inertial measurements; empty without any.
  const std::optional<MapInertia>& inertia() const { return inertia_; }
  void set_inertia(const std::optional<MapInertia>& inertia) { inertia_ = inertia; }

  /// Incremented by invalidate_copies(); a holder of copied map data compares versions to detect that the copy is
  /// outdated.
  std::uint64_t version() const { return version_; }
  /// Must be called after a change that invalidates copies: new keyframes, moved poses or points.
  void invalidate_copies() { ++version_; }

  void clear();
  /// Removes all keyframes and points; the next keyframe is the first one. Unlike after clear(), removed ids are never
  /// reused.
  void remove_all();

  /// Replaces the whole map by `content`, whose entry i gets the id of slot i, and rebuilds the feature grids. Throws
  /// Error that describes the violation, and leaves the map unchanged, unless the content satisfies the invariants of
  /// Map:
  /// - observations agree on both sides; every point has at least one, and its reference keyframe is among them;
  /// - covisibility edges are symmetric and sorted;
  /// - parents are older than their children and list them;
  /// - feature positions are finite.
  void restore(MapContent content);

 private:
  struct Removed {
    KeyFrameId parent;
    Eigen::Isometry3d T_camera_parent;
    double scale, parent_scale;  // at the time of removal
  };
  void set_edge(KeyFrame& keyframe, KeyFrameId neighbour, int weight);
  void erase_edge(KeyFrame& keyframe, KeyFrameId neighbour);
  void find_new_parents(KeyFrameId removed);
  void add_vote(const Frame& frame, std::size_t feature, ClassVotes& votes) const;
  /// Adds the votes of a frame's mask to the earlier votes of its points, before its observations are removed.
  void keep_votes(const Frame& frame);

  KeyFrames keyframes_;
  MapPoints points_;
  std::map<KeyFrameId, Removed> removed_keyframes_;
  std::uint64_t next_sequence_ = 0;
  std::uint32_t last_submap_ = 0;
  Sensor sensor_ = Sensor::rgbd;
  MapFeatures features_;
  std::vector<std::string> classes_;
  std::optional<MapInertia> inertia_;
  std::uint64_t version_ = 0;
  float evidence_limit_ = static_cast<float>(default_evidence_limit);
  int covisibility_minimum_ = default_covisibility_minimum;
};

}  // namespace holdfast
