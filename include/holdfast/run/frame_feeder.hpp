// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <condition_variable>
#include <cstdint>
#include <exception>
#include <functional>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "holdfast/config/run_settings.hpp"
#include "holdfast/core/bounded_queue.hpp"
#include "holdfast/core/sensor_frame.hpp"
#include "holdfast/core/stage_times.hpp"
#include "holdfast/interfaces/frame_source.hpp"

namespace holdfast {

/// A frame in the queue between source and tracking.
struct FedFrame {
  SensorFrame frame;
  double decode_seconds = 0.0;
  std::uint64_t fingerprint = 0;  ///< image_fingerprint() of the colour image
  Stopwatch since_due;  ///< time since the frame was due: paced, its time stamp; otherwise the moment of reading
};

/// Reads a source in a separate thread, so that decoding and tracking overlap. Of the settings it uses pace,
/// late_frames and frame_queue. Images are not copied. With late_frames `drop`, frames are dropped if tracking is too
/// slow, and if reading is late by more than a tenth of a second: then overdue frames except the newest are skipped
/// (FrameSource::pass_over()).
class FrameFeeder {
 public:
  /// Starts reading. The source must outlive the feeder, and no other code may use it during that time.
  FrameFeeder(FrameSource& source, const RunSettings& settings);
  /// Stops reading and discards the frames that were read but not taken.
  ~FrameFeeder();

  /// Waits for the next frame; empty at the end of the source. An exception of the source is thrown here, after the
  /// frames before it. While waiting, `stop` is called ten times a second; if it returns true, the result is empty.
  std::optional<FedFrame> next(const std::function<bool()>& stop = {});
  /// Stops reading and interrupts the source (FrameSource::interrupt()); next() then returns empty. Any thread.
  void stop();

  /// Statistics of the queue; frames skipped by pass_over() are counted as dropped.
  QueueCounts counts() const;
  /// Time stamps of all frames read so far, dropped ones included [s].
  std::vector<double> stamps() const;
  /// Paced: number of frames that were delivered late by the source.
  std::uint64_t late() const;
  /// Paced: largest delay of such a frame [s].
  double largest_delay() const;

 private:
  void read();
  bool wait_until_due(double timestamp, Stopwatch& since_due);
  void pass_over_late_frames();

  FrameSource& source_;
  RunSettings settings_;
  BoundedQueue<FedFrame> queue_;
  mutable std::mutex mutex_;
  std::condition_variable stopped_changed_;
  bool stopped_ = false;
  std::exception_ptr failure_;
  std::vector<double> stamps_;
  std::uint64_t late_ = 0;
  double largest_delay_ = 0.0;
  double lateness_ = 0.0;  // of the frame read last [s]
  std::uint64_t passed_over_ = 0;
  std::optional<double> first_timestamp_;
  Stopwatch since_first_;
  std::thread thread_;  // last, because it uses the members above
};

}  // namespace holdfast
