// SPDX-License-Identifier: BSD-3-Clause
#include "play_control.hpp"

#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>

#include "holdfast/core/error.hpp"

namespace holdfast::viewer {

namespace {

/// A run that is so late [s] does not catch up: it goes on at the chosen speed from where it is.
constexpr double latest = 0.5;

}  // namespace

PlayControl::PlayControl(double speed) : event_(eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)), speed_(speed) {
  if (event_ < 0) throw Error("the viewer cannot make an event descriptor; are too many files open?");
}

PlayControl::~PlayControl() { ::close(event_); }

void PlayControl::wake() const {
  const std::uint64_t one = 1;
  [[maybe_unused]] const ssize_t written = write(event_, &one, sizeof(one));  // a full counter wakes as well
}

void PlayControl::pause() {
  const std::lock_guard lock(mutex_);
  paused_ = watchers_ > 0;
  steps_ = 0;
}

void PlayControl::resume() {
  const std::lock_guard lock(mutex_);
  paused_ = false;
  first_timestamp_.reset();
  wake();
}

void PlayControl::step() {
  const std::lock_guard lock(mutex_);
  paused_ = watchers_ > 0;
  ++steps_;
  wake();
}

void PlayControl::set_speed(double speed) {
  const std::lock_guard lock(mutex_);
  speed_ = speed;
  first_timestamp_.reset();
  wake();
}

void PlayControl::set_watchers(int count) {
  const std::lock_guard lock(mutex_);
  watchers_ = count;
  if (count == 0) paused_ = false;
  wake();
}

void PlayControl::close() {
  const std::lock_guard lock(mutex_);
  closed_ = true;
  wake();
}

bool PlayControl::is_paused() const {
  const std::lock_guard lock(mutex_);
  return paused_;
}

double PlayControl::speed() const {
  const std::lock_guard lock(mutex_);
  return speed_;
}

bool PlayControl::wait(double seconds) const {
  pollfd change{event_, POLLIN, 0};
  const int timeout = seconds < 0.0 ? -1 : static_cast<int>(std::ceil(std::min(seconds, 3600.0) * 1e3));
  if (poll(&change, 1, timeout) < 0 && errno == EINTR) return false;
  std::uint64_t count = 0;
  [[maybe_unused]] const ssize_t taken = read(event_, &count, sizeof(count));
  return true;
}

std::optional<double> PlayControl::remaining(double timestamp) {
  const std::lock_guard lock(mutex_);
  if (closed_ || watchers_ == 0) return std::nullopt;
  if (paused_) {
    if (steps_ == 0) return -1.0;
    --steps_;
    first_timestamp_.reset();
    return std::nullopt;
  }
  if (speed_ <= 0.0) return std::nullopt;
  const double wait =
      first_timestamp_ ? (timestamp - *first_timestamp_) / speed_ - since_first_.seconds() : -2 * latest;
  if (wait > 0.0) return wait;
  if (wait < -latest) {
    first_timestamp_ = timestamp;
    since_first_.restart();
  }
  return std::nullopt;
}

void PlayControl::take_turn(double timestamp) {
  while (const std::optional<double> seconds = remaining(timestamp))
    if (!wait(*seconds)) {
      resume();
      return;
    }
}

void PlayControl::wait_for_watcher() {
  const auto is_done = [this] {
    const std::lock_guard lock(mutex_);
    return closed_ || watchers_ > 0;
  };
  while (!is_done() && wait(-1.0)) {
  }
}

}  // namespace holdfast::viewer
