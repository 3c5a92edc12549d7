// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/pipeline/segmentation_desk.hpp"

#include <utility>

#include "holdfast/core/error.hpp"

namespace holdfast {

SegmentationDesk::SegmentationDesk(Segmenter& segmenter, const SegmentationSettings& settings, bool threaded)
    : segmenter_(segmenter), settings_(settings) {
  if (!threaded) return;
  worker_.emplace("segmentation", 1, [this](std::shared_ptr<Job>& job) {
    StageTimes times;
    segment(*job, times);
    const std::lock_guard lock(mutex_);
    times_.push_back(std::move(times));
  });
}

void SegmentationDesk::segment(Job& job, StageTimes& times) {
  const StageTimer timer(times, "segmentation");
  Segmentation segmentation = segmenter_.segment(job.segmented.frame);
  const cv::Mat& labels = segmentation.labels;
  HOLDFAST_CHECK(labels.empty() || (labels.type() == CV_8UC1 && labels.size() == job.segmented.frame.colour.size()),
                 "the segmenter's labels are " << labels.cols << "x" << labels.rows << " of type " << labels.type());
  const std::lock_guard lock(mutex_);
  job.segmented.segmentation = std::move(segmentation);
  job.done = true;
}

bool SegmentationDesk::wants(std::uint64_t frames_fed) const {
  return settings_.on == "every_n" && frames_fed % static_cast<std::uint64_t>(settings_.every) == 0;
}

void SegmentationDesk::hand_in(const SensorFrame& frame, KeyFrameId keyframe, StageTimes& times) {
  auto job = std::make_shared<Job>();
  job->segmented.frame = frame;
  job->segmented.keyframe = keyframe;
  job->due = frames_fed_ + static_cast<std::uint64_t>(settings_.latency);
  if (keyframe.valid()) ++keyframes_inside_;
  jobs_.push_back(job);
  if (worker_)
    worker_->queue().push(std::move(job));
  else
    segment(*job, times);
}

std::optional<SegmentedFrame> SegmentationDesk::fetch(std::uint64_t frames_fed) {
  frames_fed_ = frames_fed;
  if (jobs_.empty()) return std::nullopt;
  Job& first = *jobs_.front();
  {
    const std::lock_guard lock(mutex_);
    if (!first.done) return std::nullopt;
  }
  if (!worker_ && !all_due_ && first.due > frames_fed) return std::nullopt;
  SegmentedFrame segmented = std::move(first.segmented);
  jobs_.pop_front();
  if (segmented.keyframe.valid()) --keyframes_inside_;
  return segmented;
}

void SegmentationDesk::finish() {
  if (worker_) worker_->finish();
  all_due_ = true;
}

std::vector<StageTimes> SegmentationDesk::take_times() {
  const std::lock_guard lock(mutex_);
  return std::exchange(times_, {});
}

std::optional<WorkerCounts> SegmentationDesk::worker_counts() const {
  if (!worker_) return std::nullopt;
  return worker_->counts();
}

}  // namespace holdfast
