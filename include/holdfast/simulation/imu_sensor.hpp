// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "holdfast/core/imu.hpp"
#include "holdfast/core/random.hpp"
#include "holdfast/simulation/camera_path.hpp"

namespace holdfast::simulation {

/// A simulated IMU on a camera: the exact angular velocity and specific force of the path at each sample, with white
/// noise and biases that begin at a random value and walk, limited to the sensor's ranges (Furgale, Rehder and Siegwart
/// 2013, section III). Samples are taken `rate` times a second by the clock of the IMU, which differs from that of the
/// camera by the time offset; their time stamps are by the clock of the camera. Gravity points to -z of the world, with
/// standard_gravity. Deterministic for a seed. Used by one thread.
class ImuSensor {
 public:
  /// The path begins at the time 0; the first sample is at most one interval earlier, where the camera rests.
  ImuSensor(CameraPath path, const ImuCalibration& calibration, std::uint64_t seed);

  /// The samples for the frame at `timestamp` [s], which follows that of the last call; see SensorFrame::imu.
  std::vector<ImuSample> take(double timestamp);
  /// The exact measurement at a time, without noise and biases.
  ImuSample exact(double timestamp) const;
  /// The biases of the next sample.
  const ImuBias& bias() const { return bias_; }

 private:
  ImuSample measure(double timestamp);

  CameraPath path_;
  ImuCalibration calibration_;
  Random random_;
  ImuBias bias_;
  std::int64_t next_ = 0;           ///< number of the next sample
  std::vector<ImuSample> samples_;  ///< from the last one before the last frame on
  std::optional<double> last_;      ///< time stamp of the last frame
};

}  // namespace holdfast::simulation
