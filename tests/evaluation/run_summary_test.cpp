// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/evaluation/run_summary.hpp"

#include <gtest/gtest.h>

namespace holdfast {
namespace {

TEST(RunSummary, StagesAreInTheOrderOfThePipeline) {
  RunSummary summary;
  FrameResult first;
  for (const char* stage : {"frame", "features", "mapping: insertion", "dense map: keep"})
    first.times.add(stage, 0.001);
  summary.add(first, 0.002);
  StageTimes background;
  for (const char* stage : {"loops: candidates", "mapping: points", "segmentation"}) background.add(stage, 0.001);
  summary.add(background);
  FrameResult second;
  for (const char* stage : {"frame", "predict", "local map"}) second.times.add(stage, 0.001);
  summary.add(second, 0.002);

  std::vector<std::string> names;
  double shares = 0.0;
  for (const StageRow& row : summary.stages()) {
    names.push_back(row.stage);
    shares += row.share;
  }
  EXPECT_EQ(names, (std::vector<std::string>{"decode", "frame", "features", "predict", "local map", "segmentation",
                                             "mapping: insertion", "mapping: points", "loops: candidates",
                                             "dense map: keep"}));
  EXPECT_NEAR(shares, 1.0, 1e-12);
}

TEST(RunSummary, CountsHealth) {
  RunSummary summary;
  FrameResult result;
  result.health.state = HealthState::degraded;
  result.health.reasons.add(HealthReason::few_inliers);
  summary.add(result, 0.0);
  result.health = {.state = HealthState::relocalised, .jump = 0.3};
  summary.add(result, 0.0);
  EXPECT_EQ(summary.count(HealthState::degraded), 1U);
  EXPECT_EQ(summary.count(HealthState::good), 0U);
  EXPECT_EQ(summary.reasons().at(HealthReason::few_inliers), 1U);
  EXPECT_EQ(summary.largest_jump(), 0.3);
}

}  // namespace
}  // namespace holdfast
