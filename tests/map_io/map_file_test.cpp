// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/map_io/map_file.hpp"

#include <gtest/gtest.h>
#include <malloc.h>

#include <cstring>
#include <limits>
#include <map>

#include "core/map_rows.hpp"
#include "holdfast/core/error.hpp"
#include "holdfast/map_io/map_info.hpp"
#include "map_io/example_inertia.hpp"
#include "map_io/map_files.hpp"

namespace holdfast {
namespace {

using test::random_map;
using MapFile = test::MapFileTest;

/// Positions that ids get in a file.
struct Positions {
  explicit Positions(const Map& map) {
    std::map<std::uint64_t, KeyFrameId> by_sequence;
    map.keyframes().for_each([&](KeyFrameId id, const KeyFrame& entry) { by_sequence[entry.sequence] = id; });
    for (const auto& [sequence, id] : by_sequence)
      keyframe[id] = static_cast<int>(keyframes.size()), keyframes.push_back(id);
    for (const MapPointId id : map.points().ids()) point[id] = static_cast<int>(points.size()), points.push_back(id);
  }
  int of(KeyFrameId id) const { return id.valid() ? keyframe.at(id) : -1; }
  int of(MapPointId id) const { return id.valid() ? point.at(id) : -1; }
  std::vector<int> of(const std::vector<KeyFrameId>& ids) const { return all(ids); }
  std::vector<int> of(const std::vector<MapPointId>& ids) const { return all(ids); }

  std::vector<KeyFrameId> keyframes;
  std::vector<MapPointId> points;

 private:
  template <class IdType>
  std::vector<int> all(const std::vector<IdType>& ids) const {
    std::vector<int> positions;
    for (const IdType id : ids) positions.push_back(of(id));
    return positions;
  }
  std::map<KeyFrameId, int> keyframe;
  std::map<MapPointId, int> point;
};

template <class T>
void expect_same_bits(const std::vector<T>& a, const std::vector<T>& b) {
  ASSERT_EQ(a.size(), b.size());
  EXPECT_EQ(std::memcmp(a.data(), b.data(), a.size() * sizeof(T)), 0);
}

void expect_same_frame(const Frame& a, const Frame& b) {
  EXPECT_EQ(a.index, b.index);
  EXPECT_EQ(a.timestamp, b.timestamp);
  EXPECT_EQ(*a.camera, *b.camera);
  EXPECT_EQ(a.pyramid->factor, b.pyramid->factor);
  expect_same_bits(a.pyramid->scale, b.pyramid->scale);
  expect_same_bits(a.pyramid->inverse_sigma2, b.pyramid->inverse_sigma2);
  EXPECT_EQ(a.T_camera_world.matrix(), b.T_camera_world.matrix());
  expect_same_bits(a.features.x, b.features.x);
  expect_same_bits(a.features.y, b.features.y);
  expect_same_bits(a.features.angle, b.features.angle);
  expect_same_bits(a.features.response, b.features.response);
  expect_same_bits(a.features.octave, b.features.octave);
  EXPECT_TRUE(a.features.descriptors == b.features.descriptors);
  expect_same_bits(a.x, b.x);
  expect_same_bits(a.y, b.y);
  expect_same_bits(a.depth, b.depth);
  expect_same_bits(a.right_x, b.right_x);
  expect_same_bits(a.static_probability, b.static_probability);
  EXPECT_TRUE(a.image_descriptor.empty() ? b.image_descriptor.empty() : a.image_descriptor == b.image_descriptor);
}

void expect_same(const Map& a, const Map& b) {
  const Positions in_a(a), in_b(b);
  EXPECT_EQ(a.next_sequence(), b.next_sequence());
  EXPECT_EQ(a.classes(), b.classes());
  ASSERT_EQ(in_a.keyframes.size(), in_b.keyframes.size());
  ASSERT_EQ(in_a.points.size(), in_b.points.size());
  for (std::size_t i = 0; i < in_a.keyframes.size(); ++i) {
    const KeyFrame &k = a.keyframe(in_a.keyframes[i]), &l = b.keyframe(in_b.keyframes[i]);
    EXPECT_EQ(k.sequence, l.sequence);
    expect_same_frame(k.frame, l.frame);
    EXPECT_EQ(in_a.of(k.frame.map_points), in_b.of(l.frame.map_points));
    EXPECT_EQ(in_a.of(k.parent), in_b.of(l.parent));
    EXPECT_EQ(in_a.of(k.children), in_b.of(l.children));
    EXPECT_EQ(in_a.of(k.loop_edges), in_b.of(l.loop_edges));
    ASSERT_EQ(k.covisible.size(), l.covisible.size());
    for (std::size_t e = 0; e < k.covisible.size(); ++e) {
      EXPECT_EQ(in_a.of(k.covisible[e].keyframe), in_b.of(l.covisible[e].keyframe));
      EXPECT_EQ(k.covisible[e].weight, l.covisible[e].weight);
    }
  }
  for (std::size_t i = 0; i < in_a.points.size(); ++i) {
    const MapPoint &p = a.point(in_a.points[i]), &q = b.point(in_b.points[i]);
    EXPECT_EQ(p.position, q.position);
    EXPECT_EQ(p.viewing_direction, q.viewing_direction);
    EXPECT_EQ(p.minimum_distance, q.minimum_distance);
    EXPECT_EQ(p.maximum_distance, q.maximum_distance);
    EXPECT_EQ(p.descriptor, q.descriptor);
    EXPECT_EQ(in_a.of(p.reference_keyframe), in_b.of(q.reference_keyframe));
    EXPECT_EQ(p.created_at, q.created_at);
    EXPECT_EQ(p.visible_count, q.visible_count);
    EXPECT_EQ(p.found_count, q.found_count);
    EXPECT_EQ(p.static_log_odds, q.static_log_odds);
    EXPECT_EQ(p.label, q.label);
    EXPECT_EQ(a.class_votes(p), b.class_votes(q));
    ASSERT_EQ(p.observations.size(), q.observations.size());
    for (std::size_t o = 0; o < p.observations.size(); ++o) {
      EXPECT_EQ(in_a.of(p.observations[o].keyframe), in_b.of(q.observations[o].keyframe));
      EXPECT_EQ(p.observations[o].feature, q.observations[o].feature);
    }
  }
}

TEST_F(MapFile, HoldsEverything) {
  const Map map = random_map(24, 60, 1);
  // The example must be worth it: holes in the slots, slots used twice, keyframes out of order of slots, loops.
  ASSERT_GT(map.points().slot_count(), map.points().size());
  std::uint32_t reused = 0;
  map.keyframes().for_each([&](KeyFrameId id, const KeyFrame&) { reused += id.generation; });
  ASSERT_GT(reused, 0U);
  write_map(path("map.hfm"), map);
  const Map again = read_map(path("map.hfm"));
  expect_same(map, again);
  EXPECT_FALSE(std::filesystem::exists(path("map.hfm.tmp")));
}

TEST_F(MapFile, HoldsDescriptorsOfEveryType) {
  using Kind = DescriptorKind;
  using Metric = DescriptorMetric;
  const std::vector<MapFeatures> all = {{"opencv_orb", {}},
                                        {"akaze", {Kind::binary, Metric::hamming, 488, 80, 140}},
                                        {"sift", {Kind::float32, Metric::euclidean, 128, 200, 300}},
                                        {"mine", {Kind::float32, Metric::cosine, 3, 0.1F, 0.2F}},
                                        {"", {Kind::int8, Metric::euclidean, 61, 10, 20}}};
  for (const MapFeatures& features : all) {
    SCOPED_TRACE(to_string(features.descriptors));
    const Map map = random_map(10, 30, 3, features);
    write_map(path("map.hfm"), map);
    const Map again = read_map(path("map.hfm"));
    EXPECT_EQ(again.features(), features);
    expect_same(map, again);
    const MapInfo info = read_map_info(path("map.hfm"));
    EXPECT_EQ(info.map_features, features);
    EXPECT_NE(to_text(info).find(to_string(features.descriptors)), std::string::npos);
  }
}

TEST_F(MapFile, DescriptorsThatAreNoNumbersAreNotWritten) {
  Map map = random_map(5, 20, 4, {"sift", {DescriptorKind::float32, DescriptorMetric::euclidean, 8, 1, 2}});
  const KeyFrameId keyframe = map.keyframes_by_age().front();
  map.keyframe(keyframe).frame.features.descriptors.numbers(3)[2] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW(write_map(path("map.hfm"), map), CheckError);
  EXPECT_FALSE(std::filesystem::exists(path("map.hfm")));
}

TEST_F(MapFile, IdsAreGivenAnewInOrder) {
  write_map(path("map.hfm"), random_map(20, 40, 2));
  const Map map = read_map(path("map.hfm"));
  EXPECT_EQ(map.keyframes().slot_count(), map.keyframes().size());
  EXPECT_EQ(map.points().slot_count(), map.points().size());
  std::uint64_t next = 0;
  map.keyframes().for_each([&](KeyFrameId id, const KeyFrame& keyframe) {
    EXPECT_EQ(id.generation, 0U);
    EXPECT_GE(keyframe.sequence, next);
    next = keyframe.sequence + 1;
  });
}

TEST_F(MapFile, SameBytesTwiceAndAfterARoundTrip) {
  const Map map = random_map(20, 40, 3);
  const std::string bytes = bytes_of(map);
  EXPECT_TRUE(bytes_of(map) == bytes);
  write("map.hfm", bytes);
  const Map again = read_map(path("map.hfm"));
  EXPECT_TRUE(bytes_of(again) == bytes);
  EXPECT_TRUE(bytes_of(random_map(20, 40, 3)) == bytes);
}

TEST_F(MapFile, ASubmapIsWrittenAsIfItWereTheMap) {
  Map map;
  test::build_row(map, 6);
  const std::vector<KeyFrameId> second = test::build_row(map, 5);
  const std::uint32_t number = map.new_submap();
  for (const KeyFrameId id : second) map.keyframe(id).submap = number;
  write_map(path("part.hfm"), map, number);
  write_map(path("other.hfm"), map, 0);
  EXPECT_EQ(map.keyframes().size(), 11U) << "the map itself stays";
  map.keep_submap(number);
  write_map(path("kept.hfm"), map);
  EXPECT_TRUE(content(path("part.hfm")) == content(path("kept.hfm")));
  EXPECT_EQ(read_map(path("part.hfm")).keyframes().size(), 5U);
  EXPECT_EQ(read_map(path("other.hfm")).keyframes().size(), 6U);
}

TEST_F(MapFile, AMapThatWasReadGoesOn) {
  write_map(path("map.hfm"), random_map(12, 40, 4));
  Map map = read_map(path("map.hfm"));
  const auto ids = map.keyframes().ids();
  // Windows are found through the grid, which is built anew.
  const Frame& first = map.keyframe(ids.front()).frame;
  for (std::uint32_t f = 0; f < first.size(); ++f) {
    std::vector<std::uint32_t> found;
    first.grid.query(first.x[f], first.y[f], 0.5F, found);
    EXPECT_THAT(found, ::testing::Contains(f));
  }
  Frame frame = map.keyframe(ids.back()).frame;
  const KeyFrameId added = map.add_keyframe(frame);
  map.set_covisibility_minimum(3);
  map.update_covisibility(added);
  EXPECT_GT(map.keyframe(added).covisible.size(), 0U);
  EXPECT_TRUE(map.keyframe(added).parent.valid());
  map.remove_keyframe(added);
  for (const MapPointId point : map.points().ids()) map.update_point(point);
  write_map(path("more.hfm"), map);
  expect_same(map, read_map(path("more.hfm")));
}

TEST_F(MapFile, HoldsEveryLens) {
  Map map = random_map(6, 20, 9);
  const std::string plain = bytes_of(map);
  EXPECT_EQ(plain.find("LENS"), std::string::npos) << "readers of old read maps of plain lenses";
  Camera fisheye = *find_camera("tum_fr3"), rational = fisheye;
  fisheye.readout = rational.readout = 0.0;
  fisheye.distortion = {.k1 = -0.1, .k2 = 0.02, .k3 = 0.03, .k4 = -0.004};
  fisheye.distortion.lens = Lens::fisheye;
  rational.distortion = {0.5, -2.6, 0.0007, -0.0002, 1.5, 0.39, -2.43, 1.43};
  const auto cameras = {std::make_shared<const Camera>(fisheye), std::make_shared<const Camera>(rational),
                        std::make_shared<const Camera>()};
  std::size_t next = 0;
  for (const KeyFrameId id : map.keyframes().ids())
    map.keyframe(id).frame.camera = cameras.begin()[next++ % cameras.size()];
  const std::string bytes = bytes_of(map);
  write("map.hfm", bytes);
  const Map again = read_map(path("map.hfm"));
  expect_same(map, again);
  EXPECT_TRUE(bytes_of(again) == bytes);
  // Damage that the checksums would hide if they were right is found as well.
  const auto refusal = [&](std::size_t offset, std::uint32_t value) {
    return refusal_with(bytes, "LENS", offset, value);
  };
  EXPECT_THAT(refusal(4, 77), ::testing::HasSubstr("found camera 77"));
  EXPECT_THAT(refusal(8, 9), ::testing::HasSubstr("found number 9; expected less than 2"));
}

TEST_F(MapFile, ALensWithoutInverseIsRefused) {
  Map map = random_map(6, 20, 9);
  Camera camera = *find_camera("tum_fr3");
  camera.name.clear();
  camera.readout = 0.0;
  const auto set_camera = [&] {
    for (const KeyFrameId id : map.keyframes().ids())
      map.keyframe(id).frame.camera = std::make_shared<const Camera>(camera);
  };
  set_camera();
  constexpr std::size_t upper_half_of_k1 = 4 + 2 + 2 * 4 + 4 * 8 + 4;  // after counts, name, size, fx, fy, cx and cy
  EXPECT_THAT(refusal_with(bytes_of(map), "CAMS", upper_half_of_k1, 0xBFE99999U),  // k1 = -0.8
              ::testing::HasSubstr("the distortion of the lens has no inverse in the image"));
  camera.distortion.k1 = -0.8;
  set_camera();
  EXPECT_THROW(bytes_of(map), CheckError);
}

TEST_F(MapFile, HoldsDescriptionsOfImages) {
  Map map = random_map(8, 30, 11);
  EXPECT_EQ(bytes_of(map).find("PLAC"), std::string::npos) << "maps of other detectors stay as they were";
  const DescriptorType type{DescriptorKind::float32, DescriptorMetric::cosine, 11, 0.1F, 0.2F};
  std::size_t count = 0;
  float value = 0.0F;
  for (const KeyFrameId id : map.keyframes_by_age()) {  // 0, 1, 2, 0, ... descriptors
    DescriptorBlock place(type, count++ % 3);
    for (std::size_t i = 0; i < place.size(); ++i)
      for (float& number : place.numbers(i)) number = value += 0.01F;
    map.keyframe(id).frame.image_descriptor = std::move(place);
  }
  const std::string bytes = bytes_of(map);
  write("map.hfm", bytes);
  const Map again = read_map(path("map.hfm"));
  expect_same(map, again);
  EXPECT_TRUE(bytes_of(again) == bytes);
  const auto refusal = [&](std::size_t offset, std::uint32_t wrong_value) {
    return refusal_with(bytes, "PLAC", offset, wrong_value);
  };
  EXPECT_THAT(refusal(14, 0xFFFFFFF0U), ::testing::HasSubstr("described keyframes"));
  EXPECT_THAT(refusal(18, 700), ::testing::HasSubstr("found keyframe 700; expected at least 0 and less than"));
  EXPECT_THAT(refusal(22, 1U << 30), ::testing::HasSubstr("descriptors, for which the section is too short"));
  EXPECT_THAT(refusal(26, 0x7F800000U), ::testing::HasSubstr("not finite"));
  EXPECT_THAT(refusal(2, 0), ::testing::HasSubstr("descriptors: "));
}

TEST_F(MapFile, HoldsClasses) {
  Map map = random_map(8, 20, 21);
  write_map(path("none.hfm"), map);
  const std::string without = content(path("none.hfm"));
  EXPECT_EQ(without.find("CLAS"), std::string::npos);

  map.set_classes({"background", "person\n", std::string(300, 'x')});
  std::uint8_t next = 0;
  for (const MapPointId id : map.points().ids())
    map.point(id).label = next == 3 ? CellMask::unknown : next, next = (next + 1) % 4;
  write_map(path("classes.hfm"), map);
  const Map again = read_map(path("classes.hfm"));
  expect_same(map, again);
  write_map(path("again.hfm"), again);
  EXPECT_TRUE(content(path("classes.hfm")) == content(path("again.hfm")));

  // Readers that do not know the section leave it out.
  std::string older = content(path("classes.hfm"));
  const std::size_t section = older.find("CLAS");
  ASSERT_NE(section, std::string::npos);
  std::uint32_t flags = 0;
  std::memcpy(&flags, older.data() + section + 4, sizeof(flags));
  EXPECT_EQ(flags & 1U, 0U);
  EXPECT_EQ(older.substr(76, section - 76), without.substr(76)) << "everything else is as in a file without classes";

  map.set_classes({});
  write_map(path("removed.hfm"), map);
  EXPECT_TRUE(content(path("removed.hfm")) == without);
}

TEST_F(MapFile, HoldsVotes) {
  Map map = random_map(8, 20, 21);
  map.set_classes({"background", "person"});
  write_map(path("classes.hfm"), map);
  const std::string without = content(path("classes.hfm"));
  EXPECT_EQ(without.find("VOTE"), std::string::npos);
  std::uint32_t next = 0;
  for (const MapPointId id : map.points().ids()) {
    map.point(id).earlier_votes.add(static_cast<std::uint8_t>(next % 2), 1 + next / 3);
    if (++next % 3 == 0) map.point(id).earlier_votes.add(1, 70000);
  }
  write_map(path("votes.hfm"), map);
  const Map again = read_map(path("votes.hfm"));
  expect_same(map, again);
  write_map(path("again.hfm"), again);
  EXPECT_TRUE(content(path("votes.hfm")) == content(path("again.hfm")));
  EXPECT_TRUE(content(path("votes.hfm")).substr(76, without.size() - 76) == without.substr(76))
      << "everything else is as in a file without votes";
  EXPECT_TRUE(read_map(path("classes.hfm")).point({0, 0}).earlier_votes.empty());
}

TEST_F(MapFile, HoldsEstimatesOfAnImu) {
  Map map = random_map(8, 20, 22);
  write_map(path("none.hfm"), map);
  const std::string without = content(path("none.hfm"));
  EXPECT_FALSE(read_map(path("none.hfm")).inertia());

  map.set_inertia(test::example_inertia());
  write_map(path("inertia.hfm"), map);
  const Map again = read_map(path("inertia.hfm"));
  ASSERT_TRUE(again.inertia());
  EXPECT_TRUE(test::are_same(*again.inertia(), test::example_inertia()));
  write_map(path("again.hfm"), again);
  EXPECT_TRUE(content(path("inertia.hfm")) == content(path("again.hfm")));

  // Readers that do not know the section leave it out.
  const std::string bytes = content(path("inertia.hfm"));
  const std::size_t section = test::find_section(bytes, "INER");
  EXPECT_EQ(test::number_at<std::uint32_t>(bytes, section + 4) & 1U, 0U);
  EXPECT_EQ(bytes.size() - section, 24U + 40U * 8U) << "as docs/map_format.md says";
  EXPECT_EQ(bytes.substr(76, section - 76), without.substr(76));
  read_map(path("none.hfm"), map);
  EXPECT_FALSE(map.inertia()) << "of the map before";
}

TEST_F(MapFile, HoldsVerticalsAndMotionsOfKeyframes) {
  Map map = random_map(8, 20, 22);
  map.set_inertia(test::example_inertia());
  write_map(path("none.hfm"), map);
  const std::string without = content(path("none.hfm"));

  test::add_motions(map);
  write_map(path("motions.hfm"), map);
  const Map again = read_map(path("motions.hfm"));
  const std::vector<KeyFrameId> before = map.keyframes_by_age(), after = again.keyframes_by_age();
  std::size_t bytes_of_entries = 0;
  for (std::size_t i = 0; i < before.size(); ++i) {
    const KeyFrame &was = map.keyframe(before[i]), &is = again.keyframe(after[i]);
    EXPECT_EQ(is.vertical, was.vertical) << i;
    ASSERT_EQ(is.motion.has_value(), was.motion.has_value()) << i;
    if (was.vertical || was.motion) bytes_of_entries += 8U + (was.vertical ? 24U : 0U) + (was.motion ? 72U : 0U);
    if (!was.motion) continue;
    EXPECT_EQ(is.motion->velocity, was.motion->velocity) << i;
    EXPECT_EQ(is.motion->bias.gyroscope, was.motion->bias.gyroscope) << i;
    EXPECT_EQ(is.motion->bias.accelerometer, was.motion->bias.accelerometer) << i;
  }
  write_map(path("again.hfm"), again);
  const std::string bytes = content(path("motions.hfm"));
  EXPECT_TRUE(bytes == content(path("again.hfm")));

  // Readers that do not know the section leave it out.
  const std::size_t section = test::find_section(bytes, "MOTN");
  EXPECT_EQ(test::number_at<std::uint32_t>(bytes, section + 4) & 1U, 0U);
  EXPECT_EQ(bytes.size() - section, 24U + 4U + bytes_of_entries) << "as docs/map_format.md says";
  EXPECT_EQ(bytes.substr(76, section - 76), without.substr(76));
  EXPECT_FALSE(read_map(path("none.hfm")).keyframe(after[2]).motion);
}

TEST_F(MapFile, SharedCamerasStayShared) {
  write_map(path("map.hfm"), random_map(15, 30, 5));
  const Map map = read_map(path("map.hfm"));
  std::map<const Camera*, int> cameras;
  map.keyframes().for_each([&](KeyFrameId, const KeyFrame& keyframe) { ++cameras[keyframe.frame.camera.get()]; });
  EXPECT_EQ(cameras.size(), 2U);
}

TEST_F(MapFile, AnEmptyMap) {
  write_map(path("map.hfm"), Map());
  EXPECT_TRUE(read_map(path("map.hfm")).keyframes().empty());
  expect_same(Map(), read_map(path("map.hfm")));
}

TEST_F(MapFile, ReadingIntoAMapReplacesItAndRaisesItsVersion) {
  const Map map = random_map(8, 30, 6);
  write_map(path("map.hfm"), map);
  Map other = random_map(5, 20, 7);
  const std::uint64_t version = other.version();
  read_map(path("map.hfm"), other);
  expect_same(map, other);
  EXPECT_GT(other.version(), version);
}

TEST_F(MapFile, AFailedReadingLeavesTheMapAlone) {
  Map map = random_map(6, 20, 8);
  const std::string before = bytes_of(map);
  std::string bytes = bytes_of(random_map(6, 20, 9));
  bytes.resize(bytes.size() - 1);
  write("cut.hfm", bytes);
  EXPECT_THROW(read_map(path("cut.hfm"), map), InputError);
  EXPECT_TRUE(bytes_of(map) == before);
}

TEST_F(MapFile, AFailedWritingLeavesTheOldFile) {
  const Map map = random_map(5, 20, 10);
  write_map(path("map.hfm"), map);
  const std::string before = content(path("map.hfm"));
  // A map that no file may hold.
  Map bad = random_map(5, 20, 10);
  bad.point(bad.points().ids().back()).position.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(write_map(path("map.hfm"), bad), CheckError);
  EXPECT_TRUE(content(path("map.hfm")) == before);
  EXPECT_FALSE(std::filesystem::exists(path("map.hfm.tmp")));
  // A temporary name that cannot be written.
  std::filesystem::create_directories(path("map.hfm.tmp"));
  EXPECT_THROW(write_map(path("map.hfm"), map), InputError);
  EXPECT_TRUE(content(path("map.hfm")) == before);
}

TEST_F(MapFile, ADiskThatIsFull) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no /dev/full on this system";
  std::filesystem::create_symlink("/dev/full", path("map.hfm.tmp"));
  EXPECT_THROW(write_map(path("map.hfm"), random_map(5, 20, 11)), InputError);
  EXPECT_FALSE(std::filesystem::exists(path("map.hfm")));
}

TEST_F(MapFile, PlacesThatCannotBeWritten) {
  const Map map = random_map(3, 20, 12);
  EXPECT_THROW(write_map(path("nowhere/map.hfm"), map), InputError);
  EXPECT_THROW(write_map(folder_, map), InputError);
  EXPECT_THROW(write_map("/proc/map.hfm", map), InputError);
  if (geteuid() == 0) return;  // root writes everywhere
  std::filesystem::permissions(folder_, std::filesystem::perms::owner_read | std::filesystem::perms::owner_exec);
  EXPECT_THROW(write_map(path("map.hfm"), map), InputError);
}

/// The memory that the program has taken from the allocator [bytes].
std::size_t memory_in_use() {
  const struct mallinfo2 info = mallinfo2();
  return info.uordblks + info.hblkhd;
}

TEST_F(MapFile, AlmostEmptyKeyframesOfALargeImageTakeLittleMemory) {
  Camera camera;
  camera.width = camera.height = 16384;
  camera.fx = camera.fy = 16384;
  camera.cx = camera.cy = 8192;
  Map map;
  for (int k = 0; k < 300; ++k) {
    Frame frame;
    frame.camera = std::make_shared<const Camera>(camera);
    frame.pyramid = std::make_shared<const ScalePyramid>(8, 1.2);
    map.add_keyframe(std::move(frame));
  }
  write_map(path("empty.hfm"), map);
  EXPECT_LT(std::filesystem::file_size(path("empty.hfm")), 100'000U);
  const std::size_t before = memory_in_use();
  const Map again = read_map(path("empty.hfm"));
  EXPECT_EQ(again.keyframes().size(), 300U);
  EXPECT_LT(memory_in_use(), before + 50'000'000);
}

}  // namespace
}  // namespace holdfast
