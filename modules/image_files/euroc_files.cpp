// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/image_files/euroc_files.hpp"

#include <string>

#include "holdfast/core/parsed_number.hpp"
#include "holdfast/core/text_file.hpp"
#include "yaml_numbers.hpp"

namespace holdfast {

namespace {

using yaml_numbers::location;

constexpr const char* expected_file =
    "the calibration of a sensor in the ASL layout, with T_BS, rate_hz, resolution, intrinsics, distortion_model and "
    "distortion_coefficients";

constexpr const char* expected_chain =
    "a camera chain of Kalibr, with T_cam_imu, resolution, intrinsics, distortion_model and distortion_coeffs of cam0 "
    "and "
    "cam1";

/// The value of a key that must be there.
YAML::Node required(const std::filesystem::path& file, const YAML::Node& root, const char* key,
                    const char* expected = expected_file) {
  if (!root.IsMap()) throw InputError(location(file, root.Mark()), std::string("holds no keys; expected ") + expected);
  const YAML::Node node = root[key];
  if (!node.IsDefined()) throw InputError({file.string()}, std::string("lacks ") + key + "; expected " + expected);
  return node;
}

Eigen::Isometry3d read_pose(const std::filesystem::path& file, const YAML::Node& root) {
  const YAML::Node matrix = required(file, root, "T_BS");
  if (!matrix.IsMap() || !matrix["data"].IsDefined())
    throw InputError(location(file, matrix.Mark()), "found T_BS without 'data'; expected the 16 numbers of a matrix");
  const YAML::Node data = matrix["data"];
  const auto motion = yaml_numbers::rigid_motion(yaml_numbers::numbers(file, data, "T_BS", {16}));
  if (!motion)
    throw InputError(location(file, data.Mark()),
                     "found a matrix for T_BS that is not a rigid motion; expected a rotation with a translation [m], "
                     "row by row, the last row 0 0 0 1");
  return *motion;
}

Distortion read_distortion(const std::filesystem::path& file, const YAML::Node& root, const char* coefficients) {
  const YAML::Node model = required(file, root, "distortion_model");
  const std::string name = model.IsScalar() ? model.Scalar() : "";
  if (name == "none") return {};
  const bool is_fisheye = name == "equidistant";
  if (!is_fisheye && name != "radial-tangential" && name != "radtan")
    yaml_numbers::reject(file, model, "distortion_model", "radial-tangential, equidistant or none");
  const YAML::Node list = required(file, root, coefficients);
  const std::vector<std::size_t> counts = is_fisheye ? std::vector<std::size_t>{4} : std::vector<std::size_t>{4, 5};
  return yaml_numbers::distortion(is_fisheye ? Lens::fisheye : Lens::radial_tangential,
                                  yaml_numbers::numbers(file, list, coefficients, counts));
}

/// The camera without its frame rate; `coefficients` is the key of those of the distortion.
Camera read_lens(const std::filesystem::path& file, const YAML::Node& root, const char* coefficients) {
  if (const YAML::Node model = root["camera_model"];
      model.IsDefined() && (!model.IsScalar() || model.Scalar() != "pinhole"))
    yaml_numbers::reject(file, model, "camera_model", "pinhole");
  Camera camera;
  const YAML::Node resolution = required(file, root, "resolution");
  yaml_numbers::numbers(file, resolution, "resolution", {2});
  camera.width = yaml_numbers::size(file, resolution[0], "the width");
  camera.height = yaml_numbers::size(file, resolution[1], "the height");
  const YAML::Node intrinsics = required(file, root, "intrinsics");
  yaml_numbers::numbers(file, intrinsics, "intrinsics", {4});
  camera.fx = yaml_numbers::number(file, intrinsics[0], "the focal length fu", true);
  camera.fy = yaml_numbers::number(file, intrinsics[1], "the focal length fv", true);
  camera.cx = yaml_numbers::number(file, intrinsics[2], "cu");
  camera.cy = yaml_numbers::number(file, intrinsics[3], "cv");
  camera.distortion = read_distortion(file, root, coefficients);
  if (const std::string trouble = camera.trouble(); !trouble.empty())
    throw InputError(location(file, required(file, root, coefficients).Mark()), trouble);
  return camera;
}

/// Noise and rate; `rate` is the key of the latter.
ImuCalibration read_noise(const std::filesystem::path& file, const YAML::Node& root, const char* rate) {
  const auto positive = [&](const char* key) {
    return yaml_numbers::number(file, required(file, root, key), key, true);
  };
  ImuCalibration imu;
  imu.rate = positive(rate);
  imu.noise.gyroscope_noise_density = positive("gyroscope_noise_density");
  imu.noise.accelerometer_noise_density = positive("accelerometer_noise_density");
  imu.noise.gyroscope_random_walk = positive("gyroscope_random_walk");
  imu.noise.accelerometer_random_walk = positive("accelerometer_random_walk");
  return imu;
}

}  // namespace

Eigen::Isometry3d read_euroc_pose(const std::filesystem::path& file) {
  return read_pose(file, yaml_numbers::load(file, expected_file));
}

EurocCamera read_euroc_camera(const std::filesystem::path& file) {
  const YAML::Node root = yaml_numbers::load(file, expected_file);
  EurocCamera result;
  result.T_body_camera = read_pose(file, root);
  result.camera = read_lens(file, root, "distortion_coefficients");
  result.camera.frame_rate = yaml_numbers::number(file, required(file, root, "rate_hz"), "rate_hz", true);
  return result;
}

ImuCalibration read_euroc_imu(const std::filesystem::path& file) {
  const YAML::Node root = yaml_numbers::load(file, expected_file);
  const Eigen::Isometry3d T_body_imu = read_pose(file, root);
  ImuCalibration imu = read_noise(file, root, "rate_hz");
  imu.T_body_camera = T_body_imu.inverse();
  return imu;
}

EurocCamera read_kalibr_camera(const std::filesystem::path& file, const std::string& camera) {
  const YAML::Node root = yaml_numbers::load(file, expected_chain);
  const YAML::Node node = required(file, root, camera.c_str(), expected_chain);
  const YAML::Node matrix = required(file, node, "T_cam_imu", expected_chain);
  std::vector<double> numbers;
  if (matrix.IsSequence())
    for (const YAML::Node& row : matrix)
      for (const double number : yaml_numbers::numbers(file, row, "a row of T_cam_imu", {4})) numbers.push_back(number);
  const auto T_camera_imu = numbers.size() == 16 ? yaml_numbers::rigid_motion(numbers) : std::nullopt;
  if (!T_camera_imu)
    throw InputError(
        location(file, matrix.Mark()),
        "found a value for T_cam_imu that is not a rigid motion; expected the four rows of a rotation with "
        "a translation [m], the last row 0 0 0 1");
  return {read_lens(file, node, "distortion_coeffs"), T_camera_imu->inverse()};
}

ImuCalibration read_kalibr_imu(const std::filesystem::path& file) {
  return read_noise(file, yaml_numbers::load(file, "the noise and rate of an IMU, as Kalibr has them"), "update_rate");
}

std::vector<ListedImage> read_euroc_image_list(const std::filesystem::path& file) {
  constexpr const char* form = "expected lines 'time stamp [ns],file name'";
  LineReader lines(file, "lines 'time stamp [ns],file name'");
  std::vector<ListedImage> images;
  std::string line;
  constexpr const char* blanks = " \t\r";
  while (lines.next(line)) {
    const std::size_t begin = line.find_first_not_of(blanks);
    if (begin == std::string::npos || line[begin] == '#') continue;
    const SourceLocation place = lines.location();
    const std::size_t comma = line.find(',');
    const auto nanoseconds = comma == std::string::npos
                                 ? std::nullopt
                                 : parsed_number<std::int64_t>(std::string_view(line).substr(begin, comma - begin));
    if (!nanoseconds || *nanoseconds < 0)
      throw InputError(place, "found '" + line.substr(0, 80) + "'; " + form + "; correct the line or take it out");
    const std::size_t name = line.find_first_not_of(blanks, comma + 1);
    const std::size_t end = line.find_last_not_of(blanks) + 1;
    if (name == std::string::npos || name >= end)
      throw InputError(place, std::string("names no file; ") + form + "; correct the line or take it out");
    // As of read_trajectory_file(), so that images and truth of one stamp have the same time.
    const ListedImage image{static_cast<double>(*nanoseconds) * 1e-9, line.substr(name, end - name), lines.number()};
    if (!images.empty() && !(images.back().timestamp < image.timestamp))
      throw InputError(place, "has a time stamp that is not later than that of line " +
                                  std::to_string(images.back().line) + "; expected stamps that rise from line to line");
    images.push_back(image);
  }
  if (images.empty()) throw InputError({file.string()}, std::string("is an empty list; ") + form);
  return images;
}

}  // namespace holdfast
