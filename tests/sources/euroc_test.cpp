// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/core.hpp>

#include "recording.hpp"

namespace holdfast {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

/// Calibration of a camera at x = `x` [m] of a body whose x axis is the optical axis.
std::string sensor(double x, const std::string& lens = "radial-tangential") {
  return "%YAML:1.0\n# General sensor definitions.\nsensor_type: camera\ncomment: ours\nT_BS:\n  cols: 4\n  rows: 4\n"
         "  data: [0.0, 0.0, 1.0, 0.5,\n         -1.0, 0.0, 0.0, " +
         std::to_string(-x) +
         ",\n         0.0, -1.0, 0.0, 0.0,\n         0.0, 0.0, 0.0, 1.0]\nrate_hz: 20\nresolution: [64, 48]\n"
         "camera_model: pinhole\nintrinsics: [50, 51, 32, 24] #fu, fv, cu, cv\ndistortion_model: " +
         lens + "\ndistortion_coefficients: [-0.02, 0.001, 0.0002, 0.0001]\n";
}

/// Three pairs; the right image of the second is late, and the right camera took one more.
class EurocTest : public ::testing::Test {
 protected:
  EurocTest() {
    for (int i = 0; i < 3; ++i) {
      cv::Mat grey;
      cv::extractChannel(test::colour_image(i), grey, 0);
      folder_.write_image("V9/mav0/cam0/data/" + stamp(i) + ".png", grey);
      folder_.write_image("V9/mav0/cam1/data/r" + std::to_string(i) + ".png", grey);
    }
    folder_.write(left("data.csv"), "#timestamp [ns],filename\r\n" + stamp(0) + "," + stamp(0) + ".png\r\n" + stamp(1) +
                                        "," + stamp(1) + ".png\r\n" + stamp(2) + "," + stamp(2) + ".png\r\n");
    folder_.write(right("data.csv"), "#timestamp [ns],filename\n" + stamp(0) + ",r0.png\n1403636579813555000,r1.png\n" +
                                         stamp(2) + ",r2.png\n1403636579963555584,r3.png\n");
    folder_.write(left("sensor.yaml"), sensor(0.0));
    folder_.write(right("sensor.yaml"), sensor(0.1));
    // The body goes along its x axis, which points along y of the world.
    std::string truth = "#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], ...\n";
    for (int i = 0; i < 3; ++i)
      truth +=
          stamp(i) + ",1," + std::to_string(i) + ",0,0.70710678118654752,0,0,0.70710678118654752,9,9,9,9,9,9,9,9,9\n";
    folder_.write("V9/mav0/state_groundtruth_estimate0/data.csv", truth);
  }

  static std::string stamp(int i) { return std::to_string(1403636579763555584 + i * 50000000LL); }
  static std::string left(const std::string& name) { return "V9/mav0/cam0/" + name; }
  static std::string right(const std::string& name) { return "V9/mav0/cam1/" + name; }
  std::unique_ptr<FrameSource> open(ParameterValues values = {}, const std::string& path = "V9") const {
    values["path"] = (folder_.path() / path).string();
    return test::make_source("euroc", values);
  }
  std::string message(const std::string& file, const std::string& content) const {
    const std::string before = folder_.read(file);
    folder_.write(file, content);
    std::string text = test::input_error([&] { test::read_all(*open()); });
    folder_.write(file, before);
    return text;
  }
  std::string full(const std::string& name) const { return (folder_.path() / name).string(); }

  test::TemporaryFolder folder_;
};

TEST_F(EurocTest, ReadsRectifiedPairs) {
  const auto source = open();
  const SourceDescription description = source->describe();
  EXPECT_EQ(description.name, "V9");
  EXPECT_TRUE(description.has_right);
  EXPECT_FALSE(description.has_depth);
  EXPECT_EQ(description.frame_count, 3U);
  EXPECT_EQ(description.truth_frame, "transformed");
  ASSERT_TRUE(description.camera.has_value());
  EXPECT_TRUE(description.camera->distortion.is_zero());
  EXPECT_EQ(description.camera->width, 64);
  EXPECT_EQ(description.camera->frame_rate, 20.0);
  EXPECT_NEAR(description.camera->baseline, 0.1, 1e-9);
  const std::vector<SensorFrame> frames = test::read_all(*source);
  ASSERT_EQ(frames.size(), 3U);
  EXPECT_NEAR(frames[1].timestamp - frames[0].timestamp, 0.05, 1e-6);
  EXPECT_EQ(frames[1].colour.type(), CV_8UC3);
  EXPECT_EQ(frames[1].right.type(), CV_8UC1);
  EXPECT_EQ(frames[1].right.size(), frames[1].colour.size());
}

TEST_F(EurocTest, TheTruthIsThatOfTheCamera) {
  // Both cameras look along x of the body, and are rectified without a turn.
  const auto source = open();
  const Trajectory truth = source->truth();
  ASSERT_EQ(truth.size(), 3U);
  EXPECT_EQ(truth[2].timestamp, test::read_all(*source)[2].timestamp);
  const Eigen::Isometry3d& pose = truth[2].T_world_camera;
  EXPECT_TRUE(pose.translation().isApprox(Eigen::Vector3d(1.0, 2.5, 0.0), 1e-9)) << pose.translation().transpose();
  EXPECT_TRUE(pose.linear().col(2).isApprox(Eigen::Vector3d::UnitY(), 1e-9)) << "the optical axis";
  EXPECT_TRUE(pose.linear().col(1).isApprox(-Eigen::Vector3d::UnitZ(), 1e-9)) << "down";
}

TEST_F(EurocTest, OneCameraIsGivenAsItIs) {
  const auto source = open({{"cameras", std::string("left")}}, "V9/mav0");
  const SourceDescription description = source->describe();
  EXPECT_FALSE(description.has_right);
  EXPECT_EQ(description.camera->fy, 51.0);
  EXPECT_EQ(description.camera->distortion, (Distortion{-0.02, 0.001, 0.0002, 0.0001, 0.0}));
  const std::vector<SensorFrame> frames = test::read_all(*source);
  EXPECT_EQ(frames[2].colour.at<cv::Vec3b>(5, 7), cv::Vec3b::all(test::colour_image(2).at<cv::Vec3b>(5, 7)[0]));
  EXPECT_TRUE(frames[2].right.empty());
  std::filesystem::remove_all(folder_.path() / "V9/mav0/cam1");
  EXPECT_FALSE(open()->describe().has_right) << "auto";
}

TEST_F(EurocTest, GreyImagesMayHave16Bits) {
  const auto deep = [](int number) {  // below the value of an upper byte, and at its end
    cv::Mat image(48, 64, CV_16UC1, cv::Scalar(256 * (40 + number)));
    image(cv::Rect(0, 0, 32, 48)).setTo(256 * (40 + number) + 255);
    return image;
  };
  for (int i = 0; i < 3; ++i) {
    folder_.write_image("V9/mav0/cam0/data/" + stamp(i) + ".png", deep(i));
    folder_.write_image("V9/mav0/cam1/data/r" + std::to_string(i) + ".png", deep(i));
  }
  const std::vector<SensorFrame> frames = test::read_all(*open({{"cameras", std::string("left")}}));
  ASSERT_EQ(frames.size(), 3U);
  EXPECT_EQ(frames[1].colour.type(), CV_8UC3);
  for (const int x : {3, 60}) EXPECT_EQ(frames[1].colour.at<cv::Vec3b>(5, x), cv::Vec3b::all(41));
  EXPECT_EQ(test::read_all(*open())[0].right.at<std::uint8_t>(24, 32), 40);
}

TEST_F(EurocTest, AFisheyeLensIsEquidistant) {
  folder_.write(left("sensor.yaml"), sensor(0.0, "equidistant"));
  const Distortion distortion = open({{"cameras", std::string("left")}})->describe().camera->distortion;
  EXPECT_EQ(distortion.lens, Lens::fisheye);
  EXPECT_EQ(distortion.coefficients(), (std::vector<double>{-0.02, 0.001, 0.0002, 0.0001}));
}

/// A camera of a camchain.yaml of Kalibr; the keys are in the order of the TUM VI data.
std::string chain_camera(const std::string& name, double x) {
  return name + ":\n  T_cam_imu:\n  - [0.0, -1.0, 0.0, " + std::to_string(-x) +
         "]\n  - [0.0, 0.0, -1.0, 0.0]\n  - [1.0, 0.0, 0.0, -0.5]\n  - [0.0, 0.0, 0.0, 1.0]\n  cam_overlaps: [1]\n"
         "  camera_model: pinhole\n  distortion_coeffs: [-0.02, 0.001, 0.0002, 0.0001]\n"
         "  distortion_model: equidistant\n  intrinsics: [50, 51, 32, 24]\n  resolution: [64, 48]\n"
         "  rostopic: /" +
         name + "/image_raw\n";
}

TEST_F(EurocTest, TumViHasItsCalibrationInOneFile) {
  const Trajectory expected = open()->truth();
  std::filesystem::remove(folder_.path() / left("sensor.yaml"));
  std::filesystem::remove(folder_.path() / right("sensor.yaml"));
  EXPECT_THAT(test::input_error([&] { open(); }),
              AllOf(StartsWith(full(left("sensor.yaml"))), HasSubstr("dso/camchain.yaml beside mav0")));
  folder_.write("V9/dso/camchain.yaml", chain_camera("cam0", 0.0) + chain_camera("cam1", 0.1));
  for (const char* path : {"V9", "V9/mav0"}) {
    const auto source = open({}, path);
    EXPECT_NEAR(source->describe().camera->baseline, 0.1, 1e-9) << path;
    EXPECT_NEAR(source->describe().camera->frame_rate, 20.0, 1e-4);
    EXPECT_TRUE(source->truth()[2].T_world_camera.isApprox(expected[2].T_world_camera, 1e-9));
  }
  EXPECT_EQ(open({{"cameras", std::string("left")}})->describe().camera->distortion.lens, Lens::fisheye);
  folder_.write("V9/mav0/imu0/data.csv", stamp(0) + ",0,0,0,9.8,0,0\n" + stamp(2) + ",0,0,0,9.8,0,0\n");
  EXPECT_FALSE(open()->describe().imu.has_value());
  folder_.write(
      "V9/dso/imu_config.yaml",
      "accelerometer_noise_density: 0.0028\naccelerometer_random_walk: 0.00086\n"
      "gyroscope_noise_density: 0.00016\ngyroscope_random_walk: 2.2e-05\nrostopic: /imu0\nupdate_rate: 200.0\n");
  const std::optional<ImuCalibration> imu = open({{"cameras", std::string("left")}})->describe().imu;
  ASSERT_TRUE(imu.has_value());
  EXPECT_EQ(imu->rate, 200.0);
  EXPECT_TRUE(imu->T_body_camera.translation().isApprox(Eigen::Vector3d(0.5, 0.0, 0.0)));
  const std::string chain = chain_camera("cam0", 0.0);
  EXPECT_THAT(message("V9/dso/camchain.yaml", chain), HasSubstr("camchain.yaml: lacks cam1"));
  EXPECT_THAT(message("V9/dso/camchain.yaml", "cam0:\n  T_cam_imu: [1, 2]\n"), HasSubstr("a row of T_cam_imu"));
  EXPECT_THAT(message("V9/dso/camchain.yaml", "cam0:\n  T_cam_imu:\n  - [1, 0, 0, 0]\n"),
              HasSubstr("T_cam_imu that is not a rigid motion"));
}

TEST_F(EurocTest, ImagesWithoutAPartnerMakeNoFrame) {
  folder_.write(right("data.csv"), stamp(0) + ",r0.png\n" + stamp(2) + ",r2.png\n");
  EXPECT_EQ(open()->describe().frame_count, 2U);
  EXPECT_EQ(open({{"cameras", std::string("left")}})->describe().frame_count, 3U);
  EXPECT_EQ(open({{"start", std::int64_t{1}}})->describe().frame_count, 1U);
  folder_.write(right("data.csv"), "5,r0.png\n");
  EXPECT_THAT(test::input_error([&] { open(); }), HasSubstr("has no image within 0.002000 s of one of cam0"));
}

TEST_F(EurocTest, SaysWhatIsWrong) {
  const std::string yaml = sensor(0.0), camera = full(left("sensor.yaml"));
  const auto without = [&](const std::string& key) {
    std::string text = yaml;
    text.insert(text.find(key), "x_");
    return message(left("sensor.yaml"), text);
  };
  const auto changed = [&](const std::string& from, const std::string& to) {
    std::string text = yaml;
    text.replace(text.find(from), from.size(), to);
    return message(left("sensor.yaml"), text);
  };
  EXPECT_THAT(without("T_BS"), AllOf(StartsWith(camera), HasSubstr("lacks T_BS")));
  EXPECT_THAT(without("intrinsics"), HasSubstr("lacks intrinsics"));
  EXPECT_THAT(without("distortion_coefficients"), HasSubstr("lacks distortion_coefficients"));
  EXPECT_THAT(changed("[50, 51", "[-50, 51"), AllOf(StartsWith(camera + ":15:14: "), HasSubstr("focal length fu")));
  EXPECT_THAT(changed("[50, 51", "[51"), AllOf(StartsWith(camera + ":15:13: "), HasSubstr("found 3 numbers")));
  EXPECT_THAT(changed("pinhole", "omni"), AllOf(StartsWith(camera + ":14:15: "), HasSubstr("expected pinhole")));
  EXPECT_THAT(changed("radial-tangential", "fov"), HasSubstr("expected radial-tangential, equidistant or none"));
  EXPECT_THAT(changed("[-0.02,", "[-2.0,"), AllOf(StartsWith(camera + ":"), HasSubstr("no inverse in the image")));
  EXPECT_THAT(changed("0.0002, ", ""),
              HasSubstr("found 3 numbers for distortion_coefficients; expected a list of 4 or 5"));
  EXPECT_THAT(changed("0.0, 0.0, 1.0, 0.5", "0.0, 0.0, 2.0, 0.5"), HasSubstr("not a rigid motion"));
  EXPECT_THAT(changed("rate_hz: 20", "rate_hz: [20"), StartsWith(camera + ":"));
  EXPECT_THAT(message(right("sensor.yaml"), sensor(-0.1)), HasSubstr("exchange the cameras"));
  EXPECT_THAT(message(left("data.csv"), "#timestamp [ns],filename\n12.5,a.png\n"),
              AllOf(StartsWith(full(left("data.csv")) + ":2: found '12.5,a.png'"), HasSubstr("time stamp [ns]")));
  EXPECT_THAT(message(left("data.csv"), "10,a.png\n10,b.png\n"), HasSubstr("data.csv:2: has a time stamp that is not"));
  EXPECT_THAT(message(left("data.csv"), "10,\n"), HasSubstr("data.csv:1: names no file"));
  EXPECT_THAT(message(left("data.csv"), "# nothing\n"), HasSubstr("is an empty list"));
  std::filesystem::remove(folder_.path() / right("data/r2.png"));
  EXPECT_THAT(test::input_error([&] { test::read_all(*open()); }),
              AllOf(StartsWith(full(right("data.csv")) + ":4"), HasSubstr("r2.png")));
  EXPECT_EQ(test::read_all(*open({{"on_bad_frame", std::string("skip")}})).size(), 2U);
  folder_.write_image(left("data/" + stamp(0) + ".png"), test::colour_image(0, 32, 24));
  EXPECT_THAT(test::input_error([&] { test::read_all(*open()); }),
              HasSubstr("is 32x24 pixels, but the camera is 64x48"));
  EXPECT_THAT(test::input_error([&] { open({}, "nowhere"); }),
              HasSubstr("is missing; expected the folder of a sequence"));
  EXPECT_THAT(test::input_error([&] { open({}, "V9/mav0/cam0"); }), HasSubstr("contains neither mav0/cam0 nor cam0"));
}

/// The IMU of a body whose frame is not that of the IMU.
constexpr const char* imu_sensor =
    "sensor_type: imu\nT_BS:\n  cols: 4\n  rows: 4\n  data: [1, 0, 0, 0.2, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, "
    "1]\nrate_hz: 200\ngyroscope_noise_density: 1.7e-04\ngyroscope_random_walk: 1.9e-05\n"
    "accelerometer_noise_density: 2.0e-3\naccelerometer_random_walk: 3.0e-3\n";

TEST_F(EurocTest, GivesInertialMeasurementsAndTheirCalibration) {
  EXPECT_FALSE(open()->describe().has_imu);
  std::string samples = "#timestamp [ns],w_RS_S_x [rad s^-1],...\n";
  for (int i = -1; i < 30; ++i) samples += std::to_string(1403636579763555584 + i * 5000000LL) + ",0,0,0,9.8,0,0\n";
  folder_.write("V9/mav0/imu0/data.csv", samples);
  folder_.write("V9/mav0/imu0/sensor.yaml", imu_sensor);
  const auto source = open({{"cameras", std::string("left")}});
  const SourceDescription description = source->describe();
  EXPECT_TRUE(description.has_imu);
  ASSERT_TRUE(description.imu);
  EXPECT_EQ(description.imu->rate, 200.0);
  EXPECT_EQ(description.imu->noise, (ImuNoise{1.7e-4, 2e-3, 1.9e-5, 3e-3}));
  // The camera stands at x = 0.5 of the body and looks along its x axis, the IMU at x = 0.2.
  EXPECT_LT((description.imu->T_body_camera * Eigen::Vector3d(0, 0, 1) - Eigen::Vector3d(1.3, 0, 0)).norm(), 1e-9);
  source->next();
  const SensorFrame second = *source->next();
  EXPECT_EQ(second.imu.size(), 11U);
  EXPECT_EQ(second.imu.back().timestamp, second.timestamp);
  EXPECT_FALSE(open({{"imu", std::string("none")}})->describe().has_imu);
  folder_.write("V9/mav0/imu0/sensor.yaml", "rate_hz: 200\n");
  EXPECT_THAT(test::input_error([&] { open(); }), HasSubstr("T_BS"));
}

}  // namespace
}  // namespace holdfast
