// SPDX-License-Identifier: BSD-3-Clause
// The surface of a room in which a chair is moved during the run: both places of the chair are right at their time.
#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "cli/program.hpp"
#include "holdfast/core/trajectory.hpp"
#include "holdfast/surface/mesh_files.hpp"
#include "holdfast/surface/surface_field.hpp"
#include "holdfast/surface/triangle_tree.hpp"

namespace holdfast {
namespace {

using Box = Eigen::AlignedBox3d;

/// Where the chair is before and after, above the floor.
const Box place_before{Eigen::Vector3d(2.0, 3.15, 0.06), Eigen::Vector3d(2.8, 3.95, 1.25)};
const Box place_after{Eigen::Vector3d(2.75, 2.45, 0.06), Eigen::Vector3d(3.65, 3.3, 1.25)};

/// The part of a mesh in a box [m^2].
double area_in(const TriangleMesh& mesh, const Box& box) {
  double area = 0.0;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
    if (box.contains(mesh.corner(i, 0).cast<double>())) area += mesh.area_vector(i).norm();
  return area;
}

/// The share of the true surface in a box that is within 5 cm of the estimate.
double completeness(const TriangleMesh& truth, const TriangleMesh& estimate, const Box& box) {
  const TriangleTree tree(estimate);
  double area = 0.0, found = 0.0;
  for (std::size_t i = 0; i < truth.triangles.size(); ++i) {
    const Eigen::Vector3d corner = truth.corner(i, 0).cast<double>();
    if (!box.contains(corner)) continue;
    const double one = truth.area_vector(i).norm();
    area += one;
    if (tree.nearest(corner, 0.05).distance < 0.05) found += one;
  }
  return found / area;
}

class MovedChairTest : public ::testing::Test {
 protected:
  static constexpr double before = 11.5, end = 29.9;  // [s]

  void SetUp() override {
    if (!SurfaceField::is_available()) GTEST_SKIP() << "built without OpenVDB";
  }
  void must(const std::vector<std::string>& arguments) const {
    const test::Outcome outcome = program_.run(arguments);
    ASSERT_EQ(outcome.exit_code, 0) << outcome.errors;
  }
  static std::string scene() { return HOLDFAST_SOURCE_FOLDER "/tests/cli/moved_chair.yaml"; }

  TriangleMesh truth_at(double time) const {
    must({"simulate", scene(), "--set", "frame_rate=10", "--seen-surface", "seen.ply", "--surface-time",
          std::to_string(time), "--overwrite"});
    return read_mesh(program_.path("seen.ply"));
  }
  /// In the frame of the room.
  TriangleMesh estimate_at(double time) const {
    must({"map", "export", "out/map.hfm", "--mesh", "then.ply", "--until", std::to_string(time), "--overwrite"});
    TriangleMesh mesh = read_mesh(program_.path("then.ply"));
    const TimedPose truth = read_trajectory(program_.path("truth/groundtruth.txt")).front();
    const TimedPose first = read_trajectory(program_.path("out/trajectory.txt")).front();
    EXPECT_NEAR(truth.timestamp, first.timestamp, 1e-3);
    const Eigen::Isometry3f T_room_map = (truth.T_world_camera * first.T_world_camera.inverse()).cast<float>();
    for (MeshVertex& vertex : mesh.vertices) vertex.position = T_room_map * vertex.position;
    return mesh;
  }
  void run(const std::string& resting_time) const {
    must({"run", std::string(HOLDFAST_EXAMPLE_CONFIGURATIONS) + "/full.yaml", "--set",
          "source={simulated: {scene: " + scene() + ", set: [frame_rate=10]}}", "--set",
          "segmenter={truth: {classes: [person]}}", "--set",
          "surface={enabled: true, voxel: 0.02, keep_depth: true, resting_time: " + resting_time + "}", "--output",
          "out", "--quiet"});
    must({"simulate", scene(), "--set", "frame_rate=10", "--duration", "0.1", "--output", "truth", "--quiet"});
  }

  test::Program program_;
};

TEST_F(MovedChairTest, IsWhereItIsAtBothTimes) {
  ASSERT_NO_FATAL_FAILURE(run("2"));
  const TriangleMesh first = estimate_at(before), last = estimate_at(end);
  EXPECT_GT(completeness(truth_at(before), first, place_before), 0.8);
  EXPECT_LT(area_in(first, place_after), 0.01);
  EXPECT_GT(completeness(truth_at(end), last, place_after), 0.75);
  EXPECT_LT(area_in(last, place_before), 0.005 * area_in(first, place_before)) << "no ghost";
}

}  // namespace
}  // namespace holdfast
