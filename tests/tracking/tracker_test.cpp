// SPDX-License-Identifier: BSD-3-Clause
// Drives Tracker alone: the test takes the place of the pipeline and of local mapping.
#include "holdfast/tracking/tracker.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <utility>

#include "holdfast/tracking/image_depth.hpp"
#include "holdfast/tracking/no_depth.hpp"
#include "support/brute_force_detector.hpp"
#include "support/point_world.hpp"
#include "support/pose_optimizer.hpp"

namespace holdfast {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

/// Extracts every n-th feature of the world and none without light.
class SparseExtractor final : public FeatureExtractor {
 public:
  explicit SparseExtractor(test::PointWorld& world) : all_(world, 0.3) {}
  void extract(const cv::Mat& grey, const cv::Mat& ignore, Features& out) override {
    Features all;
    all_.extract(grey, ignore, all);
    out.resize(all.size() / every);
    for (std::size_t i = 0; i < out.size(); ++i) {
      const std::size_t k = i * every;
      out.x[i] = all.x[k], out.y[i] = all.y[k], out.angle[i] = all.angle[k], out.response[i] = all.response[k];
      out.octave[i] = all.octave[k], out.descriptors.of_256_bits()[i] = all.descriptors.of_256_bits()[k];
    }
  }
  void set_budget(double factor) override { budget = factor; }
  const ScalePyramid& pyramid() const override { return all_.pyramid(); }

  std::size_t every = 1;
  double budget = 1.0;

 private:
  test::PointExtractor all_;
};

/// Makes the chain of filters active; while `*covers` is set, it is a mask over all features but every 80th.
class MaskFilter final : public DynamicFilter {
 public:
  explicit MaskFilter(const bool* covers) : covers_(covers) {}
  Needs needs() const override { return {}; }
  void apply(const FilterContext& context, StaticEvidence& evidence) override {
    for (std::size_t i = 0; i < context.frame.size() && *covers_; ++i)
      if (i % 80 != 0) evidence.add(i, -6.0F, StaticEvidence::Kind::prior);
  }

 private:
  const bool* covers_;
};

Isometry3d at(double x, double y = 0.0, double z = 0.0) {
  Isometry3d T = Isometry3d::Identity();
  T.translation() = Vector3d(x, y, z);
  return T;
}

/// A tracker in a world of points, and a map to which its keyframes are added without any refinement.
class Bench {
 public:
  explicit Bench(const TrackingSettings& settings = {}, bool with_filter = false, Map known = {},
                 std::uint64_t seed = 5, const EvidenceSettings& evidence = {},
                 FirstPoses first_poses = default_first_poses(), Segmenter* segmenter = nullptr)
      : world(find_camera("tum_fr1").value(), 1500, seed),
        map(std::move(known)),
        moving_world({.camera = world.camera(), .filters = chain(with_filter, evidence), .segmenter = segmenter}, map),
        tracker(settings, {world.camera(), extractor, depth, optimizer, detector, moving_world, map},
                std::move(first_poses)) {
    map.keyframes().for_each(
        [&](KeyFrameId id, const KeyFrame& keyframe) { detector.add(id, keyframe.frame.features.descriptors); });
  }

  FrameResult feed(double time, const Isometry3d& T_world_camera, bool visible = true) {
    return feed(world.frame(next_index, time, T_world_camera, visible));
  }
  FrameResult feed(const SensorFrame& frame) {
    ++next_index;
    FrameResult result;
    moving_world.next_frame(frame.timestamp);
    tracker.begin(frame, result);
    request = tracker.locate(access, frame, result);
    EXPECT_EQ(result.is_keyframe, request.kind != MapRequest::Kind::none);
    if (result.is_keyframe) add_keyframe();
    return result;
  }
  void add_keyframe() {
    const KeyFrameId id = map.add_keyframe(tracker.frame());
    const Frame& frame = map.keyframe(id).frame;
    for (std::uint32_t i = 0; i < frame.size(); ++i) {
      MapPointId point = frame.map_points[i];
      if (!point.valid() && frame.has_depth(i)) {
        point = map.add_point(frame.T_world_camera() * frame.camera_point(i), map.keyframe(id).sequence);
        map.add_observation(point, id, i);
      }
      if (point.valid()) map.update_point(point);
    }
    map.update_covisibility(id);
    map.invalidate_copies();
    detector.add(id, frame.features.descriptors);
    tracker.keyframe_added(access, id);
  }
  /// Feeds frames along x at 0.5 m/s from `from` to `to` [s]; the last result.
  FrameResult walk(double from, double to) {
    FrameResult result;
    for (double time = from; time < to - 1e-9; time += 1.0 / 30.0) result = feed(time, at(speed * time));
    return result;
  }

  static constexpr double speed = 0.5;
  test::PointWorld world;
  SparseExtractor extractor{world};
  /// The depth of this world consists of patches around points, all of whose borders are depth edges.
  ImageDepth depth{world.camera(), 0.0};
  test::PoseOptimizer optimizer;
  test::BruteForceDetector detector;
  Map map;
  MovingWorld moving_world;
  Tracker tracker;
  MapRequest request;           // of the last frame
  const MapAccess access{map};  // no other thread uses the map
  std::uint64_t next_index = 0;
  bool mask_covers = false;

 private:
  FilterChain chain(bool with_filter, const EvidenceSettings& evidence) const {
    FilterChain filters(evidence);
    if (with_filter) filters.add("mask", std::make_unique<MaskFilter>(&mask_covers));
    return filters;
  }
};

double error(const FrameResult& result, const Isometry3d& T_world_camera) {
  if (!result.T_world_camera) return 1e9;
  return (result.T_world_camera->translation() - T_world_camera.translation()).norm();
}

EvidenceSettings with_fallback() {
  EvidenceSettings evidence;
  evidence.fallback = true;
  return evidence;
}

/// Only the branch under test can find a lost camera.
TrackingSettings without_relocalisation() {
  TrackingSettings settings;
  settings.coasting_time = 0.0;
  settings.recovery_keyframes = 0;
  settings.relocalisation_candidates = 0;
  settings.young_map_time = 0.0;
  settings.odometry_time = 0.0;
  return settings;
}

TEST(Tracker, TracksWithTheMotionModel) {
  Bench bench;
  EXPECT_EQ(bench.feed(0.0, at(0.0)).status, TrackingStatus::initialised);
  for (int i = 1; i < 30; ++i) {
    const double time = i / 30.0;
    const FrameResult result = bench.feed(time, at(Bench::speed * time));
    EXPECT_EQ(result.status, TrackingStatus::tracked) << i;
    EXPECT_EQ(result.method, TrackingMethod::motion_model) << i;
    EXPECT_LT(error(result, at(Bench::speed * time)), 0.006) << i;
  }
}

TEST(Tracker, AJumpIsTrackedByTheReferenceKeyframe) {
  Bench bench(without_relocalisation());
  bench.walk(0.0, 0.5);
  const Isometry3d jumped = at(0.2, 0.35, 0.1);
  const FrameResult result = bench.feed(0.5, jumped);
  EXPECT_EQ(result.status, TrackingStatus::tracked);
  EXPECT_EQ(result.method, TrackingMethod::reference_keyframe);
  EXPECT_LT(error(result, jumped), 0.01);
}

/// A pose from elsewhere, such as a robot's odometry: one more method is this class, and one line of the list.
class GivenPose final : public FirstPose {
 public:
  explicit GivenPose(const Isometry3d& T_world_camera) : T_world_camera_(T_world_camera) {}
  FirstPoseOutcome find(PoseSearch& search) override {
    search.context.current.T_camera_world = T_world_camera_.inverse();
    search.context.drop_matches();
    search.context.matcher.match_local_map(3.0F, search.context.current);
    search.context.estimator.adjust(search.context.current);
    search.result.method = TrackingMethod::motion_model;
    return FirstPoseOutcome::first_pose;
  }

 private:
  Isometry3d T_world_camera_;
};

TEST(Tracker, AMethodForFirstPosesIsAddedToTheList) {
  const Isometry3d elsewhere = at(-0.1, 0.2, 0.1);
  for (const bool is_added : {true, false}) {
    FirstPoses poses = default_first_poses();
    if (is_added) poses.push_back(std::make_unique<GivenPose>(elsewhere));
    Bench bench(without_relocalisation(), false, {}, 5, {}, std::move(poses));
    bench.walk(0.0, 0.5);
    bench.feed(0.5, at(0.25), false);
    const FrameResult result = bench.feed(0.6, elsewhere);
    EXPECT_EQ(result.status, is_added ? TrackingStatus::tracked : TrackingStatus::lost);
    if (is_added) {
      EXPECT_LT(error(result, elsewhere), 0.01);
    }
  }
}

TEST(Tracker, ItsStatesFollowTheDiagram) {
  TrackingSettings settings = without_relocalisation();
  settings.recovery_keyframes = 5;
  Bench bench(settings);
  EXPECT_EQ(bench.tracker.state(), TrackerState::waiting);
  bench.feed(0.0, at(0.0));
  EXPECT_EQ(bench.tracker.state(), TrackerState::tracking) << "no mask is expected that could refute the start";
  EXPECT_EQ(bench.request.kind, MapRequest::Kind::first_keyframe);
  bench.walk(1.0 / 30.0, 0.5);
  EXPECT_EQ(bench.tracker.state(), TrackerState::tracking);
  bench.extractor.every = bench.world.seen().size() / 90;
  bench.feed(0.5, at(0.25), false);
  EXPECT_EQ(bench.tracker.state(), TrackerState::lost);
  bench.feed(0.6, at(0.25));
  EXPECT_EQ(bench.tracker.state(), TrackerState::unconfirmed) << "few features agree";
  EXPECT_TRUE(bench.request.wants_mask);
  bench.extractor.every = 1;
  bench.feed(0.63, at(0.25));
  EXPECT_EQ(bench.tracker.state(), TrackerState::tracking) << "many do";
  bench.map.remove_all();
  bench.tracker.forget_map(bench.access);
  EXPECT_EQ(bench.tracker.state(), TrackerState::waiting);
  bench.feed(0.66, at(0.25));
  EXPECT_EQ(bench.request.kind, MapRequest::Kind::first_keyframe);
}

/// Masks are expected from it, and none comes.
class SlowSegmenter final : public Segmenter {
 public:
  const std::vector<std::string>& classes() const override { return classes_; }
  Segmentation segment(const SensorFrame&) override { return {}; }

 private:
  std::vector<std::string> classes_{"background", "person"};
};

TEST(Tracker, AStartBeforeTheFirstMaskIsProvisional) {
  SlowSegmenter segmenter;
  Bench bench({}, false, {}, 5, {}, default_first_poses(), &segmenter);
  bench.feed(0.0, at(0.0));
  EXPECT_EQ(bench.tracker.state(), TrackerState::provisional);
  bench.walk(1.0 / 30.0, 0.5);
  EXPECT_EQ(bench.tracker.state(), TrackerState::provisional);
  EXPECT_FALSE(bench.tracker.judge_start(bench.access)) << "no mask, no judgement";
  bench.feed(0.5, at(0.25), false);
  EXPECT_EQ(bench.tracker.state(), TrackerState::lost);
  bench.walk(0.5 + 1.0 / 30.0, 0.6);
  EXPECT_EQ(bench.tracker.state(), TrackerState::provisional);
}

TEST(Tracker, AShortLossIsFoundAlongTheLastVelocity) {
  // In the dark for 0.9 s, the camera goes on by 0.45 m: a fifth of the image.
  for (const bool goes_on : {true, false}) {
    TrackingSettings settings = without_relocalisation();
    settings.coasting_time = 1.2;
    settings.coasting_shares = {goes_on ? 1.0 : 0.0};
    Bench bench(settings);
    bench.walk(0.0, 0.5);
    EXPECT_EQ(bench.feed(0.5, at(0.25), false).status, TrackingStatus::lost);
    const FrameResult result = bench.feed(1.4, at(0.7));
    EXPECT_EQ(result.status, goes_on ? TrackingStatus::tracked : TrackingStatus::lost);
    if (!goes_on) continue;
    EXPECT_EQ(result.method, TrackingMethod::recovered);
    EXPECT_LT(error(result, at(0.7)), 0.01);
  }
}

TEST(Tracker, CoastsNoLongerThanItsTime) {
  for (const double coasting_time : {0.4, 0.6}) {
    TrackingSettings settings = without_relocalisation();
    settings.coasting_time = coasting_time;
    Bench bench(settings);
    bench.walk(0.0, 0.5);
    bench.feed(0.5, at(0.25), false);
    const bool in_time = coasting_time > 0.5;
    EXPECT_EQ(bench.feed(0.98, at(0.49)).status, in_time ? TrackingStatus::tracked : TrackingStatus::lost);
  }
}

TEST(Tracker, ALostCameraIsRecoveredAmongTheLastKeyframes) {
  for (const int keyframes : {5, 0}) {
    TrackingSettings settings = without_relocalisation();
    settings.recovery_keyframes = keyframes;
    Bench bench(settings);
    bench.walk(0.0, 0.5);
    bench.feed(0.5, at(0.25), false);
    const Isometry3d elsewhere = at(-0.1, 0.2, 0.1);
    const FrameResult result = bench.feed(0.6, elsewhere);
    EXPECT_EQ(result.status, keyframes > 0 ? TrackingStatus::tracked : TrackingStatus::lost);
    if (keyframes == 0) continue;
    EXPECT_EQ(result.method, TrackingMethod::recovered);
    EXPECT_LT(error(result, elsewhere), 0.01);
  }
}

TEST(Tracker, FramesOfALossAreTrackedBackwardsOnceTheCameraIsFound) {
  // After the dark, the camera is somewhere else. It sees the map, but cannot have come there before a second is over.
  for (const int kept : {30, 10, 0}) {
    TrackingSettings settings = without_relocalisation();
    settings.recovery_keyframes = 5;
    settings.relocalisation_tolerance = 0.0;
    settings.relocalisation_speed = 0.4;
    settings.backward_frames = kept;
    Bench bench(settings);
    bench.walk(0.0, 0.5);
    const auto place = [](double time) { return at(-0.1 + 0.1 * (time - 0.5), 0.2, 0.1); };
    std::size_t lost = 0, dark = 0;
    for (int i = 15; i < 75; ++i) {
      const double time = i / 30.0;
      const bool is_dark = i < 20;
      const FrameResult result = bench.feed(time, place(time), !is_dark);
      lost += result.status == TrackingStatus::lost && !is_dark ? 1U : 0U;
      dark += is_dark ? 1U : 0U;
    }
    ASSERT_GT(lost, 10U);
    ASSERT_LT(lost, 30U);
    EXPECT_EQ(bench.tracker.loss_record(bench.access).tracked_backwards,
              std::min<std::size_t>(lost, static_cast<std::size_t>(kept)));
    const Trajectory trajectory = bench.tracker.trajectory(bench.access);
    EXPECT_EQ(trajectory.size(), 75 - dark - lost + bench.tracker.loss_record(bench.access).tracked_backwards);
    for (std::size_t i = 0; i < trajectory.size(); ++i) {
      const double time = trajectory[i].timestamp;
      if (i > 0) {
        EXPECT_GT(time, trajectory[i - 1].timestamp);
      }
      if (time < 0.5 - 1e-9) continue;
      EXPECT_LT((trajectory[i].T_world_camera.translation() - place(time).translation()).norm(), 0.01) << time;
    }
  }
}

TEST(Tracker, ACameraThatIsLostForLongBeginsASubmap) {
  for (const double time : {0.3, 0.0}) {
    TrackingSettings settings = without_relocalisation();
    settings.restart_time = time;
    Bench bench(settings);
    bench.walk(0.0, 0.5);
    bool began = false;
    for (int i = 15; i < 45 && !began; ++i) {
      const double now = i / 30.0;
      const FrameResult result = bench.feed(now, at(0.25, 1.0, 0.3), i > 17);
      began = bench.request.kind == MapRequest::Kind::new_submap;
      EXPECT_EQ(result.status, began ? TrackingStatus::initialised : TrackingStatus::lost);
      if (began) {
        EXPECT_NEAR(now - 14.0 / 30.0, 0.3, 0.07);
      }
    }
    EXPECT_EQ(began, time > 0.0);
  }
}

TEST(Tracker, APlaceThatTheCameraCannotHaveReachedIsRejected) {
  for (const double tolerance : {1.0, 0.05}) {
    TrackingSettings settings = without_relocalisation();
    settings.recovery_keyframes = 5;
    settings.relocalisation_candidates = 5;
    settings.relocalisation_tolerance = tolerance;
    settings.relocalisation_speed = 0.1;
    Bench bench(settings);
    bench.walk(0.0, 0.5);
    bench.feed(0.5, at(0.25), false);
    const FrameResult result = bench.feed(0.6, at(-0.1, 0.2, 0.1));
    EXPECT_EQ(result.status, tolerance > 0.5 ? TrackingStatus::tracked : TrackingStatus::lost);
  }
}

TEST(Tracker, WhereFewAgreeTheTolerancePlaysNoRole) {
  // The place is 0.55 m away, 0.3 m can be reached, and the tolerance is 1 m.
  for (const bool shows_little : {true, false}) {
    TrackingSettings settings = without_relocalisation();
    settings.recovery_keyframes = 5;
    Bench bench(settings);
    bench.walk(0.0, 0.5);
    if (shows_little) bench.extractor.every = bench.world.seen().size() / 90;
    bench.feed(0.5, at(0.25), false);
    const Isometry3d elsewhere = at(-0.25, 0.2, 0.1);
    const FrameResult result = bench.feed(0.6, elsewhere);
    EXPECT_EQ(result.status, shows_little ? TrackingStatus::lost : TrackingStatus::tracked) << result.inliers;
    EXPECT_GE(result.inliers, 2 * settings.minimum_inliers);
    if (!shows_little) {
      EXPECT_LT(error(result, elsewhere), 0.01);
    }
  }
}

TEST(Tracker, AWeakRecoveryIsWithdrawnUnlessItIsConfirmed) {
  // After the dark few features show the map, for some frames or for longer; then it is dark again.
  for (const int frames : {3, 12}) {
    TrackingSettings settings = without_relocalisation();
    settings.recovery_keyframes = 5;
    settings.backward_frames = 0;
    Bench bench(settings);
    bench.walk(0.0, 0.5);
    bench.extractor.every = bench.world.seen().size() / 90;
    bench.feed(0.5, at(0.25), false);
    const std::size_t before = bench.tracker.trajectory(bench.access).size();
    const int first = 18;  // of 30 a second
    for (int i = first; i < first + frames; ++i) {
      const FrameResult result = bench.feed(i / 30.0, at(0.25));
      EXPECT_EQ(result.status, TrackingStatus::tracked) << i;
      EXPECT_LT(result.inliers, 4 * settings.minimum_inliers);
      if (i < first + 7) {
        EXPECT_FALSE(result.is_keyframe) << i;
      }
    }
    bench.feed((first + frames) / 30.0, at(0.25), false);
    const bool is_confirmed = frames > 8;
    const auto found = static_cast<std::size_t>(frames);
    EXPECT_EQ(bench.tracker.trajectory(bench.access).size(), before + (is_confirmed ? found : 0));
    EXPECT_EQ(bench.tracker.loss_record(bench.access).withdrawn, is_confirmed ? 0U : found);
  }
}

TEST(Tracker, InALoadedMapItIsRelocalisedAtAPlaceOfTheLoopDetector) {
  for (const int candidates : {5, 0}) {
    Bench maker;
    maker.walk(0.0, 1.0);
    TrackingSettings settings;
    settings.relocalisation_candidates = candidates;
    Bench bench(settings, false, std::move(maker.map));
    bench.tracker.localise_only();
    const Isometry3d place = at(0.21, 0.02, 0.05);
    const FrameResult result = bench.feed(0.0, place);
    EXPECT_EQ(result.status, candidates > 0 ? TrackingStatus::tracked : TrackingStatus::lost);
    if (candidates == 0) continue;
    EXPECT_EQ(result.method, TrackingMethod::relocalised);
    EXPECT_LT(error(result, place), 0.01);
    EXPECT_FALSE(result.is_keyframe);
    EXPECT_EQ(bench.feed(0.03, place).method, TrackingMethod::motion_model);
  }
}

TEST(Tracker, OneCameraIsNotCarriedByAMapThatExplainsNextToNothing) {
  TrackingSettings settings;
  settings.minimum_start_points = settings.minimum_inliers = settings.relocalisation_inliers = 10;
  settings.minimum_matches = 10;
  for (const std::size_t every : {5U, 25U}) {  // of the features that the camera sees have a point in the map
    SCOPED_TRACE(every);
    Bench maker(settings);
    maker.extractor.every = every;
    ASSERT_EQ(maker.feed(0.0, at(0.0)).status, TrackingStatus::initialised);
    maker.map.set_sensor(Sensor::mono);
    Bench bench(settings, false, std::move(maker.map));
    NoDepth no_depth;
    Tracker tracker(settings, {bench.world.camera(), bench.extractor, no_depth, bench.optimizer, bench.detector,
                               bench.moving_world, bench.map});
    const MapAccess access(bench.map);
    SensorFrame frame = bench.world.frame(0, 0.0, at(0.02, 0.01));
    frame.depth.release();
    FrameResult result;
    bench.moving_world.next_frame(frame.timestamp);
    tracker.begin(frame, result);
    tracker.locate(access, frame, result);
    EXPECT_GE(result.inliers, 2 * settings.minimum_inliers);
    EXPECT_EQ(result.status, every < 10 ? TrackingStatus::tracked : TrackingStatus::lost);
    if (every > 10) continue;
    frame = bench.world.frame(1, 1.0 / 30.0, at(0.02, 0.01), false);
    frame.depth.release();
    bench.moving_world.next_frame(frame.timestamp);
    tracker.begin(frame, result);
    EXPECT_TRUE(tracker.locate(access, frame, result).wants_mask) << "to find the camera by what is static";
    EXPECT_EQ(result.status, TrackingStatus::lost);
  }
}

TEST(Tracker, AnUnknownPlaceIsNotRelocalised) {
  Bench maker;
  maker.walk(0.0, 0.5);
  Bench elsewhere(TrackingSettings{}, false, std::move(maker.map), 99);
  const FrameResult result = elsewhere.feed(0.0, at(0.1));
  EXPECT_EQ(result.status, TrackingStatus::lost);
  EXPECT_EQ(result.failure, TrackingFailure::few_matches);
}

/// The frame of a camera at `T_depth` in which few features, without depth, are seen as if from `T_features`: what a
/// person who fills most of the view and moves makes of it.
SensorFrame contradicting_frame(Bench& bench, double time, const Isometry3d& T_depth, const Isometry3d& T_features) {
  const cv::Mat depth = bench.world.frame(bench.next_index, time, T_depth).depth.clone();
  SensorFrame frame = bench.world.frame(bench.next_index, time, T_features);
  frame.depth = depth;
  const auto& seen = bench.world.seen();
  constexpr int reach = 4;
  for (std::size_t i = 0; i < seen.size(); i += bench.extractor.every)
    for (int row = static_cast<int>(seen[i].y) - reach; row <= static_cast<int>(seen[i].y) + reach; ++row)
      for (int column = static_cast<int>(seen[i].x) - reach; column <= static_cast<int>(seen[i].x) + reach; ++column)
        if (row >= 0 && column >= 0 && row < depth.rows && column < depth.cols)
          frame.depth.at<float>(row, column) = 0.0F;
  return frame;
}

TEST(Tracker, APoseThatContradictsDepthIsRefused) {
  // 40 features agree that the camera moved by 6 cm; the depth of the room shows that it did not.
  for (const bool contradicts : {true, false})
    for (const bool with_filter : {true, false}) {
      TrackingSettings settings = without_relocalisation();
      settings.jump_distance = 0.1;
      Bench bench(settings, with_filter);
      for (int i = 0; i < 10; ++i) bench.feed(i / 30.0, at(0.0));
      bench.extractor.every = bench.world.seen().size() / 42;
      const Isometry3d moved = at(0.06);
      const FrameResult result =
          bench.feed(contradicting_frame(bench, 10 / 30.0, contradicts ? at(0.0) : moved, moved));
      const bool refused = contradicts && with_filter;  // without filters, everything counts as static
      EXPECT_EQ(result.status, refused ? TrackingStatus::lost : TrackingStatus::tracked)
          << contradicts << with_filter << " inliers " << result.inliers;
      EXPECT_GE(result.inliers, 30);
      EXPECT_LT(result.inliers, 50);
      if (refused) {
        EXPECT_EQ(result.failure, TrackingFailure::few_inliers);
      } else {
        EXPECT_LT(error(result, moved), 0.02);
      }
    }
}

TEST(Tracker, MaskedFeaturesCountWhereStaticOnesDoNotSuffice) {
  for (const bool fallback : {true, false}) {
    EvidenceSettings evidence;
    evidence.fallback = fallback;
    Bench bench(without_relocalisation(), true, {}, 5, evidence);
    EXPECT_EQ(bench.walk(0.0, 0.5).fallback, TrackingFallback::none);
    bench.mask_covers = true;  // somebody seems to stand everywhere, but the depth is that of the room
    const FrameResult result = bench.feed(0.5, at(0.25));
    if (!fallback) {
      EXPECT_EQ(result.status, TrackingStatus::lost);
      continue;
    }
    EXPECT_EQ(result.status, TrackingStatus::tracked);
    EXPECT_EQ(result.fallback, TrackingFallback::masked_features);
    EXPECT_LT(error(result, at(0.25)), 0.01);
    bench.mask_covers = false;
    EXPECT_EQ(bench.feed(0.53, at(0.265)).fallback, TrackingFallback::none);
  }
}

TEST(Tracker, WherePeopleLeaveFewFeaturesMoreAreAskedFor) {
  for (const double most : {2.0, 1.0}) {
    TrackingSettings settings;
    settings.feature_boost = most;
    Bench bench(settings, true);
    bench.walk(0.0, 0.5);
    EXPECT_EQ(bench.extractor.budget, 1.0) << "nobody is there";
    bench.mask_covers = true;
    bench.feed(0.5, at(0.25));
    bench.feed(0.53, at(0.265));
    EXPECT_EQ(bench.extractor.budget, most) << "one feature in 80 is static";
    bench.mask_covers = false;
    bench.feed(0.56, at(0.28));
    bench.feed(0.6, at(0.3));
    EXPECT_EQ(bench.extractor.budget, 1.0) << "nobody is there any more";
  }
}

TEST(Tracker, MaskedFeaturesDoNotCountAgainstDepth) {
  Bench bench(without_relocalisation(), true, {}, 5, with_fallback());
  for (int i = 0; i < 10; ++i) bench.feed(i / 30.0, at(0.0));
  bench.mask_covers = true;
  // All features have moved by 10 cm; the room has not.
  const FrameResult result = bench.feed(contradicting_frame(bench, 10 / 30.0, at(0.0), at(0.1)));
  EXPECT_NE(result.fallback, TrackingFallback::masked_features);
  if (result.status == TrackingStatus::tracked) {
    EXPECT_LT(error(result, at(0.0)), 0.01);
  }
}

TEST(Tracker, WithoutFeaturesDenseDepthSufficesForAWhile) {
  TrackingSettings settings = without_relocalisation();
  settings.depth_only_time = 0.5;
  Bench bench(settings, true, {}, 5, with_fallback());
  bench.walk(0.0, 0.5);
  bench.extractor.every = 100000;  // nothing has texture
  double time = 0.5;
  int frames = 0;
  for (;; time += 1.0 / 30.0, ++frames) {
    const FrameResult result = bench.feed(time, at(Bench::speed * time));
    if (result.status == TrackingStatus::lost) break;
    ASSERT_LT(time, 2.0);
    EXPECT_EQ(result.fallback, TrackingFallback::dense_depth);
    EXPECT_FALSE(result.is_keyframe);
    EXPECT_LT(error(result, at(Bench::speed * time)), 0.04) << time;
  }
  EXPECT_GE(frames, 8);
  EXPECT_LE(frames, 15);  // 0.5 s
}

/// The camera turns to the right by `angle` [rad].
Isometry3d turned(double angle) {
  Isometry3d T = Isometry3d::Identity();
  T.linear() = Eigen::AngleAxisd(angle, Vector3d::UnitY()).toRotationMatrix();
  return T;
}

TEST(Tracker, WhereTheMapEndsThePreviousFrameSufficesForAWhile) {
  // The map is what the first view shows; the camera turns out of it within half a second, and no keyframe is made.
  for (const double odometry_time : {0.0, 0.3}) {
    TrackingSettings settings = without_relocalisation();
    settings.odometry_time = odometry_time;
    Bench bench(settings);
    bench.feed(0.0, turned(0.0));
    bench.tracker.localise_only();
    int by_odometry = 0;
    double time = 1.0 / 30.0, last_by_map = 0.0, lost_at = 0.0;
    for (; time < 2.0 && lost_at == 0.0; time += 1.0 / 30.0) {
      const FrameResult result = bench.feed(time, turned(1.2 * time));
      if (result.status == TrackingStatus::lost) {
        lost_at = time;
        continue;
      }
      EXPECT_LT(error(result, turned(1.2 * time)), 0.03) << time;
      if (result.fallback == TrackingFallback::odometry) {
        ++by_odometry;
        EXPECT_LT(result.inliers, settings.minimum_inliers) << "features of the map alone would have done";
        EXPECT_FALSE(result.is_keyframe);
      } else {
        last_by_map = time;
      }
    }
    ASSERT_GT(lost_at, 0.0) << "the world ends somewhere";
    EXPECT_NEAR(lost_at - last_by_map, odometry_time, 0.07);
    EXPECT_EQ(by_odometry > 0, odometry_time > 0.0);
  }
}

TEST(Tracker, AMapThatIsLostSoonAfterItsStartBeginsAnew) {
  struct Case {
    double young_map_time, lost_at;
    bool begins_anew;
  };
  for (const Case& c : {Case{1.0, 0.5, true}, Case{0.0, 0.5, false}, Case{0.4, 0.5, false}}) {
    TrackingSettings settings = without_relocalisation();
    settings.young_map_time = c.young_map_time;
    settings.coasting_time = 1.0;
    settings.coasting_shares = {};
    settings.minimum_start_points = 50;
    Bench bench(settings);
    bench.walk(0.0, c.lost_at);
    const auto elsewhere = [](double time) { return at(Bench::speed * time, 0.0) * turned(1.15); };
    const std::size_t keyframes = bench.map.keyframes().size();
    for (const double time : {c.lost_at, c.lost_at + 0.15})
      EXPECT_EQ(bench.feed(time, elsewhere(time)).status, TrackingStatus::lost) << "a view of the map may come back";
    const double later = c.lost_at + 0.3;
    const FrameResult result = bench.feed(later, elsewhere(later));
    EXPECT_EQ(result.status, c.begins_anew ? TrackingStatus::initialised : TrackingStatus::lost);
    EXPECT_EQ(bench.map.keyframes().size(), keyframes + (c.begins_anew ? 1U : 0U));
    if (!c.begins_anew) continue;
    EXPECT_TRUE(result.is_keyframe);
    EXPECT_LT(error(result, at(Bench::speed * later)), 0.03) << "where the motion model puts it";
    EXPECT_EQ(bench.feed(later + 0.03, elsewhere(later + 0.03)).status, TrackingStatus::tracked);
  }
}

TEST(Tracker, ALoadedMapDoesNotBeginAnew) {
  Bench maker;
  maker.walk(0.0, 1.0);
  TrackingSettings settings;
  settings.odometry_time = 0.0;
  settings.minimum_start_points = 50;
  Bench bench(settings, false, std::move(maker.map));
  const std::size_t keyframes = bench.map.keyframes().size();
  ASSERT_EQ(bench.feed(0.0, at(0.2)).status, TrackingStatus::tracked);  // stamps begin at 0, as those of simulations
  for (const double time : {0.03, 0.2, 0.5})
    EXPECT_EQ(bench.feed(time, turned(1.15)).status, TrackingStatus::lost) << time;
  EXPECT_EQ(bench.map.keyframes().size(), keyframes);
}

TEST(Tracker, WhereTheMapEndsCertainOdometryBeginsNewMap) {
  // As above, but the tracker may make keyframes; no rule but this one makes any.
  TrackingSettings settings = without_relocalisation();
  settings.odometry_time = 0.3;
  settings.keyframe_close_tracked = 0;
  settings.keyframe_tracked_ratio = settings.keyframe_first_ratio = settings.keyframe_due_ratio = 0.0;
  settings.minimum_inliers = 15;
  Bench bench(settings);
  bench.feed(0.0, turned(0.0));
  int by_odometry = 0;
  for (double time = 1.0 / 30.0; time < 1.2; time += 1.0 / 30.0) {
    const FrameResult result = bench.feed(time, turned(1.2 * time));
    ASSERT_EQ(result.status, TrackingStatus::tracked) << time;
    EXPECT_LT(error(result, turned(1.2 * time)), 0.03) << time;
    if (result.fallback != TrackingFallback::odometry) continue;
    ++by_odometry;
    EXPECT_TRUE(result.is_keyframe) << time;
  }
  EXPECT_GT(by_odometry, 0);
  EXPECT_GT(bench.map.keyframes().size(), 1U);
}

TEST(Tracker, FewFeaturesThatJumpAreRefused) {
  // Every twelfth feature is enough for a pose, but does not outweigh inertia; every second one does.
  for (const std::size_t every : {2U, 12U}) {
    Bench bench(without_relocalisation());
    bench.walk(0.0, 0.5);
    bench.extractor.every = every;
    bench.feed(0.5, at(Bench::speed * 0.5));
    ASSERT_TRUE(bench.feed(0.5 + 1.0 / 30.0, at(Bench::speed * 0.5333)).T_world_camera);
    const Isometry3d jumped = at(Bench::speed * 0.5667 + 0.1);
    const FrameResult result = bench.feed(0.5 + 2.0 / 30.0, jumped);
    EXPECT_EQ(result.status, every == 2 ? TrackingStatus::tracked : TrackingStatus::lost) << every;
  }
}

TEST(Tracker, WithoutTheMapNoNumberOfFeaturesMakesTheCameraJump) {
  // The camera has turned out of the map; all features of the previous frame agree with a step forward, which only the
  // shorter one can be.
  for (const double step : {0.1, 0.3}) {
    TrackingSettings settings = without_relocalisation();
    settings.odometry_time = 0.3;
    Bench bench(settings);
    bench.feed(0.0, turned(0.0));
    bench.tracker.localise_only();
    double time = 1.0 / 30.0;
    while (time < 2.0 && bench.feed(time, turned(1.2 * time)).fallback != TrackingFallback::odometry)
      time += 1.0 / 30.0;
    ASSERT_LT(time, 2.0);
    time += 1.0 / 30.0;
    const FrameResult result = bench.feed(time, turned(1.2 * time) * at(0.0, 0.0, step));
    EXPECT_EQ(result.status, step < 0.2 ? TrackingStatus::tracked : TrackingStatus::lost) << step;
  }
}

TEST(Tracker, RightAfterALossItSaysSo) {
  Bench bench;
  bench.walk(0.0, 0.5);
  EXPECT_FALSE(bench.request.follows_loss);
  for (int i = 15; i < 18; ++i) bench.feed(i / 30.0, at(Bench::speed * i / 30.0), false);
  EXPECT_TRUE(bench.request.wants_mask) << "to find the camera by what is static";
  ASSERT_EQ(bench.feed(0.6, at(Bench::speed * 0.6)).status, TrackingStatus::tracked);
  EXPECT_FALSE(bench.request.wants_mask);
  EXPECT_TRUE(bench.request.follows_loss);
  bench.walk(0.6 + 1.0 / 30.0, 1.2);
  EXPECT_FALSE(bench.request.follows_loss);
}

TEST(Tracker, KeyframesAreMadeWhenThePolicySaysSo) {
  // Each reason by itself: settings leave the others out.
  TrackingSettings none;
  none.keyframe_close_tracked = 0;
  none.keyframe_tracked_ratio = 0.0;
  none.keyframe_due_ratio = 0.0;
  const auto keyframes = [](const TrackingSettings& settings, bool localise_only = false) {
    Bench bench(settings);
    bench.feed(0.0, at(0.0));
    if (localise_only) bench.tracker.localise_only();
    bench.walk(1.0 / 30.0, 1.0);
    return bench.map.keyframes().size();
  };
  EXPECT_EQ(keyframes(none), 1U);
  TrackingSettings interval = none;
  interval.keyframe_due_ratio = 1.0;
  interval.keyframe_maximum_interval = 0.25;
  EXPECT_EQ(keyframes(interval), 4U);
  TrackingSettings close = none;
  close.keyframe_close_tracked = 100000;
  close.keyframe_close_possible = 10;
  EXPECT_GE(keyframes(close), 2U);
  TrackingSettings view = none;
  view.keyframe_tracked_ratio = view.keyframe_first_ratio = 0.9;
  EXPECT_GE(keyframes(view), 2U);
  EXPECT_EQ(keyframes(view, true), 1U);
}

TEST(Tracker, TheTrajectoryFollowsCorrectionsOfKeyframes) {
  Bench bench;
  bench.walk(0.0, 0.5);
  const Trajectory before = bench.tracker.trajectory(bench.access);
  ASSERT_EQ(before.size(), 15U);
  bench.map.keyframes().for_each([&](KeyFrameId id, const KeyFrame&) {
    Frame& frame = bench.map.keyframe(id).frame;
    frame.T_camera_world = frame.T_camera_world * at(0.0, 1.0).inverse();
  });
  const Trajectory after = bench.tracker.trajectory(bench.access);
  for (std::size_t i = 0; i < after.size(); ++i)
    EXPECT_LT(
        ((after[i].T_world_camera.translation() - before[i].T_world_camera.translation()) - Vector3d(0, 1, 0)).norm(),
        1e-9)
        << i;
}

TEST(Tracker, WaitsForAFrameWithDepth) {
  Bench bench;
  SensorFrame blind = bench.world.frame(0, 0.0, at(0.0));
  blind.depth.release();
  FrameResult result = bench.feed(blind);
  EXPECT_EQ(result.status, TrackingStatus::waiting);
  EXPECT_EQ(result.failure, TrackingFailure::no_depth);
  result = bench.feed(0.1, at(0.0), false);
  EXPECT_EQ(result.failure, TrackingFailure::few_features);
  EXPECT_EQ(bench.feed(0.2, at(0.0)).status, TrackingStatus::initialised);
  EXPECT_TRUE(bench.tracker.trajectory(bench.access).size() == 1U);
}

}  // namespace
}  // namespace holdfast
