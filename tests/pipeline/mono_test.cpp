// SPDX-License-Identifier: BSD-3-Clause
// One camera: threads, and a map that is lost soon after its start.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "holdfast/evaluation/evaluation.hpp"
#include "holdfast/pipeline/pipeline_builder.hpp"
#include "holdfast/settings/orb.hpp"
#include "holdfast/settings/schur.hpp"
#include "holdfast/simulation/scene_file.hpp"
#include "holdfast/simulation/simulator.hpp"

namespace holdfast {
namespace {

constexpr double frame_rate = 30.0;

class MonoTest : public ::testing::Test {
 protected:
  static Pipeline make(const Camera& camera, const TrackingSettings& tracking, bool threaded,
                       const MappingSettings& mapping = {}) {
    RunSettings run;
    run.mode = threaded ? RunMode::threaded : RunMode::sequential;
    return PipelineBuilder()
        .camera(camera)
        .sensor(Sensor::mono)
        .features(OrbSettings{.count = 1000})
        .optimizer(SchurSettings{})
        .tracking(tracking)
        .mapping(mapping)
        .run(run)
        .build();
  }
  /// Feeds the frame `index` of the scene as the next of the sequence.
  FrameResult feed(Pipeline& pipeline, std::uint64_t index) { return pipeline.feed(next_frame(index)); }
  SensorFrame next_frame(std::uint64_t index) {
    SensorFrame frame = simulator_.frame(index);
    frame.index = next_;
    frame.timestamp = static_cast<double>(next_++) / frame_rate;
    truth_.push_back({frame.timestamp, *frame.truth->T_world_camera});
    return frame;
  }
  /// RMSE of the poses after `begin` [s], aligned with scale.
  double error(const Trajectory& trajectory, double begin, std::size_t& poses) const {
    Trajectory part;
    for (const TimedPose& pose : trajectory)
      if (pose.timestamp >= begin) part.push_back(pose);
    poses = part.size();
    EvaluationOptions options;
    options.alignment = AlignmentKind::sim3;
    return evaluate(truth_, part, options).absolute_error.rmse;
  }

  simulation::Simulator simulator_{simulation::read_scene({}, {"camera.path=loop", "seed=3"}), *find_camera("tum_fr3")};
  std::uint64_t next_ = 0;
  Trajectory truth_;
};

TEST_F(MonoTest, AMapThatIsLostSoonAfterItsStartBeginsAnew) {
  for (const bool threaded : {false, true})
    for (const double young_map_time : {1.0, 0.0}) {
      SCOPED_TRACE((threaded ? "threaded, " : "sequential, ") + std::to_string(young_map_time));
      next_ = 0;
      truth_.clear();
      TrackingSettings tracking;
      tracking.young_map_time = young_map_time;
      tracking.recovery_keyframes = 0;  // nothing else finds the camera
      tracking.backward_frames = 0;     // earlier frames would get poses in the second map
      Pipeline pipeline = make(simulator_.camera(), tracking, threaded);
      std::uint64_t index = 0;
      while (index < 120 && feed(pipeline, index++).status != TrackingStatus::initialised) {
      }
      ASSERT_LT(index, 120U) << "the map has begun";
      for (int i = 0; i < 12; ++i) ASSERT_EQ(feed(pipeline, index++).status, TrackingStatus::tracked);
      // Somebody carries the camera elsewhere, with a hand on the lens.
      index += 400;
      ASSERT_LT(index + 120, simulator_.frame_count());
      int begun_again = 0, tracked_afterwards = 0;
      double begun_at = 0.0;
      for (int i = 0; i < 100; ++i) {
        const FrameResult result = feed(pipeline, index++);
        if (result.status == TrackingStatus::initialised) ++begun_again, begun_at = truth_.back().timestamp;
        if (begun_again > 0 && result.status == TrackingStatus::tracked) ++tracked_afterwards;
        if (begun_again == 0) {
          EXPECT_TRUE(result.status == TrackingStatus::lost ||
                      (young_map_time > 0.0 && result.status == TrackingStatus::waiting));
        }
      }
      pipeline.finish();
      EXPECT_EQ(begun_again, young_map_time > 0.0 ? 1 : 0);
      if (begun_again == 0) continue;
      EXPECT_GT(tracked_afterwards, 40);
      std::size_t poses = 0;
      EXPECT_LT(error(pipeline.trajectory(), 0.0, poses), threaded ? 0.02 : 0.01);
      EXPECT_GT(poses, 40U);
      EXPECT_GT(pipeline.trajectory()[1].timestamp, begun_at - 1e-9) << "poses of the map that was given up";
      // Nothing of the map is without a parent but its first keyframe.
      pipeline.map().keyframes().for_each([&](KeyFrameId, const KeyFrame& keyframe) {
        EXPECT_EQ(keyframe.parent.valid(), keyframe.sequence != 0) << keyframe.sequence;
      });
    }
}

TEST_F(MonoTest, AMapThatGrowsLessThanRequiredIsGivenUp) {
  for (const bool threaded : {false, true})
    for (const double start_support : {0.9, 0.0}) {
      SCOPED_TRACE((threaded ? "threaded, " : "sequential, ") + std::to_string(start_support));
      next_ = 0;
      truth_.clear();
      TrackingSettings tracking;
      tracking.start_support = start_support;  // more than any map reaches; each further start needs half as much
      tracking.backward_frames = 0;            // earlier frames would get poses in the next map
      Pipeline pipeline = make(simulator_.camera(), tracking, threaded);
      int given_up = 0, tracked_afterwards = 0;
      double given_up_at = 0.0;
      for (std::uint64_t index = 0; index < 240; ++index) {
        const FrameResult result = feed(pipeline, index);
        if (result.status == TrackingStatus::tracked) ++tracked_afterwards;
        if (result.failure != TrackingFailure::weak_start) continue;
        ++given_up;
        EXPECT_EQ(result.status, TrackingStatus::lost);
        EXPECT_FALSE(result.T_world_camera);
        EXPECT_TRUE(pipeline.trajectory().empty());
        given_up_at = truth_.back().timestamp;
        tracked_afterwards = 0;
      }
      pipeline.finish();
      EXPECT_EQ(given_up > 0, start_support > 0.0);
      EXPECT_LT(given_up, 4);
      EXPECT_GT(tracked_afterwards, 60);
      std::size_t poses = 0;
      EXPECT_LT(error(pipeline.trajectory(), 0.0, poses), 0.02);
      EXPECT_GE(pipeline.trajectory().front().timestamp, given_up_at);
      pipeline.map().keyframes().for_each([&](KeyFrameId, const KeyFrame& keyframe) {
        EXPECT_EQ(keyframe.parent.valid(), keyframe.sequence != 0) << keyframe.sequence;
        EXPECT_GE(keyframe.frame.timestamp, given_up_at);
      });
    }
}

TEST_F(MonoTest, ThreadsTrackAsOneThreadDoes) {
  Pipeline pipeline = make(simulator_.camera(), {}, true);
  bool begun = false;
  for (std::uint64_t index = 0; index < 180; ++index) {
    const FrameResult result = feed(pipeline, index);
    begun = begun || result.status == TrackingStatus::initialised;
    if (begun) {
      EXPECT_NE(result.status, TrackingStatus::lost) << index;
    }
  }
  pipeline.finish();
  std::size_t poses = 0;
  EXPECT_LT(error(pipeline.trajectory(), 0.0, poses), 0.01);
  EXPECT_GT(poses, 100U);
}

/// The frames between the two views that begin the map, those before them, and those that were tracked while the map
/// was young: all have poses, as good as later ones, that follow the true motion from frame to frame.
TEST_F(MonoTest, FramesOfTheStartAgreeWithTheirNeighbours) {
  TrackingSettings tracking;
  tracking.backward_frames = 100;  // all until the map has settled
  Pipeline pipeline = make(simulator_.camera(), tracking, false);
  std::uint64_t index = 0;
  while (index < 80 && feed(pipeline, index++).status != TrackingStatus::initialised) {
  }
  const auto before_the_start = static_cast<std::size_t>(index - 1);
  ASSERT_GT(before_the_start, 5U) << "frames between the two views";
  for (int i = 0; i < 60; ++i) ASSERT_EQ(feed(pipeline, index++).status, TrackingStatus::tracked);
  pipeline.finish();
  const Trajectory trajectory = pipeline.trajectory();
  ASSERT_EQ(trajectory.size(), truth_.size()) << "every frame has a pose";
  EXPECT_EQ(pipeline.loss_record().tracked_backwards + 1, before_the_start) << "all but the first view";
  EXPECT_EQ(pipeline.loss_record().withdrawn, 0U);
  EvaluationOptions options;
  options.alignment = AlignmentKind::sim3;
  const Evaluation evaluation = evaluate(truth_, trajectory, options);
  ASSERT_EQ(evaluation.poses.size(), trajectory.size());
  for (std::size_t i = 0; i < trajectory.size(); ++i) {
    EXPECT_LT(evaluation.poses[i].error, 0.02) << i;
    if (i == 0) continue;
    const auto turn = [i](const Trajectory& poses) {
      return Eigen::Matrix3d((poses[i - 1].T_world_camera.inverse() * poses[i].T_world_camera).linear());
    };
    const Eigen::AngleAxisd difference(Eigen::Matrix3d(turn(trajectory).transpose() * turn(truth_)));
    EXPECT_LT(difference.angle() * 180.0 / M_PI, 0.5) << i;
  }
}

TEST_F(MonoTest, FramesBeforeTheStartAreLocatedInTheFinishedMap) {
  struct Case {
    std::size_t kept;
    bool is_interrupted;
  };
  for (const auto [kept, is_interrupted] : {Case{100, false}, Case{3, false}, Case{100, true}}) {
    SCOPED_TRACE(::testing::Message() << kept << is_interrupted);
    next_ = 0;
    truth_.clear();
    TrackingSettings tracking;
    tracking.backward_frames = 0;
    tracking.late_frames = static_cast<int>(kept);
    Pipeline pipeline = make(simulator_.camera(), tracking, false);
    std::uint64_t index = 0;
    while (index < 80 && feed(pipeline, index++).status != TrackingStatus::initialised) {
    }
    const auto without_pose = static_cast<std::size_t>(index - 2);  // all but the two views
    ASSERT_GT(without_pose, 5U);
    for (int i = 0; i < 60; ++i) ASSERT_EQ(feed(pipeline, index++).status, TrackingStatus::tracked);
    if (is_interrupted) pipeline.interrupt();
    pipeline.finish();
    const std::size_t located = is_interrupted ? 0 : std::min(kept, without_pose);
    EXPECT_EQ(pipeline.loss_record().located_late, located);
    EXPECT_EQ(pipeline.trajectory().size(), truth_.size() - without_pose + located);
    std::size_t poses = 0;
    EXPECT_LT(error(pipeline.trajectory(), 0.0, poses), 0.01);
  }
}

/// The share of frames that turned as no keyframe did between two states of the map.
double share_between_keyframes(const Trajectory (&frames)[2], const Trajectory (&keyframes)[2]) {
  const auto turns = [](const Trajectory(&states)[2]) {
    std::vector<Eigen::Quaterniond> result;
    for (const TimedPose& earlier : states[0]) {
      const auto later = std::find_if(states[1].begin(), states[1].end(),
                                      [&](const TimedPose& pose) { return pose.timestamp == earlier.timestamp; });
      if (later != states[1].end())
        result.emplace_back(later->T_world_camera.linear() * earlier.T_world_camera.linear().transpose());
    }
    return result;
  };
  const std::vector<Eigen::Quaterniond> of_keyframes = turns(keyframes), of_frames = turns(frames);
  const auto count = std::count_if(of_frames.begin(), of_frames.end(), [&](const Eigen::Quaterniond& turn) {
    return std::none_of(of_keyframes.begin(), of_keyframes.end(),
                        [&](const Eigen::Quaterniond& other) { return turn.angularDistance(other) < 1e-7; });
  });
  return static_cast<double>(count) / static_cast<double>(of_frames.size());
}

/// Each round fuses points and adjusts, and frames follow the keyframes before and after them. An interrupted run has
/// none.
TEST_F(MonoTest, FinalRoundsSearchThePointsOfTheWholeMapAgain) {
  struct Case {
    int rounds;
    bool is_interrupted;
  };
  std::vector<std::uint64_t> fused;
  for (const auto [rounds, is_interrupted] : {Case{0, false}, Case{2, false}, Case{2, true}}) {
    SCOPED_TRACE(::testing::Message() << rounds << is_interrupted);
    next_ = 0;
    truth_.clear();
    TrackingSettings tracking;
    tracking.smooth_trajectory = false;  // it moves frames as well
    Pipeline pipeline = make(simulator_.camera(), tracking, false, {.final_rounds = rounds});
    for (std::uint64_t index = 0; index < 120; ++index) feed(pipeline, index);
    if (is_interrupted) pipeline.interrupt();
    const Trajectory frames = pipeline.trajectory(), keyframes = pipeline.keyframe_trajectory();
    pipeline.finish();
    const double between =
        share_between_keyframes({frames, pipeline.trajectory()}, {keyframes, pipeline.keyframe_trajectory()});
    const bool has_rounds = rounds > 0 && !is_interrupted;
    EXPECT_TRUE(has_rounds ? between > 0.5 : between < 0.1) << between;
    const LoopRecord record = pipeline.loop_record();
    EXPECT_TRUE(record.loops.empty());
    EXPECT_EQ(record.adjustments.size(), has_rounds ? 3U : 0U);
    for (const FullAdjustmentSummary& adjustment : record.adjustments) EXPECT_TRUE(adjustment.applied);
    std::size_t poses = 0;
    EXPECT_LT(error(pipeline.trajectory(), 0.0, poses), 0.01);
    fused.push_back(pipeline.mapping_counts().points_fused);
  }
  EXPECT_GT(fused[1], fused[0]);
  EXPECT_EQ(fused[2], fused[0]);
}

/// A frame of the young map shows the room from a place that the camera cannot have reached: it is found there, and its
/// pose is withdrawn when the neighbours have been tracked backwards.
TEST_F(MonoTest, APoseOfTheStartThatContradictsItsNeighboursIsWithdrawn) {
  Pipeline pipeline = make(simulator_.camera(), {}, false);
  std::uint64_t index = 0;
  while (index < 80 && feed(pipeline, index++).status != TrackingStatus::initialised) {
  }
  for (int i = 0; i < 6; ++i) ASSERT_EQ(feed(pipeline, index++).status, TrackingStatus::tracked);
  const FrameResult jump = feed(pipeline, index++ + 20);
  ASSERT_EQ(jump.status, TrackingStatus::tracked);
  const double time_of_jump = truth_.back().timestamp;
  for (int i = 0; i < 40; ++i) feed(pipeline, index++);
  pipeline.finish();
  EXPECT_EQ(pipeline.loss_record().withdrawn, 1U);
  for (const TimedPose& pose : pipeline.trajectory()) EXPECT_NE(pose.timestamp, time_of_jump);
}

TEST_F(MonoTest, GreyImagesServeAsColourOnesDo) {
  // A segmenter gets three channels; without it, grey is all that is read.
  class ColourOnly final : public Segmenter {
   public:
    const std::vector<std::string>& classes() const override { return classes_; }
    Segmentation segment(const SensorFrame& frame) override {
      EXPECT_EQ(frame.colour.type(), CV_8UC3);
      Segmentation segmentation;
      segmentation.labels = cv::Mat::zeros(frame.colour.size(), CV_8UC1);
      return segmentation;
    }

   private:
    std::vector<std::string> classes_{"background", "person"};
  };
  std::vector<SensorFrame> frames;
  for (std::uint64_t index = 0; index < 120; ++index) frames.push_back(simulator_.frame(index));
  for (const bool segments : {false, true}) {
    std::vector<Trajectory> trajectories;
    for (const bool is_grey : {false, true}) {
      PipelineBuilder builder;
      builder.camera(simulator_.camera())
          .sensor(Sensor::mono)
          .features(OrbSettings{.count = 1000})
          .optimizer(SchurSettings{});
      if (segments) builder.segmenter(std::make_unique<ColourOnly>());
      Pipeline pipeline = builder.build();
      for (SensorFrame frame : frames) {
        cv::Mat grey;
        cv::cvtColor(frame.colour, grey, cv::COLOR_BGR2GRAY);
        if (is_grey)
          frame.colour = grey;
        else
          cv::cvtColor(grey, frame.colour, cv::COLOR_GRAY2BGR);
        pipeline.feed(frame);
      }
      pipeline.finish();
      trajectories.push_back(pipeline.trajectory());
    }
    ASSERT_GT(trajectories[0].size(), 10U);
    ASSERT_EQ(trajectories[0].size(), trajectories[1].size());
    for (std::size_t i = 0; i < trajectories[0].size(); ++i)
      EXPECT_EQ(trajectories[0][i].T_world_camera.matrix(), trajectories[1][i].T_world_camera.matrix());
  }
}

}  // namespace
}  // namespace holdfast
