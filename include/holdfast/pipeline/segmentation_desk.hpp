// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "holdfast/core/id.hpp"
#include "holdfast/core/sensor_frame.hpp"
#include "holdfast/core/stage_times.hpp"
#include "holdfast/interfaces/segmenter.hpp"
#include "holdfast/pipeline/worker.hpp"
#include "holdfast/segmentation/segmentation_settings.hpp"

namespace holdfast {

/// A frame with its segmentation.
struct SegmentedFrame {
  SensorFrame frame;
  KeyFrameId keyframe;        ///< that the frame became; invalid for none
  Segmentation segmentation;  ///< empty when the segmenter had none
};

/// Where frames are handed in to be segmented, and fetched again. Sequential: segments at once and hands back after the
/// configured number of frames, so that results are those of a slow network and always the same. Threaded: a thread
/// segments, one frame waits at most, and each comes back as soon as it is done. Handed back in the order of handing
/// in. One thread uses it.
class SegmentationDesk {
 public:
  /// The segmenter must outlive the desk.
  SegmentationDesk(Segmenter& segmenter, const SegmentationSettings& settings, bool threaded);

  /// Whether a frame that is not a keyframe should be segmented.
  bool wants(std::uint64_t frames_fed) const;
  bool has_room() const { return !worker_ || worker_->queue().has_room(); }
  /// Hands a frame in; there must be room. `times` gets the stage "segmentation" in sequential mode.
  void hand_in(const SensorFrame& frame, KeyFrameId keyframe, StageTimes& times);
  /// The next frame that is done by now, if any. Call once or more per frame, with the number of frames fed so far.
  std::optional<SegmentedFrame> fetch(std::uint64_t frames_fed);
  /// Waits until all is done: the next calls of fetch() return everything.
  void finish();

  /// Whether no more keyframes should be made: there is no room, or two of them, one in work and one that waits, have
  /// not been fetched yet, and the next would wait longer than it is worth.
  bool is_full() const { return keyframes_inside_ >= 2 || !has_room(); }
  std::vector<StageTimes> take_times();
  /// Throws what the segmenter threw in its thread.
  void rethrow() {
    if (worker_) worker_->rethrow();
  }
  std::optional<WorkerCounts> worker_counts() const;

 private:
  struct Job {
    SegmentedFrame segmented;
    std::uint64_t due = 0;
    bool done = false;
  };
  void segment(Job& job, StageTimes& times);

  Segmenter& segmenter_;
  SegmentationSettings settings_;
  std::deque<std::shared_ptr<Job>> jobs_;
  std::uint64_t frames_fed_ = 0;
  int keyframes_inside_ = 0;
  bool all_due_ = false;
  mutable std::mutex mutex_;  // of Job::done, of what belongs to a job that is not done, and of times_
  std::vector<StageTimes> times_;
  std::optional<Worker<std::shared_ptr<Job>>> worker_;  // last: it uses all the others
};

}  // namespace holdfast
