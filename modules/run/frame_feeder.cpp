// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/run/frame_feeder.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

#include "holdfast/core/thread_name.hpp"

namespace holdfast {

FrameFeeder::FrameFeeder(FrameSource& source, const RunSettings& settings)
    : source_(source),
      settings_(settings),
      queue_(static_cast<std::size_t>(settings.frame_queue)),
      thread_([this] { read(); }) {}

FrameFeeder::~FrameFeeder() {
  stop();
  thread_.join();
}

void FrameFeeder::stop() {
  {
    const std::lock_guard lock(mutex_);
    stopped_ = true;
  }
  stopped_changed_.notify_all();
  queue_.close(true);
}

std::optional<FedFrame> FrameFeeder::next() {
  if (std::optional<FedFrame> frame = queue_.pop()) return frame;
  const std::lock_guard lock(mutex_);
  if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
  return std::nullopt;
}

std::vector<double> FrameFeeder::stamps() const {
  const std::lock_guard lock(mutex_);
  return stamps_;
}

std::uint64_t FrameFeeder::late() const {
  const std::lock_guard lock(mutex_);
  return late_;
}

double FrameFeeder::latest() const {
  const std::lock_guard lock(mutex_);
  return latest_;
}

bool FrameFeeder::wait_until_due(double timestamp, Stopwatch& since_due) {
  std::unique_lock lock(mutex_);
  if (!first_timestamp_) {
    first_timestamp_ = timestamp;
    since_first_.restart();
  }
  const double wait = timestamp - *first_timestamp_ - since_first_.seconds();
  if (wait < 0.0) {
    ++late_;
    latest_ = std::max(latest_, -wait);
  }
  stopped_changed_.wait_for(lock, std::chrono::duration<double>(std::max(wait, 0.0)), [this] { return stopped_; });
  since_due.restart(std::max(-wait, 0.0));
  return !stopped_;
}

void FrameFeeder::read() {
  name_this_thread("frame source");
  try {
    while (true) {
      const Stopwatch decoding;
      std::optional<SensorFrame> frame = source_.next();
      if (!frame) break;
      {
        const std::lock_guard lock(mutex_);
        stamps_.push_back(frame->timestamp);
      }
      FedFrame fed{std::move(*frame), decoding.seconds(), Stopwatch()};
      if (settings_.paced() && !wait_until_due(fed.frame.timestamp, fed.since_due)) break;
      const bool drop = settings_.paced() && settings_.late_frames == LateFrames::drop;
      if (!(drop ? queue_.push_newest(std::move(fed)) : queue_.push(std::move(fed)))) break;
    }
  } catch (...) {
    const std::lock_guard lock(mutex_);
    failure_ = std::current_exception();
  }
  queue_.close();
}

}  // namespace holdfast
