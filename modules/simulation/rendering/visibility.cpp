// SPDX-License-Identifier: BSD-3-Clause
#include "visibility.hpp"

#include <algorithm>
#include <cmath>

#include "vectors.hpp"

namespace holdfast::simulation {

using Eigen::Vector3d;

namespace {
// Rounding without a call into the library, for values of a size that fits.
inline int floor_of(double value) {
  const int whole = static_cast<int>(value);
  return whole - (value < whole);
}
inline int ceiling_of(double value) {
  const int whole = static_cast<int>(value);
  return whole + (value > whole);
}

bool lies_on_floor(const PosedObject& object, const Triangle& triangle) {
  constexpr double highest = 0.03;  // [m]
  return std::max({object.corners[triangle.a].z(), object.corners[triangle.b].z(), object.corners[triangle.c].z()}) <
         highest;
}

// Four samples at once: a branch on each would be guessed wrongly too often.
void draw_span(float* nearest, std::uint32_t* numbers, int count, float start, float step, std::uint32_t number) {
  const auto name = static_cast<std::int32_t>(number);
  const Integers4 names = {name, name, name, name};
  const Floats4 offsets = {0.0F, step, 2.0F * step, 3.0F * step};
  int i = 0;
  for (; i + 4 <= count; i += 4) {
    const Floats4 value = start + static_cast<float>(i) * step + offsets;
    const auto old_value = load<Floats4>(nearest + i);
    const Integers4 nearer = value > old_value;
    store(nearest + i, nearer ? value : old_value);
    store(numbers + i, nearer ? names : load<Integers4>(numbers + i));
  }
  if (i == count) return;
  const std::int32_t rest = count - i;
  const Integers4 inside = Integers4{0, 1, 2, 3} < Integers4{rest, rest, rest, rest};
  const Floats4 value = start + static_cast<float>(i) * step + offsets;
  const auto old_value = load<Floats4>(nearest + i);
  const Integers4 nearer = (value > old_value) & inside;
  store(nearest + i, nearer ? value : old_value);
  store(numbers + i, nearer ? names : load<Integers4>(numbers + i));
}
}  // namespace

VisibilityBuffer::VisibilityBuffer(const RayGrid& grid) : grid_(grid) {
  const std::size_t count = static_cast<std::size_t>(grid.columns) * grid.rows;
  nearest_.resize(count + 3);  // rows are drawn by fours
  numbers_.resize(count + 3);
  const double x1 = grid.x0 + grid.columns * grid.step_x, y1 = grid.y0 + grid.rows * grid.step_y;
  sides_ = {Vector3d(1, 0, -grid.x0), Vector3d(-1, 0, x1), Vector3d(0, 1, -grid.y0), Vector3d(0, -1, y1)};
  for (Vector3d& side : sides_) side.normalize();
}

void VisibilityBuffer::draw(const PosedWorld& world, const Eigen::Isometry3d& T_world_camera) {
  std::fill(nearest_.begin(), nearest_.end(), 0.0F);
  std::fill(numbers_.begin(), numbers_.end(), nothing);
  triangles_.clear();
  surfaces_.clear();

  const Eigen::Isometry3d T_camera_world = T_world_camera.inverse();
  order_.clear();
  for (std::uint32_t index = 0; index < world.objects().size(); ++index) {
    const PosedObject& posed = world.objects()[index];
    const Vector3d centre = T_camera_world * posed.centre;
    if (!outside(centre, posed.radius)) order_.emplace_back(centre.norm(), index);
  }
  std::sort(order_.begin(), order_.end());  // near things first, so that what they hide is turned down early

  for (const auto& [distance, index] : order_) {
    const PosedObject& posed = world.objects()[index];
    const Mesh& mesh = posed.object->mesh;
    corners_.resize(posed.corners.size());
    for (std::size_t i = 0; i < corners_.size(); ++i) corners_[i] = T_camera_world * posed.corners[i];

    for (const Triangle& triangle : mesh.triangles) {
      const Vector3d corners[3] = {corners_[triangle.a], corners_[triangle.b], corners_[triangle.c]};
      if (corners[0].z() < near_plane && corners[1].z() < near_plane && corners[2].z() < near_plane) continue;
      if (outside(corners)) continue;
      Eigen::Matrix3d edges;  // rows: the inverse of the matrix of corners
      edges.row(0) = corners[1].cross(corners[2]);
      const double determinant = edges.row(0).dot(corners[0]);
      if (determinant <= 1e-12) continue;  // turned away, or seen edge-on
      edges.row(1) = corners[2].cross(corners[0]);
      edges.row(2) = corners[0].cross(corners[1]);
      edges /= determinant;

      const std::size_t before = triangles_.size();
      VisibleTriangle& visible = triangles_.emplace_back();
      visible.inverse_depth = edges.colwise().sum().transpose();
      const Vertex &a = mesh.vertices[triangle.a], &b = mesh.vertices[triangle.b], &c = mesh.vertices[triangle.c];
      const auto gradient = [&](double at_a, double at_b, double at_c) -> Eigen::Vector3f {
        return (at_a * edges.row(0) + at_b * edges.row(1) + at_c * edges.row(2)).transpose().cast<float>();
      };
      visible.u = gradient(a.u, b.u, c.u);
      visible.v = gradient(a.v, b.v, c.v);
      visible.light = gradient(posed.light[triangle.a], posed.light[triangle.b], posed.light[triangle.c]);
      visible.texture = &world.world().textures[triangle.texture];
      surfaces_.push_back(posed.first_surface + triangle.surface);
      visible.object = static_cast<std::uint16_t>(index + 1);
      visible.floor = !posed.object->moves() && lies_on_floor(posed, triangle);
      visible.inverse_norm = static_cast<float>(1.0 / visible.inverse_depth.norm());
      draw_triangle(corners, edges, static_cast<std::uint32_t>(before));
    }
  }
}

bool VisibilityBuffer::outside(const Vector3d& centre, double radius) const {
  constexpr double margin = 1e-6;  // for rounding [m]
  if (centre.z() + radius + margin < near_plane) return true;
  return std::any_of(sides_.begin(), sides_.end(),
                     [&](const Vector3d& side) { return side.dot(centre) + radius + margin < 0.0; });
}

bool VisibilityBuffer::outside(const Vector3d corners[3]) const {
  const double x1 = grid_.x0 + grid_.columns * grid_.step_x, y1 = grid_.y0 + grid_.rows * grid_.step_y;
  int left = 0, right = 0, above = 0, below = 0;
  for (int i = 0; i < 3; ++i) {
    const Vector3d& corner = corners[i];
    left += corner.x()<grid_.x0 * corner.z(), right += corner.x()> x1 * corner.z();
    above += corner.y()<grid_.y0 * corner.z(), below += corner.y()> y1 * corner.z();
  }
  return left == 3 || right == 3 || above == 3 || below == 3;
}

void VisibilityBuffer::draw_triangle(const Vector3d corners[3], const Eigen::Matrix3d& edges, std::uint32_t number) {
  double left = 0, right = grid_.columns - 1, top = 0, bottom = grid_.rows - 1;
  const bool all_in_front =
      corners[0].z() >= near_plane && corners[1].z() >= near_plane && corners[2].z() >= near_plane;
  if (all_in_front) {
    double low_x = 1e9, high_x = -1e9, low_y = 1e9, high_y = -1e9;
    for (int i = 0; i < 3; ++i) {
      const double x = (corners[i].x() / corners[i].z() - grid_.x0) / grid_.step_x;
      const double y = (corners[i].y() / corners[i].z() - grid_.y0) / grid_.step_y;
      low_x = std::min(low_x, x), high_x = std::max(high_x, x);
      low_y = std::min(low_y, y), high_y = std::max(high_y, y);
    }
    left = std::max(left, low_x), right = std::min(right, high_x);
    top = std::max(top, low_y), bottom = std::min(bottom, high_y);
  }
  if (left > right || top > bottom) return;

  // Each half plane a i + b j + c >= 0 of the grid bounds the columns of a row: i >= or <= offset + slope j.
  struct Bound {
    double slope, offset;
  };
  Bound lower[4], upper[4];
  int lowers = 0, uppers = 0;
  double first_row = top, last_row = bottom;
  const auto add_half_plane = [&](const Vector3d& plane) {
    const double a = plane.x() * grid_.step_x, b = plane.y() * grid_.step_y;
    const double c = plane.x() * grid_.x0 + plane.y() * grid_.y0 + plane.z();
    if (a > 0)
      lower[lowers++] = {-b / a, -c / a};
    else if (a < 0)
      upper[uppers++] = {-b / a, -c / a};
    else if (b > 0)
      first_row = std::max(first_row, -c / b);
    else if (b < 0)
      last_row = std::min(last_row, -c / b);
    else if (c < 0)
      last_row = first_row - 1.0;
  };
  for (int i = 0; i < 3; ++i) add_half_plane(edges.row(i).transpose());
  const Vector3d& inverse_depth = triangles_[number].inverse_depth;
  if (!all_in_front) add_half_plane(Vector3d(0, 0, 1.0 / near_plane) - inverse_depth);

  constexpr double tolerance = 1e-6;  // triangles that share an edge both take samples on it: no gaps
  if (first_row > last_row + 2.0 * tolerance) return;
  const int begin_row = ceiling_of(first_row - tolerance);
  const int end_row = floor_of(last_row + tolerance);
  const double step = inverse_depth.x() * grid_.step_x;
  for (int j = std::max(0, begin_row); j <= std::min(end_row, grid_.rows - 1); ++j) {
    double low = left, high = right;
    for (int k = 0; k < lowers; ++k) low = std::max(low, lower[k].offset + lower[k].slope * j);
    for (int k = 0; k < uppers; ++k) high = std::min(high, upper[k].offset + upper[k].slope * j);
    if (low > high + 2.0 * tolerance) continue;
    const int begin = std::max(0, ceiling_of(low - tolerance));
    const int end = std::min(grid_.columns - 1, floor_of(high + tolerance));
    if (begin > end) continue;
    const double start = inverse_depth.x() * (grid_.x0 + begin * grid_.step_x) +
                         inverse_depth.y() * (grid_.y0 + j * grid_.step_y) + inverse_depth.z();
    const std::size_t offset = static_cast<std::size_t>(j) * grid_.columns + begin;
    float* nearest = nearest_.data() + offset;
    std::uint32_t* numbers = numbers_.data() + offset;
    const auto start_value = static_cast<float>(start), step_value = static_cast<float>(step);
    draw_span(nearest, numbers, end - begin + 1, start_value, step_value, number);
  }
}

}  // namespace holdfast::simulation
