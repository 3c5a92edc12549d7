// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/surface/surface_evaluation.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>
#include <vector>

#include "holdfast/core/error.hpp"
#include "holdfast/surface/triangle_tree.hpp"
#include "mesh_border.hpp"

namespace holdfast {

namespace {

struct SurfacePoint {
  Eigen::Vector3d position;
  std::size_t triangle = 0;
};

/// Points in numbers proportional to the area, within a triangle by the sequence R2 (Roberts 2018).
std::vector<SurfacePoint> points_on(const TriangleMesh& mesh, double spacing) {
  constexpr double first = 0.7548776662466927, second = 0.5698402909980532;  // powers of 1 / the plastic number
  std::vector<SurfacePoint> points;
  double due = 0.5, u = 0.5, v = 0.5;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    due += mesh.area_vector(i).norm() / (spacing * spacing);
    const Eigen::Vector3d a = mesh.corner(i, 0).cast<double>(), b = mesh.corner(i, 1).cast<double>(),
                          c = mesh.corner(i, 2).cast<double>();
    for (; due >= 1.0; due -= 1.0) {
      u = std::fmod(u + first, 1.0), v = std::fmod(v + second, 1.0);
      const bool is_mirrored = u + v > 1.0;
      const double s = is_mirrored ? 1.0 - u : u, t = is_mirrored ? 1.0 - v : v;
      points.push_back({a + s * (b - a) + t * (c - a), i});
    }
  }
  return points;
}

struct Distances {
  double mean = 0.0, median = 0.0, share_within = 0.0, share_beyond = 0.0, normal_agreement = 0.0;
  std::size_t points = 0;   // that were compared
  double unobserved = 0.0;  // share of all
};

using FreeTest = std::function<bool(const Eigen::Vector3d&)>;

Distances distances(const TriangleMesh& from, const TriangleMesh& to, const SurfaceEvaluationOptions& options,
                    const FreeTest& is_free = {}) {
  const TriangleTree tree(to);
  const std::optional<surface::MeshBorder> border = is_free ? std::optional<surface::MeshBorder>(to) : std::nullopt;
  std::vector<double> all;
  std::size_t within = 0, beyond = 0, unobserved = 0;
  double cosines = 0.0;
  for (const SurfacePoint& point : points_on(from, options.spacing)) {
    const TriangleTree::Nearest nearest = tree.nearest(point.position);
    if (border && nearest.distance > options.threshold && border->contains(nearest.triangle, nearest.point) &&
        !is_free(point.position)) {
      ++unobserved;
      continue;
    }
    all.push_back(nearest.distance);
    if (nearest.distance > options.ghost_distance) ++beyond;
    if (nearest.distance > options.threshold) continue;
    ++within;
    cosines +=
        std::abs(from.area_vector(point.triangle).normalized().dot(to.area_vector(nearest.triangle).normalized()));
  }
  Distances result;
  result.points = all.size();
  if (unobserved > 0)
    result.unobserved = static_cast<double>(unobserved) / static_cast<double>(all.size() + unobserved);
  if (all.empty()) return result;
  const auto count = static_cast<double>(all.size());
  for (const double distance : all) result.mean += distance / count;
  std::nth_element(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(all.size() / 2), all.end());
  result.median = all[all.size() / 2];
  result.share_within = static_cast<double>(within) / count;
  result.share_beyond = static_cast<double>(beyond) / count;
  result.normal_agreement = within > 0 ? cosines / static_cast<double>(within) : 0.0;
  return result;
}

/// Offsets of the surfaces of a mesh along a normal that face its side.
std::vector<double> layers(const TriangleTree& tree, const TriangleMesh& mesh, const Eigen::Vector3d& origin,
                           const Eigen::Vector3d& normal, double reach) {
  constexpr double same_side = 0.7;      // cosine
  constexpr double one_crossing = 1e-4;  // of an edge that two triangles share [m]
  std::vector<double> offsets;
  for (const TriangleTree::Crossing& crossing : tree.crossings(origin, normal, reach))
    if (mesh.area_vector(crossing.triangle).normalized().dot(normal) > same_side) offsets.push_back(crossing.along);
  std::sort(offsets.begin(), offsets.end());
  offsets.erase(std::unique(offsets.begin(), offsets.end(), [](double a, double b) { return b - a < one_crossing; }),
                offsets.end());
  return offsets;
}

void measure_thickness(const TriangleMesh& truth, const TriangleMesh& seen, const TriangleMesh& estimate,
                       SurfaceEvaluation& result) {
  const TriangleTree truth_tree(truth), tree(estimate);
  const double reach = result.options.thickness_reach;
  std::vector<double> all;
  std::size_t doubled = 0;
  for (const SurfacePoint& point : points_on(seen, result.options.spacing)) {
    const Eigen::Vector3d normal = seen.area_vector(point.triangle).normalized();
    // Two estimated surfaces may be 2 * reach apart, so the truth must be single over that range.
    if (layers(truth_tree, truth, point.position, normal, 2.0 * reach).size() > 1) continue;
    const std::vector<double> found = layers(tree, estimate, point.position, normal, reach);
    if (found.empty()) continue;
    all.push_back(found.back() - found.front());
    doubled += found.size() > 1 ? 1 : 0;
  }
  result.thickness_points = all.size();
  if (all.empty()) {
    result.thickness_mean = result.thickness_99 = result.doubled = std::numeric_limits<double>::quiet_NaN();
    return;
  }
  const auto count = static_cast<double>(all.size());
  for (const double thickness : all) result.thickness_mean += thickness / count;
  const auto place = all.begin() + static_cast<std::ptrdiff_t>(0.99 * (count - 1.0));
  std::nth_element(all.begin(), place, all.end());
  result.thickness_99 = *place;
  result.doubled = static_cast<double>(doubled) / count;
}

void require_area(const TriangleMesh& mesh, const char* name, double spacing) {
  if (mesh.area() < spacing * spacing)
    throw Error(std::string("the ") + name + " has no surface; expected a mesh with triangles, in metres");
}

std::vector<std::pair<const char*, double>> figures(const SurfaceEvaluation& e) {
  std::vector<std::pair<const char*, double>> values = {{"accuracy", e.accuracy},
                                                        {"accuracy_median", e.accuracy_median},
                                                        {"completion", e.completion},
                                                        {"completion_median", e.completion_median},
                                                        {"precision", e.precision},
                                                        {"completion_ratio", e.completion_ratio},
                                                        {"f_score", e.f_score},
                                                        {"chamfer", e.chamfer},
                                                        {"normal_agreement", e.normal_agreement},
                                                        {"ghosts", e.ghosts},
                                                        {"unobserved", e.unobserved},
                                                        {"truth_area", e.truth_area},
                                                        {"estimate_area", e.estimate_area},
                                                        {"threshold", e.options.threshold},
                                                        {"ghost_distance", e.options.ghost_distance},
                                                        {"spacing", e.options.spacing}};
  if (e.options.thickness_reach > 0.0)
    for (const auto& [name, value] : {std::pair{"thickness_reach", e.options.thickness_reach},
                                      {"thickness_mean", e.thickness_mean},
                                      {"thickness_99", e.thickness_99},
                                      {"doubled", e.doubled},
                                      {"thickness_points", static_cast<double>(e.thickness_points)}})
      values.emplace_back(name, value);
  return values;
}

}  // namespace

SurfaceEvaluation evaluate_surface(const TriangleMesh& truth, const TriangleMesh& seen, const TriangleMesh& estimate,
                                   const SurfaceEvaluationOptions& options, const FreeTest& is_free) {
  require_area(truth, "truth", options.spacing);
  require_area(seen, "seen part of the truth", options.spacing);
  require_area(estimate, "estimate", options.spacing);
  const Distances to_truth = distances(estimate, truth, options, is_free);
  if (to_truth.points == 0)
    throw Error(
        "the run of the truth observed nothing of the estimate; expected both in one world, and the run that made "
        "the truth");
  const Distances to_estimate = distances(seen, estimate, options);
  SurfaceEvaluation result;
  result.options = options;
  result.accuracy = to_truth.mean;
  result.accuracy_median = to_truth.median;
  result.precision = to_truth.share_within;
  result.ghosts = to_truth.share_beyond;
  result.unobserved = to_truth.unobserved;
  result.normal_agreement = to_truth.normal_agreement;
  result.completion = to_estimate.mean;
  result.completion_median = to_estimate.median;
  result.completion_ratio = to_estimate.share_within;
  const double sum = result.precision + result.completion_ratio;
  result.f_score = sum > 0.0 ? 2.0 * result.precision * result.completion_ratio / sum : 0.0;
  result.chamfer = 0.5 * (result.accuracy + result.completion);
  result.truth_area = seen.area();
  result.estimate_area = estimate.area();
  if (options.thickness_reach > 0.0) measure_thickness(truth, seen, estimate, result);
  result.truth_points = to_estimate.points;
  result.estimate_points = to_truth.points;
  return result;
}

void colour_by_error(TriangleMesh& mesh, const TriangleMesh& truth, double scale) {
  const TriangleTree tree(truth);
  for (MeshVertex& vertex : mesh.vertices) {
    const double part = std::min(tree.nearest(vertex.position.cast<double>()).distance / scale, 1.0);
    const auto level = [](double value) { return static_cast<std::uint8_t>(std::lround(255.0 * value)); };
    vertex.red = level(std::clamp(2.0 * part - 1.0, 0.0, 1.0));
    vertex.green = level(1.0 - std::abs(2.0 * part - 1.0));
    vertex.blue = level(std::clamp(1.0 - 2.0 * part, 0.0, 1.0));
  }
}

std::string to_text(const SurfaceEvaluation& e) {
  std::string text;
  const auto add = [&](const char* format, auto... values) {
    char line[160];
    std::snprintf(line, sizeof(line), format, values...);
    text += line;
  };
  add("surface     %.2f m^2 estimated, %.2f m^2 true\n", e.estimate_area, e.truth_area);
  add("accuracy    %.2f cm mean, %.2f cm median (estimate to truth)\n", 100 * e.accuracy, 100 * e.accuracy_median);
  add("completion  %.2f cm mean, %.2f cm median (truth to estimate)\n", 100 * e.completion, 100 * e.completion_median);
  add("within %.3g cm  precision %.2f %%, completion ratio %.2f %%, F-score %.2f %%\n", 100 * e.options.threshold,
      100 * e.precision, 100 * e.completion_ratio, 100 * e.f_score);
  add("Chamfer     %.2f cm\n", 100 * e.chamfer);
  add("normals     %.3f mean cosine\n", e.normal_agreement);
  add("ghosts      %.3f %% of the estimate is farther than %.3g cm from the truth\n", 100 * e.ghosts,
      100 * e.options.ghost_distance);
  if (e.unobserved > 0.0)
    add("unobserved  %.2f %% of the estimate lies beyond the borders of the truth and is not compared\n",
        100 * e.unobserved);
  if (e.thickness_points > 0)
    add("thickness   %.2f cm mean, %.2f cm at 99 %%; %.2f %% of the %zu places compared have two surfaces\n",
        100 * e.thickness_mean, 100 * e.thickness_99, 100 * e.doubled, e.thickness_points);
  else if (e.options.thickness_reach > 0.0)
    add("thickness   not measured: no place has one true and one estimated surface that face the same side\n");
  return text;
}

std::string to_json(const SurfaceEvaluation& evaluation) {
  nlohmann::ordered_json json;
  for (const auto& [name, value] : figures(evaluation)) json[name] = value;
  json["truth_points"] = evaluation.truth_points;
  json["estimate_points"] = evaluation.estimate_points;
  return json.dump(2) + "\n";
}

std::string to_csv(const SurfaceEvaluation& evaluation) {
  std::string text = "name,value\n";
  for (const auto& [name, value] : figures(evaluation)) {
    char line[64];
    std::snprintf(line, sizeof(line), "%s,%.9g\n", name, value);
    text += line;
  }
  return text;
}

}  // namespace holdfast
