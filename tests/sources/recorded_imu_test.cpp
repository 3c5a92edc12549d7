// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/image_files/recorded_imu.hpp"

#include <gmock/gmock.h>

#include <cstdlib>

#include "holdfast/core/imu_plausibility.hpp"
#include "sources/recording.hpp"

namespace holdfast {
namespace {

using test::input_error;
using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

class RecordedImuTest : public testing::Test {
 protected:
  std::vector<ImuSample> read(const std::string& text) const { return read_imu_samples(folder_.write("i.csv", text)); }
  std::string error(const std::string& text) const {
    return input_error([&] { read(text); });
  }
  /// A resting sensor from `begin` to `end` [s], 100 times a second.
  static std::string resting(double begin, double end, const std::string& header = imu_header) {
    std::string text = header;
    for (int i = 0; begin + 0.01 * i < end; ++i)
      text += imu_sample_text({begin + 0.01 * i, {0, 0, 0.01}, {0, 0, standard_gravity}});
    return text;
  }
  std::unique_ptr<FrameSource> open(ParameterValues values = {}) const {
    values["path"] = folder_.path().string();
    return test::make_source("tum", values);
  }

  test::TemporaryFolder folder_;
};

TEST_F(RecordedImuTest, ReadsSecondsAndNanosecondsWithCommasOrBlanks) {
  const std::vector<ImuSample> seconds =
      read("# t w a\n1403715273.5 0.1 0.2 0.3 1 2 3\n\n1403715273.6,-1e-1,0,0,1,2,-9.81\r\n");
  ASSERT_THAT(seconds, SizeIs(2));
  EXPECT_EQ(seconds[0].timestamp, 1403715273.5);
  EXPECT_EQ(seconds[0].angular_velocity, Eigen::Vector3d(0.1, 0.2, 0.3));
  EXPECT_EQ(seconds[1].acceleration, Eigen::Vector3d(1, 2, -9.81));
  const std::vector<ImuSample> named = read("\"timestamp\",wx,wy,wz,ax,ay,az\n1403715273262142976,0,0,0,1,2,3\n");
  ASSERT_THAT(named, SizeIs(1));
  EXPECT_NEAR(named[0].timestamp, 1403715273.262142976, 1e-6);
}

TEST_F(RecordedImuTest, ReadsWhatIsWritten) {
  const ImuSample sample{1403715273.2621429, {1.0 / 3.0, -2e-7, 5}, {9.80665, 1e-300, -0.1}};
  EXPECT_EQ(read(imu_header + imu_sample_text(sample)), std::vector<ImuSample>{sample});
}

TEST_F(RecordedImuTest, ErrorsNameTheLine) {
  const std::string good = "1 0 0 0 0 0 9.8\n";
  EXPECT_THAT(error(good + "2 0 0 0 0 0\n"), AllOf(HasSubstr("i.csv:2"), HasSubstr("found 6 values")));
  EXPECT_THAT(error(good + "2 0 0 x 0 0 9\n"), AllOf(HasSubstr("i.csv:2"), HasSubstr("found 'x'")));
  EXPECT_THAT(error(good + "2 0 0 nan 0 0 9\n"), AllOf(HasSubstr("i.csv:2"), HasSubstr("found 'nan'")));
  EXPECT_THAT(error(good + "3 0 0 0 0 0 9\n2 0 0 0 0 0 9\n"), AllOf(HasSubstr("i.csv:3"), HasSubstr("not later")));
  EXPECT_THAT(error(good + good), AllOf(HasSubstr("i.csv:2"), HasSubstr("same stamp")));
  EXPECT_THAT(error("1403715273262 0 0 0 0 0 9\n"), HasSubstr("milliseconds"));
  EXPECT_THAT(error("timestamp,ax,ay,az,wx,wy,wz\n" + good), HasSubstr("exchange the columns"));
  EXPECT_THAT(error("timestamp,acc_x,acc_y,acc_z,wx,wy,wz\n" + good), HasSubstr("exchange the columns"));
  EXPECT_THAT(error("# nothing\n"), HasSubstr("holds no inertial measurements"));
}

TEST_F(RecordedImuTest, FramesOfATumRecordingHaveTheSamplesSinceTheLast) {
  test::write_tum_recording(folder_, 5);  // from 100.0 to 100.4 s
  EXPECT_FALSE(open()->describe().has_imu);
  EXPECT_THAT(open()->next()->imu, IsEmpty());
  folder_.write("imu.csv", resting(99.995, 101));
  const auto source = open();
  EXPECT_TRUE(source->describe().has_imu) << "Holdfast wrote it";
  EXPECT_FALSE(source->describe().imu) << "without the section `imu`";
  const std::vector<SensorFrame> frames = test::read_all(*source);
  ASSERT_THAT(frames, SizeIs(5));
  EXPECT_THAT(frames[0].imu, SizeIs(2));
  EXPECT_THAT(frames[3].imu, SizeIs(12));
  EXPECT_NEAR(frames[3].imu.front().timestamp, 100.195, 1e-9);
  EXPECT_NEAR(frames[3].imu.back().timestamp, 100.305, 1e-9);
  EXPECT_THAT(source->warnings(), IsEmpty());
}

TEST_F(RecordedImuTest, AFileOfAnotherProgramIsReadWhereItIsNamed) {
  test::write_tum_recording(folder_, 5);
  folder_.write("imu.csv", "nothing that anyone reads\n");
  EXPECT_FALSE(open()->describe().has_imu);
  EXPECT_THAT(input_error([&] { open({{"imu", std::string("imu.csv")}}); }), HasSubstr("imu.csv:1"));
  EXPECT_THAT(input_error([&] { open({{"imu", std::string("other.csv")}}); }), HasSubstr("other.csv"));
  folder_.write("sensors/imu.txt", resting(99.995, 101, ""));
  EXPECT_TRUE(open({{"imu", std::string("sensors/imu.txt")}})->describe().has_imu);
}

TEST_F(RecordedImuTest, TimesMustBeThoseOfTheFrames) {
  test::write_tum_recording(folder_, 5);
  folder_.write("imu.csv", resting(5000, 5001));
  EXPECT_THAT(input_error([&] { open(); }), AllOf(HasSubstr("from 100.0"), HasSubstr("time_offset")));
  folder_.write("imu.csv", resting(100.2, 101));
  const Warnings warnings = open()->warnings();
  ASSERT_THAT(warnings, SizeIs(1));
  EXPECT_THAT(warnings[0].message, HasSubstr("2 of 5 frames have none"));
}

/// EuRoC V1_01_easy: a real sensor gives no false alarm.
TEST(RecordedImuData, ARealFlightIsPlausible) {
  const char* data = std::getenv("HOLDFAST_DATA");
  const std::filesystem::path file = std::filesystem::path(data != nullptr ? data : "") / "euroc_v101_imu/imu0.csv";
  if (data == nullptr || !std::filesystem::exists(file))
    GTEST_SKIP() << "HOLDFAST_DATA does not name the folder with euroc_v101_imu";
  std::vector<ImuSample> samples = read_imu_samples(file);
  EXPECT_THAT(samples, SizeIs(29120));
  EXPECT_THAT(imu_suspicions(samples, {200.0, 17.4, 176.0}), IsEmpty());
  for (ImuSample& sample : samples) sample.angular_velocity *= 180.0 / EIGEN_PI;
  EXPECT_THAT(imu_suspicions(samples), testing::ElementsAre(HasSubstr("degrees per second")));
}

}  // namespace
}  // namespace holdfast
