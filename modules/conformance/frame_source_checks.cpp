// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "check.hpp"
#include "holdfast/interfaces/frame_source.hpp"
#include "scene.hpp"

namespace holdfast::conformance {

namespace {

const char* const header = "holdfast/interfaces/frame_source.hpp";
const char* const frame_header = "holdfast/core/sensor_frame.hpp";
constexpr int looked_at = 10;  // frames; a source may be endless

std::vector<SensorFrame> first_frames(FrameSource& source, int count = looked_at) {
  std::vector<SensorFrame> frames;
  while (static_cast<int>(frames.size()) < count) {
    std::optional<SensorFrame> frame = source.next();
    if (!frame) break;
    frames.push_back(std::move(*frame));
  }
  return frames;
}

/// Frames of the source; there must be some, otherwise the checks would be empty.
std::vector<SensorFrame> some_frames(const Maker& maker) {
  std::vector<SensorFrame> frames = first_frames(*maker.make<FrameSource>());
  EXPECT_FALSE(frames.empty()) << "no frame: there is nothing to check";
  return frames;
}

void gives_frames(const Maker& maker) { some_frames(maker); }

void stamps_increase(const Maker& maker) {
  const std::vector<SensorFrame> frames = some_frames(maker);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    ASSERT_TRUE(std::isfinite(frames[i].timestamp) && std::isfinite(frames[i].depth_delay)) << "frame " << i;
    if (i == 0) continue;
    EXPECT_GT(frames[i].timestamp, frames[i - 1].timestamp) << "time stamp of frame " << i;
    EXPECT_GT(frames[i].index, frames[i - 1].index) << "index of frame " << i;
  }
}

void images_are_as_described(const Maker& maker) {
  const auto source = maker.make<FrameSource>();
  const SourceDescription description = source->describe();
  const std::vector<SensorFrame> frames = first_frames(*source);
  for (const SensorFrame& frame : frames) {
    SCOPED_TRACE("frame " + std::to_string(frame.index));
    ASSERT_FALSE(frame.colour.empty()) << "there is no colour image";
    EXPECT_EQ(frame.colour.type(), CV_8UC3) << "type of the colour image";
    EXPECT_EQ(frame.colour.size(), frames.front().colour.size()) << "the size changes";
    if (!frame.depth.empty()) {
      EXPECT_TRUE(description.has_depth) << "describe() says that there is no depth";
      EXPECT_EQ(frame.depth.type(), CV_32FC1) << "type of the depth image";
      EXPECT_EQ(frame.depth.size(), frame.colour.size()) << "size of the depth image";
    }
    if (!frame.right.empty()) {
      EXPECT_TRUE(description.has_right) << "describe() says that there is no right image";
      EXPECT_TRUE(frame.right.type() == CV_8UC1 || frame.right.type() == CV_8UC3) << "type of the right image";
      EXPECT_EQ(frame.right.size(), frame.colour.size()) << "size of the right image";
    }
    if (description.camera) {
      EXPECT_EQ(frame.colour.cols, description.camera->width) << "width of the camera in describe()";
      EXPECT_EQ(frame.colour.rows, description.camera->height) << "height of the camera in describe()";
    }
  }
  const auto has = [&](cv::Mat SensorFrame::*image) {
    return std::any_of(frames.begin(), frames.end(), [&](const SensorFrame& frame) { return !(frame.*image).empty(); });
  };
  EXPECT_EQ(has(&SensorFrame::depth), description.has_depth) << "has_depth, and whether any frame has depth";
  EXPECT_EQ(has(&SensorFrame::right), description.has_right) << "has_right, and whether any frame has a right image";
}

void depth_is_in_metres(const Maker& maker) {
  for (const SensorFrame& frame : some_frames(maker)) {
    if (frame.depth.empty()) continue;
    for (int row = 0; row < frame.depth.rows; ++row)
      for (int column = 0; column < frame.depth.cols; ++column) {
        const float depth = frame.depth.at<float>(row, column);
        ASSERT_TRUE(depth >= 0.0F && depth < 1000.0F) << "depth of frame " << frame.index << " at (" << column << ", "
                                                      << row << ") is " << depth << "; 0 = no value, in metres";
      }
  }
}

void description_stays(const Maker& maker) {
  const auto source = maker.make<FrameSource>();
  const SourceDescription before = source->describe();
  first_frames(*source);
  const SourceDescription after = source->describe();
  EXPECT_EQ(before.name, after.name);
  EXPECT_EQ(before.has_depth, after.has_depth);
  EXPECT_EQ(before.has_right, after.has_right);
  EXPECT_EQ(before.frame_count, after.frame_count);
  EXPECT_EQ(before.frame_timestamps, after.frame_timestamps);
  EXPECT_EQ(before.class_names, after.class_names);
  EXPECT_EQ(before.camera.has_value(), after.camera.has_value());
}

void ends_for_good(const Maker& maker) {
  const auto source = maker.make<FrameSource>();
  constexpr std::uint64_t most = 200;
  const std::optional<std::uint64_t> count = source->describe().frame_count;
  if (!count || *count > most) GTEST_SKIP() << "the source is endless or long";
  const std::vector<SensorFrame> frames = first_frames(*source, static_cast<int>(most) + 1);
  EXPECT_EQ(frames.size() + source->skipped().size(), *count) << "frames and skipped frames, and frame_count";
  const std::vector<double> stamps = source->describe().frame_timestamps;
  if (!stamps.empty()) {
    EXPECT_EQ(stamps.size(), *count) << "frame_timestamps and frame_count";
    for (const SensorFrame& frame : frames)
      EXPECT_TRUE(std::binary_search(stamps.begin(), stamps.end(), frame.timestamp))
          << "frame_timestamps does not have the stamp " << frame.timestamp << " of frame " << frame.index;
  }
  for (int again = 0; again < 3; ++again) EXPECT_FALSE(source->next()) << "a frame after the end";
}

void truth_is_sorted(const Maker& maker) {
  const auto source = maker.make<FrameSource>();
  const Trajectory truth = source->truth();
  for (std::size_t i = 0; i < truth.size(); ++i) {
    ASSERT_TRUE(std::isfinite(truth[i].timestamp) && truth[i].T_world_camera.matrix().allFinite()) << "pose " << i;
    if (i == 0) continue;
    EXPECT_GE(truth[i].timestamp, truth[i - 1].timestamp) << "stamp of pose " << i;
  }
}

void same_parameters_same_frames(const Maker& maker) {
  const auto one = maker.make<FrameSource>();
  if (!one->describe().can_read_ahead) GTEST_SKIP() << "frames depend on what happens between two calls";
  const std::vector<SensorFrame> a = first_frames(*one), b = first_frames(*maker.make<FrameSource>());
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].timestamp, b[i].timestamp) << "frame " << i;
    EXPECT_EQ(digest(a[i].colour), digest(b[i].colour)) << "colour of frame " << i;
    EXPECT_EQ(digest(a[i].depth), digest(b[i].depth)) << "depth of frame " << i;
    EXPECT_EQ(digest(a[i].right), digest(b[i].right)) << "right image of frame " << i;
  }
}

}  // namespace

std::vector<Check> frame_source_checks() {
  const Promise frames{header, "Provides the frames of a recording, a simulation or a live camera."};
  return {
      {"GivesFrames", frames, gives_frames},
      {"StampsIncrease", {header, "Time stamps increase strictly from frame to frame."}, stamps_increase},
      {"ImagesAreAsDescribed",
       {header, "Properties of a source that are known before its first frame."},
       images_are_as_described},
      {"DepthIsInMetres",
       {frame_header, "32FC1 along the optical axis [m], 0 = no value; same size as colour; may be empty"},
       depth_is_in_metres},
      {"DescriptionStays",
       {header, "Properties of a source that are known before its first frame."},
       description_stays},
      {"EndsForGood", {header, "Returns the next frame, or nothing at the end."}, ends_for_good},
      {"TruthIsSorted",
       {header, "Ground-truth poses, sorted by time stamp; the stamps may differ from those of the frames."},
       truth_is_sorted},
      {"SameParametersSameFrames",
       {header,
        "Frames do not depend on what happens between two calls of next(), as those of a recording, so that a "
        "sequential "
        "run may read ahead in another thread."},
       same_parameters_same_frames},
  };
}

}  // namespace holdfast::conformance
