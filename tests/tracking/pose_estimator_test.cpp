// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/tracking/pose_estimator.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include "holdfast/tracking/age_disagreement.hpp"
#include "holdfast/tracking/frame_builder.hpp"
#include "holdfast/tracking/image_depth.hpp"
#include "support/point_world.hpp"
#include "support/pose_optimizer.hpp"

namespace holdfast {
namespace {

class NoEvidence final : public DynamicFilter {
 public:
  Needs needs() const override { return {}; }
  void apply(const FilterContext&, StaticEvidence&) override {}
};

/// When the points were first seen, and when the frame is taken [s].
struct Times {
  double room = 0.0, person = 1.8, frame = 2.0;
};

/// A camera that stands still before a room, of which every n-th feature is. The other features are on somebody who has
/// moved by `moved` [m] since their points were made, and are static with the given probability.
struct RoomAndPerson {
  RoomAndPerson(Sensor sensor, bool with_filter, std::size_t every, const Times& times, double moved = 0.05,
                float person_probability = 1.0F)
      : world(find_camera("tum_fr3").value()),
        extractor(world),
        depth(world.camera(), 0.0),
        builder(world.camera(), extractor, depth) {
    map.set_sensor(sensor);
    StageTimes stages;
    builder.build(world.frame(0, times.room, Eigen::Isometry3d::Identity()), frame, stages);
    const std::vector<Eigen::Vector3d> positions = [&] {
      std::vector<Eigen::Vector3d> all;
      for (std::size_t i = 0; i < frame.size(); ++i) all.push_back(frame.camera_point(i));
      return all;
    }();
    std::fill(frame.right_x.begin(), frame.right_x.end(), std::numeric_limits<float>::quiet_NaN());
    std::fill(frame.depth.begin(), frame.depth.end(), 0.0F);
    frame.static_probability.assign(frame.size(), 1.0F);
    const KeyFrameId first = map.add_keyframe(frame);
    Frame later = frame;
    later.timestamp = times.person;
    const KeyFrameId second = map.add_keyframe(later);
    frame.timestamp = times.frame;
    for (std::uint32_t i = 0; i < frame.size(); ++i) {
      const bool is_room = i % every == 0;
      room += is_room ? 1 : 0;
      const MapPointId point = map.add_point(positions[i] + Eigen::Vector3d(is_room ? 0.0 : moved, 0.0, 0.0), 0);
      map.add_observation(point, is_room ? first : second, i);
      map.update_point(point);
      frame.map_points[i] = point;
      if (!is_room) frame.static_probability[i] = person_probability;
    }
    FilterChain filters{EvidenceSettings()};
    if (with_filter) filters.add("none", std::make_unique<NoEvidence>());
    MovingWorld moving_world({.camera = world.camera(), .filters = std::move(filters), .has_depth = false}, map);
    test::PoseOptimizer optimizer;
    const TrackingSettings settings;
    PoseEstimator estimator(settings, optimizer, moving_world, map);
    std::vector<OdometryMatch> odometry;
    inliers = estimator.adjust_as_weighted(frame, odometry);
    for (std::uint32_t i = 0; i < frame.size(); ++i)
      if (i % every != 0) person_matches += frame.map_points[i].valid() ? 1 : 0;
    error = frame.T_camera_world.translation().norm();
  }

  test::PointWorld world;
  test::PointExtractor extractor;
  ImageDepth depth;
  FrameBuilder builder;
  Map map;
  Frame frame;
  int room = 0, inliers = 0, person_matches = 0;
  double error = 0.0;
};

TEST(PoseEstimator, NewPointsOfOneCameraGiveWayToEstablishedOnes) {
  const RoomAndPerson scene(Sensor::mono, true, 3, {});
  ASSERT_GE(scene.room, 50);
  EXPECT_LE(scene.error, 0.002);
  EXPECT_GE(scene.inliers, 9 * scene.room / 10);
  EXPECT_LE(scene.person_matches, scene.room / 10);
}

TEST(PoseEstimator, NewPointsCountWhereEstablishedOnesDoNotDecide) {
  const auto error = [](Sensor sensor, bool with_filter, std::size_t every, const Times& times) {
    return RoomAndPerson(sensor, with_filter, every, times).error;
  };
  EXPECT_GE(error(Sensor::mono, true, 3, {.person = 0.9}), 0.04) << "all points are old";
  EXPECT_GE(error(Sensor::mono, true, 3, {.room = 1.5}), 0.04) << "no point is old";
  EXPECT_GE(error(Sensor::mono, true, 20, {}), 0.04) << "too few established points determine a pose";
  EXPECT_GE(error(Sensor::mono, false, 3, {}), 0.04) << "without filters nothing is expected to move";
  EXPECT_GE(error(Sensor::rgbd, true, 3, {}), 0.04) << "depth is measured by filters";
  EXPECT_GE(error(Sensor::mono, true, 3, {.room = 9.0, .person = 9.5}), 0.04) << "all points are of a loaded map";
}

// Of the two places that room and person say, the camera is taken to be at either. Matches that contradict the pose of
// both are gone by then, as in a tracker: somebody who moves far is an outlier.
TEST(AgeDisagreement, IsHalfTheDistanceOfWhatNewAndOldPointsSay) {
  const auto deviation = [](std::size_t every, const Times& times, float person_probability = 1.0F) {
    const RoomAndPerson scene(Sensor::rgbd, true, every, times, 0.01, person_probability);
    EXPECT_GE(scene.person_matches, every == 1 ? 0 : 9 * scene.room / 10);
    const geometry::Matrix6d found = age_disagreement(scene.frame, scene.map);
    EXPECT_NEAR(found(1, 1), 0.0, 1e-6);
    return std::sqrt(found(0, 0));
  };
  EXPECT_NEAR(deviation(2, {}), 0.005, 0.0005);
  EXPECT_EQ(deviation(2, {.person = 1.2}), 0.0) << "all points are old";
  EXPECT_EQ(deviation(2, {.room = 1.6}), 0.0) << "no point is old";
  EXPECT_EQ(deviation(2, {.room = 9.0, .person = 9.5}), 0.0) << "all points are of a loaded map";
  EXPECT_EQ(deviation(1, {}), 0.0) << "nobody is there";
  EXPECT_EQ(deviation(2, {}, 0.4F), 0.0) << "the person is known to move, and hardly moves the pose";
}

}  // namespace
}  // namespace holdfast
