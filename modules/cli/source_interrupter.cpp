// SPDX-License-Identifier: BSD-3-Clause
#include "source_interrupter.hpp"

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <stop_token>

#include "terminal.hpp"

namespace holdfast {

namespace {

void interrupt_on_signal(const std::stop_token& ended, FrameSource& source) {
  using namespace std::chrono_literals;
  std::mutex mutex;
  std::condition_variable_any ends;
  std::unique_lock lock(mutex);
  while (!ends.wait_for(lock, ended, 50ms, [&] { return ended.stop_requested(); })) {
    if (!interrupted()) continue;
    source.interrupt();
    return;
  }
}

}  // namespace

SourceInterrupter::SourceInterrupter(FrameSource& source)
    : thread_([&source](const std::stop_token& ended) { interrupt_on_signal(ended, source); }) {}

}  // namespace holdfast
