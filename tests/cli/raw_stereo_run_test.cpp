// SPDX-License-Identifier: BSD-3-Clause
// Pairs that are not rectified, in the layout of EuRoC and in folders: images of a rendered, rectified pair that are
// warped to cameras with distortion, each turned by some degrees.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "cli/program.hpp"
#include "holdfast/core/trajectory.hpp"
#include "holdfast/simulation/scene_file.hpp"
#include "holdfast/simulation/simulator.hpp"
#include "support/raw_pair.hpp"

namespace holdfast {
namespace {

using ::testing::HasSubstr;

constexpr std::uint64_t stereo_frames = 60, mono_frames = 100;

Camera rendered_camera() {
  Camera camera;
  camera.width = 720, camera.height = 520;
  camera.fx = camera.fy = 400, camera.cx = 359.5, camera.cy = 259.5;
  camera.baseline = 0.11;
  return camera;
}

std::string numbers(const std::vector<double>& values) {
  std::string text;
  for (const double value : values) {
    char number[40];
    std::snprintf(number, sizeof(number), "%s%.17g", text.empty() ? "" : ", ", value);
    text += number;
  }
  return text;
}

std::string matrix(const Eigen::Isometry3d& T) {
  std::vector<double> values;
  for (int i = 0; i < 16; ++i) values.push_back(T.matrix()(i / 4, i % 4));
  return numbers(values);
}

/// A short recording: the camera moves past the furniture of the office.
class Recording {
 public:
  Recording(const test::Program& program, const Camera& raw, std::uint64_t frames = stereo_frames)
      : program_(program),
        frames_(frames),
        pair_(rendered_camera(), raw),
        simulator_(simulation::read_scene({}, {"camera.path=xyz", "seed=1"}), rendered_camera()) {}

  /// Writes mav0 below `folder`; the truth is that of a body on which the cameras stand turned.
  void write_euroc(const std::string& folder) const {
    const Eigen::Isometry3d T_body_left =
        Eigen::Translation3d(0.1, -0.3, 0.2) * Eigen::AngleAxisd(1.2, Eigen::Vector3d(1, -2, 3).normalized());
    const StereoCameras& calibration = pair_.calibration();
    std::string lists[2], truth = "#timestamp [ns], p_RS_R_x [m], ...\n";
    write_sensor(folder + "/mav0/cam0", calibration.left, T_body_left);
    write_sensor(folder + "/mav0/cam1", calibration.right, T_body_left * calibration.T_left_right);
    for (std::uint64_t i = 0; i < frames_; ++i) {
      const std::string stamp = std::to_string(1'400'000'000'000'000'000LL + static_cast<long long>(i) * 33'333'333LL);
      write_images(i, folder + "/mav0/cam0/data/" + stamp + ".png", folder + "/mav0/cam1/data/" + stamp + ".png");
      lists[0] += stamp + "," + stamp + ".png\n", lists[1] += stamp + "," + stamp + ".png\n";
      const Eigen::Isometry3d T_world_body =
          simulator_.T_world_camera(i) * pair_.T_rendered_left() * T_body_left.inverse();
      const Eigen::Quaterniond q(T_world_body.linear());
      const Eigen::Vector3d t = T_world_body.translation();
      truth += stamp + ", " + numbers({t.x(), t.y(), t.z(), q.w(), q.x(), q.y(), q.z()}) + ", 0, 0, 0\n";
    }
    for (const int camera : {0, 1})
      program_.write(folder + "/mav0/cam" + std::to_string(camera) + "/data.csv",
                     "#timestamp [ns],filename\n" + lists[camera]);
    std::filesystem::create_directories(program_.path(folder + "/mav0/state_groundtruth_estimate0"));
    program_.write(folder + "/mav0/state_groundtruth_estimate0/data.csv", truth);
  }

  /// Writes left/, right/, camera.yaml and truth.txt, that of the raw left camera, below `folder`.
  void write_folder(const std::string& folder) const {
    const StereoCameras& calibration = pair_.calibration();
    for (const char* side : {"left", "right"}) std::filesystem::create_directories(program_.path(folder + "/" + side));
    Trajectory truth;
    for (std::uint64_t i = 0; i < frames_; ++i) {
      const std::string name = "/" + std::to_string(i) + ".png";
      write_images(i, folder + "/left" + name, folder + "/right" + name);
      truth.push_back({static_cast<double>(i) / 30.0, simulator_.T_world_camera(i) * pair_.T_rendered_left()});
    }
    program_.write(folder + "/camera.yaml", yaml_of(calibration.left, "") + "right:\n" +
                                                yaml_of(calibration.right, "  ") + "  T_left_right: [" +
                                                matrix(calibration.T_left_right) + "]\n");
    write_trajectory(program_.path(folder + "/truth.txt"), truth);
  }

 private:
  static std::string yaml_of(const Camera& camera, const std::string& indent) {
    const Distortion& d = camera.distortion;
    std::string text;
    const auto add = [&](const std::string& key, double value) {
      text += indent + key + ": " + numbers({value}) + "\n";
    };
    text += indent + "width: " + std::to_string(camera.width) + "\n";
    text += indent + "height: " + std::to_string(camera.height) + "\n";
    text += indent + "lens: " + lens_name(d.lens) + "\n";
    add("fx", camera.fx), add("fy", camera.fy), add("cx", camera.cx), add("cy", camera.cy);
    add("k1", d.k1), add("k2", d.k2), add("p1", d.p1), add("p2", d.p2), add("k3", d.k3), add("k4", d.k4);
    return text;
  }
  void write_sensor(const std::string& folder, const Camera& camera, const Eigen::Isometry3d& T_body_camera) const {
    std::filesystem::create_directories(program_.path(folder + "/data"));
    const bool is_fisheye = camera.distortion.lens == Lens::fisheye;
    std::vector<double> coefficients = camera.distortion.coefficients();
    coefficients.resize(4);
    program_.write(folder + "/sensor.yaml",
                   "sensor_type: camera\nT_BS:\n  cols: 4\n  rows: 4\n  data: [" + matrix(T_body_camera) +
                       "]\nrate_hz: 30\nresolution: [" + std::to_string(camera.width) + ", " +
                       std::to_string(camera.height) + "]\ncamera_model: pinhole\nintrinsics: [" +
                       numbers({camera.fx, camera.fy, camera.cx, camera.cy}) +
                       "]\ndistortion_model: " + (is_fisheye ? "equidistant" : "radial-tangential") +
                       "\ndistortion_coefficients: [" + numbers(coefficients) + "]\n");
  }
  void write_images(std::uint64_t index, const std::string& left, const std::string& right) const {
    const SensorFrame frame = simulator_.stereo_frame(index, rendered_camera().baseline);
    cv::Mat grey_left, grey_right = frame.right;
    cv::cvtColor(pair_.left(frame.colour), grey_left, cv::COLOR_BGR2GRAY);
    if (grey_right.channels() == 3) cv::cvtColor(frame.right, grey_right, cv::COLOR_BGR2GRAY);
    cv::imwrite(program_.path(left).string(), grey_left);
    cv::imwrite(program_.path(right).string(), pair_.right(grey_right));
  }

  const test::Program& program_;
  std::uint64_t frames_;
  test::RawPair pair_;
  mutable simulation::Simulator simulator_;
};

double run(const test::Program& program, const std::string& configuration, const std::vector<std::string>& settings,
           const std::string& output) {
  std::vector<std::string> arguments{"run",
                                     std::string(HOLDFAST_EXAMPLE_CONFIGURATIONS) + "/" + configuration + ".yaml"};
  for (const std::string& setting : settings) arguments.insert(arguments.end(), {"--set", setting});
  arguments.insert(arguments.end(), {"--output", output, "--quiet"});
  const test::Outcome outcome = program.run(arguments);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  const nlohmann::json summary = nlohmann::json::parse(program.text(output + "/run.json"));
  if (configuration == "stereo") {
    EXPECT_EQ(summary.at("frames").at("poses"), stereo_frames);
  }
  return summary.at("evaluation").at("ate_m").at("rmse").get<double>();
}

class RawStereoRun : public testing::TestWithParam<Camera> {};

TEST_P(RawStereoRun, IsTrackedAsWellAsARectifiedPair) {
  const test::Program program;
  const Recording recording(program, GetParam());
  recording.write_euroc("V9");
  const Camera camera = rendered_camera();
  const double rectified = run(program, "stereo",
                               {"source={simulated: {path: xyz, duration: 2, stereo_baseline: 0.11, seed: 1}}",
                                "camera={width: 720, height: 520, fx: 400, fy: 400, cx: 359.5, cy: 259.5}"},
                               "rectified");
  const double raw = run(program, "stereo", {"source={euroc: {path: V9}}"}, "raw");
  EXPECT_LE(raw, 1.5 * rectified + 0.0005) << "rectified: " << rectified;
  EXPECT_LE(raw, 0.003);

  recording.write_folder("pair");
  EXPECT_NEAR(run(program, "stereo",
                  {"source={folder: {path: pair, colour: left, right: right, intrinsics: pair/camera.yaml, truth: "
                   "pair/truth.txt}}"},
                  "folder"),
              raw, 0.0003);
}

INSTANTIATE_TEST_SUITE_P(Lenses, RawStereoRun, testing::Values(test::barrel_camera(), test::fisheye_camera()));

TEST(RawMonoRun, OneEyeOfEurocWithItsDistortion) {
  for (const Camera& camera : {test::barrel_camera(), test::fisheye_camera()}) {
    const test::Program program;
    Recording(program, camera, mono_frames).write_euroc("V9");
    const test::Outcome outcome =
        program.run({"run", std::string(HOLDFAST_EXAMPLE_CONFIGURATIONS) + "/mono.yaml", "--set", "camera=auto",
                     "--set", "source={euroc: {path: V9, cameras: left}}", "--output", "mono", "--quiet"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.errors;
    const nlohmann::json summary = nlohmann::json::parse(program.text("mono/run.json"));
    EXPECT_GE(summary.at("frames").at("poses"), 50);  // the map begins when the camera has moved
    EXPECT_LE(summary.at("evaluation").at("ate_m").at("rmse"), 0.004);
  }
}

TEST(RawStereoCheck, DatasetCheckReadsTheLayoutOfEuroc) {
  const test::Program program;
  Recording(program, test::barrel_camera()).write_euroc("V9");
  const test::Outcome good = program.run({"dataset", "check", "V9"});
  EXPECT_EQ(good.exit_code, 0) << good.output;
  EXPECT_THAT(good.output, HasSubstr("60 stereo pairs"));
  EXPECT_THAT(good.output, HasSubstr("to be rectified"));
  EXPECT_THAT(good.output, HasSubstr("60 true poses"));
  EXPECT_THAT(good.output, HasSubstr("in the layout 'euroc'"));
  const test::Outcome other = program.run({"dataset", "check", "V9", "--recipe", "euroc_v1_01"});
  EXPECT_EQ(other.exit_code, 1);
  EXPECT_THAT(other.output, HasSubstr("60 stereo pairs; expected 2912"));
  std::filesystem::remove(program.path("V9/mav0/cam1/data/1400000000033333333.png"));
  EXPECT_THAT(program.run({"dataset", "check", "V9"}).output,
              HasSubstr("1 image that is missing: mav0/cam1/data/1400000000033333333.png (line 3)"));
  program.write("V9/mav0/cam1/sensor.yaml", "T_BS: {}\n");
  EXPECT_THAT(program.run({"dataset", "check", "V9"}).output, HasSubstr("sensor.yaml:1:7: found T_BS without 'data'"));
  EXPECT_THAT(program.run({"dataset", "associate", "V9"}).errors,
              HasSubstr("holds stereo pairs in the layout 'euroc'"));
}

}  // namespace
}  // namespace holdfast
