// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/tracking/inertial_smoothing.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "holdfast/core/random.hpp"
#include "holdfast/plugin/registry.hpp"

extern "C" void holdfast_register_plugin_schur(holdfast::Registry&);

namespace holdfast {
namespace {

constexpr double frame_interval = 0.04;
constexpr int frame_count = 100, first_bridged = 40, last_bridged = 70;

/// A camera that swings along x and turns about the vertical by `turn` [rad/s]; its IMU has the camera's frame.
Eigen::Isometry3d pose_at(double time, double turn = 0.0) {
  Eigen::Isometry3d T_world_camera(Eigen::AngleAxisd(turn * time, Eigen::Vector3d::UnitY()));
  T_world_camera.translation().x() = 0.3 * std::sin(2.0 * time);
  return T_world_camera;
}
Eigen::Vector3d force_at(double time) { return {-1.2 * std::sin(2.0 * time), -standard_gravity, 0.0}; }

/// A history in which the bridged frames drift away by 0.15 m until the end of the bridge.
class InertialSmoothingTest : public testing::Test {
 protected:
  InertialSmoothingTest() {
    inertia->set_estimates(estimates(), 0);
    for (int i = 0; i < frame_count; ++i) add_frame(i);
  }
  static MapInertia estimates() {
    MapInertia result;
    result.gravity = {0.0, standard_gravity, 0.0};
    return result;
  }
  void add_measurements(int i) {
    SensorFrame measured;
    measured.timestamp = frame_interval * i;
    for (int k = -9; k <= 1; ++k) {
      const double time = measured.timestamp + 0.005 * k;
      const double wrong = unmodelled * std::sin(std::numbers::pi / 2.0 * time);
      const Eigen::Vector3d force = force_at(time) + wrong * Eigen::Vector3d::UnitX();
      measured.imu.push_back({time, turn * Eigen::Vector3d::UnitY(), pose_at(time, turn).linear().transpose() * force});
    }
    inertia->add(measured);
  }
  void add_frame(int i, bool lacks_measurements = false, bool drifts = false) {
    if (!lacks_measurements) add_measurements(i);
    Frame frame;
    frame.timestamp = frame_interval * i;
    Eigen::Isometry3d T_world_camera = pose_at(frame.timestamp, turn);
    const bool is_bridged = drifts || (i >= first_bridged && i <= last_bridged);
    const int since = drifts ? 20 : i - first_bridged;
    if (is_bridged) T_world_camera.translation().y() += 0.15 * since / (last_bridged - first_bridged);
    frame.T_camera_world = T_world_camera.inverse();
    history.add(frame, reference, map);
    if (is_bridged) drifting.frames.push_back(frame.timestamp);
  }
  /// Makes a keyframe of a frame, which drifts.
  KeyFrameId make_keyframe(int i) {
    Frame frame = keyframe();
    for (const TimedPose& pose : history.trajectory(map))
      if (std::abs(pose.timestamp - frame_interval * i) < 1e-9) {
        frame.timestamp = pose.timestamp;
        frame.T_camera_world = pose.T_world_camera.inverse();
      }
    const KeyFrameId id = map.add_keyframe(frame);
    history.add_past(frame, id, map);
    std::erase(drifting.frames, frame.timestamp);
    drifting.keyframes.push_back(frame.timestamp);
    return id;
  }
  std::size_t smooth() { return smooth_by_inertia(history, map, drifting, *inertia, *optimizer, stop).smoothed; }
  static Frame keyframe() {
    Frame frame;
    frame.x.resize(2), frame.map_points.resize(2);
    frame.camera = std::make_shared<Camera>(find_camera("tum_fr3").value());
    return frame;
  }
  double largest_error() const {
    double largest = 0.0;
    for (const TimedPose& pose : history.trajectory(map))
      largest = std::max(largest, (pose.T_world_camera.translation() - pose_at(pose.timestamp).translation()).norm());
    return largest;
  }

  /// A history of `count` frames in which those for which `is_missing` is true have measurements and no pose.
  template <class IsMissing>
  void add_frames_but(int count, IsMissing is_missing) {
    history.clear(), drifting = {};
    inertia.emplace(*find_imu("bmi055"), first_sequence);
    inertia->set_estimates(estimates(), 0);
    drifting.longest_gap = 4.0;
    for (int i = 0; i < count; ++i) {
      if (is_missing(i)) {
        add_measurements(i);
        drifting.missing.push_back(frame_interval * i);
      } else {
        add_frame(i);
      }
    }
    drifting.frames.clear();
    for (const TimedPose& pose : history.trajectory(map))
      history.replace(pose.timestamp, pose_at(pose.timestamp, turn).inverse(), map);
  }

  std::uint64_t first_sequence = 0;  // of the run's keyframes
  double turn = 0.0;                 // [rad/s]
  double unmodelled = 0.0;           // acceleration that measurements show and the camera has not [m/s^2]
  Map map;
  KeyFrameId reference = map.add_keyframe(keyframe());
  FrameHistory history;
  UnplacedFrames drifting;
  std::atomic<bool> stop = false;
  std::optional<InertialHistory> inertia{*find_imu("bmi055")};
  std::unique_ptr<Optimizer> optimizer = [] {
    Registry registry;
    holdfast_register_plugin_schur(registry);
    return registry.create<Optimizer>("schur", {}, {});
  }();
};

TEST_F(InertialSmoothingTest, FramesOfABridgeFollowTheFramesOnBothSides) {
  EXPECT_NEAR(largest_error(), 0.15, 1e-6);
  EXPECT_EQ(smooth(), 99U) << "all but the keyframe";
  EXPECT_LT(largest_error(), 0.005);
}

TEST_F(InertialSmoothingTest, FramesWithoutAPoseGetOneBetweenTrackedFrames) {
  turn = 5.0;  // more than one and a half turns within the gap
  add_frames_but(frame_count, [](int i) { return i >= 30 && i < 80; });
  const InertialSmoothing done = smooth_by_inertia(history, map, drifting, *inertia, *optimizer, stop);
  EXPECT_EQ(done.placed, 50U);
  EXPECT_EQ(done.smoothed, 99U);
  const Trajectory poses = history.trajectory(map);
  ASSERT_EQ(poses.size(), static_cast<std::size_t>(frame_count));
  EXPECT_LT(largest_error(), 0.005);
  for (const TimedPose& pose : poses)
    EXPECT_LT(
        Eigen::AngleAxisd(pose.T_world_camera.linear().transpose() * pose_at(pose.timestamp, turn).linear()).angle(),
        0.01);
}

TEST_F(InertialSmoothingTest, FramesWithoutAPoseGetOneWithinHalfASecondOfTheFirstAndTheLastTrackedFrame) {
  turn = 3.0;
  add_frames_but(frame_count, [](int i) { return i < 20 || i >= 70; });
  EXPECT_EQ(smooth_by_inertia(history, map, drifting, *inertia, *optimizer, stop).placed, 24U);
  const Trajectory poses = history.trajectory(map);
  ASSERT_EQ(poses.size(), 74U);
  EXPECT_NEAR(poses.front().timestamp, 8 * frame_interval, 1e-9);
  EXPECT_NEAR(poses.back().timestamp, 81 * frame_interval, 1e-9);
  EXPECT_LT(largest_error(), 0.005);
}

TEST_F(InertialSmoothingTest, FramesOfARunWithoutKeyframesGetAPoseInAnEarlierMap) {
  first_sequence = 1;
  add_frames_but(frame_count, [](int i) { return i < 5 || (i >= 30 && i < 80); });
  EXPECT_TRUE(path_of(history, map, *inertia).keyframes.empty());
  EXPECT_EQ(smooth_by_inertia(history, map, drifting, *inertia, *optimizer, stop).placed, 55U);
  EXPECT_EQ(history.trajectory(map).size(), static_cast<std::size_t>(frame_count));
  EXPECT_LT(largest_error(), 0.005);
}

TEST_F(InertialSmoothingTest, FramesWithoutAPoseStaySoInALongGap) {
  add_frames_but(frame_count, [](int i) { return i >= 30 && i < 80; });
  drifting.longest_gap = 1.9;
  EXPECT_EQ(smooth_by_inertia(history, map, drifting, *inertia, *optimizer, stop).placed, 24U) << "beside its ends";
  EXPECT_LT(largest_error(), 0.005);
}

TEST_F(InertialSmoothingTest, FramesWithoutAPoseStaySoIfNothingIsToBePredicted) {
  add_frames_but(frame_count, [](int i) { return i < 5 || (i >= 30 && i < 40); });
  drifting.longest_gap = 0.0;
  EXPECT_EQ(smooth_by_inertia(history, map, drifting, *inertia, *optimizer, stop).placed, 0U);
}

/// The bridge ends within the gap: what is missing behind it is as far from tracked frames as the whole gap.
TEST_F(InertialSmoothingTest, ABridgeIsNoSideOfAGap) {
  add_frames_but(frame_count, [](int i) { return i >= 50 && i < 80; });
  for (int i = 30; i < 50; ++i) drifting.frames.push_back(frame_interval * i);
  drifting.longest_gap = 1.5;
  EXPECT_EQ(smooth_by_inertia(history, map, drifting, *inertia, *optimizer, stop).placed, 12U)
      << "half a second before the tracked frames behind the gap";
}

TEST_F(InertialSmoothingTest, AFewTrackedFramesPredictNoLongerThanTheyLast) {
  add_frames_but(frame_count, [](int i) { return i < 45 || i >= 50; });
  EXPECT_EQ(smooth_by_inertia(history, map, drifting, *inertia, *optimizer, stop).placed, 8U);
}

TEST_F(InertialSmoothingTest, AFalsePoseDoesNotHoldABridge) {
  std::erase_if(drifting.frames,
                [](double stamp) { return stamp > frame_interval * 53.5 && stamp < frame_interval * 56.5; });
  EXPECT_EQ(smooth(), 99U);
  EXPECT_LT(largest_error(), 0.02);
}

TEST_F(InertialSmoothingTest, ErrorsOfTrackedFramesAreSmoothedByTheirOwnSize) {
  Random random(5);
  const auto disturbed = [&](int i) { return i % 20 != 0 && (i < first_bridged || i > last_bridged); };
  const auto error = [&](int begin, int end) {
    const Trajectory poses = history.trajectory(map);
    double sum = 0.0;
    for (int i = begin; i < end; ++i)
      if (disturbed(i))
        sum += (poses[i].T_world_camera.translation() - pose_at(poses[i].timestamp).translation()).norm();
    return sum;
  };
  for (int i = 0; i < frame_count; ++i) {
    Eigen::Isometry3d T_world_camera = pose_at(frame_interval * i);
    const double deviation = i < first_bridged ? 0.001 : 0.01;
    const Eigen::Vector3d noise(random.normal(), random.normal(), random.normal());
    if (disturbed(i)) T_world_camera.translation() += deviation * noise;
    if (i < first_bridged || i > last_bridged) history.replace(frame_interval * i, T_world_camera.inverse(), map);
    if (i > 0 && i % 20 == 0 && i != 60) make_keyframe(i), drifting.keyframes.clear();
  }
  const double before[] = {error(0, first_bridged), error(last_bridged, frame_count)};
  const Eigen::Matrix4d keyframe = map.pose_of(map.keyframes_by_age()[1]).matrix();
  EXPECT_EQ(smooth(), 96U);
  EXPECT_LT(error(0, first_bridged), 0.4 * before[0]);
  EXPECT_LT(error(last_bridged, frame_count), 0.15 * before[1]);
  EXPECT_EQ(map.pose_of(map.keyframes_by_age()[1]).matrix(), keyframe);
}

/// As by an error of the mounting while the camera tilts slowly.
TEST_F(InertialSmoothingTest, SlowErrorsOfTheMeasurementsDoNotTakeTheWeightOfPoses) {
  unmodelled = 0.5;
  inertia.emplace(*find_imu("bmi055"));
  inertia->set_estimates(estimates(), 0);
  history = FrameHistory();
  drifting.frames.clear();
  Random random(5);
  for (int i = frame_count; i < 7 * frame_count; ++i) {
    add_frame(i);
    Eigen::Isometry3d T_world_camera = pose_at(frame_interval * i);
    T_world_camera.translation() += 0.003 * Eigen::Vector3d(random.normal(), random.normal(), random.normal());
    history.replace(frame_interval * i, T_world_camera.inverse(), map);
  }
  const auto error = [&] {
    double sum = 0.0;
    for (const TimedPose& pose : history.trajectory(map))
      sum += (pose.T_world_camera.translation() - pose_at(pose.timestamp).translation()).squaredNorm();
    return std::sqrt(sum);
  };
  const double before = error();
  EXPECT_GT(smooth(), 590U);
  EXPECT_LT(error(), before);
}

/// As where no adjustment of the map follows the bridge.
TEST_F(InertialSmoothingTest, KeyframesOfABridgeMoveWithTheirPoints) {
  const KeyFrameId keyframe = make_keyframe(55);
  const Eigen::Vector3d seen(0.1, 0.2, 3.0);
  const MapPointId alone = map.add_point(map.pose_of(keyframe).inverse() * seen, 0);
  const MapPointId shared = map.add_point(map.pose_of(keyframe).inverse() * seen, 0);
  map.add_observation(alone, keyframe, 0);
  map.add_observation(shared, keyframe, 1);
  map.add_observation(shared, reference, 0);
  const Eigen::Vector3d before = map.point(shared).position;
  EXPECT_EQ(smooth(), 99U);
  EXPECT_LT(largest_error(), 0.006);
  EXPECT_LT((map.pose_of(keyframe).inverse().translation() - pose_at(frame_interval * 55).translation()).norm(), 0.006);
  EXPECT_LT((map.pose_of(keyframe) * map.point(alone).position - seen).norm(), 1e-9);
  EXPECT_EQ(map.point(shared).position, before);
}

TEST_F(InertialSmoothingTest, AKeyframeThatAnAdjustmentPlacedHoldsTheBridge) {
  const KeyFrameId keyframe = make_keyframe(55);
  drifting.keyframes.clear();
  const Eigen::Matrix4d before = map.pose_of(keyframe).matrix();
  EXPECT_EQ(smooth(), 98U);
  EXPECT_EQ(map.pose_of(keyframe).matrix(), before);
  EXPECT_GT(largest_error(), 0.05) << "it was not placed well here";
}

TEST_F(InertialSmoothingTest, StaysWithoutMeasurements) {
  const InertialHistory nothing(*find_imu("bmi055"));
  EXPECT_EQ(smooth_by_inertia(history, map, drifting, nothing, *optimizer, stop).smoothed, 0U);
  EXPECT_NEAR(largest_error(), 0.15, 1e-6);
}

/// A gap in the measurements ends a chain of frames, and not the smoothing: that on its other side begins anew.
TEST_F(InertialSmoothingTest, FramesOnBothSidesOfAGapAreSmoothed) {
  for (const int gap : {20, 55}) {
    history.clear(), drifting = {};
    inertia.emplace(*find_imu("bmi055"));
    inertia->set_estimates(estimates(), 0);
    for (int i = 0; i < frame_count; ++i) add_frame(i, i >= gap && i < gap + 5);
    const Trajectory before = history.trajectory(map);
    EXPECT_EQ(smooth(), gap == 20 ? 95U : 68U);
    const Trajectory after = history.trajectory(map);
    const Eigen::Vector3d moved = after[55].T_world_camera.translation() - before[55].T_world_camera.translation();
    if (gap == 20)
      EXPECT_LT(largest_error(), 0.005);
    else
      EXPECT_LT(moved.norm(), 1e-9) << "no tracked frame holds the other side of it";
  }
}

/// A trajectory of several chains, each as long as one may be; the first cut lies within a bridge, but for that.
TEST_F(InertialSmoothingTest, LongTrajectoriesAreSolvedInPieces) {
  for (int i = frame_count; i < 940; ++i) add_frame(i, false, i >= 890 && i <= 920);
  EXPECT_EQ(smooth(), 939U);
  EXPECT_LT(largest_error(), 0.005);
}

/// White noise of the poses; each piece alone would end with an error of its own.
TEST_F(InertialSmoothingTest, PiecesMeetWithoutAStep) {
  for (int i = frame_count; i < 1000; ++i) add_frame(i);
  Random random(3);
  for (const TimedPose& pose : history.trajectory(map)) {
    if (pose.timestamp == 0.0) continue;
    Eigen::Isometry3d disturbed = pose.T_world_camera;
    disturbed.translation() += 0.005 * Eigen::Vector3d(random.normal(), random.normal(), random.normal());
    history.replace(pose.timestamp, disturbed.inverse(), map);
  }
  smooth();
  const Trajectory poses = history.trajectory(map);
  std::vector<double> steps;
  for (std::size_t i = 1; i < poses.size(); ++i)
    steps.push_back((poses[i].T_world_camera.translation() - pose_at(poses[i].timestamp).translation() -
                     poses[i - 1].T_world_camera.translation() + pose_at(poses[i - 1].timestamp).translation())
                        .norm());
  const double at_cut = steps[899];
  EXPECT_LT(at_cut, 2.0 * *std::max_element(steps.begin() + 500, steps.begin() + 890));
}

TEST_F(InertialSmoothingTest, StaysAfterAnInterruption) {
  stop = true;
  EXPECT_EQ(smooth(), 0U);
  EXPECT_NEAR(largest_error(), 0.15, 1e-6);
}

TEST_F(InertialSmoothingTest, StaysWhereNoTrackedFrameFollows) {
  for (const bool is_keyframe : {false, true}) {
    add_frame(frame_count + (is_keyframe ? 1 : 0));
    const double end = history.trajectory(map).back().timestamp;
    if (is_keyframe)
      make_keyframe(frame_count + 1);
    else
      drifting.frames.push_back(end);
    const Eigen::Isometry3d before = history.trajectory(map).back().T_world_camera;
    smooth();
    EXPECT_EQ(history.trajectory(map).back().T_world_camera.matrix(), before.matrix());
  }
}

/// A keyframe that drifts is no other side.
TEST_F(InertialSmoothingTest, StaysWhereItEndsInADriftingKeyframe) {
  for (int i = last_bridged + 1; i < frame_count - 1; ++i) drifting.frames.push_back(frame_interval * i);
  make_keyframe(frame_count - 1);
  EXPECT_EQ(smooth(), 39U) << "the frames before it";
  EXPECT_NEAR(largest_error(), 0.15, 1e-6);
}

}  // namespace
}  // namespace holdfast
