// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "holdfast/core/camera.hpp"
#include "holdfast/core/imu.hpp"
#include "holdfast/core/sensor.hpp"
#include "holdfast/core/warning.hpp"

namespace holdfast {

/// Base class of all interfaces that a plugin can implement (interfaces/*.hpp).
class Module {
 public:
  virtual ~Module() = default;
  Module(const Module&) = delete;
  Module& operator=(const Module&) = delete;

  /// Warnings about the module's input: its files after construction, its frames after the last one. Called before the
  /// first frame and after the last one, while no other thread uses the module. See core/warning.hpp.
  virtual Warnings warnings() const { return {}; }

 protected:
  Module() = default;
};

/// Information about the run that a module receives on construction, in addition to its settings.
struct CreationContext {
  Camera camera = {};                           ///< camera of the run
  std::uint64_t seed = 1;                       ///< the only seed of the run; derive a module's own with Random::fork
  bool sequential = true;                       ///< if true, results must be bit-identical from run to run
  std::filesystem::path output_directory = {};  ///< for observers that write files; empty if nothing is written
  /// Class names of the source's FrameTruth::class_labels, by index; empty if the source has none, and for the source
  /// itself.
  std::vector<std::string> class_names = {};
  /// Sensor mode of the run, if it is configured; empty = all images of the source are used.
  std::optional<Sensor> sensor = {};
  /// SourceDescription::frame_timestamps of the source; empty for the source itself.
  std::vector<double> frame_timestamps = {};
  /// The configured calibration of the IMU; empty = the source's own, if it has one.
  std::optional<ImuCalibration> imu = {};
};

}  // namespace holdfast
