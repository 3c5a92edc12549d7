// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/run/frame_feeder.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "holdfast/core/thread_name.hpp"
#include "repeated_images.hpp"

namespace holdfast {

namespace {

/// Of a frame when it was read, above which those that are due already are dropped [s]: three frames at 30 Hz, so that
/// a short pause costs none.
constexpr double longest_lateness = 0.1;

}  // namespace

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
  source_.interrupt();
  queue_.close(true);
}

std::optional<FedFrame> FrameFeeder::next(const std::function<bool()>& stop) {
  if (std::optional<FedFrame> frame = stop ? queue_.pop_while([&] { return !stop(); }) : queue_.pop()) return frame;
  const std::lock_guard lock(mutex_);
  if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
  return std::nullopt;
}

QueueCounts FrameFeeder::counts() const {
  QueueCounts counts = queue_.counts();
  const std::lock_guard lock(mutex_);
  counts.dropped += passed_over_;
  return counts;
}

std::vector<double> FrameFeeder::stamps() const {
  const std::lock_guard lock(mutex_);
  return stamps_;
}

std::uint64_t FrameFeeder::late() const {
  const std::lock_guard lock(mutex_);
  return late_;
}

double FrameFeeder::largest_delay() const {
  const std::lock_guard lock(mutex_);
  return largest_delay_;
}

bool FrameFeeder::wait_until_due(double timestamp, Stopwatch& since_due) {
  std::unique_lock lock(mutex_);
  if (!std::isfinite(timestamp)) return !stopped_;  // never due; Pipeline::feed() refuses it
  if (!first_timestamp_) {
    first_timestamp_ = timestamp;
    since_first_.restart();
  }
  const double wait = timestamp - *first_timestamp_ - since_first_.seconds();
  lateness_ = std::max(-wait, 0.0);
  if (wait < 0.0) {
    ++late_;
    largest_delay_ = std::max(largest_delay_, -wait);
  }
  stopped_changed_.wait_for(lock, std::chrono::duration<double>(std::max(wait, 0.0)), [this] { return stopped_; });
  since_due.restart(lateness_);
  return !stopped_;
}

/// A reader that is slower than the clock is later with every frame, however short the queue is.
void FrameFeeder::pass_over_late_frames() {
  const std::unique_lock lock(mutex_);
  if (!first_timestamp_ || lateness_ < longest_lateness) return;
  const std::vector<double> stamps = source_.pass_over(*first_timestamp_ + since_first_.seconds());
  stamps_.insert(stamps_.end(), stamps.begin(), stamps.end());
  passed_over_ += stamps.size();
}

void FrameFeeder::read() {
  name_this_thread("frame source");
  const bool drop = settings_.paced() && settings_.late_frames == LateFrames::drop;
  try {
    while (true) {
      if (drop) pass_over_late_frames();
      const Stopwatch decoding;
      std::optional<SensorFrame> frame = source_.next();
      if (!frame) break;
      {
        const std::lock_guard lock(mutex_);
        stamps_.push_back(frame->timestamp);
      }
      const double decode_seconds = decoding.seconds();
      const std::uint64_t fingerprint = image_fingerprint(frame->colour);
      FedFrame fed{std::move(*frame), decode_seconds, fingerprint, Stopwatch()};
      if (settings_.paced() && !wait_until_due(fed.frame.timestamp, fed.since_due)) break;
      if (!(drop ? queue_.push_newest(std::move(fed)) : queue_.push(std::move(fed)))) break;
    }
  } catch (...) {
    const std::lock_guard lock(mutex_);
    failure_ = std::current_exception();
  }
  queue_.close();
}

}  // namespace holdfast
