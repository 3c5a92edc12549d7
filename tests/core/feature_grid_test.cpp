// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/core/feature_grid.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "holdfast/core/random.hpp"

namespace holdfast {
namespace {

struct Points {
  std::vector<float> x, y;
};

Points random_points(std::size_t count, double low, double high) {
  Random random(2);
  Points points;
  for (std::size_t i = 0; i < count; ++i) {
    points.x.push_back(static_cast<float>(random.uniform(low, high)));
    points.y.push_back(static_cast<float>(random.uniform(low, high)));
  }
  return points;
}

TEST(FeatureGrid, FindsWhatASearchThroughAllFinds) {
  // Some points lie outside the grid: they belong to its border cells.
  const Points points = random_points(500, -30, 230);
  Random random(3);
  for (const float cell_size : {7.0F, 20.0F, 500.0F}) {
    FeatureGrid grid;
    grid.build(points.x, points.y, {0, 0, 200, 200}, cell_size);
    for (int query = 0; query < 200; ++query) {
      const auto x = static_cast<float>(random.uniform(-40, 240)), y = static_cast<float>(random.uniform(-40, 240));
      const auto radius = static_cast<float>(random.uniform(0, 60));
      std::vector<std::uint32_t> found, expected;
      grid.query(x, y, radius, found);
      for (std::uint32_t i = 0; i < points.x.size(); ++i)
        if (std::abs(points.x[i] - x) < radius && std::abs(points.y[i] - y) < radius) expected.push_back(i);
      std::sort(found.begin(), found.end());
      EXPECT_EQ(found, expected);
    }
  }
}

TEST(FeatureGrid, AppendsInOrderOfCellsThenOfIndices) {
  FeatureGrid grid;
  const std::vector<float> x = {55, 5, 6, 15, 5}, y = {5, 5, 15, 5, 5};
  grid.build(x, y, {0, 0, 60, 20}, 10);
  std::vector<std::uint32_t> found = {99};
  grid.query(10, 10, 12, found);
  EXPECT_EQ(found, (std::vector<std::uint32_t>{99, 1, 4, 3, 2}));
}

TEST(FeatureGrid, OfNothingFindsNothing) {
  FeatureGrid grid;
  std::vector<std::uint32_t> found;
  EXPECT_TRUE(grid.empty());
  grid.query(0, 0, 10, found);
  grid.build({}, {}, {0, 0, 640, 480});
  grid.query(0, 0, 10, found);
  EXPECT_TRUE(grid.empty());
  EXPECT_TRUE(found.empty());
}

}  // namespace
}  // namespace holdfast
