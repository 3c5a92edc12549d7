// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/surface/triangle_tree.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>

namespace holdfast {

Eigen::Vector3d nearest_on_triangle(const Eigen::Vector3d& point, const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                                    const Eigen::Vector3d& c) {
  // Inside, where the projection to the plane is; otherwise on the nearest of the three edges.
  const Eigen::Vector3d normal = (b - a).cross(c - a);
  const double length2 = normal.squaredNorm();
  if (length2 > 0.0) {
    const auto side = [&](const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
      return normal.dot((to - from).cross(point - from));
    };
    if (side(a, b) >= 0.0 && side(b, c) >= 0.0 && side(c, a) >= 0.0)
      return point - normal * (normal.dot(point - a) / length2);
  }
  const auto on_edge = [&](const Eigen::Vector3d& from, const Eigen::Vector3d& to) -> Eigen::Vector3d {
    const double along2 = (to - from).squaredNorm();
    const double along = along2 > 0.0 ? std::clamp((point - from).dot(to - from) / along2, 0.0, 1.0) : 0.0;
    return from + along * (to - from);
  };
  Eigen::Vector3d best = on_edge(a, b);
  for (const Eigen::Vector3d& other : {on_edge(b, c), on_edge(c, a)})
    if ((other - point).squaredNorm() < (best - point).squaredNorm()) best = other;
  return best;
}

TriangleTree::TriangleTree(const TriangleMesh& mesh) : mesh_(mesh), order_(mesh.triangles.size()) {
  std::iota(order_.begin(), order_.end(), 0U);
  nodes_.reserve(2 * order_.size() + 1);
  if (!order_.empty()) build(0, static_cast<std::uint32_t>(order_.size()));
}

void TriangleTree::build(std::uint32_t begin, std::uint32_t end) {
  constexpr std::uint32_t leaf_size = 4;
  const std::size_t number = nodes_.size();
  nodes_.push_back({});
  Eigen::AlignedBox3f box, centres;
  const auto centre = [&](std::uint32_t triangle) -> Eigen::Vector3f {
    return (mesh_.corner(triangle, 0) + mesh_.corner(triangle, 1) + mesh_.corner(triangle, 2)) / 3.0F;
  };
  for (std::uint32_t i = begin; i < end; ++i) {
    for (int k = 0; k < 3; ++k) box.extend(mesh_.corner(order_[i], k));
    centres.extend(centre(order_[i]));
  }
  nodes_[number].box = box;
  if (end - begin <= leaf_size) {
    nodes_[number].begin = begin, nodes_[number].end = end;
    return;
  }
  Eigen::Index axis = 0;
  centres.sizes().maxCoeff(&axis);
  const std::uint32_t middle = (begin + end) / 2;
  std::nth_element(order_.begin() + begin, order_.begin() + middle, order_.begin() + end,
                   [&](std::uint32_t a, std::uint32_t b) {
                     const float at_a = centre(a)[axis], at_b = centre(b)[axis];
                     return at_a != at_b ? at_a < at_b : a < b;
                   });
  build(begin, middle);
  nodes_[number].second = static_cast<std::uint32_t>(nodes_.size());
  build(middle, end);
}

TriangleTree::Nearest TriangleTree::nearest(const Eigen::Vector3d& point, double limit) const {
  Nearest best;
  if (nodes_.empty()) return best;
  double best2 = limit * limit;
  const Eigen::Vector3f at = point.cast<float>();
  // Boxes are compared in single precision: a little further than needed is searched.
  const auto distance2 = [&](std::uint32_t node) {
    return static_cast<double>(nodes_[node].box.squaredExteriorDistance(at)) * (1.0 - 1e-5);
  };
  std::array<std::uint32_t, 64> stack{};
  std::size_t size = 0;
  stack[size++] = 0;
  while (size > 0) {
    const std::uint32_t number = stack[--size];
    if (!(distance2(number) < best2)) continue;
    const Node& node = nodes_[number];
    if (node.second != 0) {
      const std::uint32_t first = number + 1;
      const bool first_is_nearer = distance2(first) < distance2(node.second);
      stack[size++] = first_is_nearer ? node.second : first;
      stack[size++] = first_is_nearer ? first : node.second;
      continue;
    }
    for (std::uint32_t i = node.begin; i < node.end; ++i) {
      const std::size_t triangle = order_[i];
      const Eigen::Vector3d candidate =
          nearest_on_triangle(point, mesh_.corner(triangle, 0).cast<double>(), mesh_.corner(triangle, 1).cast<double>(),
                              mesh_.corner(triangle, 2).cast<double>());
      const double candidate2 = (candidate - point).squaredNorm();
      if (!(candidate2 < best2)) continue;
      best2 = candidate2;
      best = {std::sqrt(candidate2), triangle, candidate};
    }
  }
  return best;
}

std::vector<TriangleTree::Crossing> TriangleTree::crossings(const Eigen::Vector3d& origin,
                                                            const Eigen::Vector3d& direction, double reach) const {
  std::vector<Crossing> found;
  if (nodes_.empty()) return found;
  const Eigen::Vector3f from = (origin - reach * direction).cast<float>(),
                        to = (origin + reach * direction).cast<float>();
  // Few boxes are near a segment of some centimetres: those that touch its box are searched.
  Eigen::AlignedBox3f segment(from.cwiseMin(to), from.cwiseMax(to));
  segment.min().array() -= 1e-5F, segment.max().array() += 1e-5F;
  std::vector<std::uint32_t> stack{0};
  while (!stack.empty()) {
    const std::uint32_t number = stack.back();
    stack.pop_back();
    const Node& node = nodes_[number];
    if (!node.box.intersects(segment)) continue;
    if (node.second != 0) {
      stack.push_back(node.second);
      stack.push_back(number + 1);
      continue;
    }
    for (std::uint32_t i = node.begin; i < node.end; ++i)
      if (const auto along = crossing_of(order_[i], origin, direction); along && std::abs(*along) <= reach)
        found.push_back({*along, order_[i]});
  }
  return found;
}

std::optional<double> TriangleTree::crossing_of(std::size_t triangle, const Eigen::Vector3d& origin,
                                                const Eigen::Vector3d& direction) const {
  const Eigen::Vector3d a = mesh_.corner(triangle, 0).cast<double>();
  const Eigen::Vector3d ab = mesh_.corner(triangle, 1).cast<double>() - a,
                        ac = mesh_.corner(triangle, 2).cast<double>() - a;
  const Eigen::Vector3d p = direction.cross(ac);
  const double determinant = ab.dot(p);
  if (determinant == 0.0) return std::nullopt;
  const Eigen::Vector3d s = origin - a;
  const double u = s.dot(p) / determinant;
  const Eigen::Vector3d q = s.cross(ab);
  const double v = direction.dot(q) / determinant;
  if (!(u >= 0.0 && v >= 0.0 && u + v <= 1.0)) return std::nullopt;
  return ac.dot(q) / determinant;
}

}  // namespace holdfast
