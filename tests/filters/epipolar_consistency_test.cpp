// SPDX-License-Identifier: BSD-3-Clause
#include "epipolar_consistency.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstdlib>
#include <string>
#include <vector>

#include "filters/judged_frames.hpp"

namespace holdfast::epipolar_consistency_plugin {
namespace {

using test::JudgedFrames;
using test::Surface;

ParameterValues scene(const std::string& name, std::vector<std::string> set) {
  return {{"scene", std::string(HOLDFAST_SOURCE_DIR) + "/examples/scenes/" + name + ".yaml"}, {"set", std::move(set)}};
}

/// How many features of what surface were called moving and static.
struct Counts {
  std::array<int, 3> moving{}, fixed{};
  int usable_frames = 0;

  double share_moving(Surface surface) const {
    const auto i = static_cast<std::size_t>(surface);
    return moving[i] / std::max(1.0, static_cast<double>(moving[i] + fixed[i]));
  }
};

Counts count(JudgedFrames& frames) {
  EpipolarConsistency filter({}, frames.context());
  Counts counts;
  frames.run(filter, [&](const SensorFrame& image, const Frame& frame, const StaticEvidence& evidence) {
    counts.usable_frames += filter.verdict() == Verdict::usable ? 1 : 0;
    if (filter.verdict() != Verdict::usable) {
      EXPECT_TRUE(evidence.contributions().empty());
    }
    for (const StaticEvidence::Contribution& statement : evidence.contributions()) {
      EXPECT_EQ(statement.kind, StaticEvidence::Kind::measurement);
      const auto surface = static_cast<std::size_t>(test::surface_of(image, frame, statement.feature));
      ++(statement.log_odds < 0 ? counts.moving : counts.fixed)[surface];
    }
  });
  return counts;
}

TEST(EpipolarConsistency, TellsPeopleWhoWalkFromTheRoom) {
  std::vector<std::string> set{"duration=1.5"};
  for (const char* person : {"0", "1", "2", "3"}) set.push_back(std::string("people.") + person + ".start=-6");
  JudgedFrames frames("simulated", scene("walking_xyz", set));
  const Counts counts = count(frames);
  EXPECT_GE(counts.usable_frames, 2);
  EXPECT_GE(counts.share_moving(Surface::moving), 0.3);
  EXPECT_LE(counts.share_moving(Surface::still), 0.06);
}

TEST(EpipolarConsistency, IsSilentWhileTheCameraOnlyTurns) {
  JudgedFrames frames("simulated", scene("paper_rotation", {"duration=0.4"}));
  EXPECT_EQ(count(frames).usable_frames, 0);
}

TEST(EpipolarConsistency, SameFramesSameEvidence) {
  std::array<std::vector<StaticEvidence::Contribution>, 2> said;
  for (auto& statements : said) {
    JudgedFrames frames("simulated", scene("empty", {"duration=0.9", "camera.speed=4"}));
    EpipolarConsistency filter({}, frames.context());
    frames.run(filter, [&](const SensorFrame&, const Frame&, const StaticEvidence& evidence) {
      statements.insert(statements.end(), evidence.contributions().begin(), evidence.contributions().end());
    });
  }
  ASSERT_EQ(said[0].size(), said[1].size());
  EXPECT_GT(said[0].size(), 100U);
  for (std::size_t i = 0; i < said[0].size(); ++i) {
    EXPECT_EQ(said[0][i].feature, said[1][i].feature);
    EXPECT_EQ(said[0][i].log_odds, said[1][i].log_odds);
  }
}

TEST(EpipolarConsistency, RaisesFewAlarmsInARealRoomWhereNothingMoves) {
  const char* data = std::getenv("HOLDFAST_DATA");
  if (data == nullptr) GTEST_SKIP() << "HOLDFAST_DATA does not name the folder with tum_fr1_xyz";
  JudgedFrames frames(
      "tum",
      {{"path", std::string(data) + "/tum_fr1_xyz"}, {"start", std::int64_t{150}}, {"frames", std::int64_t{100}}});
  const Counts counts = count(frames);
  EXPECT_GE(counts.usable_frames, 15);
  EXPECT_LE(counts.share_moving(Surface::still), 0.07);
}

}  // namespace
}  // namespace holdfast::epipolar_consistency_plugin
