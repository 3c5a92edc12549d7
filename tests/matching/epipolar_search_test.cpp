// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/matching/epipolar_search.hpp"

#include <gtest/gtest.h>

#include <numeric>

#include "holdfast/matching/frame_features.hpp"
#include "matching/grid_frame.hpp"

namespace holdfast {
namespace {

using matching::EpipolarSearchSettings;
using test::flipped;

/// Two views with the same features, side by side: epipolar lines are rows, and feature 45 lies on that of feature 45.
class EpipolarSearch : public testing::Test {
 protected:
  EpipolarSearch() {
    Eigen::Isometry3d T_b_world = Eigen::Isometry3d::Identity();
    T_b_world.translation().x() = -0.1;
    fundamental = geometry::fundamental_matrix(*a.camera, Eigen::Isometry3d::Identity(), T_b_world);
    all.resize(b.size());
    std::iota(all.begin(), all.end(), 0U);
  }
  std::optional<std::uint32_t> find(const EpipolarSearchSettings& settings = {}) const {
    return matching::EpipolarSearch<Frame>(a, b, fundamental, settings).find(45, all);
  }

  Frame a = test::grid_frame(200), b = test::grid_frame(200);
  Eigen::Matrix3d fundamental;
  std::vector<std::uint32_t> all;
};

TEST_F(EpipolarSearch, FindsTheFeatureOnTheLineAmongTheCandidates) {
  EXPECT_EQ(find(), 45U);
  all.erase(all.begin() + 45);
  EXPECT_EQ(find(), std::nullopt);
  all.clear();
  EXPECT_EQ(find(), std::nullopt);
}

TEST_F(EpipolarSearch, RefusesFeaturesOffTheLineByMoreThanTheirNoise) {
  b.y[45] += 1.9F;  // chi-square at 95 %: 1.960 px at octave 0
  EXPECT_EQ(find(), 45U);
  b.y[45] += 0.2F;
  EXPECT_EQ(find(), std::nullopt);
  b.features.octave[45] = 1;  // 1.2 times the noise
  EXPECT_EQ(find(), 45U);
  EXPECT_EQ(find({.chi_square = 2.0}), std::nullopt);
}

TEST_F(EpipolarSearch, RefusesDescriptorsBeyondTheLargestDistance) {
  b.features.descriptors.of_256_bits()[45] = flipped(a.features.descriptors.of_256_bits()[45], 30);
  EXPECT_EQ(find({.max_distance = 30}), 45U);
  EXPECT_EQ(find({.max_distance = 29}), std::nullopt);
}

TEST_F(EpipolarSearch, RefusesPatchesThatRepeatAlongTheLineButNotElsewhere) {
  b.features.descriptors.of_256_bits()[45] = flipped(a.features.descriptors.of_256_bits()[45], 20);
  b.features.descriptors.of_256_bits()[65] = flipped(a.features.descriptors.of_256_bits()[45], 21);  // the row below
  EXPECT_EQ(find(), 45U);
  b.features.descriptors.of_256_bits()[48] = flipped(a.features.descriptors.of_256_bits()[45], 24);  // the same row
  EXPECT_EQ(find(), std::nullopt);
  EXPECT_EQ(find({.ratio = 1.0F}), 45U);
}

TEST_F(EpipolarSearch, OfEquallyNearFeaturesTheFirstCandidateIsTaken) {
  b.features.descriptors.of_256_bits()[48] = b.features.descriptors.of_256_bits()[45];
  EXPECT_EQ(find({.ratio = 1.0F}), 45U);
  std::swap(all[45], all[48]);
  EXPECT_EQ(find({.ratio = 1.0F}), 48U);
}

}  // namespace
}  // namespace holdfast
