// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "holdfast/core/imu.hpp"
#include "holdfast/core/imu_timeline.hpp"
#include "holdfast/core/sensor_frame.hpp"
#include "holdfast/core/warning.hpp"
#include "holdfast/interfaces/frame_source.hpp"

namespace holdfast {

/// The comment line that begins every file of inertial measurements that is written: the columns and their units.
inline constexpr const char* imu_header =
    "# timestamp [s], angular velocity x y z [rad/s], specific force x y z [m/s^2], in the body frame\n";

/// The line of a sample, as read_imu_samples() reads it, with all digits that its numbers need.
std::string imu_sample_text(const ImuSample& sample);

/// Reads a file of inertial measurements: lines of seven numbers, separated by commas or blanks: time stamp, angular
/// velocity x, y, z [rad/s], specific force x, y, z [m/s^2]. Time stamps are seconds or, as in the ASL layout of EuRoC,
/// whole nanoseconds, and increase strictly. '#' begins a comment, and the first line may name the columns. Throws
/// InputError (file and line) for anything else.
std::vector<ImuSample> read_imu_samples(const std::filesystem::path& file);

/// The file of inertial measurements of a recording: `name` in `folder` or, if it is empty, an imu.csv there that
/// begins with imu_header; empty without one.
std::filesystem::path find_imu_file(const std::filesystem::path& folder, const std::filesystem::path& name);

/// The inertial measurements of a recording for a frame source. Used by one thread.
class RecordedImu {
 public:
  /// No measurements.
  RecordedImu() = default;
  /// Reads a file; none for an empty path. `frame_timestamps` are those of the frames to come. Throws InputError as
  /// read_imu_samples() does, and for measurements at other times than the frames.
  RecordedImu(const std::filesystem::path& file, const std::optional<ImuCalibration>& calibration,
              std::span<const double> frame_timestamps);

  /// Measurements by the clock of the IMU, which were read at `place`; no measurements if there are none.
  RecordedImu(std::vector<ImuSample> samples, const std::string& place,
              const std::optional<ImuCalibration>& calibration, std::span<const double> frame_timestamps);

  /// Sets SourceDescription::has_imu and imu.
  void describe(SourceDescription& description) const;
  /// Sets SensorFrame::imu; frames come in their order.
  void add_to(SensorFrame& frame);
  /// Suspicions about the measurements (core/imu_plausibility.hpp), and the frames that they do not cover.
  const Warnings& warnings() const { return warnings_; }

 private:
  void check_times(const std::string& place, std::span<const double> frame_timestamps);

  std::optional<ImuCalibration> calibration_;
  ImuTimeline timeline_;
  Warnings warnings_;
};

}  // namespace holdfast
