// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cli/program.hpp"

namespace holdfast {
namespace {

using test::Outcome;
using ::testing::HasSubstr;
namespace fs = std::filesystem;

/// Fifteen frames of the simulated room, in pictures.
class PicturesTest : public ::testing::Test {
 protected:
  PicturesTest() {
    program_.write("room.yaml",
                   "source: { simulated: { duration: 0.5 } }\ncamera: tum_fr1\nfeatures: { orb: { count: 600 } "
                   "}\noptimizer: ceres\nobservers: [ overlay: { every: 7 } ]\n");
  }
  test::Program program_;
};

TEST_F(PicturesTest, BackgroundWritesKeyframesBeforeAndAfter) {
  const Outcome outcome = program_.run({"background", "room.yaml", "--output", "out", "--set", "dense_map.step=4"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_THAT(outcome.output, HasSubstr("before and after, in out/background"));
  for (const char* name : {"000000_before.png", "000000_after.png", "pictures.txt"})
    EXPECT_GT(fs::file_size(program_.path(std::string("out/background/") + name)), 40U) << name;
  EXPECT_THAT(program_.text("out/background/pictures.txt"), HasSubstr(" 000000 0."));
  EXPECT_THAT(program_.text("out/config.yaml"), HasSubstr("dense_map"));

  const std::string first = program_.text("out/background/000000_after.png");
  EXPECT_NE(program_.run({"background", "room.yaml", "--output", "out"}).exit_code, 0);  // not without --overwrite
  ASSERT_EQ(program_.run({"background", "out/config.yaml", "--output", "again"}).exit_code, 0);
  EXPECT_TRUE(first == program_.text("again/background/000000_after.png"));
}

TEST_F(PicturesTest, BackgroundNeedsWhatTheDenseMapKeeps) {
  const Outcome outcome =
      program_.run({"background", "room.yaml", "--output", "out", "--set", "dense_map.enabled=false"});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.errors, HasSubstr("dense_map.enabled"));
}

TEST_F(PicturesTest, RunWritesOverlaysAndADenseCloudThatIsTheSameEveryTime) {
  for (const char* folder : {"one", "two"}) {
    const Outcome outcome = program_.run({"run", "room.yaml", "--output", folder, "--set", "dense_map.enabled=true",
                                          "--set", "dense_map.minimum_views=1", "--quiet"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.errors;
  }
  const std::string cloud = program_.text("one/static_map.ply");
  EXPECT_THAT(cloud.substr(0, 400), HasSubstr("property uchar red"));
  EXPECT_GT(cloud.size(), 15U * 10000U);
  EXPECT_TRUE(cloud == program_.text("two/static_map.ply"));
  for (const char* name : {"frame_000000.jpg", "frame_000007.jpg", "frame_000014.jpg"})
    EXPECT_TRUE(program_.text(std::string("one/overlay/") + name) == program_.text(std::string("two/overlay/") + name));

  const Outcome again = program_.run(
      {"run", "room.yaml", "--output", "one", "--overwrite", "--quiet", "--set", "observers.0.overlay.every=10"});
  ASSERT_EQ(again.exit_code, 0) << again.errors;
  EXPECT_FALSE(fs::exists(program_.path("one/overlay/frame_000007.jpg")));
  EXPECT_THAT(program_.text("one/static_map.ply").substr(0, 600), HasSubstr("static_log_odds"));
}

}  // namespace
}  // namespace holdfast
