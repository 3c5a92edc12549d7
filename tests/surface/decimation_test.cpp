// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/surface/decimation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "holdfast/core/random.hpp"
#include "holdfast/surface/surface_evaluation.hpp"

namespace holdfast {
namespace {

constexpr double voxel = 0.02;  // [m], side of a square of two triangles

/// A surface over a grid of points; the left half is red, the right half blue.
template <class Height>
TriangleMesh surface_over(int count, const Height& height) {
  TriangleMesh mesh;
  for (int y = 0; y <= count; ++y)
    for (int x = 0; x <= count; ++x) {
      const Eigen::Vector3d p(voxel * x, voxel * y, height(voxel * x, voxel * y));
      mesh.vertices.push_back({p.cast<float>(), Eigen::Vector3f::UnitZ(), 0, 0, 0});
      (2 * x < count ? mesh.vertices.back().red : mesh.vertices.back().blue) = 200;
    }
  const auto at = [&](int x, int y) { return static_cast<std::uint32_t>(y * (count + 1) + x); };
  for (int y = 0; y < count; ++y)
    for (int x = 0; x < count; ++x) {
      mesh.triangles.push_back({at(x, y), at(x + 1, y), at(x + 1, y + 1)});
      mesh.triangles.push_back({at(x, y), at(x + 1, y + 1), at(x, y + 1)});
    }
  return mesh;
}

/// Edges with one triangle, and triangles whose normals have turned to the other side.
struct Defects {
  explicit Defects(const TriangleMesh& mesh) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
    for (const auto& triangle : mesh.triangles)
      for (std::size_t k = 0; k < 3; ++k) ++edges[{triangle[k], triangle[(k + 1) % 3]}];
    for (const auto& [edge, count] : edges) {
      repeated += count == 1 ? 0 : 1;
      if (edges.count({edge.second, edge.first}) == 0)
        boundary += (mesh.vertices[edge.first].position - mesh.vertices[edge.second].position).norm();
    }
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) flipped += mesh.area_vector(i).z() > 0.0 ? 0 : 1;
  }
  int repeated = 0, flipped = 0;
  float boundary = 0.0F;  // [m]
};

TEST(Decimate, AQuarterOfTheTrianglesStaysWithinAFifthOfAVoxel) {
  Random random(3);
  const auto hills = [&](double x, double y) {
    return 0.1 * std::sin(5.0 * x) * std::cos(4.0 * y) + random.uniform(-0.002, 0.002);
  };
  const TriangleMesh original = surface_over(60, hills);
  TriangleMesh mesh = original;
  decimate(mesh, original.triangles.size() / 4);
  EXPECT_LE(mesh.triangles.size(), original.triangles.size() / 4);
  EXPECT_GT(mesh.triangles.size(), original.triangles.size() / 4 - 3);
  const SurfaceEvaluation evaluation = evaluate_surface(original, original, mesh, {});
  EXPECT_LT(evaluation.accuracy, 0.1 * voxel);
  EXPECT_LT(evaluation.completion, 0.1 * voxel);
  EXPECT_GT(evaluation.normal_agreement, 0.98);
  const Defects defects(mesh);
  EXPECT_EQ(defects.flipped, 0);
  EXPECT_EQ(defects.repeated, 0);
  EXPECT_NEAR(mesh.area(), original.area(), 0.02 * original.area());
}

TEST(Decimate, APlaneKeepsItsBoundaryAndItsColours) {
  TriangleMesh mesh = surface_over(20, [](double, double) { return 0.5; });
  const double area = mesh.area();
  decimate(mesh, 40);
  EXPECT_LE(mesh.triangles.size(), 40U);
  EXPECT_NEAR(mesh.area(), area, 1e-6);
  const Defects defects(mesh);
  EXPECT_NEAR(defects.boundary, 4 * 20 * voxel, 1e-4);
  EXPECT_EQ(defects.flipped, 0);
  for (const MeshVertex& vertex : mesh.vertices) {
    EXPECT_NEAR(vertex.red + vertex.blue, 200, 1);
    EXPECT_NEAR(vertex.normal.z(), 1.0F, 1e-5);
    if (vertex.position.x() < 0.02F) {
      EXPECT_GT(vertex.red, 150);
    }
    if (vertex.position.x() > 0.38F) {
      EXPECT_GT(vertex.blue, 150);
    }
  }
}

TEST(Decimate, AnEdgeStaysSharp) {
  TriangleMesh mesh = surface_over(20, [](double x, double) { return std::abs(x - 0.2); });
  const TriangleMesh original = mesh;
  decimate(mesh, 60);
  EXPECT_LT(evaluate_surface(original, original, mesh, {}).accuracy, 0.0001);
  EXPECT_NEAR(mesh.area(), original.area(), 0.002 * original.area());
}

TEST(Decimate, AClosedSurfaceStaysClosedAndNoPartVanishes) {
  TriangleMesh mesh;  // a tetrahedron, and an octahedron
  for (const Eigen::Vector3f& p :
       {Eigen::Vector3f(5, 0, 0), Eigen::Vector3f(6, 0, 0), Eigen::Vector3f(5, 1, 0), Eigen::Vector3f(5, 0, 1),
        Eigen::Vector3f(1, 0, 0), Eigen::Vector3f(-1, 0, 0), Eigen::Vector3f(0, 1, 0), Eigen::Vector3f(0, -1, 0),
        Eigen::Vector3f(0, 0, 1), Eigen::Vector3f(0, 0, -1)})
    mesh.vertices.push_back({p, Eigen::Vector3f::UnitZ(), 0, 0, 0});
  mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}, {4, 6, 8}, {6, 5, 8},
                    {5, 7, 8}, {7, 4, 8}, {6, 4, 9}, {5, 6, 9}, {7, 5, 9}, {4, 7, 9}};
  decimate(mesh, 1);
  EXPECT_EQ(MeshParts(mesh).area.size(), mesh.vertices.size());
  const Defects defects(mesh);
  EXPECT_EQ(defects.boundary, 0.0F);
  EXPECT_GE(mesh.triangles.size(), 8U);
  EXPECT_LE(mesh.vertices.size(), 10U);
}

TEST(Decimate, LeavesAMeshThatIsSmallEnough) {
  TriangleMesh mesh = surface_over(2, [](double, double) { return 0.0; });
  decimate(mesh, 8);
  EXPECT_EQ(mesh.triangles.size(), 8U);
  TriangleMesh empty;
  decimate(empty, 0);
  EXPECT_TRUE(empty.empty());
}

}  // namespace
}  // namespace holdfast
