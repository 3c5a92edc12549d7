// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>

namespace holdfast {

/// How far a robot may rely on the pose of a frame.
enum class HealthState {
  waiting,      ///< there is no map yet
  good,         ///< the pose is determined well
  degraded,     ///< there is a pose, but its error may be centimetres or more (HealthReason)
  inertial,     ///< the pose is predicted by inertial measurements and drifts
  relocalised,  ///< the pose has jumped (FrameHealth::jump): found after a loss, or moved with the corrected map
  lost,         ///< there is no pose
  stalled,      ///< no frame has arrived for several periods; Pipeline::health() only
};

/// Why a frame is degraded, or what explains it.
enum class HealthReason : std::uint8_t {
  few_inliers,    ///< few map points agree with the pose
  poor_geometry,  ///< the standard deviation of the position is large: points are few, far or on one side
  fallback,       ///< the map did not determine the pose (TrackingFallback)
  unconfirmed,    ///< found after a loss by few inliers; later frames may withdraw the pose
  new_map,        ///< the map began anew: this pose and those before the loss are not connected
  few_features,   ///< the image has few static features, as of a blurred or dark image or a bare wall; explains only
  hidden_view,    ///< masks or filters mark more than half of the view as movable or moving; explains only
};
inline constexpr int health_reason_count = 7;

const char* to_string(HealthState state);
const char* to_string(HealthReason reason);

/// A set of reasons.
class HealthReasons {
 public:
  void add(HealthReason reason) { bits_ |= bit(reason); }
  bool has(HealthReason reason) const { return (bits_ & bit(reason)) != 0; }
  bool empty() const { return bits_ == 0; }
  friend bool operator==(const HealthReasons&, const HealthReasons&) = default;

 private:
  static std::uint8_t bit(HealthReason reason) {
    return static_cast<std::uint8_t>(1U << static_cast<unsigned>(reason));
  }
  std::uint8_t bits_ = 0;
};

/// Health of one frame.
struct FrameHealth {
  HealthState state = HealthState::waiting;
  HealthReasons reasons;
  /// State relocalised: distance from the last reported pose, or by which corrections moved that pose; in the unit of
  /// the map.
  double jump = 0.0;
};

/// Health of a pipeline (Pipeline::health()): that of the last frame, and whether frames arrive.
struct PipelineHealth {
  FrameHealth health;
  std::uint64_t frame = 0;  ///< index of the last frame
  double timestamp = 0.0;   ///< of the last frame [s]
  std::optional<Eigen::Isometry3d> T_world_camera;
  std::optional<Eigen::Matrix<double, 6, 6>> covariance;  ///< FrameResult::covariance
  double since_frame = 0.0;                               ///< time on the clock since the result of the last frame [s]
  double frame_period = 0.0;  ///< usual time on the clock between results [s]; 0 before the second one
};

}  // namespace holdfast
