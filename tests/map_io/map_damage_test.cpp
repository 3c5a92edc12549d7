// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <limits>

#include "holdfast/map_io/map_info.hpp"
#include "map_io/example_inertia.hpp"
#include "map_io/map_files.hpp"

namespace holdfast {
namespace {

using test::find_section;
using test::number_at;
using test::put_at;
using test::random_map;
using test::repair_checksums;
using ::testing::AllOf;
using ::testing::HasSubstr;

using MapDamage = test::MapFileTest;

TEST_F(MapDamage, EveryTruncation) {
  const std::string bytes = bytes_of(random_map(3, 10, 1));
  for (std::size_t length = 0; length < bytes.size(); ++length)
    ASSERT_NE(refusal_of(bytes.substr(0, length)), "") << length << " of " << bytes.size() << " bytes";
  EXPECT_EQ(refusal_of(bytes), "");
}

TEST_F(MapDamage, EveryFlippedBit) {
  std::string bytes = bytes_of(random_map(3, 10, 2));
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    const char mask = static_cast<char>(1 << (i % 8));
    bytes[i] = static_cast<char>(bytes[i] ^ mask);
    ASSERT_NE(refusal_of(bytes), "") << "byte " << i;
    bytes[i] = static_cast<char>(~(bytes[i] ^ mask));
    ASSERT_NE(refusal_of(bytes), "") << "byte " << i;
    bytes[i] = static_cast<char>(~bytes[i]);
  }
  EXPECT_EQ(refusal_of(bytes), "");
}

/// Changes behind fitting checksums: refused, or read as a map that can be used and written, but never a crash.
TEST_F(MapDamage, RandomChangesNeverCrash) {
  const std::string original = bytes_of(random_map(5, 12, 3));
  Random random(17);
  int refused = 0, taken = 0;
  for (int i = 0; i < 3000; ++i) {
    std::string bytes = original;
    const std::uint32_t changes = 1 + random.below(3);
    for (std::uint32_t c = 0; c < changes; ++c) {
      const std::size_t at = random.below(static_cast<std::uint32_t>(bytes.size() - 8));
      switch (random.below(4)) {
        case 0:
          bytes[at] = static_cast<char>(random.next());
          break;
        case 1:
          put_at(bytes, at & ~std::size_t{3}, static_cast<std::uint32_t>(random.below(40)));
          break;
        case 2:
          put_at(bytes, at & ~std::size_t{3}, 0xFFFFFFFFU - random.below(2));
          break;
        default:
          bytes.erase(at, random.below(40));
      }
    }
    if (random.below(2) == 0) put_at(bytes, 32, static_cast<std::uint64_t>(bytes.size()));
    if (number_at<std::uint32_t>(bytes, 12) != 76) put_at(bytes, 12, 76U);
    repair_checksums(bytes);
    write("read.hfm", bytes);
    try {
      Map map = read_map(path("read.hfm"));
      for (const MapPointId point : map.points().ids()) map.update_point(point);
      map.set_covisibility_minimum(3);
      for (const KeyFrameId keyframe : map.keyframes().ids()) map.update_covisibility(keyframe);
      ++taken;
    } catch (const InputError&) {
      ++refused;
    }
    try {
      read_map_info(path("read.hfm"));
    } catch (const InputError&) {
    }
  }
  EXPECT_GT(refused, 500);
  EXPECT_GT(taken, 100);
}

TEST_F(MapDamage, FilesOfOtherKinds) {
  EXPECT_THAT(refusal_of(""), HasSubstr("the file is empty"));
  EXPECT_THAT(refusal_of("ply\nformat ascii 1.0\n"), HasSubstr("found a file of another kind"));
  EXPECT_THAT(refusal_of("x"), HasSubstr("found a file of another kind"));
  EXPECT_THAT(refusal_of(std::string(10000, '\0')), HasSubstr("found a file of another kind"));
  // Line ends changed on the way, as by a transfer in text mode.
  std::string text = bytes_of(random_map(2, 10, 4));
  text.erase(4, 1);
  EXPECT_THAT(refusal_of(text), HasSubstr("found a file of another kind"));
  EXPECT_THAT(refusal_of("\x89HFM"), HasSubstr("cut off"));
  EXPECT_THROW(
      {
        try {
          read_map(path("nothing.hfm"));
        } catch (const InputError& error) {
          EXPECT_THAT(error.what(), AllOf(HasSubstr("nothing.hfm"), HasSubstr("no such file"), HasSubstr(".hfm")));
          throw;
        }
      },
      InputError);
  EXPECT_THROW(read_map(folder_), InputError);
  EXPECT_THROW(read_map("/dev/null"), InputError);
}

TEST_F(MapDamage, ANewerVersion) {
  std::string bytes = bytes_of(random_map(3, 10, 5));
  put_at(bytes, 8, 2U);
  EXPECT_THAT(refusal_of(bytes), HasSubstr("checksum of the header"));
  repair_checksums(bytes);
  EXPECT_THAT(refusal_of(bytes), AllOf(HasSubstr("found format version 2"), HasSubstr("up to 1"), HasSubstr("newer")));
  put_at(bytes, 8, 0U);
  repair_checksums(bytes);
  EXPECT_THAT(refusal_of(bytes), HasSubstr("version 0"));
}

TEST_F(MapDamage, SaysWhereAndWhat) {
  const std::string bytes = bytes_of(random_map(4, 10, 6));
  EXPECT_THAT(refusal_of(bytes.substr(0, bytes.size() - 5)),
              AllOf(HasSubstr("has " + std::to_string(bytes.size() - 5)),
                    HasSubstr("expected " + std::to_string(bytes.size())), HasSubstr("cut off")));
  EXPECT_THAT(refusal_of(bytes + "more"), HasSubstr("something was added"));
  std::string flipped = bytes;
  const std::size_t features = find_section(bytes, "FEAT", 1);
  flipped[features + 100] ^= 1;
  EXPECT_THAT(refusal_of(flipped),
              AllOf(HasSubstr("checksum of section 'FEAT' at byte " + std::to_string(features)), HasSubstr("0x")));
}

/// A file with a section of another type put in before the points.
std::string with_section(std::string bytes, const std::string& type, std::uint32_t flags) {
  std::string section(24, '\0');
  section.replace(0, 4, type);
  put_at(section, 4, flags);
  put_at(section, 8, std::uint64_t{5});
  bytes.insert(find_section(bytes, "POIN"), section + "hello");
  put_at(bytes, 32, static_cast<std::uint64_t>(bytes.size()));
  put_at(bytes, 40, number_at<std::uint32_t>(bytes, 40) + 1);
  repair_checksums(bytes);
  return bytes;
}

TEST_F(MapDamage, UnknownSections) {
  const std::string bytes = bytes_of(random_map(4, 10, 7));
  write("more.hfm", with_section(bytes, "BOOK", 0));
  const Map map = read_map(path("more.hfm"));
  EXPECT_TRUE(bytes_of(map) == bytes) << "an optional section changed what was read";
  EXPECT_THAT(refusal_of(with_section(bytes, "BOOK", 1)), AllOf(HasSubstr("'BOOK'"), HasSubstr("newer Holdfast")));
  EXPECT_THAT(refusal_of(with_section(bytes, "CAMS", 1)), HasSubstr("where it does not belong"));
}

/// Values at places of the layout, behind fitting checksums.
TEST_F(MapDamage, InconsistentContent) {
  const std::string bytes = bytes_of(random_map(6, 12, 8));
  const std::size_t tables = find_section(bytes, "CAMS") + 24, keyframes = find_section(bytes, "KEYF") + 24,
                    features = find_section(bytes, "FEAT", 2) + 24, points = find_section(bytes, "POIN") + 24;
  const auto refusal_with = [&](std::size_t offset, auto value) {
    std::string changed = bytes;
    put_at(changed, offset, value);
    repair_checksums(changed);
    return refusal_of(changed);
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  constexpr std::size_t count = 12;
  EXPECT_THAT(refusal_with(tables, 0x40000000U), HasSubstr("count of 1073741824 cameras"));
  EXPECT_THAT(refusal_with(tables + 4 + 2 + 7, -640), HasSubstr("width is -640"));
  EXPECT_THAT(refusal_with(tables + 4 + 2 + 7 + 8, nan), HasSubstr("focal length is nan"));
  EXPECT_THAT(refusal_with(keyframes, 0xFFFFFFF0U), HasSubstr("keyframes, for which the section is too short"));
  EXPECT_THAT(refusal_with(keyframes + 4, std::uint64_t{1000}), HasSubstr("sequence number"));
  EXPECT_THAT(refusal_with(keyframes + 4 + 16, nan), HasSubstr("keyframe 0: time stamp is nan"));
  EXPECT_THAT(refusal_with(keyframes + 4 + 24, 2.0), HasSubstr("departure of the pose from a rotation"));
  EXPECT_THAT(refusal_with(keyframes + 4 + 120, 9U), HasSubstr("found camera 9"));
  EXPECT_THAT(refusal_with(keyframes + 4 + 128, 7U), HasSubstr("section 'FEAT'"));
  EXPECT_THAT(refusal_with(keyframes + 4 + 132, 3U), HasSubstr("keyframe 0 is older than its parent 3"));
  EXPECT_THAT(refusal_with(keyframes + 4 + 136, 0x30000000U), HasSubstr("805306368 children"));
  EXPECT_THAT(refusal_with(features, 1U), HasSubstr("of keyframe 1; expected 12 of keyframe 2"));
  EXPECT_THAT(refusal_with(features + 8 + 4 * 4 * count, std::numeric_limits<float>::infinity()),
              HasSubstr("feature 0: depth is inf"));
  EXPECT_THAT(refusal_with(features + 8 + 9 * 4 * count, 5000U), HasSubstr("shows point 5000"));
  EXPECT_THAT(refusal_with(features + 8 + 9 * 4 * count, 0xFFFFFFFFU), HasSubstr("which does not show it"));
  EXPECT_THAT(refusal_with(features + 8 + 72 * count, std::uint8_t{8}), HasSubstr("octave is 8"));
  EXPECT_THAT(refusal_with(points + 4, nan), HasSubstr("point 0: position is nan"));
  EXPECT_THAT(refusal_with(points + 4 + 88, 77U), HasSubstr("reference keyframe 77, which does not see it"));
  EXPECT_THAT(refusal_with(points + 4 + 112, 0U), HasSubstr("number of observations is 0"));
  EXPECT_THAT(refusal_with(points + 4 + 116, 99U), HasSubstr("point 0 is seen by keyframe 99"));
  EXPECT_THAT(refusal_with(points + 4 + 120, 99U), HasSubstr("as feature 99, which does not show it"));
  EXPECT_THAT(refusal_with(44, 5U), HasSubstr("the header says 5"));
  EXPECT_THAT(refusal_with(64, std::uint64_t{0}), HasSubstr("expected less than the next, 0"));
}

TEST_F(MapDamage, Classes) {
  Map map = random_map(4, 10, 9);
  map.set_classes({"background", "person"});
  for (const MapPointId id : map.points().ids()) map.point(id).label = 1;
  const std::string bytes = bytes_of(map);
  const std::size_t classes = find_section(bytes, "CLAS") + 24, labels = classes + 4 + 4 + 10 + 4 + 6;
  const auto refusal_with = [&](std::size_t offset, auto value) {
    std::string changed = bytes;
    put_at(changed, offset, value);
    repair_checksums(changed);
    return refusal_of(changed);
  };
  EXPECT_THAT(refusal_with(classes, 0U), HasSubstr("found 0 classes; expected 1 to 255"));
  EXPECT_THAT(refusal_with(classes, 0x10000000U), HasSubstr("count of 268435456 classes"));
  EXPECT_THAT(refusal_with(classes + 4, 0x10000000U), HasSubstr("letters of a name"));
  EXPECT_THAT(refusal_with(labels, 3U), HasSubstr("found 3 labels; expected one for each of"));
  EXPECT_THAT(refusal_with(labels + 4, std::uint8_t{2}), HasSubstr("point 0: found label 2; expected less than 2"));
  EXPECT_EQ(refusal_with(labels + 4, std::uint8_t{255}), "");
}

TEST_F(MapDamage, Votes) {
  Map map = random_map(4, 10, 9);
  map.set_classes({"background", "person"});
  for (const MapPointId id : map.points().ids())
    map.point(id).earlier_votes.add(1, 2), map.point(id).earlier_votes.add(0);
  const std::string bytes = bytes_of(map);
  const std::size_t votes = find_section(bytes, "VOTE") + 24;
  const auto refusal_with = [&](std::size_t offset, auto value) {
    std::string changed = bytes;
    put_at(changed, offset, value);
    repair_checksums(changed);
    return refusal_of(changed);
  };
  EXPECT_THAT(refusal_with(votes, 3U), HasSubstr("found votes of 3 points; expected those of"));
  EXPECT_THAT(refusal_with(votes + 4, std::uint8_t{200}), HasSubstr("section 'VOTE'"));
  EXPECT_THAT(refusal_with(votes + 5, std::uint8_t{2}), HasSubstr("1 votes for label 2; expected at least one vote"));
  EXPECT_THAT(refusal_with(votes + 6, 0U), HasSubstr("point 0: found 0 votes for label 0"));
  EXPECT_THAT(refusal_with(votes + 10, std::uint8_t{0}), HasSubstr("increasing labels below 2"));
  EXPECT_EQ(refusal_with(votes + 6, 5U), "");
}

TEST_F(MapDamage, MotionsOfKeyframes) {
  Map map = random_map(4, 10, 9);
  test::add_motions(map);
  const std::string bytes = bytes_of(map);
  const std::size_t first = find_section(bytes, "MOTN") + 24 + 4;  // keyframe 1, which has a vertical
  const std::size_t second = first + 8 + 24;                       // keyframe 2, which has a motion
  const auto refusal_with = [&](std::size_t offset, auto value) {
    std::string changed = bytes;
    put_at(changed, offset, value);
    repair_checksums(changed);
    return refusal_of(changed);
  };
  EXPECT_EQ(refusal_with(first, 0U), "");
  EXPECT_THAT(refusal_with(first - 4, 1000U), HasSubstr("keyframes with a vertical or a motion"));
  EXPECT_THAT(refusal_with(first, 4U), HasSubstr("expected increasing keyframes below 4"));
  EXPECT_THAT(refusal_with(second, 1U), HasSubstr("found keyframe 1 with flags 2; expected increasing keyframes"));
  EXPECT_THAT(refusal_with(first + 4, 0U), HasSubstr("flags 1 to 3"));
  EXPECT_THAT(refusal_with(first + 4, 4U), HasSubstr("flags 1 to 3"));
  EXPECT_NE(refusal_with(first + 4, 3U), "");
  EXPECT_THAT(refusal_with(first + 16, 2.0), HasSubstr("keyframe 1: length of the vertical is"));
  EXPECT_THAT(refusal_with(second + 8, 2e9), HasSubstr("keyframe 2: speed is"));
  EXPECT_THAT(refusal_with(second + 8 + 3 * 8, 101.0), HasSubstr("keyframe 2: larger bias is"));
  for (std::size_t number = 0; number < 9; ++number)
    EXPECT_NE(refusal_with(second + 8 + 8 * number, std::numeric_limits<double>::quiet_NaN()), "") << number;
}

TEST_F(MapDamage, EstimatesOfAnImu) {
  Map map = random_map(4, 10, 9);
  map.set_inertia(test::example_inertia());
  const std::string bytes = bytes_of(map);
  const auto refusal_with = [&](std::size_t number, double value) {
    std::string changed = bytes;
    put_at(changed, find_section(bytes, "INER") + 24 + 8 * number, value);
    repair_checksums(changed);
    return refusal_of(changed);
  };
  EXPECT_THAT(refusal_with(1, 9500.0), HasSubstr("magnitude of gravity is"));
  EXPECT_THAT(refusal_with(3, 0.0), HasSubstr("scale is 0"));
  EXPECT_THAT(refusal_with(5, -101.0), HasSubstr("a bias is not within 100"));
  EXPECT_THAT(refusal_with(10, 0.5), HasSubstr("departure of the correction of T_body_camera from a rotation"));
  EXPECT_THAT(refusal_with(19, 11.0), HasSubstr("time offset is 11"));
  EXPECT_THAT(refusal_with(22, -1.0), HasSubstr("standard deviation is -1"));
  EXPECT_THAT(refusal_with(27, 0.5), HasSubstr("departure of T_body_camera from a rotation"));
  EXPECT_THAT(refusal_with(30, 1e9), HasSubstr("T_body_camera has a translation"));
  for (std::size_t number = 0; number < 40; ++number)
    EXPECT_NE(refusal_with(number, std::numeric_limits<double>::quiet_NaN()), "") << number;
}

}  // namespace
}  // namespace holdfast
