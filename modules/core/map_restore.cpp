// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "holdfast/core/map.hpp"

namespace holdfast {

namespace {

template <class Tag>
std::string name_of(Id<Tag> id) {
  return id.valid() ? std::to_string(id.slot) : "none";
}

/// Checks the invariants of Map; throws Error at the first violation.
class ContentCheck {
 public:
  explicit ContentCheck(const MapContent& content) : content_(content) {}

  void run() const {
    for (std::size_t i = 0; i < content_.keyframes.size(); ++i) {
      check_frame(i);
      check_tree(i);
      check_order_of_edges(i);
    }
    check_symmetry_of_edges();
    std::vector<std::size_t> last_point(content_.keyframes.size(), content_.points.size());
    for (std::size_t i = 0; i < content_.points.size(); ++i) check_point(i, last_point);
    check_counts();
  }

 private:
  [[noreturn]] static void fail(const char* kind, std::size_t i, const std::string& what) {
    throw Error(std::string(kind) + " " + std::to_string(i) + " " + what);
  }

  bool is_keyframe(KeyFrameId id) const { return id.slot < content_.keyframes.size() && id.generation == 0; }

  const KeyFrame& other(std::size_t i, KeyFrameId id, const char* role) const {
    if (!is_keyframe(id) || id.slot == i)
      fail("keyframe", i,
           std::string("names ") + name_of(id) + " as " + role + "; expected another keyframe below " +
               std::to_string(content_.keyframes.size()));
    return content_.keyframes[id.slot];
  }

  void check_frame(std::size_t i) const {
    const KeyFrame& keyframe = content_.keyframes[i];
    const Frame& frame = keyframe.frame;
    if (frame.camera == nullptr || frame.pyramid == nullptr) fail("keyframe", i, "has no camera or no pyramid");
    if (i > 0 && content_.keyframes[i - 1].sequence >= keyframe.sequence)
      fail("keyframe", i,
           "has sequence number " + std::to_string(keyframe.sequence) + "; expected more than that of the one before");
    if (keyframe.sequence >= content_.next_sequence)
      fail("keyframe", i,
           "has sequence number " + std::to_string(keyframe.sequence) + "; expected less than the next, " +
               std::to_string(content_.next_sequence));
    const std::size_t count = frame.size();
    for (const std::size_t size :
         {frame.features.y.size(), frame.features.angle.size(), frame.features.response.size(),
          frame.features.octave.size(), frame.features.descriptors.size(), frame.x.size(), frame.y.size(),
          frame.depth.size(), frame.right_x.size(), frame.map_points.size(), frame.static_probability.size()})
      if (size != count) fail("keyframe", i, "has arrays of features that differ in length");
    for (const std::uint8_t octave : frame.features.octave)
      if (octave >= frame.pyramid->scale.size()) fail("keyframe", i, "has a feature on a level above its pyramid");
    for (std::size_t feature = 0; feature < count; ++feature) {
      const MapPointId id = frame.map_points[feature];
      if (!id.valid()) continue;
      if (id.slot >= content_.points.size() || id.generation != 0)
        fail("keyframe", i,
             "feature " + std::to_string(feature) + " shows point " + name_of(id) + "; expected one below " +
                 std::to_string(content_.points.size()));
      // Every observation of a point is checked against its feature, so that here the count is enough; see
      // check_counts.
    }
  }

  void check_tree(std::size_t i) const {
    const KeyFrame& keyframe = content_.keyframes[i];
    const KeyFrameId id{static_cast<std::uint32_t>(i), 0};
    if (keyframe.parent.valid()) {
      const KeyFrame& parent = other(i, keyframe.parent, "its parent");
      if (keyframe.parent.slot > i) fail("keyframe", i, "is older than its parent " + name_of(keyframe.parent));
      if (std::count(parent.children.begin(), parent.children.end(), id) != 1)
        fail("keyframe", i, "has the parent " + name_of(keyframe.parent) + ", which does not list it once as a child");
    }
    for (const KeyFrameId child : keyframe.children)
      if (other(i, child, "a child").parent != id)
        fail("keyframe", i, "lists the child " + name_of(child) + ", whose parent is another");
    for (const KeyFrameId end : keyframe.loop_edges) {
      const std::vector<KeyFrameId>& back = other(i, end, "the end of a loop").loop_edges;
      if (std::count(back.begin(), back.end(), id) != 1 ||
          std::count(keyframe.loop_edges.begin(), keyframe.loop_edges.end(), end) != 1)
        fail("keyframe", i, "closes a loop with " + name_of(end) + ", which is not known once on both sides");
    }
  }

  void check_order_of_edges(std::size_t i) const {
    const std::vector<CovisibilityEdge>& edges = content_.keyframes[i].covisible;
    for (std::size_t e = 0; e < edges.size(); ++e) {
      other(i, edges[e].keyframe, "a neighbour");
      if (e == 0) continue;
      const CovisibilityEdge& last = edges[e - 1];
      if (last.weight < edges[e].weight ||
          (last.weight == edges[e].weight && last.keyframe.slot >= edges[e].keyframe.slot))
        fail("keyframe", i, "has neighbours that are not sorted by falling weight");
    }
  }

  /// Compares the edges that the neighbours of each keyframe list with the edges that the keyframe lists itself. Both
  /// are sorted, so that the check takes O(n log n) also for thousands of mutually covisible keyframes.
  void check_symmetry_of_edges() const {
    std::vector<std::vector<CovisibilityEdge>> gathered(content_.keyframes.size());
    for (std::size_t i = 0; i < content_.keyframes.size(); ++i)
      for (const CovisibilityEdge& edge : content_.keyframes[i].covisible)
        gathered[edge.keyframe.slot].push_back({KeyFrameId{static_cast<std::uint32_t>(i), 0}, edge.weight});
    for (std::size_t i = 0; i < content_.keyframes.size(); ++i) {
      std::vector<CovisibilityEdge> own = content_.keyframes[i].covisible;
      std::sort(own.begin(), own.end(),
                [](const CovisibilityEdge& a, const CovisibilityEdge& b) { return a.keyframe < b.keyframe; });
      const auto same = [](const CovisibilityEdge& a, const CovisibilityEdge& b) {
        return a.keyframe == b.keyframe && a.weight == b.weight;
      };
      const bool once = std::adjacent_find(own.begin(), own.end(), [](const auto& a, const auto& b) {
                          return a.keyframe == b.keyframe;
                        }) == own.end();
      if (!once || !std::equal(own.begin(), own.end(), gathered[i].begin(), gathered[i].end(), same))
        fail("keyframe", i, "and its neighbours in the covisibility graph do not name each other with one weight");
    }
  }

  /// `last_point`: for each keyframe, the last checked point that it observes.
  void check_point(std::size_t i, std::vector<std::size_t>& last_point) const {
    const MapPoint& point = content_.points[i];
    if (point.observations.empty()) fail("point", i, "has no observation");
    bool has_reference = false;
    for (const Observation& observation : point.observations) {
      if (!is_keyframe(observation.keyframe))
        fail("point", i,
             "is seen by keyframe " + name_of(observation.keyframe) + "; expected one below " +
                 std::to_string(content_.keyframes.size()));
      const std::vector<MapPointId>& shown = content_.keyframes[observation.keyframe.slot].frame.map_points;
      const MapPointId id{static_cast<std::uint32_t>(i), 0};
      if (observation.feature >= shown.size() || shown[observation.feature] != id)
        fail("point", i,
             "is seen by keyframe " + name_of(observation.keyframe) + " as feature " +
                 std::to_string(observation.feature) + ", which does not show it");
      has_reference |= observation.keyframe == point.reference_keyframe;
      if (std::exchange(last_point[observation.keyframe.slot], i) == i)
        fail("point", i, "is seen twice by keyframe " + name_of(observation.keyframe));
    }
    if (!has_reference)
      fail("point", i, "has the reference keyframe " + name_of(point.reference_keyframe) + ", which does not see it");
  }

  /// Both sides agree if the number of features with a point equals the number of observations, because every
  /// observation has a feature of its own (check_point).
  void check_counts() const {
    std::size_t observations = 0, features = 0;
    for (const MapPoint& point : content_.points) observations += point.observations.size();
    for (const KeyFrame& keyframe : content_.keyframes)
      for (const MapPointId point : keyframe.frame.map_points) features += point.valid() ? 1 : 0;
    if (observations != features)
      throw Error(std::to_string(features) + " features show a point, but points have " + std::to_string(observations) +
                  " observations");
  }

  const MapContent& content_;
};

/// The tracker's cell size [px], or more where there would be far more cells than features, as of an almost empty
/// keyframe of a very large image: a small file must not take much memory.
float cell_size(const PixelBounds& bounds, std::size_t features) {
  constexpr float usual = 20.0F, cells_per_feature = 64.0F, least_cells = 4096.0F;
  const float area = (bounds.max_x - bounds.min_x) * (bounds.max_y - bounds.min_y);
  const float most_cells = std::max(least_cells, cells_per_feature * static_cast<float>(features));
  return std::max(usual, std::sqrt(std::max(area, 0.0F) / most_cells));
}

/// Builds the feature grids as the tracker does; the bounds are computed once per camera.
void build_grids(std::vector<KeyFrame>& keyframes) {
  const Camera* camera = nullptr;
  Eigen::Vector2d minimum, maximum;
  for (KeyFrame& keyframe : keyframes) {
    Frame& frame = keyframe.frame;
    if (frame.camera.get() != camera) {
      camera = frame.camera.get();
      camera->undistorted_bounds(minimum, maximum);
    }
    const PixelBounds bounds{static_cast<float>(minimum.x()), static_cast<float>(minimum.y()),
                             static_cast<float>(maximum.x()), static_cast<float>(maximum.y())};
    frame.grid.build(frame.x, frame.y, bounds, cell_size(bounds, frame.size()));
  }
}

}  // namespace

void Map::restore(MapContent content) {
  ContentCheck(content).run();
  build_grids(content.keyframes);
  const std::uint64_t version = version_;
  clear();
  // In an empty slot map the n-th value gets slot n, generation 0, so that the ids inside the content remain valid.
  for (KeyFrame& keyframe : content.keyframes) keyframes_.emplace(std::move(keyframe));
  for (MapPoint& point : content.points) points_.emplace(std::move(point));
  next_sequence_ = content.next_sequence;
  sensor_ = content.sensor;
  features_ = std::move(content.features);
  classes_ = std::move(content.classes);
  inertia_ = content.inertia;
  version_ = version + 1;
}

}  // namespace holdfast
