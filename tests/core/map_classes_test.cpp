// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <memory>

#include "holdfast/core/map.hpp"

namespace holdfast {
namespace {

/// Adds a keyframe with a feature in each of the first cells of the coarse view, whose mask has these labels there;
/// feature i shows point i. Without labels there is no mask.
KeyFrameId add_view(Map& map, const std::vector<std::uint8_t>& labels, std::vector<MapPointId>& points,
                    std::size_t features) {
  Frame frame;
  frame.camera = std::make_shared<const Camera>(*find_camera("tum_fr3"));
  frame.pyramid = std::make_shared<const ScalePyramid>(8, 1.2);
  frame.coarse.grid = CoarseSampler(*frame.camera).grid();
  if (!labels.empty()) {
    frame.coarse.mask.assign(static_cast<std::size_t>(frame.coarse.grid.size()), CellMask::unknown, 255);
    std::copy(labels.begin(), labels.end(), frame.coarse.mask.labels.begin());
  }
  frame.features.resize(features);
  for (std::size_t i = 0; i < features; ++i) {
    frame.x.push_back(frame.coarse.grid.x_of(static_cast<int>(i)));
    frame.y.push_back(frame.coarse.grid.y_of(0));
    frame.depth.push_back(1.0F);
    frame.right_x.push_back(0.0F);
    frame.static_probability.push_back(1.0F);
  }
  frame.map_points.resize(features);
  const KeyFrameId keyframe = map.add_keyframe(std::move(frame));
  while (points.size() < features) points.push_back(map.add_point({0, 0, 1}, 0));
  for (std::uint32_t i = 0; i < features; ++i) map.add_observation(points[i], keyframe, i);
  return keyframe;
}

std::vector<int> labels_of(const Map& map) {
  std::vector<int> labels;
  map.points().for_each([&](MapPointId, const MapPoint& point) { labels.push_back(point.label); });
  return labels;
}

TEST(MapClasses, TheMajorityOfMasksDecides) {
  constexpr std::uint8_t unknown = CellMask::unknown;
  Map map;
  map.set_classes({"background", "person", "cat"});
  std::vector<MapPointId> points;
  add_view(map, {1, 0, 2, unknown, 9}, points, 5);
  add_view(map, {1, 2, 2, unknown, 9}, points, 5);
  add_view(map, {0, unknown, 2, unknown, 9}, points, 5);
  add_view(map, {}, points, 5);
  EXPECT_EQ(labels_of(map), std::vector<int>(5, unknown));
  map.classify_points();
  // As many masks for 0 as for 2: the lower one. A label that is no class counts as unknown.
  EXPECT_EQ(labels_of(map), (std::vector<int>{1, 0, 2, unknown, unknown}));
}

TEST(MapClasses, PointsThatNoMaskShowsKeepTheirs) {
  Map map;
  map.set_classes({"background", "person"});
  std::vector<MapPointId> points;
  add_view(map, {}, points, 2);
  map.point(points[0]).label = 1;
  map.classify_points();
  EXPECT_EQ(labels_of(map), (std::vector<int>{1, CellMask::unknown}));
  add_view(map, {0, 0}, points, 2);
  map.classify_points();
  EXPECT_EQ(labels_of(map), (std::vector<int>{0, 0}));
}

TEST(MapClasses, LabelsFollowNames) {
  Map map;
  map.set_classes({"background", "person", "cat"});
  for (const std::uint8_t label : {std::uint8_t{0}, std::uint8_t{1}, std::uint8_t{2}, CellMask::unknown})
    map.point(map.add_point({0, 0, 1}, 0)).label = label;
  map.set_classes({"background", "dog", "cat", "person"});
  EXPECT_EQ(labels_of(map), (std::vector<int>{0, 3, 2, CellMask::unknown}));
  map.set_classes({"cat"});
  EXPECT_EQ(labels_of(map), (std::vector<int>{CellMask::unknown, CellMask::unknown, 0, CellMask::unknown}));
  map.set_classes(std::vector<std::string>(300, "many"));
  EXPECT_EQ(map.classes().size(), 255U);
}

TEST(MapClasses, AFusedPointKeepsAClass) {
  Map map;
  map.set_classes({"background", "person"});
  std::vector<MapPointId> points;
  add_view(map, {}, points, 4);
  map.point(points[0]).label = 1;
  map.point(points[2]).label = 1;
  map.point(points[3]).label = 0;
  map.fuse_points(points[0], points[1]);
  map.fuse_points(points[2], points[3]);
  EXPECT_EQ(labels_of(map), (std::vector<int>{1, 0}));
}

ClassVotes votes(std::initializer_list<std::pair<int, std::uint32_t>> counts) {
  ClassVotes result;
  for (const auto& [label, count] : counts) result.add(static_cast<std::uint8_t>(label), count);
  return result;
}

TEST(MapClasses, HistogramsCountTheMasks) {
  Map map;
  map.set_classes({"background", "person", "cat"});
  std::vector<MapPointId> points;
  add_view(map, {1, 0, CellMask::unknown}, points, 3);
  add_view(map, {1, 2, 9}, points, 3);
  const auto first = map.class_votes(map.point(points[0])), second = map.class_votes(map.point(points[1]));
  EXPECT_EQ(first, votes({{1, 2}}));
  EXPECT_EQ(second, votes({{2, 1}, {0, 1}}));
  EXPECT_TRUE(map.class_votes(map.point(points[2])).empty()) << "unknown, and a label that is no class";
  EXPECT_EQ(second.winner(), 0) << "of equal counts, the lowest";
  EXPECT_DOUBLE_EQ(second.share(2), 0.5);
  EXPECT_DOUBLE_EQ(second.share(1), 0.0);
  EXPECT_EQ(ClassVotes().winner(), CellMask::unknown);
}

TEST(MapClasses, RemovedKeyframesLeaveTheirVotes) {
  Map map;
  map.set_classes({"background", "person"});
  std::vector<MapPointId> points;
  const KeyFrameId oldest = add_view(map, {0, 0}, points, 2);
  const KeyFrameId culled = add_view(map, {1, 1}, points, 2);
  const KeyFrameId other = add_view(map, {1, 1}, points, 2);
  map.set_parent(culled, oldest);
  map.set_parent(other, oldest);
  map.remove_observation(points[1], culled);  // an outlier: its vote goes
  map.remove_keyframe(culled);
  EXPECT_EQ(map.class_votes(map.point(points[0])), votes({{0, 1}, {1, 2}}));
  EXPECT_EQ(map.class_votes(map.point(points[1])), votes({{0, 1}, {1, 1}}));
  map.classify_points();
  map.classify_points();
  EXPECT_EQ(map.class_votes(map.point(points[0])), votes({{0, 1}, {1, 2}})) << "counting is no vote";
  EXPECT_EQ(map.point(points[0]).label, 1);
}

TEST(MapClasses, FusedPointsPutTheirVotesTogether) {
  Map map;
  map.set_classes({"background", "person", "cat"});
  std::vector<MapPointId> points;
  add_view(map, {1, 0}, points, 2);
  map.point(points[0]).earlier_votes.add(2, 3);
  map.point(points[1]).earlier_votes.add(2, 4);
  map.fuse_points(points[0], points[1]);
  // The keyframe observes both: the point keeps its own observation.
  EXPECT_EQ(map.class_votes(map.point(points[1])), votes({{0, 1}, {2, 7}}));
  map.set_classes({"cat", "background"});
  EXPECT_EQ(map.point(points[1]).earlier_votes, votes({{0, 7}})) << "votes follow names";
}

}  // namespace
}  // namespace holdfast
