// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <utility>

#include "holdfast/config/configuration.hpp"
#include "holdfast/core/nearest_rotation.hpp"
#include "holdfast/plugin/did_you_mean.hpp"

namespace holdfast {

void ImuSettings::describe(ParameterTable<ImuSettings>& table) {
  using S = ImuSettings;
  table.add("name", &S::name, "of a known sensor, whose numbers count where none are given; empty = none");
  table.add("kalibr", &S::kalibr,
            "result files of Kalibr, whose numbers count where none are given: T_cam_imu and timeshift_cam_imu of cam0 "
            "in camchain-imucam.yaml, noise and update_rate of imu.yaml");
  table
      .add("T_body_camera", &S::T_body_camera,
           "pose of the camera on the IMU, the four rows of a matrix that maps points of the (left) camera to the axes "
           "of the IMU; empty = the camera's axes and position")
      .unit("m");
  table.add("rate", &S::rate, "measurements per second").range(10, 10000).unit("1/s");
  table
      .add(
          "time_offset", &S::time_offset,
          "time of an event by the clock of the IMU, minus that by the clock of the camera (Kalibr: timeshift_cam_imu)")
      .range(-1, 1)
      .unit("s");
  table.add("gyroscope_noise_density", &S::gyroscope_noise_density, "white noise of angular velocities")
      .range(1e-8, 10)
      .unit("rad/s/sqrt(Hz)");
  table.add("accelerometer_noise_density", &S::accelerometer_noise_density, "white noise of accelerations")
      .range(1e-8, 100)
      .unit("m/s^2/sqrt(Hz)");
  table.add("gyroscope_random_walk", &S::gyroscope_random_walk, "random walk of the gyroscope's bias")
      .range(1e-10, 10)
      .unit("rad/s^2/sqrt(Hz)");
  table.add("accelerometer_random_walk", &S::accelerometer_random_walk, "random walk of the accelerometer's bias")
      .range(1e-10, 100)
      .unit("m/s^3/sqrt(Hz)");
  table.add("gyroscope_range", &S::gyroscope_range, "largest angular velocity that is measured about an axis")
      .range(0.1, 1000)
      .unit("rad/s");
  table.add("accelerometer_range", &S::accelerometer_range, "largest acceleration that is measured along an axis")
      .range(10, 10000)
      .unit("m/s^2");
}

ImuSettings imu_settings(const ImuCalibration& calibration) {
  ImuSettings settings;
  settings.name = calibration.name;
  const Eigen::Matrix4d matrix = calibration.T_body_camera.matrix();
  if (!matrix.isIdentity(0.0))
    for (int row = 0; row < 4; ++row)
      settings.T_body_camera.push_back({matrix(row, 0), matrix(row, 1), matrix(row, 2), matrix(row, 3)});
  settings.rate = calibration.rate;
  settings.time_offset = calibration.time_offset;
  settings.gyroscope_noise_density = calibration.noise.gyroscope_noise_density;
  settings.accelerometer_noise_density = calibration.noise.accelerometer_noise_density;
  settings.gyroscope_random_walk = calibration.noise.gyroscope_random_walk;
  settings.accelerometer_random_walk = calibration.noise.accelerometer_random_walk;
  settings.gyroscope_range = calibration.gyroscope_range;
  settings.accelerometer_range = calibration.accelerometer_range;
  return settings;
}

namespace {

/// The rigid motion of a table. The nearest rotation takes the place of one that is rounded; nothing for other shapes
/// and for matrices that are far from a rotation.
std::optional<Eigen::Isometry3d> motion_of(const RealTable& rows) {
  Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
  if (rows.empty()) return motion;
  const bool is_square = rows.size() == 4 && std::all_of(rows.begin(), rows.end(), [](const std::vector<double>& row) {
                           return row.size() == 4;
                         });
  if (!is_square || rows[3] != std::vector<double>{0.0, 0.0, 0.0, 1.0}) return std::nullopt;
  for (std::size_t row = 0; row < 3; ++row)
    motion.matrix().row(static_cast<int>(row)) = Eigen::RowVector4d::Map(rows[row].data());
  const Eigen::Matrix3d turn = motion.linear();
  if (!(turn.transpose() * turn).isIdentity(0.01) || turn.determinant() < 0.0) return std::nullopt;
  if (!(turn.transpose() * turn).isIdentity(1e-14)) motion.linear() = nearest_rotation(turn);
  return motion;
}

using Kind = ConfigurationNode::Kind;

/// Keys of Kalibr and the parameters that have the same meaning, but for the matrix, which is the inverse.
constexpr std::pair<const char*, const char*> kalibr_keys[] = {
    {"T_cam_imu", "T_body_camera"},
    {"timeshift_cam_imu", "time_offset"},
    {"update_rate", "rate"},
    {"gyroscope_noise_density", "gyroscope_noise_density"},
    {"accelerometer_noise_density", "accelerometer_noise_density"},
    {"gyroscope_random_walk", "gyroscope_random_walk"},
    {"accelerometer_random_walk", "accelerometer_random_walk"}};

/// The section, with the numbers of Kalibr's files that it does not give. `has_inverse`: T_body_camera is T_cam_imu.
class KalibrSection {
 public:
  KalibrSection(const ConfigurationNode& node, std::vector<Diagnostic>& diagnostics)
      : section(node), diagnostics_(diagnostics) {
    const ConfigurationNode* files = node.find("kalibr");
    if (files == nullptr) return;
    if (files->kind == Kind::scalar) read(*files);
    for (const ConfigurationNode& file : files->items)
      if (file.kind == Kind::scalar) read(file);
    // A single name, for which a list of one stands.
    ConfigurationNode& given = *section.find("kalibr");
    if (given.kind == Kind::scalar) {
      given.items = {*files};
      given.kind = Kind::list;
    }
  }

  ConfigurationNode section;
  bool has_inverse = false;

 private:
  void read(const ConfigurationNode& name) {
    const std::filesystem::path file = (name.folder / name.text).lexically_normal();
    try {
      const ConfigurationNode root = read_yaml(file);
      const std::size_t before = section.entries.size();
      bool has_key = take(root);
      for (const char* part : {"cam0", "imu0"})
        if (const ConfigurationNode* node = root.find(part)) has_key = take(*node) || has_key;
      if (!has_key && section.entries.size() == before)
        diagnostics_.push_back({name.location, "found none of Kalibr's results in " + file.string() +
                                                   "; expected the camchain-imucam.yaml of "
                                                   "kalibr_calibrate_imu_camera, with T_cam_imu, or an imu.yaml"});
    } catch (const ConfigurationError& error) {
      diagnostics_.insert(diagnostics_.end(), error.diagnostics().begin(), error.diagnostics().end());
    } catch (const InputError& error) {
      diagnostics_.push_back({name.location, error.what()});
    }
  }

  /// Whether the node has a key of Kalibr. What the section gives stays.
  bool take(const ConfigurationNode& node) {
    bool has_key = false;
    for (const auto& [key, parameter] : kalibr_keys) {
      const ConfigurationNode* value = node.find(key);
      if (value == nullptr) continue;
      has_key = true;
      if (section.find(parameter) != nullptr) continue;
      section.entries.push_back({parameter, value->location, *value});
      has_inverse = has_inverse || std::string(key) == "T_cam_imu";
    }
    return has_key;
  }

  std::vector<Diagnostic>& diagnostics_;
};

/// Adds what is unknown about a name to `diagnostics`.
std::optional<ImuCalibration> known_imu(const ConfigurationNode& node, const std::string& more,
                                        std::vector<Diagnostic>& diagnostics) {
  const std::optional<ImuCalibration> known = find_imu(node.text);
  if (!known)
    diagnostics.push_back(
        {node.location, "there is no known IMU '" + node.text + "'; " + more + did_you_mean(node.text, imu_names())});
  return known;
}

}  // namespace

std::optional<ImuCalibration> read_imu(const ConfigurationNode& given, std::vector<Diagnostic>& diagnostics,
                                       const FindParameter& elsewhere) {
  if (given.kind == Kind::scalar)
    return known_imu(given, "expected a name, or numbers as { rate: 200, T_body_camera: ... }; ", diagnostics);
  const std::size_t before = diagnostics.size();
  const KalibrSection kalibr(given, diagnostics);
  const ConfigurationNode& node = kalibr.section;
  const ParameterTable<ImuSettings> table;
  std::vector<Parameter> parameters = table.parameters();
  const ConfigurationNode* name = node.find("name");
  if (name != nullptr && name->kind == Kind::scalar && !name->text.empty()) {
    const std::optional<ImuCalibration> known = known_imu(*name, "", diagnostics);
    if (!known) return std::nullopt;
    const ParameterValues numbers = table.values(imu_settings(*known));
    for (Parameter& parameter : parameters) parameter.default_value = numbers.at(parameter.name);
  }
  const ParameterValues values = read_parameters(node, parameters, "section 'imu'", diagnostics, elsewhere);
  if (diagnostics.size() != before) return std::nullopt;
  const ImuSettings s = table.settings(values);
  const ConfigurationNode* matrix = node.find("T_body_camera");
  const SourceLocation place = matrix != nullptr ? matrix->location : node.location;
  const std::optional<Eigen::Isometry3d> motion = motion_of(s.T_body_camera);
  if (!motion) {
    diagnostics.push_back(
        {place, "found " + to_string(ParameterValue(s.T_body_camera)) +
                    " for 'T_body_camera'; expected the four rows of a rigid motion, [[r, r, r, x], [r, r, "
                    "r, y], [r, r, r, z], [0, 0, 0, 1]], with a rotation matrix and metres"});
    return std::nullopt;
  }
  ImuCalibration calibration;
  calibration.name = s.name;
  calibration.T_body_camera = kalibr.has_inverse ? motion->inverse() : *motion;
  calibration.noise = {s.gyroscope_noise_density, s.accelerometer_noise_density, s.gyroscope_random_walk,
                       s.accelerometer_random_walk};
  calibration.rate = s.rate;
  calibration.time_offset = s.time_offset;
  calibration.gyroscope_range = s.gyroscope_range;
  calibration.accelerometer_range = s.accelerometer_range;
  if (const std::string trouble = calibration.trouble(); !trouble.empty()) {
    diagnostics.push_back({place, trouble});
    return std::nullopt;
  }
  return calibration;
}

}  // namespace holdfast
