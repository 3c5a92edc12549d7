// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include "holdfast/core/imu.hpp"
#include "holdfast/core/map.hpp"
#include "holdfast/core/map_inertia.hpp"
#include "holdfast/core/sensor_frame.hpp"
#include "holdfast/interfaces/optimizer.hpp"

namespace holdfast {

/// Whether estimates belong to this calibration: those of an IMU that is mounted or timed otherwise do not fit.
bool is_calibrated_as(const MapInertia& estimates, const ImuCalibration& imu);

/// The inertial measurements of a run, from which adjustments preintegrate the motion between any two keyframes: a
/// keyframe that is culled needs no merging. The latest 240,000 measurements are kept (15 MB): 20 minutes at 200 Hz, 4
/// at 1 kHz. Any thread.
class InertialHistory {
 public:
  /// `first_sequence`: of the first keyframe of this run. Those before it are of another run, whose time stamps say
  /// nothing about these measurements.
  explicit InertialHistory(const ImuCalibration& imu, std::uint64_t first_sequence = 0)
      : imu_(imu), first_sequence_(first_sequence) {}

  /// Adds the measurements of a frame; frames must be passed in temporal order.
  void add(const SensorFrame& frame);
  /// Sets the estimates of tracking, in the world of a submap, whose keyframes are linked from now on. Where it has
  /// none any more, because images contradicted its state, the last ones in this submap stay. Without any, there are no
  /// links. Estimates of another calibration count as none.
  void set_estimates(const std::optional<MapInertia>& estimates, std::uint32_t submap);
  /// Replaces the gravity of these estimates, where there are any.
  void set_gravity(const Eigen::Vector3d& gravity, std::uint32_t submap);
  /// Forgets all estimates: the map was cleared, and begins again with submap 0 and the first keyframe.
  void forget_map();
  std::optional<MapInertia> estimates() const;
  /// Calibration as it is given.
  const ImuCalibration& imu() const { return imu_; }
  /// The measurements that are kept, by the clock of the camera.
  std::vector<ImuSample> samples() const;
  /// The nominal calibration, with which nothing else is known.
  MapInertia nominal() const;
  /// Submap whose keyframes the measurements link.
  std::uint32_t submap() const;
  std::uint64_t first_sequence() const;

  /// Preintegrated motion between two entries of a list.
  struct Link {
    std::size_t first = 0, second = 0;
    geometry::Preintegration measured;
  };
  /// The motions between successive time stamps [s], in temporal order; entries that are NaN are skipped. There is no
  /// link over a gap or a saturated measurement, or over more than 5 s, without estimates, outside what is kept, and
  /// where a single measurement leaves position and velocity without a covariance of full rank.
  std::vector<Link> links(std::span<const double> timestamps) const;
  /// The same with other estimates of biases and time offset.
  std::vector<Link> links(std::span<const double> timestamps, const MapInertia& estimates) const;

 private:
  std::optional<geometry::Preintegration> motion_between(std::span<const ImuSample> samples, double begin, double end,
                                                         const MapInertia& estimates) const;

  const ImuCalibration imu_;
  mutable std::mutex mutex_;  // of all below
  std::vector<ImuSample> samples_;
  std::map<std::uint32_t, MapInertia> estimates_;  // by submap
  std::uint32_t submap_ = 0;
  std::uint64_t first_sequence_ = 0;
};

/// Time stamps of the keyframes of this run in the submap that the history links [s], NaN of the others.
std::vector<double> linkable_stamps(const Map& map, std::span<const KeyFrameId> keyframes,
                                    const InertialHistory& history);

/// Adds motions and inertial factors between the linked poses to a bundle problem, with biases, gravity, scale (fixed)
/// and calibration as estimated, and velocities that follow from the poses (Campos et al. 2021, section
/// VI-B: the graph of visual-inertial adjustments). Biases have a prior where a chain of factors begins. `links`: of
/// InertialHistory::links(), between indices of poses. Returns, for each pose, whether it belongs to a factor.
std::vector<std::uint8_t> add_inertial_factors(BundleProblem& problem, std::span<const InertialHistory::Link> links,
                                               const MapInertia& estimates);

}  // namespace holdfast
