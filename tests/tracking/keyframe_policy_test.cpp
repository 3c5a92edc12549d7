// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/tracking/keyframe_policy.hpp"

#include <gtest/gtest.h>

#include <memory>

namespace holdfast {
namespace {

/// A frame that is tracked so well that no keyframe is needed.
KeyframeSituation calm() {
  return {.inliers = 300,
          .reference_points = 320,
          .close_tracked = 250,
          .close_untracked = 200,
          .keyframes = 10,
          .since_last = 0.5,
          .mask_age = 0.1,
          .on_hold = false};
}

KeyframeReason decide(const KeyframeSituation& situation, const TrackingSettings& settings = {}) {
  return KeyframePolicy(settings).decide(situation);
}

TEST(KeyframePolicy, AWellTrackedFrameIsNone) { EXPECT_EQ(decide(calm()), KeyframeReason::none); }

TEST(KeyframePolicy, AFrameWithoutEnoughInliersIsNeverOne) {
  KeyframeSituation situation = calm();
  situation.inliers = 29;
  situation.mask_age = 10.0;
  EXPECT_EQ(decide(situation), KeyframeReason::none);
}

TEST(KeyframePolicy, AnOldMaskIsAReason) {
  KeyframeSituation situation = calm();
  situation.mask_age = 0.5;
  EXPECT_EQ(decide(situation), KeyframeReason::old_mask);
  situation.mask_age = 0.49;
  EXPECT_EQ(decide(situation), KeyframeReason::none);
}

TEST(KeyframePolicy, FewClosePointsAreAReasonWhenNewOnesCouldBeMade) {
  KeyframeSituation situation = calm();
  situation.close_tracked = 99;
  EXPECT_EQ(decide(situation), KeyframeReason::few_close_points);
  situation.close_untracked = 70;
  EXPECT_EQ(decide(situation), KeyframeReason::none);
}

TEST(KeyframePolicy, AChangedViewIsAReason) {
  KeyframeSituation situation = calm();
  situation.inliers = 255;  // 0.8 * 320 = 256
  EXPECT_EQ(decide(situation), KeyframeReason::few_inliers);
  situation.inliers = 256;
  EXPECT_EQ(decide(situation), KeyframeReason::none);
  // The first keyframe's points are not established, so that fewer of them are enough.
  situation.keyframes = 1;
  situation.inliers = 128;
  EXPECT_EQ(decide(situation), KeyframeReason::none);
  situation.inliers = 127;
  EXPECT_EQ(decide(situation), KeyframeReason::few_inliers);
}

TEST(KeyframePolicy, TimeIsAReasonWhenTheViewChangedALittle) {
  KeyframeSituation situation = calm();
  situation.since_last = 1.0;
  situation.inliers = 287;  // 0.9 * 320 = 288
  EXPECT_EQ(decide(situation), KeyframeReason::interval);
  situation.since_last = 0.99;
  EXPECT_EQ(decide(situation), KeyframeReason::none);
  situation.since_last = 100.0;
  situation.inliers = 288;
  EXPECT_EQ(decide(situation), KeyframeReason::none);
}

TEST(KeyframePolicy, OnHoldOnlyAFrameThatIsNearlyLostIsOne) {
  for (const bool by_hold : {true, false}) {
    TrackingSettings settings;
    settings.keyframe_minimum_interval = by_hold ? 0.0 : 1.0;
    KeyframeSituation situation = calm();
    situation.on_hold = by_hold;
    situation.mask_age = 10.0;
    EXPECT_EQ(decide(situation, settings), KeyframeReason::none);
    situation.inliers = 60;
    EXPECT_EQ(decide(situation, settings), KeyframeReason::none);
    situation.inliers = 59;
    EXPECT_EQ(decide(situation, settings), KeyframeReason::nearly_lost);
  }
}

/// A frame whose features lie at these depths [m].
Frame frame_with(const std::vector<float>& depths) {
  Frame frame;
  frame.camera = std::make_shared<Camera>();
  frame.features.resize(depths.size());
  frame.x.assign(depths.size(), 10.0F), frame.y.assign(depths.size(), 10.0F);
  frame.depth = depths;
  frame.map_points.assign(depths.size(), MapPointId());
  return frame;
}

TEST(KeyframePolicy, MeasuresClosePointsAndEstablishedPoints) {
  const TrackingSettings settings;
  const auto close = static_cast<float>(settings.close_depth_factor * Camera().baseline);
  for (const std::size_t keyframe_count : {2U, 3U}) {
    Map map;
    std::vector<KeyFrameId> keyframes;
    for (std::size_t i = 0; i < keyframe_count; ++i)
      keyframes.push_back(map.add_keyframe(frame_with({1.0F, 1.0F, 1.0F, 1.0F})));
    std::vector<MapPointId> points;
    for (std::uint32_t i = 0; i < 3; ++i) {
      points.push_back(map.add_point(Eigen::Vector3d::UnitZ(), 0));
      map.add_observation(points.back(), keyframes[0], i);
    }
    map.add_observation(points[1], keyframes[1], 1);
    Frame frame = frame_with({0.0F, 0.9F * close, 0.9F * close, 0.9F * close, 1.1F * close});
    frame.map_points[0] = points[0], frame.map_points[1] = points[1], frame.map_points[4] = points[2];
    const KeyframeSituation situation = KeyframePolicy(settings).measure(frame, 77, keyframes[0], map);
    EXPECT_EQ(situation.inliers, 77);
    EXPECT_EQ(situation.keyframes, keyframe_count);
    // Established points have two observations, or one while there are two keyframes only.
    EXPECT_EQ(situation.reference_points, keyframe_count == 2 ? 3 : 1);
    EXPECT_EQ(situation.close_tracked, 1);
    EXPECT_EQ(situation.close_untracked, 2);
  }
}

TEST(KeyframePolicy, TheFirstKeyframeOfALaterSubmapIsLikeThatOfTheMap) {
  Map map;
  for (int i = 0; i < 3; ++i) map.add_keyframe(frame_with({1.0F}));
  const KeyFrameId first = map.add_keyframe(frame_with({1.0F}));
  map.keyframe(first).submap = map.new_submap();
  map.add_observation(map.add_point(Eigen::Vector3d::UnitZ(), 0), first, 0);
  const KeyframeSituation situation = KeyframePolicy(TrackingSettings()).measure(frame_with({1.0F}), 50, first, map);
  EXPECT_EQ(situation.keyframes, 1U);
  EXPECT_EQ(situation.reference_points, 1) << "nothing else of its submap could have observed the point";
}

TEST(KeyframePolicy, AReferenceThatWasRemovedHasNoPoints) {
  Map map;
  map.add_observation(map.add_point(Eigen::Vector3d::UnitZ(), 0), map.add_keyframe(frame_with({1.0F})), 0);
  EXPECT_EQ(KeyframePolicy(TrackingSettings()).measure(frame_with({1.0F}), 50, KeyFrameId(), map).reference_points, 0)
      << "no keyframe of the map has this id";
}

}  // namespace
}  // namespace holdfast
