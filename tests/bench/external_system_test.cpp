// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/bench/external_system.hpp"

#include <gmock/gmock.h>
#include <unistd.h>

#include <fstream>

namespace holdfast {
namespace {

using testing::AllOf;
using testing::HasSubstr;

RecordedSequence little_sequence() {
  RecordedSequence sequence;
  sequence.name = "little";
  sequence.folder = "/data/little";
  sequence.camera = *find_camera("tum_fr3");
  sequence.frames = {{{1.5, "rgb/a.png", 1}, {1.51, "depth/a.png", 1}},
                     {{1305031102.175304, "rgb/b.png", 2}, {1305031102.160407, "depth/b.png", 2}}};
  return sequence;
}

TEST(ExternalSystemTest, WritesAssociationsAsOthersReadThem) {
  EXPECT_EQ(associations_text(little_sequence()),
            "1.500000 rgb/a.png 1.510000 depth/a.png\n"
            "1305031102.175304 rgb/b.png 1305031102.160407 depth/b.png\n");
}

TEST(ExternalSystemTest, WritesSettingsOfTheSequencesCamera) {
  const std::string text =
      orb_slam2_settings(little_sequence(), {{"ORBextractor.nFeatures", "2000"}, {"Camera.type", "\"PinHole\""}});
  EXPECT_EQ(text.find("%YAML:1.0\n"), 0U);
  EXPECT_THAT(text, AllOf(HasSubstr("\nCamera.fx: 535.4\n"), HasSubstr("\nCamera.k1: 0.0\n"),
                          HasSubstr("\nCamera.width: 640\n"), HasSubstr("\nDepthMapFactor: 5000.0\n"),
                          HasSubstr("\nORBextractor.nFeatures: 2000\n"), HasSubstr("\nCamera.type: \"PinHole\"\n"),
                          HasSubstr("\nCamera.bf: 42.83")));
  EXPECT_EQ(text.find("nFeatures: 1000"), std::string::npos);
}

TEST(ExternalSystemTest, FillsPlaceholders) {
  const Placeholders values = {{"sequence", "/s/{output}"}, {"output", "/o"}};
  EXPECT_EQ(fill_placeholders("a {sequence} {output}/x {other} {} ${HOME} {Sequence}", values),
            "a /s/{output} /o/x {other} {} ${HOME} {Sequence}");
  EXPECT_EQ(unknown_placeholder("{sequence} {ouput}"), "ouput");
  EXPECT_FALSE(unknown_placeholder("{settings} {associations} {name} {output} { print } {2}"));
}

TEST(ExternalSystemTest, SalvagesWhatAProgramLeft) {
  const std::string file =
      (std::filesystem::temp_directory_path() / ("holdfast_salvage_" + std::to_string(getpid()))).string();
  EXPECT_FALSE(salvage_trajectory(file).exists);
  std::ofstream(file) << "# stamps\n2.0 0 0 0 0 0 0 1\n1.0 0 0 1 0 0 0 1\n3.0 nan 0 0 0 0 0 1\n4.0 0 0 0 0 0 0 0\n"
                         "5.0 0 0 -inf 0 0 0 1\nlost\n5.5 0 0 1 0 0 0 2\n6.0 0 0 0 0 0 0 1 7\n7.0 0 0 0.1";
  const SalvagedTrajectory salvaged = salvage_trajectory(file);
  std::filesystem::remove(file);
  EXPECT_TRUE(salvaged.exists);
  ASSERT_EQ(salvaged.poses.size(), 3U);
  EXPECT_EQ(salvaged.poses[0].timestamp, 1.0);
  EXPECT_EQ(salvaged.poses[2].timestamp, 6.0);
  EXPECT_EQ(salvaged.not_finite, 3U);
  EXPECT_EQ(salvaged.malformed, 3U);
}

}  // namespace
}  // namespace holdfast
