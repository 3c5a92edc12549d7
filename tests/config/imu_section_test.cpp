// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "fixture.hpp"

namespace holdfast {
namespace {

using test::problems;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST(ImuSection, IsAKnownNameOrNumbers) {
  EXPECT_FALSE(test::resolve(test::good).imu);
  EXPECT_EQ(*test::resolve(test::good + "imu: bmi160\n").imu, *find_imu("bmi160"));
  const Configuration named = test::resolve(test::good + "imu: { name: bmi160, rate: 100 }\n");
  EXPECT_EQ(named.imu->rate, 100.0);
  EXPECT_EQ(named.imu->noise, find_imu("bmi160")->noise);
  const Configuration configuration =
      test::resolve(test::good +
                    "imu: { T_body_camera: [[0, -1, 0, 0.1], [1, 0, 0, 0.2], [0, 0, 1, 0.3], [0, 0, 0, 1]], "
                    "time_offset: -0.02, gyroscope_random_walk: 1e-5 }\n");
  EXPECT_EQ(configuration.imu->T_body_camera * Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(0.1, 1.2, 0.3));
  EXPECT_EQ(configuration.imu->time_offset, -0.02);
  EXPECT_EQ(configuration.imu->noise.gyroscope_random_walk, 1e-5);
  EXPECT_EQ(configuration.imu->name, "");
}

TEST(ImuSection, AResolvedConfigurationSaysTheSame) {
  const Configuration first =
      test::resolve(test::good +
                    "imu: { name: bmi055, T_body_camera: [[0.6, -0.8, 0, 0.1], [0.8, 0.6, 0, 0], [0, 0, 1, 0], [0, 0, "
                    "0, 1]] }\n");
  const Configuration second = test::resolve(to_yaml(first));
  ASSERT_TRUE(second.imu);
  EXPECT_EQ(*second.imu, *first.imu);
  EXPECT_EQ(to_yaml(test::resolve(test::good)).find("imu:"), std::string::npos);
}

TEST(ImuSection, MistakesAreNamed) {
  EXPECT_THAT(problems(test::good + "imu: bmi106\n"),
              ElementsAre(HasSubstr("there is no known IMU 'bmi106'; expected a name, or numbers")));
  EXPECT_THAT(problems(test::good + "imu: { name: bmi106 }\n"), ElementsAre(HasSubstr("did you mean 'bmi160'?")));
  EXPECT_THAT(problems(test::good + "imu: { rat: 200 }\n"), ElementsAre(HasSubstr("did you mean 'rate'?")));
  EXPECT_THAT(problems(test::good + "imu: { time_offset: 5 }\n"), ElementsAre(HasSubstr("5 is above 1")));
  EXPECT_THAT(problems(test::good + "imu: { T_body_camera: [[1, 0, 0], [0, 1, 0], [0, 0, 1]] }\n"),
              ElementsAre(HasSubstr("four rows of a rigid motion")));
  EXPECT_THAT(
      problems(test::good + "imu: { T_body_camera: [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, -1, 0], [0, 0, 0, 1]] }\n"),
      ElementsAre(HasSubstr("four rows of a rigid motion")));
  EXPECT_THAT(
      problems(test::good + "imu: { T_body_camera: [[1, 0, 0, 64.5], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]] }\n"),
      ElementsAre(HasSubstr("metres")));
}

/// Files that exist while the test runs.
class KalibrTest : public testing::Test {
 protected:
  void SetUp() override { std::filesystem::create_directories(folder_); }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
    return (folder_ / name).string();
  }
  const std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / ("holdfast_kalibr_" + std::to_string(::getpid()));
};

constexpr const char* camchain =
    "cam0:\n  T_cam_imu:\n  - [0.0, 1.0, 0.0, 0.1]\n  - [-1.0, 0.0, 0.0, 0.2]\n  - [0.0, 0.0, 1.0, 0.3]\n"
    "  - [0.0, 0.0, 0.0, 1.0]\n  camera_model: pinhole\n  timeshift_cam_imu: 0.0042\n  rostopic: /cam0\n";

TEST_F(KalibrTest, ResultsAreTheNumbersThatAreNotGiven) {
  const std::string files =
      write("camchain-imucam.yaml", camchain) + ", " +
      write("imu.yaml",
            "accelerometer_noise_density: 0.0021\naccelerometer_random_walk: 0.0004\ngyroscope_noise_density: 0.0002\n"
            "gyroscope_random_walk: 0.00003\nrostopic: /imu\nupdate_rate: 250.0\n");
  const Configuration configuration =
      test::resolve(test::good + "imu: { kalibr: [" + files + "], gyroscope_random_walk: 0.00005 }\n");
  const ImuCalibration& imu = configuration.imu.value();
  EXPECT_EQ(imu.noise, (ImuNoise{0.0002, 0.0021, 0.00005, 0.0004}));
  EXPECT_EQ(imu.rate, 250.0);
  EXPECT_EQ(imu.time_offset, 0.0042);
  // The body's x axis is the camera's -y axis.
  EXPECT_LT((imu.T_body_camera * Eigen::Vector3d(0.1, 0.2 - 1.0, 0.3) - Eigen::Vector3d(1, 0, 0)).norm(), 1e-12);
  EXPECT_EQ(*test::resolve(to_yaml(configuration)).imu, imu) << "without the files";
  const std::string result = write("imu0.yaml", "imu0:\n  update_rate: 100\n");
  EXPECT_EQ(test::resolve(test::good + "imu: { name: bmi160, kalibr: " + result + " }\n").imu->rate, 100.0);
}

TEST_F(KalibrTest, MistakesAreNamed) {
  const std::string other = write("other.yaml", "cam0: { camera_model: pinhole }\n");
  EXPECT_THAT(problems(test::good + "imu: { kalibr: " + other + " }\n"),
              ElementsAre(HasSubstr("found none of Kalibr's results in " + other)));
  EXPECT_THAT(problems(test::good + "imu: { kalibr: nowhere.yaml }\n"), ElementsAre(HasSubstr("/data/nowhere.yaml")));
  const std::string wrong = write("wrong.yaml", "update_rate: 1\n");
  EXPECT_THAT(problems(test::good + "imu: { kalibr: " + wrong + " }\n"), ElementsAre(HasSubstr(wrong + ":1:")));
}

}  // namespace
}  // namespace holdfast
