// SPDX-License-Identifier: BSD-3-Clause
// The facade as the tracker and the pipeline use it, in a world of boxes.
#include "holdfast/moving_world/moving_world.hpp"

#include <gtest/gtest.h>

#include <memory>

#include "support/box_world.hpp"

namespace holdfast {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using test::BoxWorld;

constexpr std::uint8_t person = 1, table = 2;

/// A wall with furniture, and one person.
BoxWorld room(double person_x = 0.0) {
  BoxWorld world;
  world.boxes = {BoxWorld::box({-0.8, 0.3, 2.4}, {0.2, 0.3, 0.2}, 0),
                 BoxWorld::box({0.9, -0.4, 2.0}, {0.2, 0.2, 0.3}, 0),
                 BoxWorld::box({person_x, 0.0, 1.5}, {0.15, 0.4, 0.1}, person)};
  return world;
}

Isometry3d at(double x) {
  Isometry3d T = Isometry3d::Identity();
  T.translation() = Vector3d(x, 0.0, 0.0);
  return T;
}

/// The exact labels of the room.
class ExactSegmenter final : public Segmenter {
 public:
  const std::vector<std::string>& classes() const override { return classes_; }
  std::vector<std::string> movable() const override { return {"person"}; }
  Segmentation segment(const SensorFrame& frame) override {
    if (finds_nothing) return {};
    const BoxWorld world = room();
    cv::Mat labels(frame.colour.size(), CV_8UC1);
    for (int row = 0; row < labels.rows; ++row)
      for (int column = 0; column < labels.cols; ++column)
        labels.at<std::uint8_t>(row, column) = world.look(at(0.0), column, row).label;
    if (inverts) labels = (labels == 0) / 255 * shown;
    if (!covers_upper_edge) labels.rowRange(0, 40) = 0;
    return {labels, {}};
  }

  bool finds_nothing = false, inverts = false, covers_upper_edge = true;
  std::uint8_t shown = person;  ///< label of the background of inverted masks

 private:
  std::vector<std::string> classes_{"background", "person", "table"};
};

/// Suspects the features and cells on masks; notes the stages in which it ran.
class MaskFilter final : public DynamicFilter {
 public:
  explicit MaskFilter(Needs needs = {}, int* calls = nullptr) : needs_(needs), calls_(calls) {}
  Needs needs() const override { return needs_; }
  std::vector<std::string> movable_classes(const std::vector<std::string>& specified) const override {
    return specified;
  }
  void apply(const FilterContext& context, StaticEvidence& evidence) override {
    if (calls_ != nullptr) ++*calls_;
    EXPECT_EQ(context.T_camera_world != nullptr,
              needs_.pose_prior || needs_.matches || context.segmentation != nullptr);
    const CellMask& mask = context.frame.coarse.mask;
    if (mask.empty()) return;
    EXPECT_NE(context.classes, nullptr);
    const CoarseGrid& grid = context.frame.coarse.grid;
    for (std::size_t i = 0; i < context.frame.size(); ++i)
      if (mask.labels[static_cast<std::size_t>(grid.cell_of(context.frame.x[i], context.frame.y[i]))] == person)
        evidence.add(i, -6.0F, StaticEvidence::Kind::prior);
    for (std::size_t cell = 0; cell < mask.labels.size(); ++cell)
      if (mask.labels[cell] == person) evidence.add_cell(cell, -6.0F);
  }

 private:
  Needs needs_;
  int* calls_;
};

class MovingWorldTest : public testing::Test {
 protected:
  static constexpr Needs masks{.segmentation = true};

  MovingWorld world_with(int latency, SegmentedFrames on = SegmentedFrames::keyframes) {
    FilterChain filters;
    filters.add("mask", std::make_unique<MaskFilter>(masks));
    return MovingWorld({.camera = Camera(),
                        .filters = std::move(filters),
                        .segmenter = &segmenter,
                        .segmentation = {.frames = on, .every = 3, .latency = latency}},
                       map);
  }
  /// Goes through a frame as tracker and pipeline do, up to the request of its mask.
  Frame track(MovingWorld& world, std::uint64_t index) {
    Frame frame = room().frame(at(0.0), static_cast<double>(index) / 30.0);
    frame.index = index;
    world.next_frame(frame.timestamp);
    ignored = world.begin_frame(grey, Isometry3d::Identity(), kept_frame = frame, times).clone();
    world.evaluate(FilterStage::before_matching, {sensor_frame(index), nullptr, kept_frame}, times);
    world.weight_features(kept_frame);
    world.end_frame(kept_frame, true);
    return kept_frame;
  }
  SensorFrame sensor_frame(std::uint64_t index) const {
    SensorFrame frame;
    frame.index = index;
    frame.timestamp = static_cast<double>(index) / 30.0;
    frame.colour = cv::Mat::zeros(480, 640, CV_8UC3);
    return frame;
  }
  static int suspects(const Frame& frame) {
    return static_cast<int>(std::count_if(frame.static_probability.begin(), frame.static_probability.end(),
                                          [](float p) { return p < 0.5F; }));
  }

  ExactSegmenter segmenter;
  Map map;
  StageTimes times;
  cv::Mat grey = cv::Mat::zeros(480, 640, CV_8UC1);
  cv::Mat ignored;
  Frame kept_frame;  // the mask follows from it
};

TEST_F(MovingWorldTest, WithoutFiltersAndSegmenterEverythingIsTrusted) {
  MovingWorld world({.camera = Camera()}, map);
  EXPECT_FALSE(world.expects_masks());
  EXPECT_FALSE(world.weights_features());
  const Frame frame = track(world, 0);
  EXPECT_TRUE(ignored.empty());
  EXPECT_TRUE(frame.coarse.mask.empty());
  EXPECT_EQ(suspects(frame), 0);
  EXPECT_FALSE(world.request_mask(sensor_frame(0), KeyFrameId{0, 0}, times));
  EXPECT_FALSE(world.take_mask(times));
  EXPECT_FALSE(world.holds_keyframes());
  EXPECT_EQ(world.mask_age(), 0.0);
  EXPECT_FALSE(world.contradicts_depth(frame, 0, true, KeyFrameId{0, 0}));
}

TEST_F(MovingWorldTest, AMaskIsAppliedAfterItsLatencyAndPropagatedFromThere) {
  MovingWorld world = world_with(3);
  ASSERT_EQ(suspects(track(world, 0)), 0);
  const KeyFrameId keyframe{7, 1};
  ASSERT_TRUE(world.request_mask(sensor_frame(0), keyframe, times));
  for (std::uint64_t i = 1; i <= 2; ++i) {
    EXPECT_EQ(suspects(track(world, i)), 0);
    EXPECT_FALSE(world.take_mask(times)) << i;
  }
  EXPECT_EQ(suspects(track(world, 3)), 0);  // the pipeline takes masks before it tracks; here one frame later
  const std::optional<ArrivedMask> arrived = world.take_mask(times);
  ASSERT_TRUE(arrived);
  EXPECT_EQ(arrived->keyframe, keyframe);
  EXPECT_EQ(arrived->frame.index, 0U);
  EXPECT_FALSE(world.take_mask(times));
  ASSERT_EQ(world.mask_latencies().size(), 1U);
  EXPECT_NEAR(world.mask_latencies()[0], 0.1, 1e-9);
  const Frame frame = track(world, 4);
  EXPECT_NEAR(world.mask_age(), 4.0 / 30.0, 1e-9);
  int on_person = 0;
  for (std::size_t i = 0; i < frame.size(); ++i) {
    const bool shows_person = room().look(at(0.0), frame.x[i], frame.y[i]).label == person;
    on_person += shows_person ? 1 : 0;
    EXPECT_EQ(frame.static_probability[i] < 0.5F, shows_person) << frame.x[i] << " " << frame.y[i];
  }
  EXPECT_GE(on_person, 50);
}

TEST_F(MovingWorldTest, MasksAreCountedByWhatTheyShow) {
  MovingWorld world = world_with(0);
  const auto segment = [&](std::uint64_t index) {
    track(world, index);
    world.request_mask(sensor_frame(index), KeyFrameId{static_cast<std::uint32_t>(index), 1}, times);
    EXPECT_TRUE(world.take_mask(times));
  };
  segment(0);
  EXPECT_EQ(world.mask_counts().segmented, 1U);
  EXPECT_EQ(world.mask_counts().found, 1U);
  EXPECT_EQ(world.mask_counts().mostly_movable, 0U);
  segmenter.finds_nothing = true;
  segment(1);
  EXPECT_EQ(world.mask_counts().segmented, 2U);
  EXPECT_EQ(world.mask_counts().found, 1U);
  EXPECT_EQ(world.mask_latencies().size(), 1U);
  segmenter.finds_nothing = false;
  segmenter.inverts = true;
  segment(2);
  EXPECT_EQ(world.mask_counts().found, 2U);
  EXPECT_EQ(world.mask_counts().mostly_movable, 1U);
  EXPECT_EQ(world.mask_counts().upper_edge_movable, 1U);
  segmenter.covers_upper_edge = false;
  segment(3);
  EXPECT_EQ(world.mask_counts().mostly_movable, 2U);
  EXPECT_EQ(world.mask_counts().upper_edge_movable, 1U) << "as of people that fill the view up to their heads";
}

TEST_F(MovingWorldTest, OnlyClassesThatCanMoveHideTheView) {
  segmenter.inverts = true;
  for (const bool can_move : {true, false}) {
    segmenter.shown = can_move ? person : table;
    MovingWorld world = world_with(0);
    track(world, 0);
    ASSERT_TRUE(world.request_mask(sensor_frame(0), KeyFrameId{0, 0}, times));
    ASSERT_TRUE(world.take_mask(times));
    EXPECT_EQ(world.hides_most(track(world, 1).coarse), can_move);
  }
  MovingWorld world({.camera = Camera()}, map);
  Frame frame = track(world, 0);
  EXPECT_FALSE(world.hides_most(frame.coarse));
  frame.coarse.static_log_odds.assign(static_cast<std::size_t>(frame.coarse.grid.size()), -1.0F);
  EXPECT_TRUE(world.hides_most(frame.coarse)) << "everything moves";
}

TEST_F(MovingWorldTest, FeaturesAreNotExtractedOnObjectsThatMove) {
  MovingWorld world = world_with(0);
  track(world, 0);
  ASSERT_TRUE(world.request_mask(sensor_frame(0), KeyFrameId{0, 0}, times));
  ASSERT_TRUE(world.take_mask(times));
  track(world, 1);
  EXPECT_TRUE(ignored.empty());  // not evaluated yet when its features were extracted
  track(world, 2);
  ASSERT_FALSE(ignored.empty());
  EXPECT_NE(ignored.at<std::uint8_t>(240, 320), 0);
  EXPECT_EQ(ignored.at<std::uint8_t>(240, 40), 0);
}

TEST_F(MovingWorldTest, AKeyframeIsEvaluatedAgainByItsOwnMask) {
  MovingWorld world = world_with(0);
  const KeyFrameId keyframe = map.add_keyframe(track(world, 0));
  ASSERT_TRUE(world.request_mask(sensor_frame(0), keyframe, times));
  const std::optional<ArrivedMask> arrived = world.take_mask(times);
  ASSERT_TRUE(arrived);
  world.evaluate_keyframe(MapAccess(map), *arrived, times);
  const Frame& frame = map.keyframe(keyframe).frame;
  EXPECT_GE(suspects(frame), 50);
  EXPECT_EQ(frame.coarse.mask.labels, arrived->mask.labels);
  EXPECT_LT(frame.coarse.static_log_odds[static_cast<std::size_t>(frame.coarse.grid.cell_of(320, 240))], 0.0F);
  // A keyframe that was removed in the meantime, or a segmenter without a result, changes nothing.
  world.evaluate_keyframe(MapAccess(map), {.frame = {}, .keyframe = {99, 0}, .segmentation = {}, .mask = arrived->mask},
                          times);
  segmenter.finds_nothing = true;
  const KeyFrameId second = map.add_keyframe(track(world, 1));
  ASSERT_TRUE(world.request_mask(sensor_frame(1), second, times));
  const std::vector<float> before = map.keyframe(second).frame.static_probability;
  const std::optional<ArrivedMask> nothing = world.take_mask(times);
  ASSERT_TRUE(nothing);
  EXPECT_TRUE(nothing->mask.empty());
  world.evaluate_keyframe(MapAccess(map), *nothing, times);
  EXPECT_EQ(map.keyframe(second).frame.static_probability, before);
}

TEST_F(MovingWorldTest, OtherFramesAreSegmentedOnlyWhenAsked) {
  for (const SegmentedFrames on : {SegmentedFrames::keyframes, SegmentedFrames::every_n}) {
    MovingWorld world = world_with(0, on);
    int segmented = 0;
    for (std::uint64_t i = 0; i < 9; ++i) {
      track(world, i);
      segmented += world.request_mask(sensor_frame(i), KeyFrameId(), times) ? 1 : 0;
      if (const auto arrived = world.take_mask(times)) {
        EXPECT_FALSE(arrived->keyframe.valid());
      }
    }
    EXPECT_EQ(segmented, on == SegmentedFrames::every_n ? 3 : 0);
  }
}

TEST_F(MovingWorldTest, HoldsKeyframesWhileTwoWaitForTheirMasks) {
  MovingWorld world = world_with(2);
  track(world, 0);
  world.request_mask(sensor_frame(0), KeyFrameId{0, 0}, times);
  EXPECT_FALSE(world.holds_keyframes());
  track(world, 1);
  world.request_mask(sensor_frame(1), KeyFrameId{1, 0}, times);
  EXPECT_TRUE(world.holds_keyframes());
  track(world, 2);
  ASSERT_TRUE(world.take_mask(times));
  EXPECT_FALSE(world.holds_keyframes());
  world.finish();
  EXPECT_TRUE(world.take_mask(times));
}

TEST_F(MovingWorldTest, FiltersRunInTheStageThatTheirNeedsName) {
  int before = 0, with_pose = 0, after = 0;
  FilterChain filters;
  filters.add("before", std::make_unique<MaskFilter>(Needs{}, &before));
  filters.add("pose", std::make_unique<MaskFilter>(Needs{.pose_prior = true}, &with_pose));
  filters.add("matches", std::make_unique<MaskFilter>(Needs{.matches = true}, &after));
  MovingWorld world({.camera = Camera(), .filters = std::move(filters)}, map);
  Frame frame = room().frame(at(0.0), 0.0);
  const SensorFrame image = sensor_frame(0);
  const TrackedView view{image, nullptr, frame};
  EXPECT_TRUE(world.evaluate(FilterStage::before_matching, view, times));
  EXPECT_EQ(std::make_tuple(before, with_pose, after), std::make_tuple(1, 0, 0));
  EXPECT_TRUE(world.evaluate(FilterStage::with_pose, view, times));
  EXPECT_EQ(std::make_tuple(before, with_pose, after), std::make_tuple(1, 1, 0));
  EXPECT_TRUE(world.evaluate(FilterStage::after_matching, view, times));
  EXPECT_EQ(std::make_tuple(before, with_pose, after), std::make_tuple(1, 1, 1));
}

/// A keyframe of the room two seconds ago, so that poses can be compared with its depth.
class MovingWorldDepth : public MovingWorldTest {
 protected:
  MovingWorldDepth() : world({.camera = Camera(), .filters = one_filter()}, map) {
    Frame frame = room().frame(at(0.0), 0.0);
    reference = map.add_keyframe(frame);
  }
  static FilterChain one_filter() {
    FilterChain filters;
    filters.add("mask", std::make_unique<MaskFilter>());
    return filters;
  }
  MovingWorld world;
  KeyFrameId reference;
};

TEST_F(MovingWorldDepth, APoseFromMoversIsReplacedByThePrediction) {
  const Isometry3d truth = at(0.1), astray = at(0.4);
  for (const bool is_astray : {true, false}) {
    Frame frame = room().frame(truth, 2.0);
    frame.T_camera_world = is_astray ? astray.inverse() : truth.inverse();
    // The prediction is right in the first case and wrong in the second: the better of the two poses stays.
    const PosePrediction prediction{is_astray ? truth.inverse() : astray.inverse(), at(0.09)};
    world.check_pose(prediction, reference, frame, times);
    EXPECT_TRUE(frame.T_camera_world.isApprox(truth.inverse())) << is_astray;
  }
}

TEST_F(MovingWorldDepth, FewInliersMustNotContradictTheRoom) {
  // The camera looks at the wall from nearer than the pose says: nothing agrees.
  Frame frame = room().frame(at(0.1), 2.0);
  EXPECT_FALSE(world.contradicts_depth(frame, 40, false, reference));
  frame.T_camera_world.translation().z() -= 0.5;
  EXPECT_TRUE(world.contradicts_depth(frame, 49, false, reference));
  EXPECT_FALSE(world.contradicts_depth(frame, 50, false, reference));  // so many cannot agree by chance
  EXPECT_TRUE(world.contradicts_depth(frame, 59, true, reference));    // after a loss, chance had more tries
  EXPECT_FALSE(world.contradicts_depth(frame, 60, true, reference));
}

TEST_F(MovingWorldDepth, WhatWasNotThereMayFillTheView) {
  const Isometry3d here = at(0.1);
  Frame frame = room().frame(here, 2.0);
  EXPECT_FALSE(world.is_view_filled(frame, reference));
  // Somebody stands 0.4 m before the camera: what the keyframe knows of the view is hidden.
  for (float& depth : frame.coarse.depth) depth = 0.4F;
  EXPECT_TRUE(world.is_view_filled(frame, reference));
  // Where the keyframe knows nothing, nothing speaks against what is seen.
  frame.T_camera_world = at(100.0).inverse();
  EXPECT_FALSE(world.is_view_filled(frame, reference));
  // Without filters, everything is trusted.
  MovingWorld trusting({.camera = Camera()}, map);
  frame.T_camera_world = here.inverse();
  EXPECT_FALSE(trusting.is_view_filled(frame, reference));
}

}  // namespace
}  // namespace holdfast
