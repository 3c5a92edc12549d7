// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/surface/surface_views.hpp"

#include <gmock/gmock.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <opencv2/core.hpp>
#include <sstream>

#include "holdfast/core/error.hpp"
#include "holdfast/core/trajectory.hpp"
#include "holdfast/surface/mesh_files.hpp"
#include "holdfast/surface/observed_space.hpp"
#include "map_io/random_map.hpp"
#include "surface/solid_world.hpp"

namespace holdfast {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;

/// A ball before a wall, seen by the keyframes of a map, and by a frame that only carves.
class SurfaceViewsTest : public testing::Test {
 protected:
  SurfaceViewsTest() : folder_(fs::temp_directory_path() / ("surface_views_test." + std::to_string(getpid()))) {
    world_.has_wall = true;
    views_.camera = world_.camera;
    views_.settings.voxel = 0.05;
    views_.settings.minimum_views = 1;
    std::uint64_t number = 0;
    for (const KeyFrameId id : map_.keyframes_by_age()) {
      Frame& frame = map_.keyframe(id).frame;
      Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
      pose.translation().x() = 0.02 * static_cast<double>(number);
      frame.T_camera_world = pose.inverse();
      views_.views.push_back(world_.view(pose, number++));
      views_.views.back().keyframe = id;
      views_.views.back().timestamp = frame.timestamp;
    }
    KeptView carving = world_.view(Eigen::Isometry3d::Identity(), number);
    carving.keyframe = views_.views.front().keyframe;
    carving.colour.release();
    carving.coarse_camera = std::make_shared<const Camera>(world_.camera);
    carving.T_view_keyframe.translation().z() = 0.125;
    views_.views.push_back(carving);
    views_.views.front().depth.at<std::uint16_t>(5, 7) |= KeptView::moves_bit;
  }
  ~SurfaceViewsTest() override { fs::remove_all(folder_); }

  std::string list() const {
    std::ostringstream text;
    text << std::ifstream(folder_ / "views.json").rdbuf();
    return text.str();
  }
  std::string refusal_of(const Map& map) const {
    try {
      read_views(folder_, map);
      return {};
    } catch (const InputError& error) {
      return error.what();
    }
  }
  std::string refusal_with(const std::string& from, const std::string& to) const {
    const std::string before = list();
    std::string text = before;
    text.replace(text.find(from), from.size(), to);
    write_file_atomically(folder_ / "views.json", text);
    const std::string refusal = refusal_of(map_);
    write_file_atomically(folder_ / "views.json", before);
    return refusal;
  }

  fs::path folder_;
  test::SolidWorld world_;
  Map map_ = test::random_map(6, 30, 1);
  SurfaceViews views_;
};

TEST_F(SurfaceViewsTest, AreReadAsTheyWereWritten) {
  write_views(folder_, views_, map_);
  const SurfaceViews read = read_views(folder_, map_);
  EXPECT_EQ(read.settings.voxel, 0.05);
  EXPECT_EQ(read.settings.minimum_views, 1);
  EXPECT_EQ(read.camera.fx, world_.camera.fx);
  ASSERT_EQ(read.views.size(), views_.views.size());
  for (std::size_t i = 0; i < read.views.size(); ++i) {
    const KeptView &a = views_.views[i], &b = read.views[i];
    EXPECT_EQ(a.keyframe, b.keyframe);
    EXPECT_EQ(a.frame_index, b.frame_index);
    EXPECT_EQ(a.only_carves(), b.only_carves());
    EXPECT_EQ(a.T_view_keyframe.matrix(), b.T_view_keyframe.matrix());
    EXPECT_EQ(cv::norm(a.depth, b.depth, cv::NORM_INF), 0.0);
    if (!a.only_carves()) {
      EXPECT_EQ(cv::norm(a.colour, b.colour, cv::NORM_INF), 0.0);
    }
  }
}

TEST_F(SurfaceViewsTest, SayWhatTheyLookedThrough) {
  // Pixels of dynamic objects as well.
  for (KeptView& view : views_.views) view.depth |= cv::Scalar(KeptView::moves_bit);
  const ObservedSpace space(views_, map_);
  EXPECT_TRUE(space.is_free({0.0, 0.0, 0.8})) << "before the ball";
  EXPECT_TRUE(space.is_free({0.9, 0.0, 2.0})) << "beside it";
  EXPECT_FALSE(space.is_free({0.9, 0.0, 2.45})) << "nearer to the wall than the truncation";
  EXPECT_FALSE(space.is_free({0.0, 0.0, 2.2})) << "behind the ball";
  EXPECT_FALSE(space.is_free({0.0, 0.0, -0.5})) << "behind the camera";
  EXPECT_FALSE(space.is_free({4.0, 0.0, 2.0})) << "beside the image";
}

TEST_F(SurfaceViewsTest, KeepTheClassesOfTheirPixels) {
  write_views(folder_, views_, map_);
  EXPECT_FALSE(fs::exists(folder_ / "labels"));
  EXPECT_TRUE(read_views(folder_, map_).classes.empty());
  views_.classes = {"background", "ball"};
  views_.views[1].labels = cv::Mat(world_.camera.height, world_.camera.width, CV_8UC1, cv::Scalar(1));
  write_views(folder_, views_, map_);
  const SurfaceViews read = read_views(folder_, map_);
  EXPECT_EQ(read.classes, views_.classes);
  EXPECT_TRUE(read.views[0].labels.empty());
  ASSERT_FALSE(read.views[1].labels.empty());
  EXPECT_EQ(cv::norm(read.views[1].labels, views_.views[1].labels, cv::NORM_INF), 0.0);
  SurfaceViews others = read, more = read;
  others.classes = {"background", "cube"};
  EXPECT_THROW(more.append(others), Error);
  if (!SurfaceField::is_available()) return;
  const TriangleMesh mesh = fuse(read, map_);
  EXPECT_EQ(mesh.classes, views_.classes);
  EXPECT_TRUE(std::any_of(mesh.vertices.begin(), mesh.vertices.end(), [](const auto& v) { return v.label == 1; }));
}

TEST_F(SurfaceViewsTest, MakeTheMeshOfTheRunAtThePosesOfTheMap) {
  if (!SurfaceField::is_available()) GTEST_SKIP() << "built without OpenVDB";
  write_views(folder_, views_, map_);
  std::vector<Eigen::Isometry3d> poses;
  for (const KeptView& view : views_.views)
    poses.push_back((view.T_view_keyframe * map_.pose_of(view.keyframe)).inverse());
  SurfaceMap run(world_.camera, views_.settings);
  run.update(views_.views, poses, 0);
  std::size_t fused = 0;
  const TriangleMesh mesh = fuse(read_views(folder_, map_), map_, [&](std::size_t done) { fused = done; });
  EXPECT_GT(mesh.triangles.size(), 100U);
  EXPECT_EQ(mesh_ply(mesh), mesh_ply(run.field().mesh()));
  EXPECT_EQ(fused, views_.views.size());
  EXPECT_EQ(SurfaceViews::of(run).views.size(), views_.views.size());

  // A correction of the map moves the mesh.
  for (const KeyFrameId id : map_.keyframes_by_age()) map_.keyframe(id).frame.T_camera_world.translation().z() -= 1.0;
  Eigen::AlignedBox3f before, after;
  for (const MeshVertex& vertex : mesh.vertices) before.extend(vertex.position);
  for (const MeshVertex& vertex : fuse(read_views(folder_, map_), map_).vertices) after.extend(vertex.position);
  EXPECT_NEAR(after.max().z() - before.max().z(), 1.0, 1e-3);
}

TEST_F(SurfaceViewsTest, OfSeveralRunsOnOneMapMakeOneMesh) {
  if (!SurfaceField::is_available()) GTEST_SKIP() << "built without OpenVDB";
  // Both runs count their frames from 0.
  SurfaceViews first = views_, second = views_;
  first.views.assign(views_.views.begin(), views_.views.begin() + 3);
  second.views.assign(views_.views.begin() + 3, views_.views.end());
  for (std::size_t i = 0; i < second.views.size(); ++i) second.views[i].frame_index = i;
  second.left_out = 2;
  first.append(second);
  ASSERT_EQ(first.views.size(), views_.views.size());
  EXPECT_EQ(first.left_out, 2U);
  for (std::size_t i = 1; i < first.views.size(); ++i)
    EXPECT_LT(first.views[i - 1].frame_index, first.views[i].frame_index);
  EXPECT_EQ(mesh_ply(fuse(first, map_)), mesh_ply(fuse(views_, map_)));
  second.camera.fx += 1.0;
  EXPECT_THROW(first.append(second), Error);
}

TEST_F(SurfaceViewsTest, OfARemovedKeyframeFollowTheOneNearestInTime) {
  const KeyFrameId removed = views_.views[2].keyframe;
  const Eigen::Isometry3d pose = map_.pose_of(removed);
  map_.remove_keyframe(removed);
  write_views(folder_, views_, map_);
  const SurfaceViews read = read_views(folder_, map_);
  ASSERT_EQ(read.views.size(), views_.views.size());
  const KeptView& view = read.views[2];
  EXPECT_NE(view.keyframe, removed);
  EXPECT_NEAR(std::abs(map_.keyframe(view.keyframe).frame.timestamp - view.timestamp), 0.23, 1e-3);
  EXPECT_TRUE((view.T_view_keyframe * map_.pose_of(view.keyframe)).isApprox(pose, 1e-9));
  EXPECT_EQ(read.left_out, 0U);
  map_.remove_keyframe(view.keyframe);
  EXPECT_GE(read_views(folder_, map_).left_out, 2U);
}

TEST_F(SurfaceViewsTest, AreRefusedWithTheReason) {
  EXPECT_THAT(refusal_of(map_), AllOf(HasSubstr("views.json"), HasSubstr("surface.keep_depth=true")));
  write_views(folder_, views_, map_);
  EXPECT_THAT(refusal_of(test::random_map(6, 30, 2)), "") << "the same keyframes";
  EXPECT_THAT(refusal_of(Map()), HasSubstr("views.json: none of its keyframes is in the map"));
  EXPECT_THAT(refusal_with("\"version\": 1", "\"version\": 2"), HasSubstr("a version that this program does not know"));
  EXPECT_THAT(refusal_with("\"width\": 160", "\"width\": 0"), HasSubstr("without a valid size"));
  EXPECT_THAT(refusal_with("\"width\": 160", "\"width\": 161"), HasSubstr("expected"));
  EXPECT_THAT(refusal_with("\"voxel\": 0.05", "\"voxel\": 0"), HasSubstr("'voxel'"));
  EXPECT_THAT(refusal_with("\"frame\": 1", "\"frame\": 0"), HasSubstr("out of order"));
  EXPECT_THAT(refusal_with("[\n    1.0", "[\n    2.0"), HasSubstr("no rigid motion"));
  EXPECT_THAT(refusal_with("\"fx\": ", "\"fx\": 1e-300, \"unused\": "), HasSubstr("focal length"));
  EXPECT_THAT(refusal_with("]", ""), HasSubstr("is damaged"));
  EXPECT_EQ(refusal_of(map_), "");
  write_file_atomically(folder_ / "depth/000001.png", "no image");
  EXPECT_THAT(refusal_of(map_), HasSubstr("000001.png"));
}

}  // namespace
}  // namespace holdfast
