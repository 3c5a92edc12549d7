// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/moving_world/segmentation_queue.hpp"

#include <utility>

#include "holdfast/core/error.hpp"

namespace holdfast {

SegmentationQueue::SegmentationQueue(Segmenter& segmenter, const SegmentationSettings& settings, bool threaded)
    : segmenter_(segmenter), settings_(settings) {
  if (!threaded) return;
  worker_.emplace("segmentation", 1, [this](std::shared_ptr<Job>& job) { segment_in_background(*job); });
}

void SegmentationQueue::segment(Job& job, StageTimes& times) {
  const StageTimer timer(times, "segmentation");
  Segmentation segmentation = segmenter_.segment(job.segmented.frame);
  const cv::Mat& labels = segmentation.labels;
  HOLDFAST_CHECK(labels.empty() || (labels.type() == CV_8UC1 && labels.size() == job.segmented.frame.colour.size()),
                 "the segmenter's labels are " << labels.cols << "x" << labels.rows << " of type " << labels.type());
  const std::lock_guard lock(mutex_);
  job.segmented.segmentation = std::move(segmentation);
  job.done = true;
}

void SegmentationQueue::segment_in_background(Job& job) {
  StageTimes times;
  segment(job, times);
  const std::lock_guard lock(mutex_);
  times_.push_back(std::move(times));
}

bool SegmentationQueue::wants(std::uint64_t frame_number) const {
  return settings_.frames == SegmentedFrames::every_n &&
         frame_number % static_cast<std::uint64_t>(settings_.every) == 0;
}

void SegmentationQueue::push(const SensorFrame& frame, KeyFrameId keyframe, StageTimes& times) {
  auto job = std::make_shared<Job>();
  job->segmented.frame = frame;
  job->segmented.keyframe = keyframe;
  job->due = frame_number_ + static_cast<std::uint64_t>(settings_.latency);
  if (keyframe.valid()) ++keyframes_inside_;
  jobs_.push_back(job);
  const bool waits = std::exchange(is_first_, false) && segmenter_.first_call_waits();
  if (worker_) {
    worker_->queue().push(std::move(job));
  } else if (waits) {
    first_ = std::async(std::launch::async, [this, job] {
      name_this_thread("segmentation");
      segment_in_background(*job);
    });
  } else {
    finish_first();
    segment(*job, times);
  }
}

void SegmentationQueue::wait_for_due(std::uint64_t frame_number) {
  if (!worker_ && !jobs_.empty() && is_due(frame_number)) finish_first();
}

std::optional<SegmentedFrame> SegmentationQueue::pop(std::uint64_t frame_number) {
  frame_number_ = frame_number;
  if (jobs_.empty()) return std::nullopt;
  wait_for_due(frame_number);
  Job& first = *jobs_.front();
  {
    const std::lock_guard lock(mutex_);
    if (!first.done) return std::nullopt;
  }
  if (!worker_ && !is_due(frame_number)) return std::nullopt;
  SegmentedFrame segmented = std::move(first.segmented);
  jobs_.pop_front();
  if (segmented.keyframe.valid()) --keyframes_inside_;
  return segmented;
}

void SegmentationQueue::finish() {
  if (worker_) worker_->finish();
  finish_first();
  all_due_ = true;
}

std::vector<StageTimes> SegmentationQueue::take_times() {
  const std::lock_guard lock(mutex_);
  return std::exchange(times_, {});
}

std::optional<WorkerCounts> SegmentationQueue::worker_counts() const {
  if (!worker_) return std::nullopt;
  return worker_->counts();
}

}  // namespace holdfast
