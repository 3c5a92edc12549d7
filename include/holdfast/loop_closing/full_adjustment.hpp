// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <cstdint>
#include <mutex>
#include <span>
#include <vector>

#include "holdfast/core/map.hpp"
#include "holdfast/core/map_mutex.hpp"
#include "holdfast/interfaces/inertial_history.hpp"
#include "holdfast/interfaces/optimizer.hpp"
#include "holdfast/loop_closing/full_adjustment_summary.hpp"
#include "holdfast/loop_closing/loop_closing_settings.hpp"

namespace holdfast {

/// Bundle adjustment of the whole map after a loop (Mur-Artal and Tardos 2017, section III-E), concurrent with tracking
/// and mapping: prepare() preintegrates without a lock and copies the map under the structure mutex and its lock,
/// solve() works on the copy without any lock, apply() writes the result to the map under the structure mutex and the
/// map's lock. Keyframes inserted meanwhile are moved with their parents, points with their reference keyframes;
/// removed ones are skipped. The oldest keyframe is fixed. With inertial measurements, factors link the keyframes:
/// those behind a view that people hid, which hardly share a point with the others, are then placed by the motion from
/// both sides (Campos et al. 2021, section VI-B). If the factors cannot be used, the map is adjusted without them.
///
/// A stopped adjustment is never applied, because a new loop has moved the map or the run ends.
///
/// Threads: prepare, solve and apply are called in this order by one thread at a time, request_stop by any thread. A
/// request is effective from prepare() to the end of apply(); prepare() clears earlier requests, except that of
/// cancel(). With one thread, the same map gives bit-identical results.
class FullAdjustment {
 public:
  /// All references must outlive this object.
  FullAdjustment(const LoopClosingSettings& settings, const SharedMap& shared, Optimizer& optimizer);

  /// Links keyframes by these measurements, which must outlive this object and get the gravity that is found.
  void use_inertia(InertialHistory& history) { inertia_ = &history; }
  /// Copies the map. Acquires the structure mutex and the map's lock.
  void prepare();
  /// Solves the problem without a lock; checks for a request to stop between iterations.
  void solve();
  /// Applies the result, and frees the copy. Acquires the structure mutex, and the map's lock for a few milliseconds at
  /// a time.
  FullAdjustmentSummary apply();
  /// Calls the three functions in order; for sequential mode.
  FullAdjustmentSummary run() {
    prepare();
    solve();
    return apply();
  }

  /// Time stamps of the keyframes that the last adjustment placed [s], with inertial measurements: neither fixed nor
  /// carried with others. None if it was not applied. For the thread that calls apply().
  const std::vector<double>& placed_keyframes() const { return placed_keyframes_; }

  /// Requests solve() to end within one iteration and apply() to have no effect.
  void request_stop();
  /// Stops this adjustment and all later ones, which end before their first iteration. From any thread.
  void cancel();

 private:
  void find_links();
  BundleSummary solve_with_inertia();
  void drop_stale_links();
  void copy_poses();
  void add_links();
  void copy_points();
  void change_map();
  void move_map();
  void keep_motions(std::span<const Eigen::Isometry3d> poses);
  void remove_outliers();

  LoopClosingSettings settings_;
  Map& map_;
  MapMutex& map_mutex_;
  std::mutex& structure_mutex_;
  Optimizer& optimizer_;
  InertialHistory* inertia_ = nullptr;
  std::atomic<bool> stop_{false};
  std::atomic<bool> cancelled_{false};
  std::atomic<std::int64_t> stop_time_{0};  // [ns] of the steady clock; 0 = not requested
  BundleProblem problem_;
  std::vector<KeyFrameId> keyframes_;         // by pose
  std::vector<KeyFrameId> linkable_;          // keyframes when the links were found
  std::vector<InertialHistory::Link> links_;  // between indices of linkable_
  std::uint32_t linked_submap_ = 0;
  std::vector<std::uint32_t> cluster_;                // by pose, of keyframes that share ample points
  std::vector<std::uint8_t> is_linked_;               // by pose, whether it has an inertial factor
  std::vector<std::uint8_t> is_fixed_without_links_;  // by pose
  std::vector<MapPointId> points_;                    // by point
  std::vector<Eigen::Vector3d> before_;               // positions of the points before the adjustment
  std::vector<double> placed_keyframes_;
  FullAdjustmentSummary summary_;
};

}  // namespace holdfast
