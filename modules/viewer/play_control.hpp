// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <mutex>
#include <optional>

#include "holdfast/core/stage_times.hpp"

namespace holdfast::viewer {

/// Pause, step and speed of a run, and whether anybody watches. Any thread may call any method; waiting is done in the
/// thread that runs.
class PlayControl {
 public:
  explicit PlayControl(double speed);
  ~PlayControl();
  PlayControl(const PlayControl&) = delete;
  PlayControl& operator=(const PlayControl&) = delete;

  void pause();
  void resume();
  /// Pauses after one more frame.
  void step();
  /// 1 = at the time stamps, 0 = as fast as it goes.
  void set_speed(double speed);
  /// The number of browsers. Without any there is no pause.
  void set_watchers(int count);
  /// Ends all waiting for good.
  void close();

  bool is_paused() const;
  double speed() const;
  int watchers() const { return watchers_; }

  /// See Viewer::take_turn() and Viewer::wait_for_browser().
  void take_turn(double timestamp);
  void wait_for_watcher();

 private:
  void wake() const;
  /// Waits for a change or a timeout [s], negative = none. False after a signal.
  bool wait(double seconds) const;
  /// How long the frame has to wait by now [s]; negative: until something changes; nothing: not at all.
  std::optional<double> remaining(double timestamp);

  int event_;  // a descriptor, because waiting for one ends with a signal, and waiting for a condition does not
  mutable std::mutex mutex_;
  bool paused_ = false, closed_ = false;
  int steps_ = 0;
  double speed_;
  std::optional<double> first_timestamp_;  // of those paced by since_first_
  Stopwatch since_first_;
  std::atomic<int> watchers_ = 0;
};

}  // namespace holdfast::viewer
