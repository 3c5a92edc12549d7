// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/evaluation/association.hpp"

#include <gmock/gmock.h>

#include "holdfast/core/error.hpp"

namespace holdfast {
namespace {

using ::testing::ElementsAre;
using Stamps = std::vector<double>;

TEST(PairStamps, TakesTheNearestFirst) {
  // 1.00 is near 1.01 too, but 1.012 is nearer to that.
  EXPECT_THAT(pair_stamps(Stamps{1.0, 1.012}, Stamps{1.01}, 0.02), ElementsAre(StampPair{1, 0}));
}

TEST(PairStamps, GivesWhatIsLeftToTheNextNearest) {
  EXPECT_THAT(pair_stamps(Stamps{1.0, 1.012}, Stamps{0.985, 1.01}, 0.02),
              ElementsAre(StampPair{0, 0}, StampPair{1, 1}));
}

TEST(PairStamps, UsesEachStampOnce) {
  EXPECT_EQ(pair_stamps(Stamps{1.0, 1.001, 1.002}, Stamps{1.0005, 1.0015}, 0.02).size(), 2u);
}

TEST(PairStamps, LeavesOutWhatIsExactlyAtTheLimit) {
  EXPECT_TRUE(pair_stamps(Stamps{1.0}, Stamps{1.5}, 0.5).empty());
  EXPECT_EQ(pair_stamps(Stamps{1.0}, Stamps{1.5}, 0.5000001).size(), 1u);
}

TEST(PairStamps, TakesTheEarlierOfEquallyNearOnes) {
  EXPECT_THAT(pair_stamps(Stamps{1.0}, Stamps{0.75, 1.25}, 0.5), ElementsAre(StampPair{0, 0}));
}

TEST(PairStamps, HandlesEmptyLists) {
  EXPECT_TRUE(pair_stamps({}, Stamps{1.0}, 0.02).empty());
  EXPECT_TRUE(pair_stamps(Stamps{1.0}, {}, 0.02).empty());
}

TEST(NearestStamp, TakesTheEarlierOfTwoAndStaysInside) {
  const Stamps stamps{1.0, 2.0, 4.0};
  EXPECT_EQ(nearest_stamp(stamps, 1.5), 0u);
  EXPECT_EQ(nearest_stamp(stamps, 1.6), 1u);
  EXPECT_EQ(nearest_stamp(stamps, 2.0), 1u);
  EXPECT_EQ(nearest_stamp(stamps, -5.0), 0u);
  EXPECT_EQ(nearest_stamp(stamps, 9.0), 2u);
  EXPECT_THROW(nearest_stamp({}, 1.0), CheckError);
}

}  // namespace
}  // namespace holdfast
