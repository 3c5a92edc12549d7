// SPDX-License-Identifier: BSD-3-Clause
// The kernels, written once with the compiler's vector types: included by kernels_baseline.cpp and kernels_avx2.cpp
// after they have defined HOLDFAST_TARGET and HOLDFAST_TARGET_INLINE. Every element of a vector is computed by itself,
// so that the width of the processor's registers does not change a result.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "holdfast/geometry/pose_problem.hpp"


namespace holdfast::schur_plugin {
namespace {

typedef double Vector __attribute__((vector_size(32)));
typedef std::int64_t Mask __attribute__((vector_size(32)));
typedef float Floats __attribute__((vector_size(16)));

HOLDFAST_TARGET_INLINE Vector load(const double* p) {
  Vector v;
  std::memcpy(&v, p, sizeof v);
  return v;
}
HOLDFAST_TARGET_INLINE void store(double* p, Vector v) { std::memcpy(p, &v, sizeof v); }
HOLDFAST_TARGET_INLINE Vector load(const float* p) {
  Floats v;
  std::memcpy(&v, p, sizeof v);
  return __builtin_convertvector(v, Vector);
}
HOLDFAST_TARGET_INLINE Vector fill(double value) { return Vector{value, value, value, value}; }
HOLDFAST_TARGET_INLINE Vector choose(Mask mask, Vector a, Vector b) {
  return reinterpret_cast<Vector>((mask & reinterpret_cast<Mask>(a)) | (~mask & reinterpret_cast<Mask>(b)));
}
HOLDFAST_TARGET_INLINE Vector square_root(Vector v) {
  return Vector{std::sqrt(v[0]), std::sqrt(v[1]), std::sqrt(v[2]), std::sqrt(v[3])};
}
HOLDFAST_TARGET_INLINE double sum(Vector v) { return (v[0] + v[1]) + (v[2] + v[3]); }
HOLDFAST_TARGET_INLINE void transpose(Vector& a, Vector& b, Vector& c, Vector& d) {
  const Vector ab_low = __builtin_shufflevector(a, b, 0, 4, 2, 6), ab_high = __builtin_shufflevector(a, b, 1, 5, 3, 7);
  const Vector cd_low = __builtin_shufflevector(c, d, 0, 4, 2, 6), cd_high = __builtin_shufflevector(c, d, 1, 5, 3, 7);
  a = __builtin_shufflevector(ab_low, cd_low, 0, 1, 4, 5), b = __builtin_shufflevector(ab_high, cd_high, 0, 1, 4, 5);
  c = __builtin_shufflevector(ab_low, cd_low, 2, 3, 6, 7), d = __builtin_shufflevector(ab_high, cd_high, 2, 3, 6, 7);
}

/// Four observations of a point, seen from their cameras.
struct Sight {
  Vector rotation[3][3];
  Vector x, y, z, inverse_z;  ///< the point in the camera frame; z is 1 behind the camera
  Vector residual[3];         ///< [px], the last one in the right image; 0 without a column there
  Vector disparity;           ///< residual of the disparity, in standard deviations; 0 without one
  Vector disparity_slope;     ///< derivative of Huber's cost of the disparity by its square
  Vector weight;
  Vector scale2;              ///< inverse_sigma2 * weight
  Vector squared;             ///< weighted cost: squares of the pixel, and Huber's cost of the disparity
  Vector limit;               ///< of squared, where Huber's cost becomes linear
  Mask in_front, has_right;
};

HOLDFAST_TARGET_INLINE Sight see(const BundleView& view, std::size_t entry, const double* point) {
  Sight sight;
  const std::int32_t* pose = view.pose + entry;
  const double* p[lanes];
  for (std::size_t i = 0; i < lanes; ++i) p[i] = view.poses + pose_size * static_cast<std::size_t>(pose[i]);
  const Vector world[3] = {fill(point[0]), fill(point[1]), fill(point[2])};
  Vector camera[3];
  for (std::size_t row = 0; row < 3; ++row) {
    Vector a = load(p[0] + 4 * row), b = load(p[1] + 4 * row), c = load(p[2] + 4 * row), d = load(p[3] + 4 * row);
    transpose(a, b, c, d);
    sight.rotation[row][0] = a, sight.rotation[row][1] = b, sight.rotation[row][2] = c;
    camera[row] = a * world[0] + b * world[1] + c * world[2] + d;
  }
  sight.in_front = camera[2] > fill(geometry::minimum_depth);
  sight.x = camera[0], sight.y = camera[1];
  sight.z = choose(sight.in_front, camera[2], fill(1.0));
  sight.inverse_z = fill(1.0) / sight.z;

  const Vector right_x = load(view.right_x + entry);
  sight.has_right = right_x == right_x;
  const Vector column = fill(view.fx) * sight.x * sight.inverse_z + fill(view.cx);
  const Vector shift = fill(view.fx * view.baseline) * sight.inverse_z;
  sight.residual[0] = column - load(view.x + entry);
  sight.residual[1] = fill(view.fy) * sight.y * sight.inverse_z + fill(view.cy) - load(view.y + entry);
  sight.residual[2] = choose(sight.has_right, column - shift - right_x, fill(0.0));

  sight.disparity = (sight.residual[0] - sight.residual[2]) * fill(view.disparity_scale);
  sight.disparity = choose(sight.has_right, sight.disparity, fill(0.0));
  const Vector disparity2 = sight.disparity * sight.disparity, disparity_limit = fill(view.disparity_limit);
  const Mask wrong_depth = disparity2 > disparity_limit;
  sight.disparity_slope = square_root(choose(wrong_depth, disparity_limit / choose(wrong_depth, disparity2, fill(1.0)),
                                             fill(1.0)));
  const Vector disparity_cost =
      choose(wrong_depth, fill(2.0) * sight.disparity_slope * disparity2 - disparity_limit, disparity2);

  sight.weight = load(view.weight + entry);
  sight.scale2 = load(view.inverse_sigma2 + entry) * sight.weight;
  sight.limit = choose(sight.has_right, fill(view.chi_square_3d), fill(view.chi_square_2d)) * sight.weight;
  // Behind the camera the residual is large and constant, so that steps that push points there are refused.
  const Vector behind = choose(sight.has_right, fill(3.0 * 900.0), fill(2.0 * 900.0));
  const Vector squared = sight.residual[0] * sight.residual[0] + sight.residual[1] * sight.residual[1];
  sight.squared = choose(sight.in_front, squared * sight.scale2 + disparity_cost * sight.weight, behind * sight.scale2);
  return sight;
}

/// Derivative of Huber's cost by the squared residual: 1 below the limit.
HOLDFAST_TARGET_INLINE Vector huber_slope(const BundleView& view, const Sight& sight) {
  if (!view.is_robust) return fill(1.0);
  const Mask beyond = sight.squared > sight.limit;
  return square_root(choose(beyond, sight.limit / choose(beyond, sight.squared, fill(1.0)), fill(1.0)));
}

HOLDFAST_TARGET double cost(const BundleView& view, double* chi_squares) {
  Vector total = fill(0.0);
  for (std::size_t point = 0; point < view.point_count; ++point) {
    for (std::size_t group = view.first_group[point]; group < view.first_group[point + 1]; ++group) {
      const Sight sight = see(view, lanes * group, view.points + 3 * point);
      if (view.is_robust) {
        const Vector linear = fill(2.0) * huber_slope(view, sight) * sight.squared - sight.limit;
        total += choose(sight.squared > sight.limit, linear, sight.squared);
      } else {
        total += sight.squared;
      }
      if (chi_squares == nullptr) continue;
      const Vector squared = sight.residual[0] * sight.residual[0] + sight.residual[1] * sight.residual[1] +
                             sight.residual[2] * sight.residual[2];
      store(chi_squares + lanes * group,
            choose(sight.in_front, squared * load(view.inverse_sigma2 + lanes * group),
                   fill(std::numeric_limits<double>::infinity())));
    }
  }
  return 0.5 * sum(total);
}

/// The derivatives of four observations' residuals, scaled by the square roots of their weights. Rows of the camera:
/// (a, 0, au), (0, b, bv), (0, 0, d) by translation, followed by three numbers each by rotation.
struct Derivatives {
  Vector residual[3];
  Vector by_point[3][3];
  Vector a, au, b, bv, d;
  Vector turn[3][3];
};
static_assert(sizeof(Derivatives) == sizeof(Scratch) && alignof(Derivatives) <= alignof(Scratch));

HOLDFAST_TARGET_INLINE void linearise(const BundleView& view, const Sight& sight, bool with_camera, Derivatives& out) {
  const Vector zero = fill(0.0);
  const Vector slope = huber_slope(view, sight);
  const Vector weight = choose(sight.in_front, square_root(sight.scale2 * slope), zero);  // of the pixel's residuals
  const Vector disparity_weight =
      choose(sight.in_front & sight.has_right, square_root(sight.weight * slope * sight.disparity_slope), zero);
  out.residual[0] = weight * sight.residual[0], out.residual[1] = weight * sight.residual[1];
  out.residual[2] = disparity_weight * sight.disparity;
  const Vector u = sight.x * sight.inverse_z, v = sight.y * sight.inverse_z;
  out.a = weight * fill(view.fx) * sight.inverse_z;
  out.b = weight * fill(view.fy) * sight.inverse_z;
  out.au = -out.a * u;
  out.bv = -out.b * v;
  out.d = -disparity_weight * fill(view.disparity_scale * view.fx * view.baseline) * sight.inverse_z * sight.inverse_z;
  for (int i = 0; i < 3; ++i) {
    out.by_point[0][i] = out.a * sight.rotation[0][i] + out.au * sight.rotation[2][i];
    out.by_point[1][i] = out.b * sight.rotation[1][i] + out.bv * sight.rotation[2][i];
    out.by_point[2][i] = out.d * sight.rotation[2][i];
  }
  if (!with_camera) return;
  // The derivative by a left rotation is the point in the camera frame cross the row by translation.
  out.turn[0][0] = sight.y * out.au;
  out.turn[0][1] = sight.z * out.a - sight.x * out.au;
  out.turn[0][2] = -sight.y * out.a;
  out.turn[1][0] = sight.y * out.bv - sight.z * out.b;
  out.turn[1][1] = -sight.x * out.bv;
  out.turn[1][2] = sight.x * out.b;
  out.turn[2][0] = sight.y * out.d;
  out.turn[2][1] = -sight.x * out.d;
  out.turn[2][2] = zero;
}

/// Rows of a 6 x 3 matrix in the pattern in which a block's elements, column by column, need them.
struct RowPattern {
  Vector part[3][3];
};
HOLDFAST_TARGET_INLINE RowPattern rows_of(const double* columns) {
  RowPattern pattern;
  for (int k = 0; k < 3; ++k) {
    const double* c = columns + 6 * k;
    pattern.part[k][0] = load(c);
    pattern.part[k][1] = Vector{c[4], c[5], c[0], c[1]};
    pattern.part[k][2] = load(c + 2);
  }
  return pattern;
}

/// block + sign * rows * columns^T of two 6 x 3 matrices.
template <bool subtracts>
HOLDFAST_TARGET_INLINE void add_product(const RowPattern& rows, const double* columns, double* block) {
  for (int pair = 0; pair < 3; ++pair) {  // two columns of the block
    Vector part[3];
    for (int k = 0; k < 3; ++k) {
      const Vector first = fill(columns[6 * k + 2 * pair]), second = fill(columns[6 * k + 2 * pair + 1]);
      const Vector mixed = __builtin_shufflevector(first, second, 0, 1, 6, 7);
      if (k == 0) {
        part[0] = rows.part[k][0] * first, part[1] = rows.part[k][1] * mixed, part[2] = rows.part[k][2] * second;
      } else {
        part[0] += rows.part[k][0] * first, part[1] += rows.part[k][1] * mixed, part[2] += rows.part[k][2] * second;
      }
    }
    double* target = block + 12 * pair;
    for (int i = 0; i < 3; ++i)
      store(target + 4 * i, subtracts ? load(target + 4 * i) - part[i] : load(target + 4 * i) + part[i]);
  }
}

/// Inverse of the Cholesky factor of a damped 3 x 3 Hessian (00 10 11 20 21 22 in and out). Directions without
/// information are left out.
HOLDFAST_TARGET_INLINE void invert_factor(double* h) {
  const auto inverse_root = [](double pivot, double diagonal) {
    return pivot > 1e-14 * diagonal ? 1.0 / std::sqrt(pivot) : 0.0;
  };
  const double i00 = inverse_root(h[0], h[0]);
  const double l10 = h[1] * i00, l20 = h[3] * i00;
  const double i11 = inverse_root(h[2] - l10 * l10, h[2]);
  const double l21 = (h[4] - l20 * l10) * i11;
  const double i22 = inverse_root(h[5] - l20 * l20 - l21 * l21, h[5]);
  h[0] = i00;
  h[1] = -i11 * l10 * i00;
  h[2] = i11;
  h[3] = -i22 * (l20 * i00 + l21 * h[1]);
  h[4] = -i22 * l21 * i11;
  h[5] = i22;
}

/// Linearises the observations of a point, and factorises its Hessian.
HOLDFAST_TARGET_INLINE void linearise_point(const BundleView& view, std::size_t point, double damping,
                                            Derivatives* derivatives, double* elimination) {
  const std::size_t begin = view.first_group[point], end = view.first_group[point + 1];
  const std::size_t free_groups = (view.first_coupling[point + 1] - view.first_coupling[point] + lanes - 1) / lanes;
  Vector hessian[6], gradient[3];
  for (Vector& v : hessian) v = fill(0.0);
  for (Vector& v : gradient) v = fill(0.0);
  for (std::size_t group = begin; group < end; ++group) {
    Derivatives& d = derivatives[group - begin];
    linearise(view, see(view, lanes * group, view.points + 3 * point), group - begin < free_groups, d);
    for (int row = 0; row < 3; ++row) {
      const Vector* j = d.by_point[row];
      hessian[0] += j[0] * j[0], hessian[1] += j[1] * j[0], hessian[2] += j[1] * j[1];
      hessian[3] += j[2] * j[0], hessian[4] += j[2] * j[1], hessian[5] += j[2] * j[2];
      for (int i = 0; i < 3; ++i) gradient[i] += j[i] * d.residual[row];
    }
  }
  double* factor = elimination;
  for (int i = 0; i < 6; ++i) factor[i] = sum(hessian[i]);
  constexpr int diagonal[3] = {0, 2, 5};
  for (int i = 0; i < 3; ++i) {
    elimination[9 + i] = damping * std::clamp(factor[diagonal[i]], 1e-6, 1e32);
    factor[diagonal[i]] += elimination[9 + i];
  }
  invert_factor(factor);
  const double g[3] = {sum(gradient[0]), sum(gradient[1]), sum(gradient[2])};
  elimination[6] = factor[0] * g[0];
  elimination[7] = factor[1] * g[0] + factor[2] * g[1];
  elimination[8] = factor[3] * g[0] + factor[4] * g[1] + factor[5] * g[2];
}

/// Writes vectors[0..4*count) of four observations as rows of 4 * count numbers, one per observation.
template <int count>
HOLDFAST_TARGET_INLINE void store_rows(const Vector* vectors, double* rows, std::size_t row_count) {
  for (int i = 0; i < count; ++i) {
    Vector a = vectors[4 * i], b = vectors[4 * i + 1], c = vectors[4 * i + 2], d = vectors[4 * i + 3];
    transpose(a, b, c, d);
    const Vector row[4] = {a, b, c, d};
    for (std::size_t k = 0; k < row_count; ++k) store(rows + static_cast<std::size_t>(4 * count) * k + 4 * i, row[k]);
  }
}

/// The three rows of derivatives by the camera, transposed, times a vector of three: six numbers.
HOLDFAST_TARGET_INLINE void by_camera(const Derivatives& d, Vector first, Vector second, Vector third, Vector* six) {
  six[0] = d.a * first;
  six[1] = d.b * second;
  six[2] = d.au * first + d.bv * second + d.d * third;
  for (int i = 0; i < 3; ++i) six[3 + i] = d.turn[0][i] * first + d.turn[1][i] * second + d.turn[2][i] * third;
}

/// The free observations of a group: their couplings, and their part in the Hessians and gradients of their cameras.
HOLDFAST_TARGET_INLINE void add_cameras(const Derivatives& d, const double* elimination, const std::int32_t* pose,
                                        std::size_t count, double* couplings, double* cameras) {
  const double* inverse = elimination;
  Vector reduced[3][3];  // derivatives by the point, times the transposed inverse factor
  for (int row = 0; row < 3; ++row) {
    const Vector* j = d.by_point[row];
    reduced[row][0] = j[0] * fill(inverse[0]);
    reduced[row][1] = j[0] * fill(inverse[1]) + j[1] * fill(inverse[2]);
    reduced[row][2] = j[0] * fill(inverse[3]) + j[1] * fill(inverse[4]) + j[2] * fill(inverse[5]);
  }
  Vector coupling[20];
  for (int k = 0; k < 3; ++k) by_camera(d, reduced[0][k], reduced[1][k], reduced[2][k], coupling + 6 * k);
  coupling[18] = coupling[19] = fill(0.0);
  store_rows<5>(coupling, couplings, count);

  Vector gradient[12];
  by_camera(d, d.residual[0], d.residual[1], d.residual[2], gradient);
  for (int i = 0; i < 6; ++i)
    gradient[6 + i] = gradient[i] - (coupling[i] * fill(elimination[6]) + coupling[6 + i] * fill(elimination[7]) +
                                     coupling[12 + i] * fill(elimination[8]));
  double gradients[lanes * 12];
  store_rows<3>(gradient, gradients, lanes);

  const Vector zero = fill(0.0);
  const Vector rows[20] = {d.a,  zero,         d.au,         d.turn[0][0], d.turn[0][1], d.turn[0][2], zero,
                           d.b,  d.bv,         d.turn[1][0], d.turn[1][1], d.turn[1][2], zero,         zero,
                           d.d,  d.turn[2][0], d.turn[2][1], d.turn[2][2], zero,         zero};
  double jacobians[lanes * 20];
  store_rows<5>(rows, jacobians, lanes);
  for (std::size_t i = 0; i < count; ++i) {
    double* camera = cameras + camera_size * static_cast<std::size_t>(pose[i]);
    add_product<false>(rows_of(jacobians + 20 * i), jacobians + 20 * i, camera);
    for (int k = 0; k < 3; ++k)
      store(camera + block_size + 4 * k, load(camera + block_size + 4 * k) + load(gradients + 12 * i + 4 * k));
  }
}

HOLDFAST_TARGET void eliminate(const BundleView& view, double damping, const BundleSystem& system) {
  Derivatives* derivatives = reinterpret_cast<Derivatives*>(system.scratch);
  for (std::size_t point = 0; point < view.point_count; ++point) {
    double* elimination = system.points + elimination_size * point;
    linearise_point(view, point, damping, derivatives, elimination);
    const std::size_t count = view.first_coupling[point + 1] - view.first_coupling[point];
    const std::int32_t* pose = view.pose + lanes * view.first_group[point];
    double* couplings = system.couplings + coupling_size * view.first_coupling[point];
    for (std::size_t begin = 0; begin < count; begin += lanes)
      add_cameras(derivatives[begin / lanes], elimination, pose + begin, std::min(lanes, count - begin),
                  couplings + coupling_size * begin, system.cameras);
    const std::uint32_t* block = system.pair_block + view.first_pair[point];
    for (std::size_t a = 0; a < count; ++a) {
      const RowPattern rows = rows_of(couplings + coupling_size * a);
      for (std::size_t b = 0; b <= a; ++b) {
        double* target = system.blocks + block_size * *block++;
        add_product<true>(rows, couplings + coupling_size * b, target);
        // A camera that sees the point twice: the block of the diagonal takes both products.
        if (pose[a] == pose[b] && a != b)
          add_product<true>(rows_of(couplings + coupling_size * b), couplings + coupling_size * a, target);
      }
    }
  }
}

HOLDFAST_TARGET double substitute(const BundleView& view, const BundleSystem& system, const double* steps,
                                  double* points) {
  double decrease = 0.0;
  for (std::size_t point = 0; point < view.point_count; ++point) {
    const double* elimination = system.points + elimination_size * point;
    const std::int32_t* pose = view.pose + lanes * view.first_group[point];
    Vector total[5];
    for (Vector& v : total) v = fill(0.0);
    const std::size_t begin = view.first_coupling[point], end = view.first_coupling[point + 1];
    for (std::size_t i = begin; i < end; ++i) {
      const double* coupling = system.couplings + coupling_size * i;
      const double* step = steps + coupling_size * static_cast<std::size_t>(pose[i - begin]);
      for (int k = 0; k < 5; ++k) total[k] += load(coupling + 4 * k) * load(step + 4 * k);
    }
    double sums[20];
    for (int k = 0; k < 5; ++k) store(sums + 4 * k, total[k]);
    double e[3];
    for (int k = 0; k < 3; ++k) {
      const double* s = sums + 6 * k;
      e[k] = elimination[6 + k] + (((s[0] + s[1]) + (s[2] + s[3])) + (s[4] + s[5]));
    }
    const double* inverse = elimination;
    const double step[3] = {-(inverse[0] * e[0] + inverse[1] * e[1] + inverse[3] * e[2]),
                            -(inverse[2] * e[1] + inverse[4] * e[2]), -(inverse[5] * e[2])};
    for (int k = 0; k < 3; ++k) {
      points[3 * point + k] = view.points[3 * point + k] + step[k];
      decrease += elimination[6 + k] * e[k] + elimination[9 + k] * step[k] * step[k];
    }
  }
  return 0.5 * decrease;
}

}  // namespace
}  // namespace holdfast::schur_plugin
