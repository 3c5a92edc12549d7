// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/moving_world/segmentation_queue.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <future>
#include <thread>

#include "holdfast/core/error.hpp"

namespace holdfast {
namespace {

/// Labels every pixel with the index of the frame; may wait, throw or answer in the wrong size.
class Stamper final : public Segmenter {
 public:
  const std::vector<std::string>& classes() const override { return names_; }
  bool first_call_waits() const override { return is_loading; }
  Segmentation segment(const SensorFrame& frame) override {
    if (frame.index == bad) throw InputError({"mask.png"}, "is broken");
    if (frame.index == held) gate.get_future().wait();
    thread = std::this_thread::get_id();
    ++count;
    if (frame.index == nothing_for) return {};
    return {cv::Mat(frame.colour.rows + more_rows, frame.colour.cols, type, cv::Scalar(double(frame.index))), {}};
  }

  static constexpr std::uint64_t none = ~std::uint64_t{0};
  std::uint64_t bad = none, held = none, nothing_for = none;
  int more_rows = 0, type = CV_8UC1;
  bool is_loading = false;
  std::promise<void> gate;
  std::atomic<int> count = 0;
  std::thread::id thread;

 private:
  std::vector<std::string> names_{"background", "person"};
};

SensorFrame frame_at(std::uint64_t index) {
  SensorFrame frame;
  frame.index = index;
  frame.colour = cv::Mat::zeros(4, 6, CV_8UC3);
  return frame;
}
KeyFrameId keyframe_at(std::uint64_t index) { return {static_cast<std::uint32_t>(index), 0}; }

/// Uses the queue as the pipeline does: pop before a frame, push after it. Returns the index of each frame and the
/// number of the frame at which its result was available.
std::vector<std::pair<std::uint64_t, std::uint64_t>> returns(SegmentationQueue& queue, int frames, int every) {
  std::vector<std::pair<std::uint64_t, std::uint64_t>> returned;
  StageTimes times;
  for (std::uint64_t i = 0; i < static_cast<std::uint64_t>(frames); ++i) {
    while (const auto segmented = queue.pop(i)) {
      returned.emplace_back(segmented->frame.index, i);
      EXPECT_EQ(segmented->segmentation.labels.at<std::uint8_t>(0, 0), segmented->frame.index);
      EXPECT_EQ(segmented->keyframe, keyframe_at(segmented->frame.index));
    }
    if (i % static_cast<std::uint64_t>(every) == 0) queue.push(frame_at(i), keyframe_at(i), times);
  }
  return returned;
}

TEST(SegmentationQueue, SequentialAnswersCountAfterExactlyTheLatency) {
  for (const int latency : {1, 5, 7}) {
    Stamper segmenter;
    SegmentationQueue queue(segmenter, {.latency = latency}, false);
    const auto returned = returns(queue, 30, 3);
    ASSERT_EQ(returned.size(), static_cast<std::size_t>((29 - latency) / 3 + 1));
    for (std::size_t i = 0; i < returned.size(); ++i) {
      EXPECT_EQ(returned[i].first, 3 * i);
      EXPECT_EQ(returned[i].second, 3 * i + static_cast<std::uint64_t>(latency));
    }
  }
}

TEST(SegmentationQueue, WithoutLatencyTheAnswerIsThereAtOnce) {
  Stamper segmenter;
  SegmentationQueue queue(segmenter, {.latency = 0}, false);
  StageTimes times;
  for (std::uint64_t i = 0; i < 3; ++i) {
    EXPECT_FALSE(queue.pop(i));
    queue.push(frame_at(i), keyframe_at(i), times);
    const auto segmented = queue.pop(i);
    ASSERT_TRUE(segmented);
    EXPECT_EQ(segmented->frame.index, i);
  }
}

TEST(SegmentationQueue, SequentialWorkIsDoneInTheCallersThreadAndTimed) {
  Stamper segmenter;
  SegmentationQueue queue(segmenter, {}, false);
  StageTimes times;
  EXPECT_TRUE(queue.has_room());
  queue.push(frame_at(0), keyframe_at(0), times);
  EXPECT_EQ(segmenter.thread, std::this_thread::get_id());
  EXPECT_FALSE(times.entries().empty());
  EXPECT_TRUE(queue.has_room());
  EXPECT_TRUE(queue.take_times().empty());
  EXPECT_FALSE(queue.worker_counts().has_value());
}

TEST(SegmentationQueue, TheFirstFrameOfALoadingSegmenterHoldsNobodyUp) {
  Stamper segmenter;
  segmenter.is_loading = true;
  segmenter.held = 0;
  SegmentationQueue queue(segmenter, {.latency = 3}, false);
  StageTimes times;
  queue.push(frame_at(0), keyframe_at(0), times);  // returns although the segmenter waits
  for (std::uint64_t i = 1; i < 3; ++i) EXPECT_FALSE(queue.pop(i));
  EXPECT_TRUE(times.entries().empty());
  segmenter.gate.set_value();
  const auto segmented = queue.pop(3);  // waits, whatever the timing
  ASSERT_TRUE(segmented);
  EXPECT_EQ(segmented->frame.index, 0U);
  EXPECT_NE(segmenter.thread, std::this_thread::get_id());
  EXPECT_EQ(queue.take_times().size(), 1U);
  queue.push(frame_at(3), keyframe_at(3), times);
  EXPECT_EQ(segmenter.thread, std::this_thread::get_id());
}

TEST(SegmentationQueue, ALoadingSegmenterChangesNoResult) {
  for (const int latency : {0, 1, 5}) {
    std::vector<std::pair<std::uint64_t, std::uint64_t>> expected;
    for (const bool is_loading : {false, true}) {
      Stamper segmenter;
      segmenter.is_loading = is_loading;
      SegmentationQueue queue(segmenter, {.latency = latency}, false);
      const auto returned = returns(queue, 20, 2);
      EXPECT_EQ(segmenter.count, 10);
      if (is_loading)
        EXPECT_EQ(returned, expected);
      else
        expected = returned;
    }
  }
}

TEST(SegmentationQueue, WhatALoadingSegmenterThrowsComesWhenItsResultIsNeeded) {
  StageTimes times;
  Stamper segmenter;
  segmenter.is_loading = true;
  segmenter.bad = 0;
  SegmentationQueue due(segmenter, {.latency = 2}, false), pushed(segmenter, {.latency = 2}, false),
      finished(segmenter, {.latency = 2}, false), abandoned(segmenter, {.latency = 2}, false);
  for (SegmentationQueue* queue : {&due, &pushed, &finished, &abandoned})
    EXPECT_NO_THROW(queue->push(frame_at(0), keyframe_at(0), times));
  EXPECT_FALSE(due.pop(1));
  EXPECT_THROW(due.pop(2), InputError);
  EXPECT_THROW(pushed.push(frame_at(1), keyframe_at(1), times), InputError);
  EXPECT_THROW(finished.finish(), InputError);
}

TEST(SegmentationQueue, WantsEveryNthFrameOnlyWhenAsked) {
  Stamper segmenter;
  const SegmentationQueue keyframes(segmenter, {.frames = SegmentedFrames::keyframes, .every = 4}, false);
  const SegmentationQueue every(segmenter, {.frames = SegmentedFrames::every_n, .every = 4}, false);
  int wanted = 0;
  for (std::uint64_t i = 0; i < 40; ++i) {
    EXPECT_FALSE(keyframes.wants(i));
    wanted += every.wants(i) ? 1 : 0;
    EXPECT_EQ(every.wants(i), every.wants(i + 4));
  }
  EXPECT_EQ(wanted, 10);
}

TEST(SegmentationQueue, IsFullWithTwoKeyframesAndOtherFramesDoNotCount) {
  Stamper segmenter;
  SegmentationQueue queue(segmenter, {.latency = 2}, false);
  StageTimes times;
  queue.pop(0);
  for (std::uint64_t i = 0; i < 3; ++i) queue.push(frame_at(i), KeyFrameId(), times);
  EXPECT_FALSE(queue.is_full());
  queue.push(frame_at(3), keyframe_at(3), times);
  EXPECT_FALSE(queue.is_full());
  queue.push(frame_at(4), keyframe_at(4), times);
  EXPECT_TRUE(queue.is_full());
  for (int i = 0; i < 3; ++i) EXPECT_FALSE(queue.pop(2)->keyframe.valid());
  EXPECT_TRUE(queue.is_full());
  EXPECT_TRUE(queue.pop(2)->keyframe.valid());
  EXPECT_FALSE(queue.is_full());
}

TEST(SegmentationQueue, FinishMakesAllDue) {
  Stamper segmenter;
  segmenter.nothing_for = 2;
  SegmentationQueue queue(segmenter, {.latency = 1000}, false);
  StageTimes times;
  for (std::uint64_t i = 0; i < 4; ++i) queue.push(frame_at(i), keyframe_at(i), times);
  EXPECT_FALSE(queue.pop(4));
  queue.finish();
  for (std::uint64_t i = 0; i < 4; ++i) {
    const auto segmented = queue.pop(4);
    ASSERT_TRUE(segmented);
    EXPECT_EQ(segmented->frame.index, i);
    EXPECT_EQ(segmented->segmentation.empty(), i == 2);  // an empty answer is an answer
  }
  EXPECT_FALSE(queue.pop(4));
}

TEST(SegmentationQueue, AThreadSegmentsWhileOneFrameWaits) {
  Stamper segmenter;
  segmenter.held = 0;
  SegmentationQueue queue(segmenter, {.latency = 1000}, true);
  StageTimes times;
  queue.push(frame_at(0), keyframe_at(0), times);
  while (!queue.has_room()) std::this_thread::yield();  // until the thread took it
  queue.push(frame_at(1), keyframe_at(1), times);
  EXPECT_FALSE(queue.has_room());
  EXPECT_FALSE(queue.pop(1));
  EXPECT_TRUE(queue.is_full());
  segmenter.gate.set_value();
  queue.finish();
  EXPECT_NE(segmenter.thread, std::this_thread::get_id());
  for (std::uint64_t i = 0; i < 2; ++i) EXPECT_EQ(queue.pop(2)->frame.index, i);
  EXPECT_FALSE(queue.pop(2));
  EXPECT_FALSE(queue.is_full());
  EXPECT_TRUE(times.entries().empty());
  EXPECT_EQ(queue.take_times().size(), 2U);
  EXPECT_EQ(queue.worker_counts()->queue.taken, 2U);
}

TEST(SegmentationQueue, AThreadsAnswerDoesNotWaitForTheLatency) {
  Stamper segmenter;
  SegmentationQueue queue(segmenter, {.latency = 1000}, true);
  StageTimes times;
  queue.push(frame_at(3), keyframe_at(3), times);
  std::optional<SegmentedFrame> segmented;
  const Stopwatch watch;
  while (!(segmented = queue.pop(4)) && watch.seconds() < 60.0) std::this_thread::yield();
  ASSERT_TRUE(segmented);
  EXPECT_EQ(segmented->segmentation.labels.at<std::uint8_t>(3, 5), 3);
}

TEST(SegmentationQueue, WhatTheSegmenterThrowsComesBack) {
  Stamper segmenter;
  segmenter.bad = 1;
  StageTimes times;
  SegmentationQueue sequential(segmenter, {}, false);
  sequential.push(frame_at(0), keyframe_at(0), times);
  EXPECT_THROW(sequential.push(frame_at(1), keyframe_at(1), times), InputError);

  SegmentationQueue threaded(segmenter, {}, true);
  threaded.push(frame_at(0), keyframe_at(0), times);
  EXPECT_NO_THROW(threaded.rethrow());
  threaded.push(frame_at(1), keyframe_at(1), times);
  threaded.finish();
  EXPECT_THROW(threaded.rethrow(), InputError);
  EXPECT_EQ(threaded.pop(1)->frame.index, 0U);
  EXPECT_FALSE(threaded.pop(1));
}

TEST(SegmentationQueue, LabelsOfAnotherSizeOrTypeAreAnError) {
  for (const bool wrong_size : {true, false}) {
    Stamper segmenter;
    (wrong_size ? segmenter.more_rows : segmenter.type) = wrong_size ? 1 : CV_16UC1;
    StageTimes times;
    SegmentationQueue sequential(segmenter, {}, false);
    EXPECT_THROW(sequential.push(frame_at(0), keyframe_at(0), times), CheckError);
    SegmentationQueue threaded(segmenter, {}, true);
    threaded.push(frame_at(0), keyframe_at(0), times);
    threaded.finish();
    EXPECT_THROW(threaded.rethrow(), CheckError);
  }
}

}  // namespace
}  // namespace holdfast
