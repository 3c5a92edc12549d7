// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/moving_world/mask_propagator.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <memory>
#include <opencv2/imgproc.hpp>

#include "holdfast/simulation/scene_file.hpp"
#include "holdfast/simulation/simulator.hpp"
#include "moving_world/overlap.hpp"

namespace holdfast {
namespace {

using Eigen::Isometry3d;
using test::overlap;

/// Some frames of walking_xyz with people in view; each is made when it is first asked for, in order.
class Recording {
 public:
  static constexpr std::uint64_t first = 90;

  const Camera& camera() const { return *camera_; }
  const CoarseSampler& sampler() const { return sampler_; }
  const Frame& frame(std::size_t i) { return at(i).frame; }
  const cv::Mat& grey(std::size_t i) { return at(i).grey; }
  const Segmentation& segmentation(std::size_t i) { return at(i).segmentation; }
  CellMask mask(std::size_t i) { return sample_mask(sampler_, segmentation(i)); }
  /// 1 where a cell shows a person.
  const std::vector<std::uint8_t>& truth(std::size_t i) { return at(i).truth; }

 private:
  struct Entry {
    cv::Mat grey;
    Frame frame;
    Segmentation segmentation;
    std::vector<std::uint8_t> truth;
  };

  const Entry& at(std::size_t i) {
    const auto& names = simulator_.class_names();
    const auto person = static_cast<std::uint8_t>(std::find(names.begin(), names.end(), "person") - names.begin());
    while (entries_.size() <= i) {
      const std::uint64_t index = entries_.size();
      const SensorFrame image = simulator_.frame(first + index);
      Entry& entry = entries_.emplace_back();
      cv::cvtColor(image.colour, entry.grey, cv::COLOR_BGR2GRAY);
      entry.frame.index = index;
      entry.frame.timestamp = image.timestamp;
      entry.frame.camera = camera_;
      sampler_.sample_depth(image.depth, entry.frame.coarse);
      entry.frame.T_camera_world = image.truth->T_world_camera->inverse();
      entry.segmentation.labels = (image.truth->class_labels == person) / 255;
      sampler_.sample_labels(entry.segmentation.labels, 0, entry.truth);
    }
    return entries_[i];
  }

  simulation::Simulator simulator_{
      simulation::read_scene(std::string(HOLDFAST_SOURCE_DIR) + "/examples/scenes/walking_xyz.yaml"),
      find_camera("tum_fr3").value()};
  std::shared_ptr<const Camera> camera_ = std::make_shared<Camera>(simulator_.camera());
  CoarseSampler sampler_{*camera_};
  std::deque<Entry> entries_;
};

class MaskPropagatorTest : public testing::Test {
 protected:
  static void SetUpTestSuite() { recording_ = new Recording; }
  static void TearDownTestSuite() {
    delete recording_;
    recording_ = nullptr;
  }

  static Recording& recording() { return *recording_; }
  static MaskPropagator propagator(double memory = 1.0) {
    return {recording().camera(), recording().sampler(), memory};
  }
  /// Goes to a frame with the true motion of the camera; locates it truly.
  static void go(MaskPropagator& masks, std::size_t i, bool lost = false) {
    const Frame& frame = recording().frame(i);
    masks.advance(recording().grey(i), frame,
                  i == 0 ? Isometry3d::Identity() : frame.T_camera_world * recording().frame(i - 1).T_world_camera());
    masks.set_pose(lost ? std::nullopt : std::optional(frame.T_camera_world), frame.coarse, -1.0F);
  }
  static double quality(const MaskPropagator& masks, std::size_t i) {
    return overlap(masks.mask().labels, recording().truth(i));
  }

 private:
  static inline Recording* recording_ = nullptr;
};

TEST_F(MaskPropagatorTest, WithoutASegmentationThereIsNoMask) {
  MaskPropagator masks = propagator();
  masks.remember();  // before any frame: nothing to remember
  for (std::size_t i = 0; i < 3; ++i) go(masks, i);
  EXPECT_TRUE(masks.mask().empty());
  EXPECT_TRUE(masks.moving_pixels().empty());
  EXPECT_EQ(masks.points().size(), 0U);
}

TEST_F(MaskPropagatorTest, WhileTheFirstSegmentationIsAwaitedThereIsNoMaskEither) {
  MaskPropagator masks = propagator();
  go(masks, 0);
  masks.remember();
  EXPECT_GE(masks.points().size(), 100U);  // anything may turn out to be an object
  for (std::size_t i = 1; i < 4; ++i) {
    go(masks, i);
    EXPECT_TRUE(masks.mask().empty());
    EXPECT_EQ(masks.mask().age, 0.0);
  }
  masks.apply(0, {});
  go(masks, 4);
  EXPECT_TRUE(masks.mask().empty());
}

TEST_F(MaskPropagatorTest, AMaskThatComesAtOnceIsExact) {
  MaskPropagator masks = propagator();
  go(masks, 0);
  masks.remember();
  masks.apply(0, recording().mask(0));
  EXPECT_EQ(masks.mask().labels, recording().truth(0));
  EXPECT_EQ(masks.mask().age, 0.0);
  for (const std::uint8_t confidence : masks.mask().confidence) EXPECT_EQ(confidence, 255);
}

TEST_F(MaskPropagatorTest, AMaskThatComesLateIsCarriedToThePresent) {
  MaskPropagator masks = propagator();
  go(masks, 0);
  masks.remember();
  for (std::size_t i = 1; i <= 5; ++i) go(masks, i);
  ASSERT_GE(std::count(recording().truth(5).begin(), recording().truth(5).end(), 1), 2000);
  const double uncarried = overlap(recording().truth(0), recording().truth(5));
  masks.apply(0, recording().mask(0));
  EXPECT_GE(quality(masks, 5), 0.85);
  EXPECT_LE(1.0 - quality(masks, 5), 0.6 * (1.0 - uncarried)) << uncarried;
  EXPECT_NEAR(masks.mask().age, 5.0 / 30.0, 1e-6);
  // And from there on from frame to frame.
  for (std::size_t i = 6; i <= 10; ++i) go(masks, i);
  EXPECT_GE(quality(masks, 10), 0.8);
  EXPECT_LE(1.0 - quality(masks, 10), 0.6 * (1.0 - overlap(recording().truth(0), recording().truth(10))));
}

TEST_F(MaskPropagatorTest, ANewerSegmentationReplacesWhatWasCarried) {
  MaskPropagator masks = propagator();
  go(masks, 0);
  masks.remember();
  masks.apply(0, recording().mask(0));
  for (std::size_t i = 1; i <= 7; ++i) go(masks, i);
  masks.remember();
  for (std::size_t i = 8; i <= 12; ++i) go(masks, i);
  const double carried = quality(masks, 12);
  masks.apply(7, recording().mask(7));
  EXPECT_GT(quality(masks, 12), carried);
  EXPECT_GE(quality(masks, 12), 0.85);
  EXPECT_NEAR(masks.mask().age, 5.0 / 30.0, 1e-6);
}

TEST_F(MaskPropagatorTest, AnEmptySegmentationChangesNothing) {
  MaskPropagator masks = propagator(), others = propagator();
  for (MaskPropagator* each : {&masks, &others}) {
    go(*each, 0);
    each->remember();
    each->apply(0, recording().mask(0));
    for (std::size_t i = 1; i <= 3; ++i) go(*each, i);
    each->remember();
    for (std::size_t i = 4; i <= 5; ++i) go(*each, i);
  }
  const CellMask before = masks.mask();
  masks.apply(3, {});
  EXPECT_EQ(masks.mask().labels, before.labels);
  EXPECT_EQ(masks.mask().confidence, before.confidence);
  EXPECT_EQ(masks.mask().age, before.age);
  // It is not awaited any more either.
  masks.apply(3, recording().mask(3));
  EXPECT_EQ(masks.mask().labels, before.labels);
  others.apply(3, recording().mask(3));
  EXPECT_NE(others.mask().labels, before.labels);
}

TEST_F(MaskPropagatorTest, OlderFramesAreForgottenWithANewerAnswer) {
  MaskPropagator masks = propagator();
  for (std::size_t i = 0; i <= 4; ++i) {
    go(masks, i);
    if (i == 0 || i == 2) masks.remember();
  }
  masks.apply(2, recording().mask(2));
  const CellMask before = masks.mask();
  EXPECT_GE(quality(masks, 4), 0.85);
  Segmentation everywhere{cv::Mat(recording().segmentation(0).labels.size(), CV_8UC1, cv::Scalar(1)), {}};
  masks.apply(0, sample_mask(recording().sampler(), everywhere));  // forgotten
  masks.apply(3, sample_mask(recording().sampler(), everywhere));  // never remembered
  EXPECT_EQ(masks.mask().labels, before.labels);
}

TEST_F(MaskPropagatorTest, ConfidenceHalvesInTheMemoryTime) {
  // At 30 frames a second, 6 frames are 0.2 s.
  MaskPropagator masks = propagator(0.2);
  go(masks, 0);
  masks.remember();
  masks.apply(0, recording().mask(0));
  int before = 255;
  for (std::size_t i = 1; i <= 12; ++i) {
    go(masks, i);
    const int best = *std::max_element(masks.mask().confidence.begin(), masks.mask().confidence.end());
    EXPECT_LT(best, before);
    before = best;
    EXPECT_NEAR(best, 255.0 * std::exp2(-static_cast<double>(i) / 6.0), 1.0);
  }
}

TEST_F(MaskPropagatorTest, ConfidenceBeginsAtTheSegmentersOwn) {
  MaskPropagator masks = propagator();
  go(masks, 0);
  masks.remember();
  Segmentation segmentation = recording().segmentation(0);
  segmentation.confidence = cv::Mat(segmentation.labels.size(), CV_8UC1, cv::Scalar(100));
  masks.apply(0, sample_mask(recording().sampler(), segmentation));
  EXPECT_EQ(*std::max_element(masks.mask().confidence.begin(), masks.mask().confidence.end()), 100);
}

TEST_F(MaskPropagatorTest, ALostCameraStillCarries) {
  MaskPropagator masks = propagator();
  go(masks, 0);
  masks.remember();
  masks.apply(0, recording().mask(0));
  for (std::size_t i = 1; i <= 5; ++i) go(masks, i, true);
  EXPECT_GE(quality(masks, 5), 0.8);
}

TEST_F(MaskPropagatorTest, PointsAreFollowedOnObjectsOnlyUnlessAMaskIsAwaited) {
  MaskPropagator masks = propagator();
  const auto points_off_objects = [&](const std::vector<std::uint8_t>& labels) {
    int count = 0;
    for (std::size_t i = 0; i < masks.points().size(); ++i) {
      const int cell = recording().sampler().grid().cell_of(masks.points().x[i], masks.points().y[i]);
      count += labels[static_cast<std::size_t>(cell)] != 1 ? 1 : 0;
    }
    return count;
  };
  go(masks, 0);
  masks.remember();
  EXPECT_GE(points_off_objects(recording().truth(0)), 20);
  masks.apply(0, recording().mask(0));
  go(masks, 1);
  EXPECT_GE(masks.points().size(), 100U);
  EXPECT_EQ(points_off_objects(masks.mask().labels), 0);
}

TEST_F(MaskPropagatorTest, WhatWasJudgedToMoveIsMarkedAndGoesAlong) {
  MaskPropagator masks = propagator();
  go(masks, 0);
  masks.remember();
  masks.apply(0, recording().mask(0));
  CoarseView evaluated = recording().frame(0).coarse;
  evaluated.static_log_odds.assign(evaluated.depth.size(), -5.0F);  // the room, too: it is no object
  masks.set_pose(recording().frame(0).T_camera_world, evaluated, -1.0F);
  const auto marked = [&] {
    std::vector<std::uint8_t> cells;
    recording().sampler().sample_labels(masks.moving_pixels(), 0, cells);
    for (std::uint8_t& cell : cells) cell = cell != 0 ? 1 : 0;
    return cells;
  };
  // Marks overlap by a pixel; centres of cells decide.
  EXPECT_GE(overlap(marked(), recording().truth(0)), 0.99);
  // The next frame's features are found before it is evaluated itself.
  const Frame& frame = recording().frame(1);
  masks.advance(recording().grey(1), frame, frame.T_camera_world * recording().frame(0).T_world_camera());
  EXPECT_GE(overlap(marked(), recording().truth(1)), 0.85);
  evaluated.static_log_odds.assign(evaluated.depth.size(), 0.0F);
  masks.set_pose(frame.T_camera_world, evaluated, -1.0F);
  EXPECT_TRUE(masks.moving_pixels().empty());
}

}  // namespace
}  // namespace holdfast
