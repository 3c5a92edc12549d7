// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/surface/decimation.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <queue>
#include <tuple>
#include <vector>

namespace holdfast {

namespace {

/// Sum of weighted squared distances to planes: p'Ap + 2b'p + c.
struct Quadric {
  Eigen::Matrix3d A = Eigen::Matrix3d::Zero();
  Eigen::Vector3d b = Eigen::Vector3d::Zero();
  double c = 0.0;

  void add_plane(const Eigen::Vector3d& normal, const Eigen::Vector3d& point, double weight) {
    const double offset = -normal.dot(point);
    A += weight * normal * normal.transpose();
    b += weight * offset * normal;
    c += weight * offset * offset;
  }
  Quadric& operator+=(const Quadric& other) {
    A += other.A, b += other.b, c += other.c;
    return *this;
  }
  double at(const Eigen::Vector3d& p) const { return p.dot(A * p) + 2.0 * b.dot(p) + c; }
};

/// An edge, and its cost when neither end had been changed since.
struct Collapse {
  double cost = 0.0;
  std::uint32_t a = 0, b = 0, version = 0;

  bool operator<(const Collapse& other) const {  // the cheapest first in a queue
    return std::tie(other.cost, other.a, other.b) < std::tie(cost, a, b);
  }
};

class Decimator {
 public:
  explicit Decimator(TriangleMesh& mesh)
      : mesh_(mesh),
        quadrics_(mesh.vertices.size()),
        triangles_of_(mesh.vertices.size()),
        versions_(mesh.vertices.size(), 0),
        is_boundary_(mesh.vertices.size(), false),
        is_removed_(mesh.triangles.size(), false) {
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) add_triangle(t);
    add_edges();
  }

  void reduce_to(std::size_t target) {
    std::size_t count = mesh_.triangles.size();
    while (count > target && !queue_.empty()) {
      const Collapse next = queue_.top();
      queue_.pop();
      if (versions_[next.a] + versions_[next.b] == next.version) count -= collapse(next.a, next.b);
    }
    // A triangle that was removed has become its first corner.
    for (std::size_t t = 0; t < is_removed_.size(); ++t)
      if (is_removed_[t]) mesh_.triangles[t].fill(mesh_.triangles[t][0]);
    remove_triangles(mesh_, [](const auto& triangle) { return triangle[0] == triangle[1]; });
  }

 private:
  Eigen::Vector3d position(std::uint32_t vertex) const { return mesh_.vertices[vertex].position.cast<double>(); }

  void add_triangle(std::uint32_t t) {
    const Eigen::Vector3d area = mesh_.area_vector(t);
    const double size = area.norm();
    for (const std::uint32_t corner : mesh_.triangles[t]) {
      triangles_of_[corner].push_back(t);
      if (size > 0.0) quadrics_[corner].add_plane(area / size, position(corner), size);
    }
  }

  void add_edges() {
    std::vector<std::array<std::uint32_t, 3>> edges;  // ends in order, triangle
    for (std::uint32_t t = 0; t < mesh_.triangles.size(); ++t)
      for (std::size_t k = 0; k < 3; ++k) {
        const auto [low, high] = std::minmax(mesh_.triangles[t][k], mesh_.triangles[t][(k + 1) % 3]);
        edges.push_back({low, high, t});
      }
    std::sort(edges.begin(), edges.end());
    for (std::size_t i = 0; i < edges.size();) {
      const auto [a, b, triangle] = edges[i];
      std::size_t end = i;
      while (end < edges.size() && edges[end][0] == a && edges[end][1] == b) ++end;
      if (end - i != 2) is_boundary_[a] = is_boundary_[b] = true;
      if (end - i == 1) keep_boundary(a, b, mesh_.area_vector(triangle));
      i = end;
    }
    for (std::size_t i = 0; i < edges.size(); ++i)
      if (i == 0 || edges[i][0] != edges[i - 1][0] || edges[i][1] != edges[i - 1][1]) push(edges[i][0], edges[i][1]);
  }

  void keep_boundary(std::uint32_t a, std::uint32_t b, const Eigen::Vector3d& area) {
    constexpr double weight = 10.0;
    const Eigen::Vector3d edge = position(b) - position(a), normal = edge.cross(area);
    if (!(normal.norm() > 0.0)) return;
    for (const std::uint32_t end : {a, b})
      quadrics_[end].add_plane(normal.normalized(), position(a), weight * edge.squaredNorm());
  }

  void push(std::uint32_t a, std::uint32_t b) {
    constexpr double by_length = 1e-4;  // prefers short edges where a surface is plane
    const double length = (position(b) - position(a)).squaredNorm();
    Quadric sum = quadrics_[a];
    sum += quadrics_[b];
    const double error = std::max(sum.at(best_position(sum, a, b)), 0.0);
    queue_.push({error + by_length * length * length, a, b, versions_[a] + versions_[b]});
  }

  /// The minimum of the error if it is well defined and near the edge, else the best of its ends and middle.
  Eigen::Vector3d best_position(const Quadric& sum, std::uint32_t a, std::uint32_t b) const {
    const Eigen::Vector3d p = position(a), q = position(b), middle = 0.5 * (p + q);
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(sum.A);
    const Eigen::Vector3d& values = solver.eigenvalues();
    Eigen::Vector3d best = middle;
    if (values[0] > 1e-3 * values[2]) {
      best = -(solver.eigenvectors() * values.cwiseInverse().asDiagonal() * solver.eigenvectors().transpose() * sum.b);
      if ((best - middle).norm() <= (q - p).norm()) return best;
      best = middle;
    }
    for (const Eigen::Vector3d& end : {p, q})
      if (sum.at(end) < sum.at(best)) best = end;
    return best;
  }

  bool has(std::uint32_t triangle, std::uint32_t vertex) const {
    const auto& corners = mesh_.triangles[triangle];
    return corners[0] == vertex || corners[1] == vertex || corners[2] == vertex;
  }

  std::vector<std::uint32_t> neighbours_of(std::uint32_t vertex) const {
    std::vector<std::uint32_t> neighbours;
    for (const std::uint32_t t : triangles_of_[vertex])
      for (const std::uint32_t corner : mesh_.triangles[t])
        if (corner != vertex) neighbours.push_back(corner);
    std::sort(neighbours.begin(), neighbours.end());
    neighbours.erase(std::unique(neighbours.begin(), neighbours.end()), neighbours.end());
    return neighbours;
  }

  /// The link condition (Dey et al. 1999), that no boundary meets another one, and that no part vanishes.
  bool keeps_topology(std::uint32_t a, std::uint32_t b) const {
    const auto& triangles = triangles_of_[a];
    const auto shared = std::count_if(triangles.begin(), triangles.end(), [&](std::uint32_t t) { return has(t, b); });
    if (shared == 0 || shared > 2 || (shared == 2 && is_boundary_[a] && is_boundary_[b])) return false;
    const std::vector<std::uint32_t> of_a = neighbours_of(a), of_b = neighbours_of(b);
    std::vector<std::uint32_t> common;
    std::set_intersection(of_a.begin(), of_a.end(), of_b.begin(), of_b.end(), std::back_inserter(common));
    return common.size() == static_cast<std::size_t>(shared) && of_a.size() + of_b.size() > 2 * common.size() + 2;
  }

  /// Whether the triangles of `vertex` without `other` keep their side when the vertex moves.
  bool keeps_normals(std::uint32_t vertex, std::uint32_t other, const Eigen::Vector3d& target) const {
    constexpr double smallest_cosine = 0.2;
    return std::all_of(triangles_of_[vertex].begin(), triangles_of_[vertex].end(), [&](std::uint32_t t) {
      if (has(t, other)) return true;
      std::array<Eigen::Vector3d, 3> corners;
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t corner = mesh_.triangles[t][k];
        corners[k] = corner == vertex ? target : position(corner);
      }
      const Eigen::Vector3d before = mesh_.area_vector(t);
      const Eigen::Vector3d after = 0.5 * (corners[1] - corners[0]).cross(corners[2] - corners[0]);
      return !(before.norm() > 0.0) ||
             (after.norm() > 0.0 && before.dot(after) > smallest_cosine * before.norm() * after.norm());
    });
  }

  /// Merges `b` into `a`; returns the number of triangles that this removes, 0 if it is refused.
  std::size_t collapse(std::uint32_t a, std::uint32_t b) {
    Quadric sum = quadrics_[a];
    sum += quadrics_[b];
    const Eigen::Vector3d target = best_position(sum, a, b);
    if (!keeps_topology(a, b) || !keeps_normals(a, b, target) || !keeps_normals(b, a, target)) return 0;
    quadrics_[a] = sum;
    interpolate(a, b, target);
    is_boundary_[a] = is_boundary_[a] || is_boundary_[b];
    std::size_t removed = 0;
    for (const std::uint32_t t : triangles_of_[b]) {
      if (has(t, a)) {
        ++removed;
        is_removed_[t] = true;
        for (const std::uint32_t corner : mesh_.triangles[t])
          if (corner != b) std::erase(triangles_of_[corner], t);
        continue;
      }
      std::replace(mesh_.triangles[t].begin(), mesh_.triangles[t].end(), b, a);
      triangles_of_[a].push_back(t);
    }
    triangles_of_[b].clear();
    ++versions_[a], ++versions_[b];
    for (const std::uint32_t neighbour : neighbours_of(a)) push(std::min(a, neighbour), std::max(a, neighbour));
    return removed;
  }

  /// Gives `a` the normal and the colour of the point of the edge that is nearest to its new position.
  void interpolate(std::uint32_t a, std::uint32_t b, const Eigen::Vector3d& target) {
    MeshVertex& vertex = mesh_.vertices[a];
    const MeshVertex& other = mesh_.vertices[b];
    const Eigen::Vector3d edge = position(b) - position(a);
    const double length = edge.squaredNorm();
    const double share = length > 0.0 ? std::clamp((target - position(a)).dot(edge) / length, 0.0, 1.0) : 0.0;
    const auto mix = [&](std::uint8_t x, std::uint8_t y) {
      return static_cast<std::uint8_t>(std::lround((1.0 - share) * x + share * y));
    };
    vertex.red = mix(vertex.red, other.red);
    vertex.green = mix(vertex.green, other.green);
    vertex.blue = mix(vertex.blue, other.blue);
    if (share > 0.5) vertex.label = other.label;
    const auto single = static_cast<float>(share);
    vertex.normal = ((1.0F - single) * vertex.normal + single * other.normal).normalized();
    vertex.position = target.cast<float>();
  }

  TriangleMesh& mesh_;
  std::vector<Quadric> quadrics_;
  std::vector<std::vector<std::uint32_t>> triangles_of_;
  std::vector<std::uint32_t> versions_;
  std::vector<bool> is_boundary_, is_removed_;
  std::priority_queue<Collapse> queue_;
};

}  // namespace

void decimate(TriangleMesh& mesh, std::size_t target) {
  if (mesh.triangles.size() > target) Decimator(mesh).reduce_to(target);
}

}  // namespace holdfast
