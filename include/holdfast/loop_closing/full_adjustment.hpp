// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <cstdint>
#include <mutex>
#include <vector>

#include "holdfast/core/map.hpp"
#include "holdfast/core/map_mutex.hpp"
#include "holdfast/interfaces/optimizer.hpp"
#include "holdfast/loop_closing/loop_closing_settings.hpp"

namespace holdfast {

/// What an adjustment of the whole map did.
struct FullAdjustmentSummary {
  BundleSummary bundle;
  bool applied = false;  ///< false: the map is as before
  int keyframes = 0;
  int points = 0;
  int observations = 0;
  int keyframes_carried = 0;  ///< added meanwhile, moved along with their parents
  int points_carried = 0;     ///< added meanwhile, moved along with their reference keyframes
  double seconds_per_iteration = 0.0;
  bool stop_requested = false;
  double stop_seconds = 0.0;  ///< from the request to the end of the solver; 0 without one
};

/// Bundle adjustment of the whole map after a loop (Mur-Artal and Tardos 2017, section III-E), beside tracking and
/// mapping: prepare() copies the map under `work` and its lock, solve() works on the copy without any lock, apply() brings the
/// result into the map under `work` and the map's lock. What the map gained in between follows: keyframes their
/// parents, points their reference keyframes; what it lost is passed over. The oldest keyframe stays where it is.
///
/// An adjustment that was asked to stop is never applied: either a new loop has moved the map since, or the run ends.
///
/// Threads: prepare, solve and apply in this order by one thread at a time; request_stop by any. A request counts from
/// prepare() to the end of apply(); prepare() begins with a clean slate. One thread and the same map: the same bits.
class FullAdjustment {
 public:
  /// All references must outlive this.
  FullAdjustment(const LoopClosingSettings& settings, Map& map, MapMutex& map_mutex, std::mutex& work,
                 Optimizer& optimizer);

  /// Copies the map. Takes `work` and the map's lock.
  void prepare();
  /// Takes no lock; looks at the request to stop between iterations.
  void solve();
  /// Takes `work`, and the map's lock for a few milliseconds at a time.
  FullAdjustmentSummary apply();
  /// The three in turn: for sequential mode.
  FullAdjustmentSummary run() {
    prepare();
    solve();
    return apply();
  }

  /// Makes solve() end within one iteration and apply() do nothing.
  void request_stop();

 private:
  void move_map();
  void remove_outliers();

  LoopClosingSettings settings_;
  Map& map_;
  MapMutex& map_mutex_;
  std::mutex& work_;
  Optimizer& optimizer_;
  std::atomic<bool> stop_{false};
  std::atomic<std::int64_t> stop_time_{0};  // [ns] of the steady clock; 0 = not asked
  BundleProblem problem_;
  std::vector<KeyFrameId> keyframes_;    // by pose
  std::vector<MapPointId> points_;       // by point
  std::vector<Eigen::Vector3d> before_;  // where the points were
  FullAdjustmentSummary summary_;
};

}  // namespace holdfast
