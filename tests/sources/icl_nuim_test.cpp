// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <cstdio>

#include "holdfast/core/camera.hpp"
#include "recording.hpp"

namespace holdfast {
namespace {

using test::input_error;
using test::read_all;
using ::testing::AllOf;
using ::testing::HasSubstr;

/// The published pose of frame i: of a camera with y up, in a left-handed world.
Eigen::Isometry3d published_pose(int i) {
  return Eigen::Translation3d(0.3 * i, 1.2 - 0.1 * i, -2.0) *
         Eigen::AngleAxisd(0.2 + 0.1 * i, Eigen::Vector3d(0.3, -0.8, 0.4).normalized());
}

/// Frames 1 to 4 as the archives have them: the depth image first, numbers in place of stamps.
class IclNuimTest : public ::testing::Test {
 protected:
  IclNuimTest() {
    std::string list, truth;
    for (int i = 1; i <= 4; ++i) {
      const std::string name = std::to_string(i) + ".png";
      folder_.write_image("rgb/" + name, test::colour_image(i));
      folder_.write_image("depth/" + name, test::depth_image(i));
      list += std::to_string(i) + " depth/" + name + " " + std::to_string(i) + " rgb/" + name + "\n";
      const Eigen::Isometry3d pose = published_pose(i);
      const Eigen::Quaterniond q(pose.rotation());
      const Eigen::Vector3d p = pose.translation();
      char line[300];
      std::snprintf(line, sizeof(line), "%d %.12f %.12f %.12f %.12f %.12f %.12f %.12f\n", i, p.x(), p.y(), p.z(), q.x(),
                    q.y(), q.z(), q.w());
      truth += line;
    }
    folder_.write("associations.txt", list);
    folder_.write("livingRoom0.gt.freiburg", truth);
  }
  std::unique_ptr<FrameSource> open(ParameterValues values = {}) const {
    values["path"] = folder_.path().string();
    return test::make_source("icl_nuim", values);
  }

  test::TemporaryFolder folder_;
};

TEST_F(IclNuimTest, ReadsPairsWithTheDepthImageListedFirst) {
  const auto source = open();
  EXPECT_TRUE(source->describe().has_depth);
  EXPECT_EQ(source->describe().frame_count, 4U);
  const std::vector<SensorFrame> frames = read_all(*source);
  ASSERT_EQ(frames.size(), 4U);
  for (int i = 0; i < 4; ++i) {
    const SensorFrame& frame = frames[static_cast<std::size_t>(i)];
    EXPECT_DOUBLE_EQ(frame.timestamp, (i + 1) / 30.0);
    EXPECT_EQ(frame.depth_delay, 0.0);
    EXPECT_EQ(frame.colour.at<cv::Vec3b>(10, 10)[0], 40 + i + 1);
    EXPECT_EQ(frame.depth.at<float>(20, 30), static_cast<float>((100 * (i + 1) + 64 * 20 + 30) / 5000.0));
  }
  const auto some = open({{"start", std::int64_t{1}}, {"frames", std::int64_t{2}}, {"frame_rate", 10.0}});
  const std::vector<SensorFrame> chosen = read_all(*some);
  ASSERT_EQ(chosen.size(), 2U);
  EXPECT_DOUBLE_EQ(chosen[0].timestamp, 0.2);
}

/// A point of the room has the same pixel by the published pose with fy = -480 and by the truth of the source with
/// fy = 480.
TEST_F(IclNuimTest, TheTruthIsThatOfACameraWithPositiveFocalLengths) {
  const Trajectory truth = open()->truth();
  ASSERT_EQ(truth.size(), 4U);
  const Camera camera = *find_camera("icl_nuim");
  EXPECT_EQ(camera.fy, 480.0);
  for (int i = 1; i <= 4; ++i) {
    const TimedPose& pose = truth[static_cast<std::size_t>(i - 1)];
    EXPECT_DOUBLE_EQ(pose.timestamp, i / 30.0);
    EXPECT_NEAR(pose.T_world_camera.rotation().determinant(), 1.0, 1e-9);
    for (const Eigen::Vector3d& seen : {Eigen::Vector3d(0.4, 0.7, 2.0), Eigen::Vector3d(-0.5, -0.2, 3.0)}) {
      const Eigen::Vector3d room = published_pose(i) * seen;
      const Eigen::Vector3d ours = pose.T_world_camera.inverse() * Eigen::Vector3d(room.x(), -room.y(), room.z());
      EXPECT_NEAR(camera.fx * ours.x() / ours.z(), camera.fx * seen.x() / seen.z(), 1e-6);
      EXPECT_NEAR(camera.fy * ours.y() / ours.z(), -480.0 * seen.y() / seen.z(), 1e-6);
      EXPECT_NEAR(ours.z(), seen.z(), 1e-9);
    }
  }
}

TEST_F(IclNuimTest, SaysWhatIsWrong) {
  folder_.write("livingRoom0n.gt.freiburg", "1 0 0 0 0 0 0 1\n");
  EXPECT_THAT(input_error([&] { open(); }), AllOf(HasSubstr("has 2 files of true poses"), HasSubstr("`truth`")));
  EXPECT_EQ(open({{"truth", (folder_.path() / "livingRoom0n.gt.freiburg").string()}})->truth().size(), 1U);
  std::filesystem::remove(folder_.path() / "livingRoom0n.gt.freiburg");
  std::filesystem::remove(folder_.path() / "livingRoom0.gt.freiburg");
  EXPECT_THAT(input_error([&] { open(); }), HasSubstr("has no file NAME.gt.freiburg"));
  std::filesystem::remove(folder_.path() / "associations.txt");
  EXPECT_THAT(input_error([&] { open(); }), HasSubstr("associations.txt: is missing"));
}

}  // namespace
}  // namespace holdfast
