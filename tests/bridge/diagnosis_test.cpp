// SPDX-License-Identifier: BSD-3-Clause
#include "diagnosis.hpp"

#include <gmock/gmock.h>

namespace holdfast::bridge {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::Pair;
using Level = Diagnostics::Level;

BridgeStatus running(HealthState state) {
  BridgeStatus status;
  status.counts.colour = status.counts.answered = 10;
  status.health.emplace();
  status.health->health.state = state;
  return status;
}

TEST(Diagnosis, SaysWhatIsMissingFirst) {
  BridgeStatus status;
  EXPECT_THAT(diagnose(status).message, HasSubstr("no colour image"));
  EXPECT_EQ(diagnose(status).level, Level::warning);
  status.counts.colour = 5;
  status.needs_camera = true;
  EXPECT_THAT(diagnose(status).message, HasSubstr("no camera_info"));
  status.needs_camera = false;
  status.counts.unpaired = 5;
  EXPECT_THAT(diagnose(status).message, HasSubstr("without a partner"));
  status.failure = "the file is missing";
  EXPECT_EQ(diagnose(status).message, "the file is missing");
  EXPECT_EQ(diagnose(status).level, Level::error);
}

TEST(Diagnosis, TheLevelFollowsTheHealth) {
  EXPECT_EQ(diagnose(running(HealthState::good)).level, Level::ok);
  for (const HealthState state : {HealthState::degraded, HealthState::inertial, HealthState::relocalised})
    EXPECT_EQ(diagnose(running(state)).level, Level::warning);
  for (const HealthState state : {HealthState::lost, HealthState::stalled})
    EXPECT_EQ(diagnose(running(state)).level, Level::error);
  BridgeStatus paused = running(HealthState::stalled);
  paused.is_paused = true;
  EXPECT_EQ(diagnose(paused).level, Level::ok) << "who pauses expects no frames";
}

TEST(Diagnosis, NamesReasonsAndNumbers) {
  BridgeStatus status = running(HealthState::degraded);
  status.health->health.reasons.add(HealthReason::few_inliers);
  status.health->health.reasons.add(HealthReason::fallback);
  status.counts.late = 3;
  const Diagnostics result = diagnose(status);
  EXPECT_EQ(result.message, "degraded: few inliers, fallback");
  EXPECT_THAT(result.values, Contains(Pair("late", "3")));
  EXPECT_THAT(result.values, Contains(Pair("reasons", "few inliers, fallback")));
}

}  // namespace
}  // namespace holdfast::bridge
