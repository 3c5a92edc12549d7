// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/surface/surface_field.hpp"

#include <gtest/gtest.h>

#include <map>

#include "holdfast/core/coarse_view.hpp"
#include "holdfast/core/frame.hpp"
#include "holdfast/surface/carving_views.hpp"
#include "holdfast/surface/fused_frames.hpp"
#include "holdfast/surface/mesh_files.hpp"
#include "surface/solid_world.hpp"

namespace holdfast {
namespace {

using test::SolidWorld;

SurfaceSettings settings_of_test() {
  SurfaceSettings settings;
  settings.smallest_part = 0.0;
  return settings;
}

class SurfaceFieldTest : public testing::Test {
 protected:
  void SetUp() override {
    if (!SurfaceField::is_available()) GTEST_SKIP() << "built without OpenVDB";
  }

  static std::vector<KeptView> views_of(const SolidWorld& world, const std::vector<Eigen::Isometry3d>& poses) {
    std::vector<KeptView> views;
    for (const Eigen::Isometry3d& pose : poses) views.push_back(world.view(pose, views.size()));
    return views;
  }
  static std::vector<Eigen::Isometry3d> side_by_side(int count, double step) {
    std::vector<Eigen::Isometry3d> poses(static_cast<std::size_t>(count), Eigen::Isometry3d::Identity());
    for (int i = 0; i < count; ++i) poses[static_cast<std::size_t>(i)].translation().x() = i * step;
    return poses;
  }
  static SurfaceMap map_of(const SolidWorld& world, const std::vector<Eigen::Isometry3d>& poses) {
    SurfaceMap map(world.camera, settings_of_test());
    map.update(views_of(world, poses), poses, 0);
    return map;
  }
  static double area_in_front_of(const TriangleMesh& mesh, double z) {
    double area = 0.0;
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
      if (mesh.corner(i, 0).z() < z) area += mesh.area_vector(i).norm();
    return area;
  }
};

TEST_F(SurfaceFieldTest, FusesABallToItsRadiusNormalAreaAndColour) {
  const SolidWorld world;
  const TriangleMesh mesh = map_of(world, test::poses_around(world.centre, 1.2)).field().mesh();
  ASSERT_GT(mesh.triangles.size(), 1000U);
  double error = 0.0, worst = 0.0, worst_normal = 1.0;
  for (const MeshVertex& vertex : mesh.vertices) {
    const Eigen::Vector3d offset = vertex.position.cast<double>() - world.centre;
    error += std::abs(offset.norm() - SolidWorld::radius);
    worst = std::max(worst, std::abs(offset.norm() - SolidWorld::radius));
    worst_normal = std::min(worst_normal, offset.normalized().dot(vertex.normal.cast<double>()));
    EXPECT_EQ(vertex.red, 200);
    EXPECT_EQ(vertex.green, 100);
    EXPECT_EQ(vertex.blue, 10);
  }
  EXPECT_LT(worst, 0.015);
  EXPECT_LT(error / static_cast<double>(mesh.vertices.size()), 0.003);
  EXPECT_GT(worst_normal, 0.85);
  EXPECT_NEAR(mesh.area(), 4.0 * M_PI * SolidWorld::radius * SolidWorld::radius, 0.05);
}

TEST_F(SurfaceFieldTest, ClosesTheMeshOfABall) {
  const SolidWorld world;
  const TriangleMesh mesh = map_of(world, test::poses_around(world.centre, 1.2)).field().mesh();
  // Closed and oriented: each edge is once in each direction in two triangles. Euler: V - E + F = 2.
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  for (const auto& triangle : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) ++edges[{triangle[k], triangle[(k + 1) % 3]}];
  int open = 0, repeated = 0;
  for (const auto& [edge, count] : edges) {
    repeated += count == 1 ? 0 : 1;
    open += edges.count({edge.second, edge.first}) == 1U ? 0 : 1;
  }
  EXPECT_EQ(open, 0);
  EXPECT_EQ(repeated, 0);
  EXPECT_EQ(mesh.vertices.size() + mesh.triangles.size(), edges.size() / 2 + 2);
}

TEST_F(SurfaceFieldTest, GivesTheSameBytesTwice) {
  const SolidWorld world;
  const auto poses = test::poses_around(world.centre, 1.2);
  EXPECT_EQ(mesh_ply(map_of(world, poses).field().mesh()), mesh_ply(map_of(world, poses).field().mesh()));
}

TEST_F(SurfaceFieldTest, LeavesOutDynamicPixels) {
  SolidWorld world;
  world.has_wall = true;
  const auto poses = side_by_side(4, 0.02);
  std::vector<KeptView> views = views_of(world, poses);
  for (KeptView& view : views)
    for (int y = 0; y < view.depth.rows; ++y)
      for (int x = 0; x < view.depth.cols; ++x)
        if (view.depth_at(x, y) < 2.0) view.depth.at<std::uint16_t>(y, x) |= KeptView::moves_bit;
  SurfaceMap map(world.camera, settings_of_test());
  map.update(views, poses, 0);
  const TriangleMesh mesh = map.field().mesh();
  EXPECT_GT(mesh.area(), 3.0);
  EXPECT_EQ(area_in_front_of(mesh, 2.3), 0.0);
}

TEST_F(SurfaceFieldTest, LeavesOutWhatTwiceAsManyViewsCallDynamic) {
  SolidWorld world;
  world.has_ball = false;
  world.has_wall = world.has_box = true;
  const auto central_area = [&](int dynamic) {  // of the box, whose mask two views have missed
    const auto poses = side_by_side(2 + dynamic, 0.02);
    std::vector<KeptView> views = views_of(world, poses);
    for (std::size_t i = 2; i < views.size(); ++i)
      for (int y = 0; y < world.camera.height; ++y)
        for (int x = 0; x < world.camera.width; ++x)
          if (views[i].depth_at(x, y) < 2.3) views[i].depth.at<std::uint16_t>(y, x) |= KeptView::moves_bit;
    SurfaceMap map(world.camera, settings_of_test());
    map.update(views, poses, 0);
    const auto area = [](TriangleMesh mesh) {
      remove_triangles(mesh, [&](const auto& triangle) {
        const Eigen::Vector3f& corner = mesh.vertices[triangle[0]].position;
        return corner.z() > 1.9F || corner.head<2>().cwiseAbs().maxCoeff() > 0.15F;
      });
      return mesh.area();
    };
    const double with_votes = area(map.field().mesh());
    map.update({views[0], views[1]}, {poses[0], poses[1]}, 0);
    EXPECT_GT(area(map.field().mesh()), 0.08) << "votes of views that are taken out";
    return with_votes;
  };
  EXPECT_GT(central_area(3), 0.08);
  EXPECT_EQ(central_area(4), 0.0);
}

TEST_F(SurfaceFieldTest, RemovesWhatLeavesAndKeepsWhatArrives) {
  SolidWorld with, without;
  with.has_ball = without.has_ball = false;
  with.has_wall = without.has_wall = with.has_box = true;
  const auto poses = side_by_side(24, 0.01);
  const auto fused = [&](int first, int last) {  // the box is there from one view to another one
    std::vector<KeptView> views;
    for (int i = 0; i < 24; ++i) {
      const auto at = static_cast<std::size_t>(i);
      views.push_back((i >= first && i < last ? with : without).view(poses[at], at));
    }
    SurfaceMap map(with.camera, settings_of_test());
    map.update(views, poses, 0);
    return map.field().mesh();
  };
  const double front = 0.36, empty_wall = fused(0, 0).area();
  // Twenty views of it, and four without.
  const TriangleMesh left = fused(0, 20);
  EXPECT_EQ(area_in_front_of(left, 2.3), 0.0);
  EXPECT_NEAR(left.area(), empty_wall, 0.02 * empty_wall);
  EXPECT_NEAR(area_in_front_of(fused(20, 24), 1.65), front, 0.05);
  EXPECT_NEAR(area_in_front_of(fused(0, 24), 1.65), front, 0.05);
  // One view that sees through it proves nothing.
  EXPECT_NEAR(area_in_front_of(fused(0, 23), 1.65), front, 0.05);
}

/// A view whose pixels have one label.
KeptView with_label(KeptView view, std::uint8_t label) {
  view.labels.create(view.depth.size(), CV_8UC1);
  view.labels.setTo(label);
  return view;
}

TEST_F(SurfaceFieldTest, VerticesHaveTheClassOfMostVotes) {
  SolidWorld world;
  world.has_ball = false, world.has_wall = true;
  const auto poses = side_by_side(8, 0.01);
  const std::vector<KeptView> views = views_of(world, poses);
  const auto labels_of = [&](const std::vector<std::uint8_t>& votes, std::size_t kept) {
    std::vector<KeptView> labelled;
    for (std::size_t i = 0; i < votes.size(); ++i) labelled.push_back(with_label(views[i], votes[i]));
    SurfaceMap map(world.camera, settings_of_test());
    const auto end = static_cast<std::ptrdiff_t>(votes.size());
    map.update(labelled, {poses.begin(), poses.begin() + end}, 0);
    labelled.resize(kept);  // the others are taken out
    map.update(labelled, {poses.begin(), poses.begin() + static_cast<std::ptrdiff_t>(kept)}, 0);
    std::map<int, std::size_t> counts;
    for (const MeshVertex& vertex : map.field().mesh().vertices) ++counts[vertex.label];
    for (const SurfacePatch& patch : map.field().changes(0, 0))
      for (const MeshVertex& vertex : patch.vertices) EXPECT_EQ(counts.count(vertex.label), 1U) << int{vertex.label};
    // The label that nearly all have; at the rim not all views see the wall.
    for (const auto& [label, count] : counts)
      if (10 * count > 9 * map.field().mesh().vertices.size()) return label;
    return -1;
  };
  EXPECT_EQ(labels_of({3, 3, 3}, 3), 3);
  EXPECT_EQ(labels_of({3, 3, 0, 3, 0}, 5), 3);
  EXPECT_EQ(labels_of({255, 255, 7, 255}, 4), 7) << "an unknown class has no vote";
  EXPECT_EQ(labels_of({255, 255, 255}, 3), 255);
  EXPECT_EQ(labels_of({5, 2, 5, 2}, 4), 2) << "of several the smallest one";
  EXPECT_EQ(labels_of({2, 2, 2, 5, 5, 5, 5}, 7), 5);
  EXPECT_EQ(labels_of({2, 2, 2, 5, 5, 5, 5}, 5), 2) << "votes are taken out with their view";
}

TEST_F(SurfaceFieldTest, ClassesChangeNothingElse) {
  const SolidWorld world;
  const auto poses = test::poses_around(world.centre, 1.2);
  std::vector<KeptView> views = views_of(world, poses);
  for (KeptView& view : views) view = with_label(view, 1);
  SurfaceMap with(world.camera, settings_of_test()), without = map_of(world, poses);
  with.update(views, poses, 0);
  TriangleMesh mesh = with.field().mesh();
  EXPECT_EQ(mesh_ply(mesh), mesh_ply(without.field().mesh()));
  EXPECT_GT(with.memory_bytes(), without.memory_bytes());
  mesh.classes = {"background", "ball"};
  const std::string ply = mesh_ply(mesh);
  EXPECT_NE(ply.find("comment label 1 ball\n"), std::string::npos);
  EXPECT_NE(ply.find("property uchar blue\nproperty uchar label\n"), std::string::npos);
}

/// Coarse views of frames between keyframes.
class CarvingTest : public SurfaceFieldTest {
 protected:
  static Frame frame_of(const SolidWorld& world, const Eigen::Isometry3d& pose, std::uint64_t index) {
    const CoarseSampler sampler(world.camera);
    const KeptView view = world.view(pose, index);
    cv::Mat depth;
    view.depth.convertTo(depth, CV_32F, KeptView::depth_unit);
    Frame frame;
    frame.index = view.frame_index;
    frame.timestamp = view.timestamp;
    frame.camera = std::make_shared<Camera>(world.camera);
    frame.coarse.grid = sampler.grid();
    sampler.sample_depth(depth, frame.coarse);
    frame.T_camera_world = pose.inverse();
    return frame;
  }
  /// Frames of a world from poses; `first` is the index of the first one.
  static void add_frames(const SolidWorld& world, const std::vector<Eigen::Isometry3d>& poses, std::uint64_t first,
                         CarvingViews& carving) {
    for (std::size_t i = 0; i < poses.size(); ++i)
      carving.add(frame_of(world, poses[i], first + i), {}, Eigen::Isometry3d::Identity());
  }
  /// A box before a wall in eight keyframes, then without the box in as many frames as there are poses.
  static TriangleMesh mesh_after_box(const std::vector<Eigen::Isometry3d>& later) {
    SolidWorld with, without;
    with.has_ball = without.has_ball = false;
    with.has_wall = without.has_wall = with.has_box = true;
    const auto poses = side_by_side(8, 0.05);
    std::vector<KeptView> views = views_of(with, poses);
    CarvingViews carving(0.1, 100);
    add_frames(without, later, poses.size(), carving);
    views.insert(views.end(), carving.views().begin(), carving.views().end());
    std::vector<Eigen::Isometry3d> all = poses;
    for (const KeptView& view : carving.views()) all.push_back(view.T_view_keyframe.inverse());
    SurfaceMap map(with.camera, settings_of_test());
    map.update(views, all, 0);
    EXPECT_EQ(map.fused_view_count(), 8U);
    const TriangleMesh mesh = map.field().mesh();
    // Taken out, they leave no trace.
    map.update(views_of(with, poses), poses, 0);
    EXPECT_EQ(map.view_count(), 8U);
    return mesh;
  }
};

TEST_F(CarvingTest, CarvesByTheCoarseDepthOfFrames) {
  const double front = 0.36;
  EXPECT_GT(area_in_front_of(mesh_after_box(side_by_side(2, 0.05)), 2.3), front);  // two frames prove nothing
  EXPECT_LT(area_in_front_of(mesh_after_box(side_by_side(6, 0.05)), 2.3), 0.02);
}

TEST_F(CarvingTest, RemovesTheRemnantsOfWhatIsCarved) {
  // The last frames do not see the top of the box, a sixth of its front.
  std::vector<Eigen::Isometry3d> lower = side_by_side(6, 0.05);
  for (Eigen::Isometry3d& pose : lower) pose.linear() = Eigen::AngleAxisd(-0.31, Eigen::Vector3d::UnitX()).matrix();
  EXPECT_EQ(area_in_front_of(mesh_after_box(lower), 2.3), 0.0);
}

TEST_F(CarvingTest, FramesAreFusedWhereFewViewsObservedTheSurface) {
  SolidWorld world;
  world.has_ball = false;
  world.has_wall = true;
  const auto poses = side_by_side(8, 0.0);
  const std::vector<KeptView> views = views_of(world, poses);
  SurfaceMap map(world.camera, settings_of_test());
  Frame frame = frame_of(world, poses[0], 8);
  const std::vector<bool> left_out = {false, true};
  map.update({views.begin(), views.end() - 1}, {poses.begin(), poses.end() - 1}, 0);
  EXPECT_TRUE(FusedFrames::is_worthwhile(frame, map.field(), left_out)) << "seven views";
  map.update(views, poses, 0);
  EXPECT_FALSE(FusedFrames::is_worthwhile(frame, map.field(), left_out)) << "eight views";
  frame.T_camera_world.translation().x() += 0.2;  // a twelfth of the image is new
  EXPECT_TRUE(FusedFrames::is_worthwhile(frame, map.field(), left_out));
  frame.coarse.mask.labels.assign(frame.coarse.depth.size(), 1);
  EXPECT_FALSE(FusedFrames::is_worthwhile(frame, map.field(), left_out)) << "all is a person";
  frame.coarse.mask.labels.clear();
  frame.coarse.static_log_odds.assign(frame.coarse.depth.size(), -1.0F);
  EXPECT_FALSE(FusedFrames::is_worthwhile(frame, map.field(), left_out)) << "all moves";
}

TEST_F(CarvingTest, FramesAreFusedAtTheirShareOfKeyframes) {
  const SolidWorld world;
  const ViewSampler sampler(world.camera, {.step = 1});
  FusedFrames frames(sampler, 0.1, 0.5, 100);
  frames.keyframe_kept(1.0);
  EXPECT_FALSE(frames.is_due(2.0)) << "one keyframe";
  frames.keyframe_kept(3.0);
  EXPECT_FALSE(frames.is_due(3.05));
  EXPECT_TRUE(frames.is_due(3.15));
  frames.leave_out(3.15);
  EXPECT_FALSE(frames.is_due(3.2));
  EXPECT_TRUE(frames.is_due(3.3));
  SensorFrame sensor_frame;
  sensor_frame.colour = cv::Mat(world.camera.height, world.camera.width, CV_8UC3, cv::Scalar::all(0));
  frames.add(sensor_frame, frame_of(world, Eigen::Isometry3d::Identity(), 33), {}, Eigen::Isometry3d::Identity(), {});
  EXPECT_FALSE(frames.is_due(9.0)) << "two keyframes allow one frame";
  EXPECT_EQ(frames.views().size(), 1U);
}

TEST_F(CarvingTest, KeepsViewsApartInTimeAndFewEnough) {
  CarvingViews carving(0.2, 5);
  EXPECT_TRUE(carving.is_due(0.0));
  carving.keyframe_kept(1.0);
  EXPECT_FALSE(carving.is_due(1.1));
  EXPECT_TRUE(carving.is_due(1.25));
  add_frames(SolidWorld(), side_by_side(20, 0.01), 0, carving);
  ASSERT_EQ(carving.views().size(), 5U);
  EXPECT_EQ(carving.views().front().frame_index, 0U);
  EXPECT_EQ(carving.views().back().frame_index, 19U);
  EXPECT_EQ(carving.views().back().depth.cols, 20);
}

TEST_F(SurfaceFieldTest, ForgetsAViewThatIsTakenOut) {
  SolidWorld world;
  world.has_wall = true;
  const auto poses = side_by_side(4, 0.02);
  const std::vector<KeptView> views = views_of(world, poses);
  SurfaceMap map(world.camera, settings_of_test());
  map.update(views, poses, 0);
  EXPECT_GT(map.field().block_count(), 100U);
  map.update({}, {}, 0);
  EXPECT_EQ(map.field().block_count(), 0U);
  EXPECT_TRUE(map.field().mesh().empty());
}

TEST_F(SurfaceFieldTest, MovesViewsToTheirAdjustedPoses) {
  SolidWorld world;
  world.has_wall = true;
  const auto poses = side_by_side(6, 0.03);
  const std::vector<KeptView> views = views_of(world, poses);
  std::vector<Eigen::Isometry3d> drifted = poses;
  for (std::size_t i = 3; i < drifted.size(); ++i) drifted[i].translation() += Eigen::Vector3d(0.0, 0.0, -0.25);

  SurfaceMap moved(world.camera, settings_of_test());
  moved.update(views, drifted, 0);
  const double two_walls = moved.field().mesh().area();
  EXPECT_EQ(moved.update(views, poses, 2), 1U);  // one of three waits
  EXPECT_EQ(moved.update(views, poses, 2), 0U);
  EXPECT_EQ(moved.move_count(), 3U);

  const TriangleMesh expected = map_of(world, poses).field().mesh(), found = moved.field().mesh();
  EXPECT_GT(two_walls, 1.5 * expected.area());
  EXPECT_NEAR(found.area(), expected.area(), 1e-3 * expected.area());
  ASSERT_EQ(area_in_front_of(found, 1.0), 0.0);
  double worst = 0.0;
  for (const MeshVertex& vertex : found.vertices) {
    const Eigen::Vector3d p = vertex.position.cast<double>();
    worst = std::max(worst, std::min(std::abs(p.z() - SolidWorld::wall_z),
                                     std::abs((p - world.centre).norm() - SolidWorld::radius)));
  }
  double worst_expected = 0.0;
  for (const MeshVertex& vertex : expected.vertices) {
    const Eigen::Vector3d p = vertex.position.cast<double>();
    worst_expected = std::max(worst_expected, std::min(std::abs(p.z() - SolidWorld::wall_z),
                                                       std::abs((p - world.centre).norm() - SolidWorld::radius)));
  }
  EXPECT_NEAR(worst, worst_expected, 1e-3);
}

TEST_F(SurfaceFieldTest, LeavesOutSmallParts) {
  SolidWorld world;
  const auto poses = test::poses_around(world.centre, 1.2);
  SurfaceSettings settings;
  settings.smallest_part = 2.1;  // the ball has 2.01 m^2
  SurfaceMap map(world.camera, settings);
  map.update(views_of(world, poses), poses, 0);
  EXPECT_TRUE(map.field().mesh().empty());
}

}  // namespace
}  // namespace holdfast
