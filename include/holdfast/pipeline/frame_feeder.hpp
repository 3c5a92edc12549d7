// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <condition_variable>
#include <cstdint>
#include <exception>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "holdfast/core/sensor_frame.hpp"
#include "holdfast/core/stage_times.hpp"
#include "holdfast/interfaces/frame_source.hpp"
#include "holdfast/pipeline/bounded_queue.hpp"

namespace holdfast {

/// When frames come, and what happens to those that come too late.
struct PaceSettings {
  bool by_timestamps = false;  ///< each frame at its time stamp, as a camera would give it; else as fast as possible
  bool drop_late = false;      ///< paced: what finds the queue full pushes the oldest out; else the source waits
  std::size_t frame_queue = 4;
};

/// A frame on its way to tracking.
struct FedFrame {
  SensorFrame frame;
  double decode_seconds = 0.0;
  Stopwatch since_due;  ///< started when the frame was due: at its time stamp when paced, else when it was read
};

/// Reads a source in a thread of its own, so that decoding and tracking overlap.
class FrameFeeder {
 public:
  /// The source must outlive the feeder and is used by nobody else meanwhile.
  FrameFeeder(FrameSource& source, const PaceSettings& settings);
  /// Stops reading; what was read and not taken is abandoned.
  ~FrameFeeder();

  /// Waits for the next frame; nothing at the end. Throws what the source threw, after the frames before it.
  std::optional<FedFrame> next();
  /// Makes next() return nothing from now on, and ends the reading. From any thread.
  void stop();

  QueueCounts counts() const { return queue_.counts(); }
  /// Stamps of all frames read so far, dropped ones included [s].
  std::vector<double> stamps() const;
  /// Paced: frames that the source gave after they were due, and by how much at most [s].
  std::uint64_t late() const;
  double latest() const;

 private:
  void read();
  bool wait_until_due(double timestamp, Stopwatch& since_due);

  FrameSource& source_;
  PaceSettings settings_;
  BoundedQueue<FedFrame> queue_;
  mutable std::mutex mutex_;
  std::condition_variable stopped_changed_;
  bool stopped_ = false;
  std::exception_ptr failure_;
  std::vector<double> stamps_;
  std::uint64_t late_ = 0;
  double latest_ = 0.0;
  std::optional<double> first_timestamp_;
  Stopwatch since_first_;
  std::thread thread_;  // last: it uses all the others
};

}  // namespace holdfast
