// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ctime>
#include <vector>

namespace holdfast {

inline double seconds_of_clock(clockid_t clock) {
  std::timespec time{};
  clock_gettime(clock, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

/// Time that the calling thread has computed [s]; other programs do not count.
inline double thread_seconds() { return seconds_of_clock(CLOCK_THREAD_CPUTIME_ID); }
/// Time that all threads of this process have computed [s].
inline double processor_seconds() { return seconds_of_clock(CLOCK_PROCESS_CPUTIME_ID); }

/// Adds the processor time that `run` takes of the calling thread.
template <class Run>
void time(std::vector<double>& times, const Run& run) {
  const double begin = thread_seconds();
  run();
  times.push_back(thread_seconds() - begin);
}

}  // namespace holdfast
