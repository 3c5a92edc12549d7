// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/surface/surface_evaluation.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "holdfast/core/error.hpp"
#include "holdfast/core/random.hpp"
#include "holdfast/surface/triangle_tree.hpp"

namespace holdfast {
namespace {

/// A square of `cells` x `cells` cells of 0.1 m at a height, from x = 0.
TriangleMesh floor_at(double z, int cells, double from_x = 0.0) {
  TriangleMesh mesh;
  for (int i = 0; i <= cells; ++i)
    for (int j = 0; j <= cells; ++j) {
      MeshVertex vertex;
      vertex.position = Eigen::Vector3d(from_x + 0.1 * i, 0.1 * j, z).cast<float>();
      mesh.vertices.push_back(vertex);
    }
  const auto at = [&](int i, int j) { return static_cast<std::uint32_t>(i * (cells + 1) + j); };
  for (int i = 0; i < cells; ++i)
    for (int j = 0; j < cells; ++j) {
      mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  compute_normals(mesh);
  return mesh;
}

void append(TriangleMesh& mesh, const TriangleMesh& more) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), more.vertices.begin(), more.vertices.end());
  for (const auto& t : more.triangles) mesh.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
}

TEST(SurfaceEvaluation, GivesZeroForTheSameSurface) {
  const TriangleMesh floor = floor_at(0.0, 10);
  const SurfaceEvaluation result = evaluate_surface(floor, floor, floor, {});
  EXPECT_LT(result.accuracy, 1e-6);
  EXPECT_LT(result.completion, 1e-6);
  EXPECT_EQ(result.f_score, 1.0);
  EXPECT_EQ(result.ghosts, 0.0);
  EXPECT_NEAR(result.normal_agreement, 1.0, 1e-6);
  EXPECT_NEAR(result.truth_area, 1.0, 1e-6);
  EXPECT_NEAR(static_cast<double>(result.estimate_points), 2500.0, 2.0);
}

TEST(SurfaceEvaluation, MeasuresOffsetHolesAndGhosts) {
  // Half of the floor, one centimetre too high, and a tenth of its area hovering half a metre above it.
  const TriangleMesh truth = floor_at(0.0, 10);
  TriangleMesh estimate = floor_at(0.01, 10);
  std::erase_if(estimate.triangles, [&](const auto& t) { return estimate.vertices[t[0]].position.x() > 0.45F; });
  TriangleMesh ghost = floor_at(0.5, 10);
  std::erase_if(ghost.triangles, [&](const auto& t) {
    return ghost.vertices[t[0]].position.x() > 0.05F || ghost.vertices[t[0]].position.y() > 0.45F;
  });
  append(estimate, ghost);
  const SurfaceEvaluation result = evaluate_surface(truth, truth, estimate, {});
  EXPECT_NEAR(result.ghosts, 0.05 / 0.55, 1e-3);
  EXPECT_NEAR(result.precision, 0.5 / 0.55, 1e-3);
  EXPECT_NEAR(result.accuracy, (0.5 * 0.01 + 0.05 * 0.5) / 0.55, 1e-3);
  EXPECT_NEAR(result.accuracy_median, 0.01, 1e-6);
  // Within 5 cm: the half below, and a strip of sqrt(0.05^2 - 0.01^2) beside it.
  EXPECT_NEAR(result.completion_ratio, 0.5 + 0.049, 6e-3);
  EXPECT_NEAR(result.f_score,
              2 * result.precision * result.completion_ratio / (result.precision + result.completion_ratio), 1e-9);
  EXPECT_NEAR(result.chamfer, 0.5 * (result.accuracy + result.completion), 1e-9);
  // Of the seen half everything is complete.
  TriangleMesh seen = floor_at(0.0, 10);
  std::erase_if(seen.triangles, [&](const auto& t) { return seen.vertices[t[0]].position.x() > 0.45F; });
  EXPECT_EQ(evaluate_surface(truth, seen, estimate, {}).completion_ratio, 1.0);
}

TEST(SurfaceEvaluation, LeavesOutWhatTheTruthDidNotObserve) {
  // The truth ends at x = 0.5 m; the estimate goes on to 1 m. It is bent upwards within the truth, over a fifth of it.
  const TriangleMesh truth = floor_at(0.0, 5);
  TriangleMesh estimate = floor_at(0.0, 10);
  std::erase_if(estimate.triangles, [&](const auto& t) { return estimate.vertices[t[0]].position.y() > 0.45F; });
  TriangleMesh ghost = floor_at(0.3, 10);  // of 0.1 x 0.5 m over the middle, and of 0.1 x 0.5 m beyond the border
  std::erase_if(ghost.triangles, [&](const auto& t) {
    const Eigen::Vector3f& corner = ghost.vertices[t[0]].position;
    return corner.y() > 0.45F || (std::abs(corner.x() - 0.2F) > 0.01F && std::abs(corner.x() - 0.7F) > 0.01F);
  });
  append(estimate, ghost);
  const auto nothing = [](const Eigen::Vector3d&) { return false; };
  const auto above = [](const Eigen::Vector3d& point) { return point.z() > 0.1; };
  const SurfaceEvaluation raw = evaluate_surface(truth, truth, estimate, {});
  EXPECT_EQ(raw.unobserved, 0.0);
  EXPECT_NEAR(raw.precision, 0.275 / 0.6, 0.01);
  // Beyond the border neither the floor nor the ghost counts; over the truth the ghost does.
  const SurfaceEvaluation closed = evaluate_surface(truth, truth, estimate, {}, nothing);
  EXPECT_NEAR(closed.unobserved, 0.275 / 0.6, 0.01);
  EXPECT_NEAR(closed.ghosts, 0.05 / 0.325, 0.01);
  EXPECT_NEAR(closed.precision, 0.275 / 0.325, 0.01);
  // What the truth looked through counts.
  const SurfaceEvaluation open = evaluate_surface(truth, truth, estimate, {}, above);
  EXPECT_NEAR(open.ghosts, 0.1 / 0.375, 0.01);
  EXPECT_EQ(open.completion, raw.completion);
  EXPECT_THAT(to_text(open), testing::HasSubstr("unobserved  "));
  EXPECT_THAT(to_json(open), testing::HasSubstr("\"unobserved\": 0.3"));
}

TEST(SurfaceEvaluation, FindsTheBordersOfTrianglesWithoutCommonVertices) {
  // A ridge, which is the nearest place of all that is above it, and no border.
  TriangleMesh roof = floor_at(0.0, 10), soup;
  for (MeshVertex& vertex : roof.vertices) vertex.position.z() = -std::abs(vertex.position.x() - 0.5F);
  for (const auto& t : roof.triangles) {
    const auto first = static_cast<std::uint32_t>(soup.vertices.size());
    for (const std::uint32_t corner : t) soup.vertices.push_back(roof.vertices[corner]);
    soup.triangles.push_back({first, first + 1, first + 2});
  }
  TriangleMesh above = floor_at(0.2, 2, 0.4);
  for (MeshVertex& vertex : above.vertices) vertex.position.y() += 0.4F;
  const auto nothing = [](const Eigen::Vector3d&) { return false; };
  EXPECT_EQ(evaluate_surface(soup, soup, above, {}, nothing).unobserved, 0.0);
}

TEST(SurfaceEvaluation, RefusesAnEstimateOfWhichNothingWasObserved) {
  TriangleMesh elsewhere = floor_at(0.0, 2);
  for (MeshVertex& vertex : elsewhere.vertices) vertex.position.x() += 5.0F;
  const auto nothing = [](const Eigen::Vector3d&) { return false; };
  EXPECT_THROW(evaluate_surface(floor_at(0.0, 10), floor_at(0.0, 10), elsewhere, {}, nothing), Error);
}

TEST(SurfaceEvaluation, MeasuresTheThicknessOfADoubledWall) {
  // A quarter of the floor is there twice, 6 cm apart. What faces the other side does not count, nor does the floor
  // where the truth itself has two surfaces.
  TriangleMesh truth = floor_at(0.0, 10), estimate = floor_at(0.0, 10), double_part = floor_at(0.06, 10);
  std::erase_if(double_part.triangles, [&](const auto& t) {
    return double_part.vertices[t[0]].position.x() > 0.45F || double_part.vertices[t[0]].position.y() > 0.45F;
  });
  TriangleMesh back = floor_at(-0.05, 10);
  for (auto& t : back.triangles) std::swap(t[1], t[2]);
  append(estimate, double_part);
  append(estimate, back);
  SurfaceEvaluationOptions options;
  EXPECT_EQ(evaluate_surface(truth, truth, estimate, options).doubled, 0.0);
  options.thickness_reach = 0.1;
  const SurfaceEvaluation result = evaluate_surface(truth, truth, estimate, options);
  EXPECT_NEAR(result.doubled, 0.25, 5e-3);
  EXPECT_NEAR(result.thickness_mean, 0.25 * 0.06, 5e-4);
  EXPECT_NEAR(result.thickness_99, 0.06, 1e-6);
  EXPECT_THAT(to_text(result), testing::HasSubstr("thickness   1.50 cm mean, 6.00 cm at 99 %; 25.0"));
  EXPECT_THAT(to_text(result),
              testing::HasSubstr("of the " + std::to_string(result.thickness_points) + " places compared"));
  EXPECT_THAT(to_json(result), testing::HasSubstr("\"doubled\": 0.25"));
  append(truth, double_part);
  EXPECT_EQ(evaluate_surface(truth, truth, estimate, options).doubled, 0.0);
}

TEST(SurfaceEvaluation, SaysThatNoThicknessWasMeasured) {
  const TriangleMesh truth = floor_at(0.0, 10);
  TriangleMesh estimate = truth;  // of the other winding
  for (auto& t : estimate.triangles) std::swap(t[1], t[2]);
  SurfaceEvaluationOptions options;
  options.thickness_reach = 0.1;
  const SurfaceEvaluation result = evaluate_surface(truth, truth, estimate, options);
  EXPECT_EQ(result.thickness_points, 0U);
  EXPECT_THAT(to_text(result), testing::HasSubstr("thickness   not measured"));
  EXPECT_THAT(to_json(result), testing::HasSubstr("\"thickness_mean\": null"));
}

TEST(SurfaceEvaluation, RefusesMeshesWithoutArea) {
  const TriangleMesh floor = floor_at(0.0, 2);
  EXPECT_THROW(evaluate_surface(floor, floor, {}, {}), Error);
  EXPECT_THROW(evaluate_surface({}, {}, floor, {}), Error);
}

TEST(SurfaceEvaluation, WritesItsFigures) {
  const TriangleMesh floor = floor_at(0.0, 2);
  const SurfaceEvaluation result = evaluate_surface(floor, floor, floor_at(0.02, 2), {});
  EXPECT_THAT(to_text(result), testing::HasSubstr("accuracy    2.00 cm mean, 2.00 cm median"));
  EXPECT_THAT(to_json(result), testing::HasSubstr("\"completion_ratio\": 1.0"));
  EXPECT_THAT(to_csv(result), testing::HasSubstr("\ncompletion,0.0199999"));
}

TEST(TriangleTree, FindsTheNearestPointOfAllTriangles) {
  Random random(3);
  TriangleMesh mesh;
  const auto place = [&] {
    return Eigen::Vector3d(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
  };
  for (std::uint32_t i = 0; i < 200; ++i) {
    const Eigen::Vector3d corner = place();
    for (int k = 0; k < 3; ++k) {
      MeshVertex vertex;
      vertex.position = (corner + 0.2 * place()).cast<float>();
      mesh.vertices.push_back(vertex);
    }
    mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  const TriangleTree tree(mesh);
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector3d point = 1.5 * place();
    double nearest = 1e9;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      nearest =
          std::min(nearest, (nearest_on_triangle(point, mesh.corner(t, 0).cast<double>(),
                                                 mesh.corner(t, 1).cast<double>(), mesh.corner(t, 2).cast<double>()) -
                             point)
                                .norm());
    }
    EXPECT_NEAR(tree.nearest(point).distance, nearest, 1e-12);
    EXPECT_EQ(tree.nearest(point, 0.5 * nearest).distance, std::numeric_limits<double>::infinity());
  }
}

TEST(TriangleTree, FindsNoPointOfATriangleThatIsNearer) {
  Random random(5);
  const auto place = [&] {
    return Eigen::Vector3d(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
  };
  for (int i = 0; i < 50; ++i) {
    const Eigen::Vector3d a = place(), b = place(), c = place(), point = 2.0 * place();
    const Eigen::Vector3d found = nearest_on_triangle(point, a, b, c);
    constexpr int steps = 60;
    double sampled = 1e9;
    for (int u = 0; u <= steps; ++u)
      for (int v = 0; u + v <= steps; ++v)
        sampled = std::min(sampled, (a + (b - a) * u / steps + (c - a) * v / steps - point).norm());
    EXPECT_LE((found - point).norm(), sampled + 1e-12);
    EXPECT_GE((found - point).norm(), sampled - 0.05);
  }
}

}  // namespace
}  // namespace holdfast
