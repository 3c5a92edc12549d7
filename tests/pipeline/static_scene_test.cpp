// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <map>
#include <utility>

#include "holdfast/core/error.hpp"
#include "holdfast/dense_map/static_scene.hpp"
#include "holdfast/pipeline/pipeline.hpp"
#include "holdfast/surface/surface_map.hpp"
#include "support/point_pipeline.hpp"

namespace holdfast {
namespace {

/// Sees somebody in the right third of every image.
class RightThird final : public Segmenter {
 public:
  const std::vector<std::string>& classes() const override {
    static const std::vector<std::string> names{"background", "cat", "person"};
    return names;
  }
  Segmentation segment(const SensorFrame& frame) override {
    Segmentation segmentation;
    segmentation.labels = cv::Mat::zeros(frame.colour.size(), CV_8UC1);
    segmentation.labels.colRange(0, frame.colour.cols / 3) = 1;
    segmentation.labels.colRange(2 * frame.colour.cols / 3, frame.colour.cols) = 2;
    return segmentation;
  }
};

/// What an observer is told of the dense map.
struct Told {
  std::vector<std::string> classes;
  std::vector<KeyFrameId> keyframes;
  std::vector<std::size_t> points;
  double farthest_from_truth = 0.0;  // of the poses [m]
  bool has_person = false;
};

class ViewObserver final : public Observer {
 public:
  explicit ViewObserver(Told& told) : told_(told) {}
  void on_start(const std::vector<std::string>& classes) override {
    EXPECT_TRUE(told_.keyframes.empty());
    told_.classes = classes;
  }
  void on_static_view(const ObservedView& view) override {
    told_.keyframes.push_back(view.keyframe);
    const std::vector<CloudPoint> points = view.points(1000);
    told_.points.push_back(points.size());
    EXPECT_GE(view.points(4000).size(), points.size());
    const double error = (view.T_world_camera.translation() - test::path_pose(view.timestamp).translation()).norm();
    told_.farthest_from_truth = std::max(told_.farthest_from_truth, error);
    for (const CloudPoint& point : points) told_.has_person = told_.has_person || point.x > 0.4F * point.z;
  }

 private:
  Told& told_;
};

Pipeline fed_pipeline(bool enabled, bool segmented, bool threaded, Told* told = nullptr) {
  test::PointWorld world(find_camera("tum_fr3").value());
  PipelineParts parts = test::point_parts(world);
  parts.dense_map.enabled = enabled;
  if (threaded) parts.run.mode = RunMode::threaded;
  if (segmented) parts.segmenter = std::make_unique<RightThird>();
  if (told != nullptr) parts.observers.push_back(std::make_unique<ViewObserver>(*told));
  Pipeline pipeline(std::move(parts));
  for (int i = 0; i < 60; ++i)
    pipeline.feed(world.frame(static_cast<std::uint64_t>(i), i / 30.0, test::path_pose(i / 30.0)));
  pipeline.finish();
  return pipeline;
}

TEST(PipelineStaticScene, IsKeptOnlyWhenAskedFor) {
  EXPECT_EQ(fed_pipeline(false, false, false).static_scene(), nullptr);
}

TEST(PipelineStaticScene, HasEveryKeyframeWithItsOwnMask) {
  for (const bool segmented : {false, true})
    for (const bool threaded : {false, true}) {
      const Pipeline pipeline = fed_pipeline(true, segmented, threaded);
      const StaticScene* scene = pipeline.static_scene();
      ASSERT_NE(scene, nullptr);
      ASSERT_GE(scene->views().size(), 2U);
      EXPECT_EQ(scene->views().size(), pipeline.mapping_counts().keyframes_made);
      for (const KeptView& view : scene->views()) {
        EXPECT_EQ(view.moves(300, 100), segmented);  // the person
        EXPECT_FALSE(view.moves(10, 100));           // the cat is not among the classes to be left out
      }
      EXPECT_FALSE(scene->cloud(pipeline.map()).empty());
    }
}

TEST(PipelineStaticScene, IsToldToObservers) {
  for (const bool segmented : {false, true})
    for (const bool threaded : {false, true}) {
      Told told;
      const Pipeline pipeline = fed_pipeline(true, segmented, threaded, &told);
      EXPECT_EQ(told.classes.size(), segmented ? 3U : 0U);
      EXPECT_EQ(told.keyframes.size(), pipeline.static_scene()->views().size());
      for (const std::size_t points : told.points) {
        EXPECT_GT(points, 10U);  // the world has depth at its points alone
        EXPECT_LE(points, 1000U);
      }
      EXPECT_LT(told.farthest_from_truth, 0.02);
      EXPECT_EQ(told.has_person, !segmented) << "the right third of the image";
    }
  Told told;
  fed_pipeline(false, true, false, &told);
  EXPECT_TRUE(told.keyframes.empty());
  EXPECT_EQ(told.classes.size(), 3U);
}

/// Follows the surface by its changes.
class SurfaceObserver final : public Observer {
 public:
  using Vertices = std::map<std::array<int, 3>, std::size_t>;
  explicit SurfaceObserver(Vertices& vertices) : vertices_(vertices) {}
  void on_surface(const ObservedSurface& surface) override {
    for (const SurfacePatch& patch : surface.changes(std::exchange(seen_, surface.version), 0))
      vertices_[{patch.cube.x(), patch.cube.y(), patch.cube.z()}] = patch.vertices.size();
  }

 private:
  Vertices& vertices_;
  std::uint64_t seen_ = 0;
};

/// Frames with depth everywhere: that of the points, and a wall behind them, 8 m before the first pose.
SensorFrame with_wall(SensorFrame frame, const Camera& camera, const Eigen::Isometry3d& T_world_camera) {
  const double distance = 8.0 - T_world_camera.translation().z();
  for (int row = 0; row < frame.depth.rows; ++row)
    for (int column = 0; column < frame.depth.cols; ++column) {
      const Eigen::Vector3d ray = T_world_camera.linear() * camera.back_project(column, row, 1.0);
      auto& depth = frame.depth.at<float>(row, column);
      if (depth == 0.0F) depth = static_cast<float>(distance / ray.z());
    }
  return frame;
}

PipelineParts parts_with_surface(test::PointWorld& world) {
  PipelineParts parts = test::point_parts(world);
  parts.surface = {.enabled = true, .voxel = 0.2, .maximum_depth = 9.0, .moves_per_keyframe = 0, .cell = 0.5};
  parts.dense_map.step = 8;
  return parts;
}

TEST(PipelineSurface, HoldsFramesWithoutFeaturesIfAsked) {
  if (!SurfaceField::is_available()) GTEST_SKIP() << "built without OpenVDB";
  for (const bool poses : {false, true}) {
    test::PointWorld world(find_camera("tum_fr3").value());
    PipelineParts parts = parts_with_surface(world);
    parts.surface.poses = poses;
    parts.surface.minimum_views = 1;  // few keyframes are made in a second
    Pipeline pipeline(std::move(parts));
    int by_depth = 0;
    for (int i = 0; i < 40; ++i) {
      // When the light goes out, the camera turns back from the wall, which no velocity predicts.
      Eigen::Isometry3d truth = test::path_pose(std::min(i, 29) / 30.0);
      truth.translation().z() -= 0.02 * std::max(i - 29, 0);
      const SensorFrame frame = world.frame(static_cast<std::uint64_t>(i), i / 30.0, truth, i < 30);
      const FrameResult result = pipeline.feed(with_wall(frame, world.camera(), truth));
      if (i < 30 || result.fallback != TrackingFallback::dense_depth) continue;
      ++by_depth;
      EXPECT_NEAR(result.T_world_camera->translation().z(), truth.translation().z(), 0.01) << i;
    }
    EXPECT_EQ(by_depth, poses ? 10 : 0);
  }
}

TEST(PipelineSurface, FusesFramesBetweenKeyframesIfThereAreMasks) {
  if (!SurfaceField::is_available()) GTEST_SKIP() << "built without OpenVDB";
  for (const bool segmented : {false, true}) {
    test::PointWorld world(find_camera("tum_fr3").value());
    PipelineParts parts = parts_with_surface(world);
    if (segmented) parts.segmenter = std::make_unique<RightThird>();
    Pipeline pipeline(std::move(parts));
    for (int i = 0; i < 30; ++i) {
      const Eigen::Isometry3d pose = test::path_pose(i / 30.0);
      pipeline.feed(with_wall(world.frame(static_cast<std::uint64_t>(i), i / 30.0, pose), world.camera(), pose));
    }
    pipeline.finish();
    const std::size_t keyframes = pipeline.mapping_counts().keyframes_made;
    const std::size_t frames = pipeline.surface()->fused_view_count() - keyframes;
    EXPECT_LE(2 * frames, keyframes);
    EXPECT_EQ(frames > 0, segmented);
  }
}

TEST(PipelineSurface, HasEveryKeyframeAtItsFinalPose) {
  if (!SurfaceField::is_available()) GTEST_SKIP() << "built without OpenVDB";
  for (const bool threaded : {false, true}) {
    test::PointWorld world(find_camera("tum_fr3").value());
    PipelineParts parts = parts_with_surface(world);
    if (threaded) parts.run.mode = RunMode::threaded;
    SurfaceObserver::Vertices observed;
    parts.observers.push_back(std::make_unique<SurfaceObserver>(observed));
    Pipeline pipeline(std::move(parts));
    for (int i = 0; i < 40; ++i) {
      const Eigen::Isometry3d pose = test::path_pose(i / 30.0);
      pipeline.feed(with_wall(world.frame(static_cast<std::uint64_t>(i), i / 30.0, pose), world.camera(), pose));
    }
    const Eigen::Vector3d ahead(0.0, 0.0, 6.0);
    EXPECT_TRUE(threaded || pipeline.is_free(ahead)) << "while frames come";
    pipeline.finish();
    EXPECT_TRUE(pipeline.is_free(ahead));
    EXPECT_NEAR(pipeline.distance(ahead), 2.0, 0.6);
    EXPECT_FALSE(pipeline.is_free({0.0, 0.0, 9.0}));
    ASSERT_NE(pipeline.surface(), nullptr);
    EXPECT_EQ(pipeline.static_scene(), nullptr) << "a surface keeps views, and asks for no cloud";
    EXPECT_EQ(pipeline.surface()->fused_view_count(), pipeline.mapping_counts().keyframes_made);
    EXPECT_GE(pipeline.surface()->view_count(), pipeline.surface()->fused_view_count() + 2U) << "frames that carve";
    EXPECT_FALSE(pipeline.surface()->field().mesh().empty());
    std::erase_if(observed, [](const auto& entry) { return entry.second == 0; });
    SurfaceObserver::Vertices final_vertices;
    for (const SurfacePatch& patch : pipeline.surface()->field().changes(0, 0))
      final_vertices[{patch.cube.x(), patch.cube.y(), patch.cube.z()}] = patch.vertices.size();
    EXPECT_EQ(observed, final_vertices);
  }
}

TEST(PipelineSurface, IsMadeOnlyWhenAskedFor) {
  const Pipeline pipeline = fed_pipeline(true, false, false);
  EXPECT_EQ(pipeline.surface(), nullptr);
  EXPECT_EQ(pipeline.free_space(), nullptr);
  EXPECT_THROW(pipeline.is_free({0.0, 0.0, 1.0}), Error);
}

}  // namespace
}  // namespace holdfast
