// SPDX-License-Identifier: BSD-3-Clause
#include "orientation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "subpixel.hpp"

namespace holdfast::orb_plugin {
namespace {

TEST(Direction, AgreesWithTheLibraryInEveryQuadrant) {
  for (int x = -40; x <= 40; ++x)
    for (int y = -40; y <= 40; ++y) {
      if (x == 0 && y == 0) continue;
      double expected = std::atan2(y, x);
      if (expected < 0) expected += 2 * std::numbers::pi;
      EXPECT_NEAR(direction(x, y), expected, 1e-6) << x << " " << y;
    }
  EXPECT_EQ(direction(0, 0), 0.0F);
  EXPECT_LT(direction(1000000000, -1), 2 * std::numbers::pi_v<float>);
}

TEST(ScorePeak, FindsThePeakOfAQuadratic) {
  for (const double px : {-0.4, 0.0, 0.3})
    for (const double py : {-0.2, 0.1, 0.5}) {
      std::array<std::uint8_t, 9> scores;
      for (int i = 0; i < 9; ++i) {
        const double dx = i % 3 - 1 - px, dy = i / 3 - 1 - py;
        scores[i] = static_cast<std::uint8_t>(std::lround(200 - 30 * dx * dx - 25 * dy * dy + 10 * dx * dy));
      }
      const SubpixelOffset peak = score_peak(scores);
      EXPECT_NEAR(peak.x, px, 0.03);
      EXPECT_NEAR(peak.y, py, 0.03);
    }
}

TEST(ScorePeak, IsTheMiddleWhereThereIsNoPeak) {
  for (const std::array<std::uint8_t, 9>& scores :
       {std::array<std::uint8_t, 9>{}, std::array<std::uint8_t, 9>{9, 9, 9, 9, 5, 9, 9, 9, 9},
        std::array<std::uint8_t, 9>{0, 9, 0, 0, 9, 0, 0, 9, 0}}) {
    EXPECT_EQ(score_peak(scores).x, 0.0F);
    EXPECT_EQ(score_peak(scores).y, 0.0F);
  }
}

}  // namespace
}  // namespace holdfast::orb_plugin
