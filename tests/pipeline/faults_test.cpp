// SPDX-License-Identifier: BSD-3-Clause
// A sensor that fails for a while: no pose that contradicts what the sensor showed, and a map as good as without.
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "holdfast/pipeline/pipeline_builder.hpp"
#include "holdfast/settings/ceres.hpp"
#include "holdfast/settings/orb.hpp"
#include "holdfast/simulation/scene_file.hpp"
#include "holdfast/simulation/simulator.hpp"
#include "support/faulty_source.hpp"

namespace holdfast {
namespace {

using test::Fault;

/// Three seconds of the empty office, rendered once.
class Office {
 public:
  static constexpr std::uint64_t count = 84;

  Office()
      : simulator_(simulation::read_scene({}, {"camera.path=xyz"}),
                   Camera{.width = 320, .height = 240, .fx = 270, .fy = 270, .cx = 159.5, .cy = 119.5}) {
    for (std::uint64_t i = 0; i < count; ++i) frames_.push_back(simulator_.frame(i));
  }
  const std::vector<SensorFrame>& frames() const { return frames_; }
  const Camera& camera() const { return simulator_.camera(); }

 private:
  simulation::Simulator simulator_;
  std::vector<SensorFrame> frames_;
};

/// Gives the frames of a list.
class Replay final : public FrameSource {
 public:
  explicit Replay(const std::vector<SensorFrame>& frames) : frames_(frames) {}
  SourceDescription describe() const override { return {.name = "replay", .has_depth = true}; }
  std::optional<SensorFrame> next() override {
    if (next_ == frames_.size()) return std::nullopt;
    return frames_[next_++];
  }

 private:
  const std::vector<SensorFrame>& frames_;
  std::size_t next_ = 0;
};

struct Measured {
  double worst_pose = 0.0;        ///< of all frames, against the pose that their images show [m]
  double error_afterwards = 0.0;  ///< RMSE of the corrected poses after the last fault [m]
  std::size_t lost_during = 0, lost_afterwards = 0;
  double good_points = 0.0;  ///< share of the map points in view at the end that lie on what the sensor sees
};

class FaultsTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { office_ = new Office; }
  static void TearDownTestSuite() {
    delete office_;
    office_ = nullptr;
  }

  static Measured measure(std::unique_ptr<FrameSource> source, std::uint64_t after, bool threaded) {
    RunSettings run;
    run.mode = threaded ? RunMode::threaded : RunMode::sequential;
    Pipeline pipeline = PipelineBuilder()
                            .camera(office_->camera())
                            .features(OrbSettings{.count = 600})
                            .optimizer(CeresSettings{})
                            .run(run)
                            .build();
    const Eigen::Isometry3d T_first_world = office_->frames().front().truth->T_world_camera->inverse();
    Measured measured;
    std::map<double, Eigen::Isometry3d> truth;
    while (const std::optional<SensorFrame> frame = source->next()) {
      const FrameResult result = pipeline.feed(*frame);
      const Eigen::Isometry3d true_pose = T_first_world * *frame->truth->T_world_camera;
      if (frame->index >= after) truth.emplace(frame->timestamp, true_pose);
      if (result.T_world_camera)
        measured.worst_pose =
            std::max(measured.worst_pose, (result.T_world_camera->translation() - true_pose.translation()).norm());
      else if (frame->index < after)
        ++measured.lost_during;
      else if (frame->index >= after + 5)
        ++measured.lost_afterwards;
    }
    pipeline.finish();
    std::size_t poses = 0;
    for (const TimedPose& pose : pipeline.trajectory()) {
      const auto found = truth.find(pose.timestamp);
      if (found == truth.end()) continue;
      measured.error_afterwards += (pose.T_world_camera.translation() - found->second.translation()).squaredNorm();
      ++poses;
    }
    EXPECT_GT(poses, 10U);
    measured.error_afterwards = std::sqrt(measured.error_afterwards / static_cast<double>(poses));
    measured.good_points = good_points(pipeline.map(), T_first_world);
    return measured;
  }

  static double good_points(const Map& map, const Eigen::Isometry3d& T_first_world) {
    const SensorFrame& last = office_->frames().back();
    const Eigen::Isometry3d T_camera_first = (T_first_world * *last.truth->T_world_camera).inverse();
    int in_view = 0, good = 0;
    map.points().for_each([&](MapPointId, const MapPoint& point) {
      const Eigen::Vector3d p = T_camera_first * point.position;
      if (p.z() < 0.1) return;
      const Eigen::Vector2d pixel = office_->camera().project(p);
      const int column = static_cast<int>(std::lround(pixel.x())), row = static_cast<int>(std::lround(pixel.y()));
      if (column < 0 || row < 0 || column >= last.depth.cols || row >= last.depth.rows) return;
      const double depth = last.depth.at<float>(row, column);
      if (depth == 0.0) return;
      ++in_view;
      good += std::abs(depth - p.z()) < 0.05 + 0.02 * depth ? 1 : 0;
    });
    EXPECT_GT(in_view, 50);
    return static_cast<double>(good) / in_view;
  }

  static void expect_recovery(bool threaded) {
    const Measured clean = measure(std::make_unique<Replay>(office_->frames()), 50, threaded);
    for (const Fault fault : test::all_faults)
      for (const std::uint64_t seed : {1, 2}) {
        SCOPED_TRACE(std::string(to_string(fault)) + ", seed " + std::to_string(seed));
        auto source = std::make_unique<test::FaultySource>(std::make_unique<Replay>(office_->frames()), fault, seed);
        const std::uint64_t after = source->end();
        ASSERT_LT(after + 15, Office::count);
        const Measured measured = measure(std::move(source), after, threaded);
        // What one thread finds depends on nothing but the frames; threads differ from run to run.
        EXPECT_LT(measured.worst_pose, threaded ? 0.04 : 0.03);
        const bool is_blind = fault == Fault::black || fault == Fault::white || fault == Fault::noise;
        EXPECT_EQ(measured.lost_during > 0, is_blind) << measured.lost_during;
        EXPECT_EQ(measured.lost_afterwards, 0U);
        EXPECT_LT(measured.error_afterwards, clean.error_afterwards + (threaded ? 0.02 : 0.01));
        EXPECT_GT(measured.good_points, clean.good_points - (threaded ? 0.10 : 0.05));
      }
  }

  static const Office* office_;
};
const Office* FaultsTest::office_ = nullptr;

TEST_F(FaultsTest, TheMapRecoversSequential) { expect_recovery(false); }
TEST_F(FaultsTest, TheMapRecoversThreaded) { expect_recovery(true); }

}  // namespace
}  // namespace holdfast
