// SPDX-License-Identifier: BSD-3-Clause
#include "image_pairing.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <vector>

#include "holdfast/core/association.hpp"

namespace holdfast::bridge {
namespace {

constexpr Stamp millisecond = 1'000'000;

StampedImage image(Stamp stamp) { return {stamp, cv::Mat(1, 1, CV_8UC1), 0.0}; }

std::vector<std::pair<Stamp, Stamp>> take_all(ImagePairing& pairing) {
  std::vector<std::pair<Stamp, Stamp>> pairs;
  while (const auto set = pairing.next()) pairs.emplace_back(set->colour.stamp, set->depth.stamp);
  return pairs;
}

TEST(ImagePairing, GivesTheNearestDepthOnceItIsCertain) {
  ImagePairing pairing(true, false, 20 * millisecond);
  pairing.add(ImageKind::depth, image(90 * millisecond));
  pairing.add(ImageKind::colour, image(100 * millisecond));
  EXPECT_FALSE(pairing.next()) << "the next depth image may be nearer";
  pairing.add(ImageKind::depth, image(104 * millisecond));
  const auto set = pairing.next();
  ASSERT_TRUE(set);
  EXPECT_EQ(set->colour.stamp, 100 * millisecond);
  EXPECT_EQ(set->depth.stamp, 104 * millisecond);
  EXPECT_FALSE(pairing.next());
}

TEST(ImagePairing, DoesNotWaitForAnotherImageOnceThePeriodIsKnown) {
  ImagePairing pairing(true, false, 20 * millisecond);
  for (const Stamp stamp : {0, 33, 66}) pairing.add(ImageKind::depth, image(stamp * millisecond));
  pairing.add(ImageKind::colour, image(76 * millisecond));
  EXPECT_TRUE(pairing.next()) << "10 ms are less than half of the period of 33 ms";
  pairing.add(ImageKind::depth, image(99 * millisecond));
  pairing.add(ImageKind::colour, image(115 * millisecond));
  EXPECT_FALSE(pairing.next()) << "16 ms are about half: the next one may be as near";
  pairing.add(ImageKind::depth, image(132 * millisecond));
  const auto set = pairing.next();
  ASSERT_TRUE(set);
  EXPECT_EQ(set->depth.stamp, 99 * millisecond);
}

TEST(ImagePairing, GivesExactStampsAtOnceAndInTheirOrder) {
  ImagePairing pairing(true, true, 20 * millisecond);
  pairing.add(ImageKind::right, image(10 * millisecond));
  pairing.add(ImageKind::colour, image(20 * millisecond));
  pairing.add(ImageKind::depth, image(20 * millisecond));
  pairing.add(ImageKind::depth, image(10 * millisecond));  // late, out of order
  pairing.add(ImageKind::colour, image(10 * millisecond));
  auto set = pairing.next();
  ASSERT_TRUE(set);
  EXPECT_EQ(set->colour.stamp, 10 * millisecond);
  EXPECT_EQ(set->right.stamp, 10 * millisecond);
  EXPECT_FALSE(pairing.next()) << "the right image of 20 ms is missing";
  pairing.add(ImageKind::right, image(20 * millisecond));
  set = pairing.next();
  ASSERT_TRUE(set);
  EXPECT_EQ(set->right.stamp, 20 * millisecond);
}

TEST(ImagePairing, CountsColourImagesWithoutAPartner) {
  ImagePairing pairing(true, false, 20 * millisecond);
  pairing.add(ImageKind::colour, image(100 * millisecond));
  pairing.add(ImageKind::depth, image(150 * millisecond));
  pairing.add(ImageKind::colour, image(150 * millisecond));
  EXPECT_EQ(take_all(pairing), (std::vector<std::pair<Stamp, Stamp>>{{150 * millisecond, 150 * millisecond}}));
  EXPECT_EQ(pairing.unpaired(), 1U);
  // A topic that nobody publishes must not keep all images.
  for (Stamp i = 0; i < 100; ++i) pairing.add(ImageKind::colour, image((200 + 33 * i) * millisecond));
  EXPECT_TRUE(take_all(pairing).empty());
  EXPECT_GE(pairing.unpaired(), 90U);
}

TEST(ImagePairing, NeedsNoPartnerForOneCamera) {
  ImagePairing pairing(false, false, 0);
  pairing.add(ImageKind::depth, image(5));
  pairing.add(ImageKind::colour, image(7));
  const auto set = pairing.next();
  ASSERT_TRUE(set);
  EXPECT_TRUE(set->depth.image.empty());
  EXPECT_FALSE(set->colour.image.empty());
}

std::vector<double> stamps_of(const std::string& file) {
  std::ifstream stream(file);
  std::vector<double> stamps;
  for (std::string line; std::getline(stream, line);)
    if (!line.empty() && line[0] != '#') stamps.push_back(std::stod(line));
  return stamps;
}

/// Played as it was recorded, a recording gives the pairs that its lists give.
TEST(ImagePairing, PairsARecordingAsItsListsDo) {
  const char* data = std::getenv("HOLDFAST_DATA");
  if (data == nullptr) GTEST_SKIP() << "HOLDFAST_DATA is not set";
  const std::string folder = std::string(data) + "/tum_fr1_xyz/";
  const std::vector<double> colours = stamps_of(folder + "rgb.txt"), depths = stamps_of(folder + "depth.txt");
  ASSERT_GT(colours.size(), 700U);
  const auto expected = associate_stamps(colours, depths, 0.02);
  const auto nanoseconds = [](double stamp) { return static_cast<Stamp>(std::llround(stamp * 1e6)) * 1000; };

  std::vector<std::pair<Stamp, ImageKind>> messages;
  for (const double stamp : colours) messages.emplace_back(nanoseconds(stamp), ImageKind::colour);
  for (const double stamp : depths) messages.emplace_back(nanoseconds(stamp), ImageKind::depth);
  std::sort(messages.begin(), messages.end());
  ImagePairing pairing(true, false, 20 * millisecond);
  std::vector<std::pair<Stamp, Stamp>> pairs;
  std::size_t at_once = 0;
  for (const auto& [stamp, kind] : messages) {
    pairing.add(kind, image(stamp));
    for (const auto& pair : take_all(pairing)) {
      at_once += stamp == std::max(pair.first, pair.second) ? 1U : 0U;
      pairs.push_back(pair);
    }
  }
  std::size_t same = 0;
  for (const auto& [i, j] : expected)
    same += static_cast<std::size_t>(
        std::count(pairs.begin(), pairs.end(), std::pair(nanoseconds(colours[i]), nanoseconds(depths[j]))));
  RecordProperty("same", static_cast<int>(same));
  std::printf("%zu pairs of the lists, %zu pairs, %zu the same, %zu as soon as both images had come\n", expected.size(),
              pairs.size(), same, at_once);
  EXPECT_GE(same, expected.size() * 97 / 100);
  EXPECT_GE(pairs.size(), expected.size() * 99 / 100);
}

}  // namespace
}  // namespace holdfast::bridge
