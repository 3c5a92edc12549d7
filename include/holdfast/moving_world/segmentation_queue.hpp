// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <future>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "holdfast/core/id.hpp"
#include "holdfast/core/sensor_frame.hpp"
#include "holdfast/core/stage_times.hpp"
#include "holdfast/core/worker.hpp"
#include "holdfast/interfaces/segmenter.hpp"
#include "holdfast/moving_world/segmentation_settings.hpp"

namespace holdfast {

/// A frame with its segmentation.
struct SegmentedFrame {
  SensorFrame frame;
  KeyFrameId keyframe;        ///< the keyframe made of the frame; invalid when there is none
  Segmentation segmentation;  ///< empty when the segmenter had no result
};

/// Queue of frames to be segmented and of results to be applied. Sequential mode: push() segments at once, and pop()
/// returns the result after the configured number of frames, which simulates a slow network deterministically; the
/// first frame is segmented in a thread if the segmenter may still be loading. Threaded mode: a thread segments, at
/// most one frame waits for it, and pop() returns a result as soon as it exists. First in, first out. One thread uses
/// it.
class SegmentationQueue {
 public:
  /// The segmenter must outlive the queue.
  SegmentationQueue(Segmenter& segmenter, const SegmentationSettings& settings, bool threaded);

  /// Whether a frame that is not a keyframe should be segmented. Frames are counted from 0.
  bool wants(std::uint64_t frame_number) const;
  bool has_room() const { return !worker_ || worker_->queue().has_room(); }
  /// Waits for the result that is due at this frame, if any, so that pop() does not block.
  void wait_for_due(std::uint64_t frame_number);
  /// Adds a frame; there must be room. Sequential mode throws exceptions of the segmenter here; those of the first
  /// frame of a loading segmenter are thrown by the next push() or when its result is due. `times` gets the stage
  /// "segmentation" in sequential mode.
  void push(const SensorFrame& frame, KeyFrameId keyframe, StageTimes& times);
  /// The next result that is available at this frame, if any. Call it at least once per frame.
  std::optional<SegmentedFrame> pop(std::uint64_t frame_number);
  /// Waits until every frame is segmented; the next calls of pop() return all results.
  void finish();

  /// True if no further keyframe should be created: the queue is full, or it contains two keyframes, so that the mask
  /// of a third would arrive too late.
  bool is_full() const { return keyframes_inside_ >= 2 || !has_room(); }
  /// Stage times of the segmentation thread since the last call.
  std::vector<StageTimes> take_times();
  /// Rethrows exceptions of the segmenter's thread.
  void rethrow() {
    if (worker_) worker_->rethrow();
  }
  /// Statistics of the thread; empty in sequential mode.
  std::optional<WorkerCounts> worker_counts() const;

 private:
  struct Job {
    SegmentedFrame segmented;
    std::uint64_t due = 0;
    bool done = false;
  };
  void segment(Job& job, StageTimes& times);
  void segment_in_background(Job& job);
  bool is_due(std::uint64_t frame_number) const { return all_due_ || jobs_.front()->due <= frame_number; }
  /// Waits for the first frame and rethrows exceptions of the segmenter.
  void finish_first() {
    if (first_.valid()) first_.get();
  }

  Segmenter& segmenter_;
  SegmentationSettings settings_;
  std::deque<std::shared_ptr<Job>> jobs_;
  std::uint64_t frame_number_ = 0;
  int keyframes_inside_ = 0;
  bool all_due_ = false;
  mutable std::mutex mutex_;  // protects Job::done, the content of jobs that are not done, and times_
  std::vector<StageTimes> times_;
  bool is_first_ = true;
  // Last: they use all the others.
  std::optional<Worker<std::shared_ptr<Job>>> worker_;
  std::future<void> first_;  // sequential mode: segments the first frame in a thread
};

}  // namespace holdfast
