// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/core/trajectory.hpp"

#include <gmock/gmock.h>
#include <sys/stat.h>

#include <fstream>
#include <limits>
#include <sstream>

#include "holdfast/core/error.hpp"
#include "holdfast/core/random.hpp"
#include "holdfast/core/stamp_unit.hpp"

namespace holdfast {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

class TrajectoryTest : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::path(::testing::TempDir()) /
              (std::string("holdfast_") + ::testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path write(const std::string& content) const {
    std::ofstream(folder_ / "trajectory.txt") << content;
    return folder_ / "trajectory.txt";
  }
  static std::string content(const std::filesystem::path& file) {
    std::stringstream text;
    text << std::ifstream(file).rdbuf();
    return text.str();
  }
  static std::string error_of(const std::filesystem::path& file) {
    try {
      read_trajectory(file);
    } catch (const InputError& error) {
      return error.what();
    }
    return "no error";
  }

  std::filesystem::path folder_;
};

TEST_F(TrajectoryTest, ReadsBlanksTabsCommentsAndWindowsLineEnds) {
  const Trajectory trajectory =
      read_trajectory(write("# timestamp tx ty tz qx qy qz qw\r\n"
                            "1.5 1 2 3 0 0 0 1\r\n"
                            "\n"
                            "2.5 +4 -5  6e-1 0 0 1 0 # a comment, of words\n"
                            "3.5\t7 8 9 1 0 0 0"));
  ASSERT_EQ(trajectory.size(), 3u);
  EXPECT_EQ(trajectory[0].timestamp, 1.5);
  EXPECT_EQ(trajectory[1].T_world_camera.translation(), Eigen::Vector3d(4.0, -5.0, 0.6));
  EXPECT_EQ(trajectory[2].T_world_camera.translation(), Eigen::Vector3d(7.0, 8.0, 9.0));
}

TEST_F(TrajectoryTest, SkipsAByteOrderMark) {
  EXPECT_EQ(read_trajectory(write("\xef\xbb\xbf"
                                  "1 0 0 0 0 0 0 1\n"))
                .size(),
            1u);
  EXPECT_EQ(read_trajectory(write("\xef\xbb\xbf# a comment\n1 0 0 0 0 0 0 1\n")).size(), 1u);
  EXPECT_EQ(read_trajectory(write("")).size(), 0u);
  EXPECT_THAT(error_of(write("\xef\xbb 1 0 0 0 0 0 0 1\n")), HasSubstr("trajectory.txt:1: found 9 columns"));
}

TEST_F(TrajectoryTest, SortsAndKeepsTheLastOfEqualStamps) {
  const Trajectory trajectory =
      read_trajectory(write("3 1 0 0 0 0 0 1\n1 2 0 0 0 0 0 1\n3 3 0 0 0 0 0 1\n2 4 0 0 0 0 0 1\n"));
  ASSERT_EQ(trajectory.size(), 3u);
  EXPECT_EQ(trajectory[0].timestamp, 1.0);
  EXPECT_EQ(trajectory[1].timestamp, 2.0);
  EXPECT_EQ(trajectory[2].timestamp, 3.0);
  EXPECT_EQ(trajectory[2].T_world_camera.translation().x(), 3.0);
}

TEST_F(TrajectoryTest, LeavesOutPosesThatAreNotFiniteAndZeroQuaternions) {
  const Trajectory trajectory =
      read_trajectory(write("1 nan 0 0 0 0 0 1\n2 0 inf 0 0 0 0 1\n3 0 0 0 NaN 0 0 1\n4 0 0 0 0 0 0 0\nnan 0 0 0 0 0 0 "
                            "1\n5 1 2 3 0 0 0 1\n"));
  ASSERT_EQ(trajectory.size(), 1u);
  EXPECT_EQ(trajectory[0].timestamp, 5.0);
}

TEST_F(TrajectoryTest, CountsWhatItLeavesOut) {
  const TrajectoryFile read = read_trajectory_file(
      write("1 nan 0 0 0 0 0 1\n2 0 inf 0 0 0 0 1\n3 0 0 0 0 0 0 0\n4 1 0 0 0 0 0 1\n4 2 0 0 0 0 0 1\n"));
  EXPECT_EQ(read.poses.size(), 1u);
  EXPECT_EQ(read.not_finite, 2u);
  EXPECT_EQ(read.zero_quaternions, 1u);
  EXPECT_EQ(read.repeated_stamps, 1u);
  EXPECT_EQ(read.omissions(),
            "2 poses that are not finite, 1 pose with a zero quaternion, 1 pose with the stamp of a later line");
  EXPECT_EQ(read_trajectory_file(write("1 0 0 0 0 0 0 1\n")).omissions(), "");
}

TEST_F(TrajectoryTest, NormalisesQuaternions) {
  const Trajectory trajectory = read_trajectory(write("1 0 0 0 0 0 0.71 0.71\n"));
  ASSERT_EQ(trajectory.size(), 1u);
  const Eigen::Vector3d turned = trajectory[0].T_world_camera.linear() * Eigen::Vector3d::UnitX();
  EXPECT_NEAR((turned - Eigen::Vector3d::UnitY()).norm(), 0.0, 1e-15);
}

TEST_F(TrajectoryTest, RefusesColumnsThatAreNoRotation) {
  const auto tum = [&](const char* quaternion) {
    return error_of(write(std::string("1 0 0 0 0 0 0 1\n2 1 2 3 ") + quaternion + "\n"));
  };
  const auto refused = [](const char* length) {
    return AllOf(HasSubstr("trajectory.txt:2: found four numbers of length " + std::string(length)),
                 HasSubstr("unit quaternion"), HasSubstr("Euler angles"), HasSubstr("expected TUM format"));
  };
  EXPECT_THAT(tum("1.2 1.3 1.4 1.3"), refused("2.604"));
  EXPECT_THAT(tum("0 0 90 1"), refused("90.006"));
  EXPECT_THAT(tum("0.1 0.2 0.3 0"), refused("0.374"));
  EXPECT_THAT(tum("0 0 0 1.03"), refused("1.030"));
  EXPECT_THAT(tum("0 0 0 -0.001"), refused("0.001000"));
  // As printed with two decimals, as sums of many rotations drift, with either sign, and without a rotation.
  for (const char* right : {"0.27 0.53 0.80 0.05", "0 0 0 1.001", "0 0 0 -1", "0 0 0 0", "nan 0 0 1", "0.71 0 0 0.71"})
    EXPECT_EQ(tum(right), "no error") << right;

  const auto kitti = [&](const char* matrix) -> std::string {
    try {
      const auto file = write(std::string("1 0 0 4 0 1 0 5 0 0 1 6\n") + matrix + "\n");
      return std::to_string(read_trajectory_file(file, {.format = std::nullopt, .stamps = {}}).poses.size());
    } catch (const InputError& error) {
      return error.what();
    }
  };
  EXPECT_THAT(
      kitti("1000 0 0 4 0 1000 0 5 0 0 1000 6"),
      AllOf(HasSubstr("trajectory.txt:2: found a rotation matrix that is scaled by 1000"), HasSubstr("divide")));
  EXPECT_THAT(kitti("1 0 0 4 0 -1 0 5 0 0 1 6"), AllOf(HasSubstr("mirrors"), HasSubstr("left-handed")));
  EXPECT_THAT(kitti("1 0 0 4 0 1 0 5 0 0.5 1 6"), HasSubstr("no rotation"));
  EXPECT_THAT(kitti("1 0 0 0 1 0 0 0 1 4 5 6"), HasSubstr("no rotation"));
  EXPECT_EQ(kitti("0.99 -0.12 0.03 4 0.12 0.99 0 5 -0.03 0 1 6"), "2");
  EXPECT_EQ(kitti("0 0 0 4 0 0 0 5 0 0 0 6"), "1") << "a pose without a rotation is left out";
}

TEST_F(TrajectoryTest, NamesStampsInMicroseconds) {
  // They have as many digits as no clock in seconds, but must not be taken for nanoseconds.
  for (const char* line : {"1403636580838555.0 1 2 3 0 0 0 1\n", "1403636580838555 1 2 3 0 0 0 1\n"})
    EXPECT_THAT(error_of(write(line)),
                AllOf(HasSubstr("trajectory.txt:1"), HasSubstr("stamps look like microseconds: divide them by 1e6")));
}

TEST(StampUnit, IsRecognisedByTheIntervalOrTheMagnitude) {
  const auto suspicion = [](double begin, double interval) {
    std::vector<double> stamps;
    for (int i = 0; i < 20; ++i) stamps.push_back(begin + interval * i + (i % 3 == 0 ? 0.01 * interval : 0.0));
    return stamp_unit_suspicion(stamps);
  };
  // Cameras, IMUs, motion capture, a truth at 1 Hz and a time-lapse, with clocks that began now or in 1970.
  for (const double begin : {0.0, 12.5, 1305031102.175304})
    for (const double interval : {0.0005, 0.01, 1.0 / 30.0, 0.1, 1.0, 4.5}) EXPECT_EQ(suspicion(begin, interval), "");
  EXPECT_THAT(suspicion(0.0, 33.4), HasSubstr("look like milliseconds (33.4"));
  EXPECT_THAT(suspicion(0.0, 33.4), HasSubstr("divide them by 1000"));
  EXPECT_THAT(suspicion(7.0, 33333.3), HasSubstr("microseconds"));
  EXPECT_THAT(suspicion(7.0, 3000.0), HasSubstr("ticks of 90 kHz"));
  EXPECT_THAT(suspicion(7.0, 333333.0), HasSubstr("ticks of 100 ns"));
  EXPECT_THAT(suspicion(7.0, 3.3e7), HasSubstr("nanoseconds"));
  EXPECT_THAT(suspicion(1305031102175.0, 33.0), HasSubstr("milliseconds: divide them by 1000"));
  EXPECT_THAT(suspicion(1305031102175304.0, 33e3), HasSubstr("microseconds: divide them by 1e6"));
  EXPECT_THAT(suspicion(1305031102175304000.0, 33e6), HasSubstr("nanoseconds: divide them by 1e9"));
  EXPECT_THAT(suspicion(1305031.1, 33e-6), HasSubstr("rise too slowly for seconds"));
  EXPECT_THAT(stamp_unit_suspicion(std::vector<double>{0, 1, 2, 3, 4, 6}), HasSubstr("frame numbers"));
  EXPECT_THAT(stamp_unit_suspicion(std::vector<double>{0, 33, 66, 100}), HasSubstr("milliseconds or frame numbers"));
  EXPECT_EQ(stamp_unit_suspicion(std::vector<double>{1305031102, 1305031103, 1305031104}), "");
  EXPECT_EQ(stamp_unit_suspicion(std::vector<double>{0, 33}), "");
}

TEST_F(TrajectoryTest, NamesTheLineOfAnError) {
  const std::string message = error_of(write("# head\n1 0 0 0 0 0 0 1\n2 0 0 zero 0 0 0 1\n"));
  EXPECT_THAT(message, HasSubstr("trajectory.txt:3: found 8 columns, '2 0 0 zero"));
  EXPECT_THAT(message, HasSubstr("expected TUM format (t tx ty tz qx qy qz qw, t in seconds, separated by blanks)"));
  EXPECT_THAT(error_of(write("1 0 0 0 0 0 0\n")), HasSubstr("trajectory.txt:1:"));
}

TEST_F(TrajectoryTest, RefusesOtherFormatsByName) {
  EXPECT_THAT(error_of(write("1 0 0 0 0 1 0 0 0 0 1 0\n")),
              AllOf(HasSubstr("trajectory.txt:1: found 12 columns"), HasSubstr("KITTI's format")));
  const char* euroc = "it looks like EuRoC's format (stamps in nanoseconds";
  EXPECT_THAT(error_of(write("#timestamp,x,y,z\n1403636580838555648,4.6,-1.7,0.7,0.5,-0.1,-0.8,-0.1\n")),
              AllOf(HasSubstr("trajectory.txt:2: found 8 columns"), HasSubstr(euroc)));
  EXPECT_THAT(error_of(write("1403636580838555648,4.6,-1.7,0.7,0.5,-0.1,-0.8,-0.1,0,0,0,0,0,0,0,0,0\n")),
              AllOf(HasSubstr("found 17 columns"), HasSubstr(euroc)));
  EXPECT_THAT(error_of(write("timestamp,tx,ty,tz,qx,qy,qz,qw\n1,0,0,0,0,0,0,1\n")),
              AllOf(HasSubstr("trajectory.txt:1: found 8 columns, 'timestamp,tx"), HasSubstr("expected TUM format")));
  EXPECT_THAT(error_of(write("1 0 0 0 0 0 0 1 0.5\n")), HasSubstr("found 9 columns"));
  EXPECT_THAT(error_of(write("1 0 0 0 0 0 0 1 further words\n")), HasSubstr("found 10 columns"));
}

/// Eight numbers do not show whether the quaternion begins or ends with its real part.
TEST_F(TrajectoryTest, RefusesWhatMayHaveTheRealPartElsewhere) {
  const auto error_of_any = [&](const std::string& content) -> std::string {
    try {
      read_trajectory_file(write(content), {.format = std::nullopt, .stamps = {}});
    } catch (const InputError& error) {
      return error.what();
    }
    return "no error";
  };
  for (const char* rows : {"100.5,1,2,3,1,0,0,0\n", "100.5, 1, 2, 3, 1, 0, 0, 0\n"}) {
    const auto refused = AllOf(HasSubstr("trajectory.txt:1: found '100.5,"), HasSubstr("as in EuRoC's format"),
                               HasSubstr("replace the commas by blanks"), HasSubstr("expected TUM format"));
    EXPECT_THAT(error_of(write(rows)), refused);
    EXPECT_THAT(error_of_any(rows), refused);
  }
  const auto header = HasSubstr("a comment above says that the quaternion begins with qw");
  EXPECT_THAT(error_of_any("# timestamp tx ty tz qw qx qy qz\n100.5 1 2 3 1 0 0 0\n"), header);
  EXPECT_THAT(error_of_any("#timestamp, p_x [m], q_w [], q_x []\n100.5 1 2 3 1 0 0 0\n"), header);
  EXPECT_EQ(error_of_any("# timestamp tx ty tz qx qy qz qw\n100.5 1 2 3 0 0 0 1\n"), "no error");
  // As ORB-SLAM3 writes the poses of EuRoC's recordings.
  const std::string orb_slam3 = "1403636580838555648.000000 4.6 -1.7 0.7 0.0 0.0 0.0 1.0\n";
  EXPECT_THAT(error_of_any(orb_slam3), AllOf(HasSubstr("ORB-SLAM3"), HasSubstr("divide their stamps by 1e9")));
  EXPECT_EQ(error_of_any("# t qw qx qy qz\n" + orb_slam3), "no error");
  EXPECT_EQ(read_trajectory_file(write(orb_slam3), {.format = TrajectoryFormat::euroc, .stamps = {}}).poses.size(), 1U);
  // A column without a number would move the others.
  EXPECT_THAT(error_of_any("1403636580838555648,4.6,,-1.7,0.7,0.5,-0.1,-0.8,-0.1\n"), HasSubstr("found 9 columns"));
}

TEST_F(TrajectoryTest, EveryFormatIsRecognisedAndGivesThePosesBack) {
  Trajectory trajectory;
  for (int i = 0; i < 5; ++i) {
    TimedPose pose;
    pose.timestamp = 1403636580.25 + 0.1 * i;
    pose.T_world_camera = Eigen::Translation3d(0.1 * i, -1.5, 2.0) *
                          Eigen::AngleAxisd(0.3 * i + 0.1, Eigen::Vector3d(1, 2, -1).normalized());
    trajectory.push_back(pose);
  }
  std::vector<double> stamps;
  for (const TimedPose& pose : trajectory) stamps.push_back(pose.timestamp);
  for (const TrajectoryFormat format : {TrajectoryFormat::tum, TrajectoryFormat::kitti, TrajectoryFormat::euroc}) {
    const std::filesystem::path file = write(trajectory_text(trajectory, format));
    const TrajectoryFile read = read_trajectory_file(file, {.format = std::nullopt, .stamps = stamps});
    EXPECT_EQ(read.format, format);
    EXPECT_EQ(find_trajectory_format(trajectory_format_name(format)), format);
    ASSERT_EQ(read.poses.size(), trajectory.size()) << trajectory_format_name(format);
    for (std::size_t i = 0; i < trajectory.size(); ++i) {
      EXPECT_NEAR(read.poses[i].timestamp, trajectory[i].timestamp, 1e-6);
      EXPECT_LT((read.poses[i].T_world_camera.matrix() - trajectory[i].T_world_camera.matrix()).norm(), 1e-7);
    }
  }
}

TEST_F(TrajectoryTest, PosesWithoutStampsGetThem) {
  const std::filesystem::path file = write("1 0 0 5 0 1 0 6 0 0 1 7\n1 0 0 8 0 1 0 6 0 0 1 7\n");
  const TrajectoryReading kitti{.format = TrajectoryFormat::kitti, .stamps = {}};
  const Trajectory poses = read_trajectory_file(file, kitti).poses;
  ASSERT_EQ(poses.size(), 2u);
  EXPECT_EQ(poses[1].timestamp, 0.1);
  EXPECT_EQ(poses[1].T_world_camera.translation(), Eigen::Vector3d(8, 6, 7));
  for (const std::vector<double>& stamps : {std::vector<double>{1.0}, std::vector<double>{1.0, 2.0, 3.0}}) {
    try {
      read_trajectory_file(file, {.format = TrajectoryFormat::kitti, .stamps = stamps});
      ADD_FAILURE();
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr("expected one stamp for each pose"));
    }
  }
  EXPECT_THAT(error_of(file), HasSubstr("it looks like KITTI's format"));
}

TEST_F(TrajectoryTest, NamesAFileThatIsMissingOrAFolder) {
  EXPECT_THAT(error_of(folder_ / "absent.txt"), HasSubstr("absent.txt: no such file"));
  EXPECT_THAT(error_of(folder_), HasSubstr("found a folder"));
}

TEST_F(TrajectoryTest, WritesStampsWithSixAndValuesWithNineDecimals) {
  TimedPose pose;
  pose.timestamp = 1305031102.1753040;
  pose.T_world_camera = Eigen::Translation3d(1.0, -0.25, 1e-9) * Eigen::Quaterniond(-0.6, 0.0, 0.8, 0.0);
  write_trajectory(folder_ / "out.txt", {pose});
  EXPECT_EQ(
      content(folder_ / "out.txt"),
      std::string(trajectory_header) +
          "1305031102.175304 1.000000000 -0.250000000 0.000000001 0.000000000 -0.800000000 0.000000000 0.600000000\n");
}

TEST_F(TrajectoryTest, WhatIsRoundedToZeroHasNoSign) {
  TimedPose pose;
  pose.T_world_camera = Eigen::Translation3d(-0.0, -1e-12, -6e-10) * Eigen::Quaterniond(1.0, -0.0, -1e-11, 0.0);
  EXPECT_EQ(pose_text(pose),
            "0.000000 0.000000000 0.000000000 -0.000000001 0.000000000 0.000000000 0.000000000 1.000000000\n");
}

TEST_F(TrajectoryTest, BeginsWithACommentThatNamesTheColumns) {
  const std::string text = trajectory_text({});
  EXPECT_EQ(text, trajectory_header);
  EXPECT_EQ(text.front(), '#');
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 1);
}

TEST_F(TrajectoryTest, RefusesANamedPipe) {
  ASSERT_EQ(mkfifo((folder_ / "pipe").c_str(), 0600), 0);
  EXPECT_THAT(error_of(folder_ / "pipe"), HasSubstr("pipe: found a named pipe"));
}

TEST_F(TrajectoryTest, ReadsWhatItWrote) {
  Random random(7);
  Trajectory trajectory;
  for (int i = 0; i < 50; ++i) {
    TimedPose pose;
    pose.timestamp = 1.3e9 + i / 30.0;
    const Eigen::Quaterniond rotation{random.normal(), random.normal(), random.normal(), random.normal()};
    pose.T_world_camera =
        Eigen::Translation3d{random.normal(), random.normal(), random.normal()} * rotation.normalized();
    trajectory.push_back(pose);
  }
  write_trajectory(folder_ / "out.txt", trajectory);
  const Trajectory again = read_trajectory(folder_ / "out.txt");
  ASSERT_EQ(again.size(), trajectory.size());
  for (std::size_t i = 0; i < again.size(); ++i) {
    EXPECT_NEAR(again[i].timestamp, trajectory[i].timestamp, 1e-6);
    EXPECT_TRUE(again[i].T_world_camera.matrix().isApprox(trajectory[i].T_world_camera.matrix(), 1e-8));
  }
}

TEST_F(TrajectoryTest, ReplacesAFileWithoutLeavingATemporaryOne) {
  write_file_atomically(write("old"), "new");
  EXPECT_EQ(content(folder_ / "trajectory.txt"), "new");
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_), {}), 1);
  EXPECT_THROW(write_file_atomically(folder_ / "absent" / "file.txt", "text"), InputError);
}

TEST(Trajectory, CleaningSortsAndDropsWhatIsNotFinite) {
  Trajectory trajectory(4);
  trajectory[0].timestamp = 2.0;
  trajectory[1].timestamp = std::numeric_limits<double>::quiet_NaN();
  trajectory[2].timestamp = 1.0;
  trajectory[3].timestamp = 3.0;
  trajectory[3].T_world_camera.translation().y() = std::numeric_limits<double>::infinity();
  const Trajectory clean = sort_and_clean(trajectory);
  ASSERT_EQ(clean.size(), 2u);
  EXPECT_EQ(clean[0].timestamp, 1.0);
  EXPECT_EQ(clean[1].timestamp, 2.0);
}

}  // namespace
}  // namespace holdfast
