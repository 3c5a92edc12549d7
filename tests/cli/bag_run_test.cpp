// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgcodecs.hpp>

#include "cli/program.hpp"
#include "support/bag_writer.hpp"

namespace holdfast {
namespace {

std::uint64_t nanoseconds(const std::string& stamp) {
  return static_cast<std::uint64_t>(std::llround(std::stod(stamp) * 1e6)) * 1000;
}

/// A recording in TUM layout as a bag of the TUM benchmark has it: depth in metres, 32 bits.
template <class Writer, class ImageMessage>
std::string bag_of(const test::Program& program, const std::string& folder, Writer bag, const std::string& type,
                   const ImageMessage& image_message) {
  std::istringstream pairs(program.text(folder + "/associations.txt"));
  std::string colour_stamp, colour, depth_stamp, depth;
  while (pairs >> colour_stamp >> colour >> depth_stamp >> depth) {
    const cv::Mat units = cv::imread(program.path(folder + "/" + depth).string(), cv::IMREAD_UNCHANGED);
    cv::Mat metres(units.size(), CV_32FC1);
    for (int y = 0; y < units.rows; ++y)
      for (int x = 0; x < units.cols; ++x) {
        const auto value = static_cast<float>(units.at<std::uint16_t>(y, x));
        metres.at<float>(y, x) = value == 0.0F ? std::nanf("") : value / 5000.0F;
      }
    bag.add("/camera/depth/image", type, nanoseconds(depth_stamp),
            image_message(nanoseconds(depth_stamp), "32FC1", metres));
    bag.add("/camera/rgb/image_color", type, nanoseconds(colour_stamp) + 1'000'000,
            image_message(nanoseconds(colour_stamp), "bgr8", cv::imread(program.path(folder + "/" + colour).string())));
  }
  return bag.finish();
}

TEST(BagRunTest, ARunOnABagIsTheRunOnTheFolder) {
  const test::Program program;
  const auto run = [&](const std::vector<std::string>& words) {
    const test::Outcome outcome = program.run(words);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  };
  run({"simulate", "--duration", "1", "--output", "folder", "--quiet"});
  const auto ros1 = [](auto... fields) { return test::image_message(fields...); };
  program.write("recording.bag", bag_of(program, "folder", test::BagWriter("lz4", 4), "sensor_msgs/Image", ros1));
  program.write("recording.mcap",
                bag_of(program, "folder", test::McapWriter(), "sensor_msgs/msg/Image", &test::cdr_image_message));
  // The folder says that its rows are exposed at once, which a bag cannot.
  const std::string rest = "camera: tum_fr1\nfeatures: orb\noptimizer: schur\ntracking: { rolling_shutter: off }\n";
  program.write("folder.yaml", "source: { tum: { path: folder } }\n" + rest);
  program.write("bag.yaml", "source: { rosbag: { path: recording.bag } }\n" + rest);
  run({"run", "folder.yaml", "--output", "out_folder", "--quiet"});
  run({"run", "bag.yaml", "--output", "out_bag", "--quiet"});
  EXPECT_FALSE(program.text("out_bag/trajectory.txt").empty());
  EXPECT_EQ(program.text("out_bag/trajectory.txt"), program.text("out_folder/trajectory.txt"));
  EXPECT_EQ(program.text("out_bag/map.hfm"), program.text("out_folder/map.hfm"));
  run({"run", "bag.yaml", "--set", "source.rosbag.path=recording.mcap", "--output", "out_mcap", "--quiet"});
  EXPECT_EQ(program.text("out_mcap/trajectory.txt"), program.text("out_folder/trajectory.txt"));
  EXPECT_EQ(program.text("out_mcap/map.hfm"), program.text("out_folder/map.hfm"));

  // What is recorded of the bag is the folder again.
  run({"record", "bag.yaml", "--output", "again", "--quiet"});
  EXPECT_EQ(program.text("again/rgb.txt"), program.text("folder/rgb.txt"));
  EXPECT_EQ(program.text("again/depth.txt"), program.text("folder/depth.txt"));
  run({"run", "again/recording.yaml", "--output", "out_again", "--quiet"});
  EXPECT_EQ(program.text("out_again/trajectory.txt"), program.text("out_folder/trajectory.txt"));
}

// The folder has depth in a fifth of a millimetre, which a bag has as 32FC1, and a global shutter.
TEST(BagRunTest, ARunOnARecordedBagIsTheRunOnItsSource) {
  const test::Program program;
  const auto run = [&](const std::vector<std::string>& words) {
    const test::Outcome outcome = program.run(words);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  };
  run({"simulate", "--duration", "0.4", "--output", "folder", "--quiet"});
  program.write("folder.yaml",
                "source: { tum: { path: folder, associations: folder/associations.txt } }\ncamera: tum_fr1\n"
                "features: orb\noptimizer: schur\nfilters: [multi_view_depth]\n");
  run({"record", "folder.yaml", "--bag", "recording.mcap", "--quiet"});
  run({"run", "folder.yaml", "--output", "out_folder", "--quiet"});
  // With what lies beside it, the bag can be moved.
  std::filesystem::create_directory(program.path("elsewhere"));
  for (const char* name : {"recording.mcap", "recording.yaml", "recording.truth.txt"})
    std::filesystem::rename(program.path(name), program.path(std::string("elsewhere/") + name));
  run({"run", "elsewhere/recording.yaml", "--output", "out_bag", "--quiet"});
  EXPECT_FALSE(program.text("out_bag/trajectory.txt").empty());
  EXPECT_EQ(program.text("out_bag/trajectory.txt"), program.text("out_folder/trajectory.txt"));
  EXPECT_EQ(program.text("out_bag/map.hfm"), program.text("out_folder/map.hfm"));
  EXPECT_EQ(program.text("out_bag/evaluation.json").empty(), program.text("out_folder/evaluation.json").empty());
  EXPECT_FALSE(program.text("out_bag/evaluation.json").empty());

  const test::Outcome again = program.run({"record", "folder.yaml", "--bag", "elsewhere/recording.mcap"});
  EXPECT_EQ(again.exit_code, 1);
  EXPECT_THAT(again.errors, testing::HasSubstr("recording.mcap: is there already"));
  EXPECT_EQ(program.run({"record", "folder.yaml"}).exit_code, 2);
  EXPECT_THAT(program.run({"record", "folder.yaml", "--bag", "recording.bag"}).errors,
              testing::HasSubstr("expected a name that ends with .mcap"));
}

TEST(BagRunTest, ARunOnARecordedPairIsTheRunOnItsSource) {
  const test::Program program;
  const auto run = [&](const std::vector<std::string>& words) {
    const test::Outcome outcome = program.run(words);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  };
  const std::string modules = "features: orb\noptimizer: schur\n";
  for (const std::string imu : {"imu: { name: bmi055 }\n", ""}) {
    program.write("pair.yaml",
                  "source: { simulated: { duration: 0.3, stereo_baseline: 0.12 } }\n"
                  "camera: { width: 320, height: 240, fx: 260, fy: 260, cx: 160, cy: 120 }\n" +
                      modules + imu);
    run({"record", "pair.yaml", "--bag", "recording.mcap", "--quiet", "--overwrite"});
    run({"run", "pair.yaml", "--output", "out_pair", "--quiet", "--overwrite"});
    run({"run", "recording.yaml", "--output", "out_bag", "--quiet", "--overwrite"});
    EXPECT_FALSE(program.text("out_bag/trajectory.txt").empty());
    EXPECT_EQ(program.text("out_bag/trajectory.txt"), program.text("out_pair/trajectory.txt"));
    EXPECT_EQ(program.text("out_bag/map.hfm"), program.text("out_pair/map.hfm"));
  }
  // The bag alone: the baseline is in its camera_info.
  program.write("bag.yaml",
                "source: { rosbag: { path: recording.mcap, right: /stereo/right/image_rect_color } }\n"
                "camera: auto\ntracking: { rolling_shutter: off }\n" +
                    modules);
  run({"run", "bag.yaml", "--output", "out_alone", "--quiet"});
  EXPECT_EQ(program.text("out_alone/trajectory.txt"), program.text("out_pair/trajectory.txt"));
}

constexpr const char* office =
    "source: { simulated: { duration: 0.2 } }\ncamera: { width: 160, height: 120, fx: 130, fy: 130, cx: 80, cy: 60 }\n"
    "features: orb\noptimizer: schur\n";

TEST(BagRunTest, WhatARecordingReadsIsNeverReplaced) {
  const test::Program program;
  const auto refused = [&](const std::vector<std::string>& arguments, const std::string& expected) {
    const test::Outcome outcome = program.run(arguments);
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_THAT(outcome.errors, testing::HasSubstr(expected));
    EXPECT_THAT(outcome.errors, testing::Not(testing::HasSubstr("--overwrite")));
  };
  program.write("office.yaml", office);
  for (const char* bag : {"office.mcap", "./office.mcap"}) {
    refused({"record", "office.yaml", "--bag", bag}, "office.yaml: is the configuration of this recording");
    refused({"record", "office.yaml", "--bag", bag, "--overwrite"}, "name another bag");
  }
  EXPECT_EQ(program.text("office.yaml"), office);
  ASSERT_EQ(program.run({"record", "office.yaml", "--bag", "bag/first.mcap", "--quiet"}).exit_code, 0);
  const std::string before = program.text("bag/first.mcap");
  for (const char* path : {"bag/first.mcap", "bag"}) {
    program.write("again.yaml",
                  std::string("source: { rosbag: { path: ") + path + " } }\nfeatures: orb\noptimizer: schur\n");
    refused({"record", "again.yaml", "--bag", "bag/first.mcap", "--overwrite"}, "is a file of the source");
  }
  EXPECT_TRUE(program.text("bag/first.mcap") == before);
}

TEST(BagRunTest, NegativeTimesAreShifted) {
  const test::Program program;
  program.write("office.yaml", office);
  ASSERT_EQ(program.run({"record", "office.yaml", "--output", "folder", "--quiet"}).exit_code, 0);
  const std::string pairs = program.text("folder/associations.txt");
  program.write("folder/associations.txt",  // the depth before time 0, and before the colour
                "0.010000 rgb/0.000000.png -0.005000 depth/0.000000.png\n" + pairs.substr(pairs.find('\n') + 1));
  test::Outcome outcome = program.run({"record", "folder/recording.yaml", "--bag", "bag.mcap"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_THAT(outcome.errors, testing::HasSubstr("all time stamps are 1 second later than those of the source"));
  EXPECT_THAT(program.text("bag.yaml"), testing::StartsWith("# all time stamps are 1 second later"));
  EXPECT_THAT(program.text("bag.truth.txt"), testing::HasSubstr("\n1.0"));
  outcome = program.run({"run", "bag.yaml", "--output", "out", "--quiet"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_THAT(program.text("out/trajectory.txt"), testing::HasSubstr("\n1.010000 "));
  EXPECT_FALSE(program.text("out/evaluation.json").empty());
}

}  // namespace
}  // namespace holdfast
