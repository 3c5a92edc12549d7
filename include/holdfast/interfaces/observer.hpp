// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "holdfast/core/cloud_point.hpp"
#include "holdfast/core/frame.hpp"
#include "holdfast/core/frame_result.hpp"
#include "holdfast/core/map.hpp"
#include "holdfast/core/map_snapshot.hpp"
#include "holdfast/core/module.hpp"
#include "holdfast/core/sensor_frame.hpp"
#include "holdfast/core/surface_patch.hpp"

namespace holdfast {

/// Access of observers to the map of a run in progress: a snapshot that is copied on first use and shared by all
/// observers of one event. Valid during the call of the observer, in its thread.
class ObservedMap {
 public:
  /// `copy` makes the snapshot and takes the lock of the map if there is one.
  explicit ObservedMap(std::function<MapSnapshot()> copy) : copy_(std::move(copy)) {}

  /// The map at the time of the first call. Copying holds the lock of the map for about 2 ms per 50,000 points.
  const MapSnapshot& snapshot() const {
    if (!snapshot_) snapshot_ = copy_();
    return *snapshot_;
  }

 private:
  std::function<MapSnapshot()> copy_;
  mutable std::optional<MapSnapshot> snapshot_;
};

/// The static scene as observed by a keyframe of the dense map. Valid during the call of the observer.
struct ObservedView {
  KeyFrameId keyframe = {};
  double timestamp = 0.0;                                            ///< of the keyframe [s]
  Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();  ///< pose of the keyframe at the time of the call
  /// Coloured points of static surfaces in the frame of the camera [m]: at most `max_count`, evenly over the image. The
  /// cost is proportional to the number, about 0.02 ms for 5000.
  std::function<std::vector<CloudPoint>(std::size_t max_count)> points = {};
};

/// The fused surface (SurfaceSettings) of a run in progress. Valid during the call of the observer.
struct ObservedSurface {
  std::uint64_t version = 0;  ///< grows with each change
  /// Meshes of the cubes of 8^3 voxels in which the surface may have changed since an earlier version; since 0: of all
  /// in which there is surface. `coarseness` 0, 1 or 2: one sample per 1, 2 or 4 voxels along each axis. Parts that are
  /// too small for the mesh of the run, and remnants of what disappeared, are included. About 0.02 ms per cube.
  std::function<std::vector<SurfacePatch>(std::uint64_t since, int coarseness)> changes = {};
};

/// Observes a run. Every method does nothing unless overridden. In sequential mode the thread that feeds frames calls
/// all of them; arguments are valid during the call only. No lock is held during a call: a slow observer delays the
/// thread that calls it, and no other. An exception ends the run, and feed() or finish() throws it; interrupt() throws
/// none.
class Observer : public Module {
 public:
  static constexpr const char* kind = "observers";

  /// Once, before the first frame. `classes`: names of the segmenter's classes by label, see Segmenter::classes();
  /// empty without a segmenter.
  virtual void on_start(const std::vector<std::string>& /*classes*/) {}
  /// After each frame, by the tracking thread.
  virtual void on_frame(const SensorFrame&, const Frame&, const FrameResult&) {}
  /// After local mapping has processed a keyframe that is still in the map, by the mapping thread.
  virtual void on_keyframe(KeyFrameId, const ObservedMap&) {}
  /// When a keyframe's mask is final and the dense map has kept its image, by the tracking thread, or by the one that
  /// calls finish(); never without DenseMapSettings::enabled.
  virtual void on_static_view(const ObservedView&) {}
  /// After views were fused into the surface, by the thread that fuses them, or by the one that calls finish(); never
  /// without SurfaceSettings::enabled.
  virtual void on_surface(const ObservedSurface&) {}
  /// After a loop was closed between two keyframes, by the loop closing thread.
  virtual void on_loop(KeyFrameId, KeyFrameId, const ObservedMap&) {}
  /// Once at the end of the run, when all threads have ended, by the thread that calls finish().
  virtual void on_finish(const Map&) {}
  /// When the run is interrupted (Pipeline::interrupt()), by any thread, also during another call, and more than once:
  /// an observer that waits for somebody, such as a browser, goes on and does not wait again. Must not throw: it is
  /// called where nobody could catch an exception, such as in a std::stop_callback.
  virtual void interrupt() noexcept {}
};

}  // namespace holdfast
