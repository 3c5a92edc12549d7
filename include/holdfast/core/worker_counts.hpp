// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>

namespace holdfast {

/// Cumulative statistics of a bounded queue.
struct QueueCounts {
  std::size_t capacity = 0;
  std::size_t taken = 0;      ///< values taken from the queue
  std::size_t dropped = 0;    ///< values dropped in favour of newer ones
  std::size_t longest = 0;    ///< maximum length of the queue
  double wait_total = 0.0;    ///< sum over the values taken [s]
  double wait_longest = 0.0;  ///< [s]

  /// Mean waiting time of these values [s].
  double mean_wait() const { return taken == 0 ? 0.0 : wait_total / static_cast<double>(taken); }
};

/// Cumulative statistics of a thread of the pipeline.
struct WorkerCounts {
  std::string name;
  QueueCounts queue;
  double busy_seconds = 0.0;
};

}  // namespace holdfast
