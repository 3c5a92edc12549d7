// SPDX-License-Identifier: BSD-3-Clause
// A lost camera goes on in a new submap.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <memory>

#include "holdfast/pipeline/pipeline.hpp"
#include "holdfast/plugin/registry.hpp"
#include "support/brute_force_detector.hpp"
#include "support/point_world.hpp"

extern "C" void holdfast_register_plugin_ceres(holdfast::Registry&);

namespace holdfast {
namespace {

using Eigen::Isometry3d;

/// Shows the camera one half of the points, the other half, or all: two places that have nothing in common, and a view
/// of both.
class HalfExtractor final : public FeatureExtractor {
 public:
  enum class Half { first, second, both };
  HalfExtractor(test::PointWorld& world, const Half& shown) : all_(world, 0.3), world_(world), shown_(shown) {}
  void extract(const cv::Mat& grey, const cv::Mat& ignore, Features& out) override {
    Features all;
    all_.extract(grey, ignore, all);
    out.resize(0);
    for (std::size_t i = 0; i < all.size(); ++i) {
      const bool is_second = world_.seen()[i].point % 2 == 1;
      if (shown_ != Half::both && is_second != (shown_ == Half::second)) continue;
      const std::size_t k = out.size();
      out.resize(k + 1);
      out.x[k] = all.x[i], out.y[k] = all.y[i], out.angle[k] = all.angle[i], out.response[k] = all.response[i];
      out.octave[k] = all.octave[i], out.descriptors.of_256_bits()[k] = all.descriptors.of_256_bits()[i];
    }
  }
  const ScalePyramid& pyramid() const override { return all_.pyramid(); }

 private:
  test::PointExtractor all_;
  test::PointWorld& world_;
  const Half& shown_;
};

class SubmapsTest : public testing::Test {
 protected:
  using Half = HalfExtractor::Half;

  std::unique_ptr<Pipeline> make(double restart_time, bool threaded) {
    Registry registry;
    holdfast_register_plugin_ceres(registry);
    PipelineParts parts;
    parts.camera = world.camera();
    parts.features = std::make_unique<HalfExtractor>(world, half);
    parts.optimizer = registry.create<Optimizer>("ceres", {}, {});
    parts.loop_detector = std::make_unique<test::BruteForceDetector>();
    parts.tracking.restart_time = restart_time;
    parts.tracking.depth_edge_ratio = 0.0;
    parts.tracking.odometry_time = 0.0;
    parts.tracking.backward_frames = 0;
    parts.tracking.keyframe_maximum_interval = 0.2;  // many keyframes: loops are looked for at these
    parts.tracking.keyframe_due_ratio = parts.tracking.keyframe_tracked_ratio = 1.0;
    if (threaded) parts.run.mode = RunMode::threaded;
    return std::make_unique<Pipeline>(std::move(parts));
  }
  static bool has_joined(const Pipeline& pipeline) {
    const std::vector<LoopEvent> loops = pipeline.loop_record().loops;
    return std::any_of(loops.begin(), loops.end(), [](const LoopEvent& event) {
      return event.loop.joins_submaps && event.loop.correction.metres > 0.1;
    });
  }
  /// Two seconds of each: the first half, darkness of half a second, in which the camera goes elsewhere, the second
  /// half, and both if `comes_back`. `until_joined`: both are shown until the submaps are joined, for half a minute at
  /// most, because few frames of two seconds become keyframes where threads share a busy machine. `begin`: the first
  /// frame.
  void drive(Pipeline& pipeline, bool comes_back, bool until_joined = false, int begin = 0) {
    const int frames = comes_back ? 180 : 120;
    for (int i = begin; i < frames || (until_joined && i < 1000 && !has_joined(pipeline)); ++i) {
      const double time = i / 30.0;
      const bool is_dark = i >= 60 && i < 75;
      half = i < 60 ? Half::first : i < 120 ? Half::second : Half::both;
      Isometry3d pose = test::path_pose(time);
      if (i >= 60) pose = Eigen::Translation3d(0.3, 0.0, 0.1) * pose;
      truth.emplace(time, pose);
      const FrameResult result = pipeline.feed(world.frame(static_cast<std::uint64_t>(i), time, pose, !is_dark));
      began += i > begin && result.status == TrackingStatus::initialised ? 1 : 0;
    }
    pipeline.finish();
  }
  double worst_error(const Trajectory& trajectory) const {
    double worst = 0.0;
    for (const TimedPose& pose : trajectory)
      worst = std::max(worst, (pose.T_world_camera.translation() - truth.at(pose.timestamp).translation()).norm());
    return worst;
  }

  test::PointWorld world{find_camera("tum_fr1").value(), 3000};
  Half half = Half::first;
  std::map<double, Isometry3d> truth;
  int began = 0;
};

TEST_F(SubmapsTest, APlaceSeenInBothJoinsThem) {
  for (const bool threaded : {false, true}) {
    began = 0, truth.clear();
    const auto pipeline = make(0.3, threaded);
    drive(*pipeline, true, threaded);
    EXPECT_GE(began, 1);
    EXPECT_TRUE(has_joined(*pipeline));
    const Trajectory trajectory = pipeline->trajectory();
    EXPECT_GT(trajectory.size(), truth.size() - 30);  // 15 are dark
    EXPECT_LT(worst_error(trajectory), 0.03);
  }
}

TEST_F(SubmapsTest, WithoutThemTheSecondPlaceIsLost) {
  const auto pipeline = make(0.0, false);
  drive(*pipeline, true);
  EXPECT_EQ(began, 0);
  const Trajectory trajectory = pipeline->trajectory();
  EXPECT_LT(trajectory.size(), 125U);
  EXPECT_LT(worst_error(trajectory), 0.03);
}

TEST_F(SubmapsTest, ASubmapThatNothingJoinsIsLeftOut) {
  const auto pipeline = make(0.3, false);
  drive(*pipeline, false);
  EXPECT_EQ(began, 1);
  EXPECT_TRUE(pipeline->loop_record().loops.empty());
  EXPECT_EQ(pipeline->trajectory().size(), 60U);
  EXPECT_LT(worst_error(pipeline->trajectory()), 0.03);
  pipeline->map().keyframes().for_each([](KeyFrameId, const KeyFrame& keyframe) {
    EXPECT_LT(keyframe.frame.timestamp, 2.0);
    EXPECT_EQ(keyframe.submap, 0U);
  });
}

/// A recording that begins with a glimpse of another place.
TEST_F(SubmapsTest, TheLargerSubmapIsTheResult) {
  const auto pipeline = make(0.3, false);
  drive(*pipeline, false, false, 25);  // for longer than young_map_time
  EXPECT_EQ(began, 1);
  const Trajectory trajectory = pipeline->trajectory();
  EXPECT_EQ(trajectory.front().timestamp, 2.5)
      << "as soon as it is light, because the camera has been lost for so long";
  EXPECT_EQ(trajectory.size(), 45U);
  EXPECT_EQ(pipeline->loss_record().left_out, 35U);
  pipeline->map().keyframes().for_each(
      [](KeyFrameId, const KeyFrame& keyframe) { EXPECT_GE(keyframe.frame.timestamp, 2.5); });
}

}  // namespace
}  // namespace holdfast
