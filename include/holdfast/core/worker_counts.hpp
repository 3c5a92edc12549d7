// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>

namespace holdfast {

/// Cumulative statistics of a bounded queue.
struct QueueCounts {
  std::size_t capacity = 0;
  std::size_t taken = 0;      ///< values that came out
  std::size_t dropped = 0;    ///< values that newer ones pushed out
  std::size_t longest = 0;    ///< most values that waited at one time
  double wait_total = 0.0;    ///< sum over the values that came out [s]
  double wait_longest = 0.0;  ///< [s]

  /// Of the values that came out [s].
  double mean_wait() const { return taken == 0 ? 0.0 : wait_total / static_cast<double>(taken); }
};

/// Cumulative statistics of a thread of the pipeline.
struct WorkerCounts {
  std::string name;
  QueueCounts queue;
  double busy_seconds = 0.0;
};

}  // namespace holdfast
