// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
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

/// The inertial measurements of a run, from which adjustments preintegrate the motion between any two keyframes: a
/// keyframe that is culled needs no merging. The latest 20 minutes at 200 Hz are kept (15 MB). Any thread.
class InertialHistory {
 public:
  /// `scale_is_known`: the unit of the map is the metre.
  InertialHistory(const ImuCalibration& imu, bool scale_is_known) : imu_(imu), scale_is_known_(scale_is_known) {}

  /// Adds the measurements of a frame; frames must be passed in temporal order.
  void add(const SensorFrame& frame);
  /// Sets the estimates of tracking, in the world of a submap. Where it has none any more, because images contradicted
  /// its state, the last ones in this submap stay. Without any, there are no links.
  void set_estimates(const std::optional<MapInertia>& estimates, std::uint32_t submap);
  std::optional<MapInertia> estimates() const;
  /// Submap whose keyframes the measurements link.
  std::uint32_t submap() const;
  bool scale_is_known() const { return scale_is_known_; }

  /// Preintegrated motion between two entries of a list.
  struct Link {
    std::size_t first = 0, second = 0;
    geometry::Preintegration measured;
  };
  /// The motions between successive time stamps [s], in temporal order; entries that are NaN are skipped. There is no
  /// link over a gap or a saturated measurement, or over more than 5 s, without estimates, and outside what is kept.
  std::vector<Link> links(std::span<const double> timestamps) const;

 private:
  std::optional<geometry::Preintegration> motion_between(double begin, double end, const MapInertia& estimates) const;

  const ImuCalibration imu_;
  const bool scale_is_known_;
  mutable std::mutex mutex_;  // of all below
  std::vector<ImuSample> samples_;
  std::vector<double> saturated_;  // time stamps [s]
  std::optional<MapInertia> estimates_;
  std::uint32_t submap_ = 0;
};

/// Time stamps of the keyframes that belong to the submap [s], NaN of the others.
std::vector<double> linkable_stamps(const Map& map, std::span<const KeyFrameId> keyframes, std::uint32_t submap);

/// Adds motions and inertial factors between successive poses to a bundle problem, with biases, gravity, scale and
/// calibration as tracking estimates them, and velocities that follow from the poses (Campos et al. 2021, section VI-B:
/// the graph of visual-inertial adjustments). Biases have a prior where a chain of factors begins. `timestamps`: of
/// each pose [s]; NaN = not linked. Returns, for each pose, whether it belongs to a factor.
std::vector<std::uint8_t> add_inertial_factors(BundleProblem& problem, std::span<const double> timestamps,
                                               const InertialHistory& history);

}  // namespace holdfast
