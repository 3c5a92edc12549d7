// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <string_view>
#include <vector>

namespace holdfast {

/// Seconds of monotonic wall-clock time since construction or the last restart.
class Stopwatch {
 public:
  double seconds() const { return std::chrono::duration<double>(Clock::now() - begin_).count(); }
  /// Restarts the measurement at `already` seconds.
  void restart(double already = 0.0) {
    begin_ = Clock::now() - std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(already));
  }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point begin_ = Clock::now();
};

/// Processing time of one frame per stage, in the order in which the stages ended.
class StageTimes {
 public:
  /// A stage and its processing time [s].
  struct Entry {
    std::string_view stage;  ///< must be a string literal
    double seconds = 0.0;
  };
  /// Adds time to a stage of this frame [s].
  void add(std::string_view stage, double seconds) {
    for (Entry& entry : entries_)
      if (entry.stage == stage) {
        entry.seconds += seconds;
        return;
      }
    entries_.push_back({stage, seconds});
  }
  const std::vector<Entry>& entries() const { return entries_; }
  void clear() { entries_.clear(); }

 private:
  std::vector<Entry> entries_;
};

/// Adds the duration of its lifetime to a stage.
class StageTimer {
 public:
  StageTimer(StageTimes& times, std::string_view stage) : times_(times), stage_(stage) {}
  ~StageTimer() { times_.add(stage_, watch_.seconds()); }
  StageTimer(const StageTimer&) = delete;
  StageTimer& operator=(const StageTimer&) = delete;

 private:
  StageTimes& times_;
  std::string_view stage_;
  Stopwatch watch_;
};

}  // namespace holdfast
