// SPDX-License-Identifier: BSD-3-Clause
#include "class_evidence.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <numeric>

#include "place_check.hpp"

namespace holdfast {
namespace {

/// A detector that only knows weights.
class Weights final : public LoopDetector {
 public:
  void add(KeyFrameId, const DescriptorView&) override {}
  void remove(KeyFrameId) override {}
  std::vector<PlaceMatch> query(const DescriptorView&, int) const override { return {}; }
  std::vector<std::pair<std::string, double>> class_weights() const override { return {{"chair", 0.1}, {"sofa", 0.0}}; }
};

constexpr std::uint8_t wall = 0, chair = 1, unknown = CellMask::unknown;

/// Feature i lies in cell i of the mask, whose labels are given; point i has one vote for each of its labels.
class ClassEvidenceTest : public testing::Test {
 protected:
  void add(std::uint8_t label, std::initializer_list<std::uint8_t> votes) {
    labels.push_back(label);
    place.positions.emplace_back(0, 0, 1);
    place.votes.emplace_back();
    for (const std::uint8_t vote : votes) place.votes.back().add(vote);
  }
  ClassEvidence evidence(const PlaceWeights& weights) {
    Frame frame;
    const Camera camera = *find_camera("tum_fr3");
    frame.coarse.grid = CoarseSampler(camera).grid();
    frame.coarse.mask.assign(static_cast<std::size_t>(frame.coarse.grid.size()), unknown, 255);
    std::vector<std::uint32_t> visible(labels.size());
    std::iota(visible.begin(), visible.end(), 0U);
    std::vector<matching::FeatureMatch> matches;
    for (std::uint32_t i = 0; i < labels.size(); ++i) {
      frame.coarse.mask.labels[i] = labels[i];
      frame.x.push_back(frame.coarse.grid.x_of(static_cast<int>(i)));
      frame.y.push_back(frame.coarse.grid.y_of(0));
      if (i % 2 == 0) matches.push_back({.source = i, .feature = i});
    }
    return class_evidence(frame, place, visible, matches, weights);
  }

  std::vector<std::uint8_t> labels;
  PlacePoints place;
};

TEST_F(ClassEvidenceTest, WithoutWeightsEverythingCounts) {
  add(chair, {wall});
  add(chair, {chair});
  add(wall, {wall});
  const ClassEvidence found = evidence({});
  EXPECT_EQ(found.inliers, 2.0);
  EXPECT_EQ(found.expected, 3.0);
  EXPECT_EQ(found.solid.size(), 2U);
  EXPECT_EQ(found.agreement, 1.0);
}

TEST_F(ClassEvidenceTest, MatchesCountByTheirClass) {
  const Weights detector;
  const PlaceWeights weights(detector, {"wall", "chair"});
  EXPECT_FALSE(weights.are_uniform());
  EXPECT_TRUE(PlaceWeights(detector, {"wall", "table"}).are_uniform()) << "classes that the segmenter does not have";
  add(wall, {wall});                // match: 1
  add(wall, {chair, chair, wall});  // visible only: 0.1
  add(chair, {chair});              // match: 0.1
  add(wall, {wall});                // visible only: 1
  add(wall, {chair, chair, wall});  // match: 0.1 by the point, a third agrees
  add(unknown, {});                 // visible only: 1
  add(unknown, {wall});             // match: 1, not compared
  const ClassEvidence found = evidence(weights);
  EXPECT_NEAR(found.inliers, 2.2, 1e-5);
  EXPECT_NEAR(found.expected, 1.0 + 0.1 + 0.1 + 1.0 + 0.1 + 1.0 + 1.0, 1e-5);
  EXPECT_EQ(found.solid.size(), 2U);
  EXPECT_EQ(found.compared, 3);
  EXPECT_NEAR(found.agreement, (1.0 + 1.0 + 1.0 / 3.0) / 3.0, 1e-9);
}

}  // namespace
}  // namespace holdfast
