// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "holdfast/core/simd.hpp"
#include "holdfast/geometry/pinhole.hpp"
#include "holdfast/geometry/pose_problem.hpp"
#include "holdfast/geometry/se3.hpp"

/// The arithmetic of adjust_pose(): residuals and normal equations of four observations at a time, with AVX2 where the
/// processor has it. Needs the vector extensions of GCC or Clang.
namespace holdfast::geometry::detail {

/// Four observations side by side. The width is fixed, so that sums have the same order on every processor.
using Batch = double __attribute__((vector_size(32)));
inline constexpr std::size_t batch_size = 4;

/// Four observations of a pose problem, ready for arithmetic. An observation that cannot be used has information and
/// weight 0. The alignment is explicit because the baseline compiler would take 16 bytes and the AVX2 kernel needs 32.
struct alignas(32) ObservationBatch {
  Batch point_x, point_y, point_z;  ///< world [m]
  Batch x, y, right_x;              ///< [px]
  Batch information;                ///< of x and y [1/px^2]
  Batch information_right;          ///< of right_x in the chi-square test, 0 where there is none
  Batch information_disparity;      ///< of x - right_x in the cost, 0 where there is none
  Batch limit;                      ///< chi-square limit, and square of Huber's threshold
  Batch full_weight;                ///< weight of the observation's cost as an inlier
  Batch weight;                     ///< full_weight, or 0 in a round in which the observation is an outlier
  Batch chi_square;                 ///< by chi_squares()
};

/// The normal equations of a left perturbation (translation, rotation) of T_camera_world.
struct PoseSystem {
  Matrix6d hessian;
  Vector6d gradient;
  double cost = 0.0;  ///< half the weighted sum of (robust) squared residuals
};

/// Camera and pose in the layout of the kernels.
struct PoseView {
  PoseView(const Pinhole& camera, const Eigen::Isometry3d& T_camera_world)
      : fx(camera.fx), fy(camera.fy), cx(camera.cx), cy(camera.cy), fx_baseline(camera.fx * camera.baseline) {
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column) rotation[3 * row + column] = T_camera_world(row, column);
      translation[row] = T_camera_world(row, 3);
    }
  }
  double rotation[9];  ///< row by row
  double translation[3];
  double fx, fy, cx, cy, fx_baseline;
};

/// Cost of a point behind the camera, in units of the chi-square limit. Large, so that steps that move points behind
/// the camera are rejected.
inline constexpr double behind_cost = 100.0;

/// Sums over all observations of the blocks of the Hessian (t: translation, r: rotation), of the gradient and of the
/// cost.
///
/// A residual e = projection - measurement has the Jacobian row (a, p x a) for the perturbation, where a is its
/// derivative by the point p in the camera frame. With M = sum of information * a a^T over the rows of one observation,
/// the blocks of the Hessian are M, M C and C^T M C with C = -hat(p): rows p x m_i, then columns p x n_j. M(0,1) is 0.
struct alignas(32) NormalEquationSums {
  Batch tt00, tt02, tt11, tt12, tt22;
  Batch tr00, tr01, tr02, tr10, tr11, tr12, tr20, tr21, tr22;
  Batch rr00, rr01, rr02, rr11, rr12, rr22;
  Batch gt0, gt1, gt2, gr0, gr1, gr2;
  Batch cost;
};

template <bool robust>
[[gnu::always_inline]] inline void accumulate(const std::vector<ObservationBatch>& batches, const PoseView& view,
                                              double disparity_limit, NormalEquationSums& sums) {
  const double* r = view.rotation;
  const double* t = view.translation;
  const Batch one = Batch{} + 1.0;
  NormalEquationSums s{};
  for (const ObservationBatch& o : batches) {
    const Batch x = r[0] * o.point_x + r[1] * o.point_y + r[2] * o.point_z + t[0];
    const Batch y = r[3] * o.point_x + r[4] * o.point_y + r[5] * o.point_z + t[1];
    const Batch z = r[6] * o.point_x + r[7] * o.point_y + r[8] * o.point_z + t[2];
    const auto in_front = z > minimum_depth;
    const Batch inverse_z = one / (in_front ? z : one);
    const Batch a = view.fx * inverse_z;
    const Batch c = view.fy * inverse_z;
    const Batch fx_x = a * x;
    const Batch fy_y = c * y;
    const Batch shift = view.fx_baseline * inverse_z;
    const Batch error_x = fx_x + view.cx - o.x;
    const Batch error_y = fy_y + view.cy - o.y;
    const Batch error_disparity = shift - (o.x - o.right_x);
    const Batch chi_disparity = o.information_disparity * (error_disparity * error_disparity);
    const auto wrong_depth = chi_disparity > disparity_limit;
    const Batch disparity_ratio = wrong_depth ? disparity_limit / chi_disparity : one;
    Batch disparity_scale;
    for (std::size_t k = 0; k < batch_size; ++k) disparity_scale[k] = std::sqrt(disparity_ratio[k]);
    const Batch disparity_cost = wrong_depth ? 2.0 * chi_disparity * disparity_scale - disparity_limit : chi_disparity;
    const Batch chi = o.information * (error_x * error_x + error_y * error_y) + disparity_cost;
    Batch weight = in_front ? o.weight : Batch{};
    Batch cost = chi;
    if constexpr (robust) {
      const auto beyond = chi > o.limit;
      const Batch ratio = beyond ? o.limit / chi : one;
      Batch scale;
      for (std::size_t k = 0; k < batch_size; ++k) scale[k] = std::sqrt(ratio[k]);
      cost = beyond ? 2.0 * chi * scale - o.limit : chi;
      weight *= scale;
    }
    s.cost += o.weight * (in_front ? cost : behind_cost * o.limit);

    const Batch w = weight * o.information;
    const Batch w_disparity = weight * o.information_disparity * disparity_scale;
    const Batch a2 = -fx_x * inverse_z;
    const Batch c2 = -fy_y * inverse_z;
    const Batch disparity2 = -shift * inverse_z;
    const Batch m00 = w * a * a;
    const Batch m02 = a * (w * a2);
    const Batch m11 = w * c * c;
    const Batch m12 = w * c * c2;
    const Batch m22 = w * (a2 * a2 + c2 * c2) + w_disparity * disparity2 * disparity2;
    const Batch g0 = a * (w * error_x);
    const Batch g1 = c * w * error_y;
    const Batch g2 = w * (a2 * error_x + c2 * error_y) + w_disparity * disparity2 * error_disparity;
    s.tt00 += m00, s.tt02 += m02, s.tt11 += m11, s.tt12 += m12, s.tt22 += m22;
    s.gt0 += g0, s.gt1 += g1, s.gt2 += g2;
    s.gr0 += y * g2 - z * g1, s.gr1 += z * g0 - x * g2, s.gr2 += x * g1 - y * g0;
    const Batch n00 = y * m02, n01 = z * m00 - x * m02, n02 = -y * m00;
    const Batch n10 = y * m12 - z * m11, n11 = -x * m12, n12 = x * m11;
    const Batch n20 = y * m22 - z * m12, n21 = z * m02 - x * m22, n22 = x * m12 - y * m02;
    s.tr00 += n00, s.tr01 += n01, s.tr02 += n02;
    s.tr10 += n10, s.tr11 += n11, s.tr12 += n12;
    s.tr20 += n20, s.tr21 += n21, s.tr22 += n22;
    s.rr00 += y * n20 - z * n10, s.rr01 += y * n21 - z * n11, s.rr02 += y * n22 - z * n12;
    s.rr11 += z * n01 - x * n21, s.rr12 += z * n02 - x * n22;
    s.rr22 += x * n12 - y * n02;
  }
  sums = s;
}

[[gnu::always_inline]] inline void chi_squares_inline(std::vector<ObservationBatch>& batches, const PoseView& view) {
  const double* r = view.rotation;
  const double* t = view.translation;
  const Batch one = Batch{} + 1.0;
  const Batch infinite = Batch{} + std::numeric_limits<double>::infinity();
  for (ObservationBatch& o : batches) {
    const Batch x = r[0] * o.point_x + r[1] * o.point_y + r[2] * o.point_z + t[0];
    const Batch y = r[3] * o.point_x + r[4] * o.point_y + r[5] * o.point_z + t[1];
    const Batch z = r[6] * o.point_x + r[7] * o.point_y + r[8] * o.point_z + t[2];
    const auto in_front = z > minimum_depth;
    const Batch inverse_z = one / (in_front ? z : one);
    const Batch column = view.fx * inverse_z * x + view.cx;
    const Batch error_x = column - o.x;
    const Batch error_y = view.fy * inverse_z * y + view.cy - o.y;
    const Batch error_right = column - view.fx_baseline * inverse_z - o.right_x;
    const Batch chi =
        o.information * (error_x * error_x + error_y * error_y) + o.information_right * (error_right * error_right);
    o.chi_square = in_front ? chi : infinite;
  }
}

#if defined(__x86_64__)
// With the same lanes and without fused multiply-add, AVX2 gives the same bits as the baseline.
__attribute__((target("avx2"))) inline void accumulate_avx2(const std::vector<ObservationBatch>& batches,
                                                            const PoseView& view, double disparity_limit, bool robust,
                                                            NormalEquationSums& sums) {
  robust ? accumulate<true>(batches, view, disparity_limit, sums)
         : accumulate<false>(batches, view, disparity_limit, sums);
}
__attribute__((target("avx2"))) inline void chi_squares_avx2(std::vector<ObservationBatch>& batches,
                                                             const PoseView& view) {
  chi_squares_inline(batches, view);
}
#endif

inline void accumulate_baseline(const std::vector<ObservationBatch>& batches, const PoseView& view,
                                double disparity_limit, bool robust, NormalEquationSums& sums) {
  robust ? accumulate<true>(batches, view, disparity_limit, sums)
         : accumulate<false>(batches, view, disparity_limit, sums);
}

inline double sum(const Batch& batch) { return (batch[0] + batch[1]) + (batch[2] + batch[3]); }

/// Builds the normal equations; Jacobians in closed form. `robust`: Huber's cost, else plain squares. The cost of the
/// disparity alone is always Huber's, with the squared threshold `disparity_limit`.
inline void build_system(const std::vector<ObservationBatch>& batches, const PoseView& view, double disparity_limit,
                         bool robust, PoseSystem& system) {
  NormalEquationSums s;
#if defined(__x86_64__)
  if (simd_level() >= SimdLevel::avx2)
    accumulate_avx2(batches, view, disparity_limit, robust, s);
  else
#endif
    accumulate_baseline(batches, view, disparity_limit, robust, s);

  Matrix6d& h = system.hessian;
  h(0, 0) = sum(s.tt00), h(0, 1) = 0.0, h(0, 2) = sum(s.tt02);
  h(1, 1) = sum(s.tt11), h(1, 2) = sum(s.tt12), h(2, 2) = sum(s.tt22);
  h(0, 3) = sum(s.tr00), h(0, 4) = sum(s.tr01), h(0, 5) = sum(s.tr02);
  h(1, 3) = sum(s.tr10), h(1, 4) = sum(s.tr11), h(1, 5) = sum(s.tr12);
  h(2, 3) = sum(s.tr20), h(2, 4) = sum(s.tr21), h(2, 5) = sum(s.tr22);
  h(3, 3) = sum(s.rr00), h(3, 4) = sum(s.rr01), h(3, 5) = sum(s.rr02);
  h(4, 4) = sum(s.rr11), h(4, 5) = sum(s.rr12), h(5, 5) = sum(s.rr22);
  for (int row = 1; row < 6; ++row)
    for (int column = 0; column < row; ++column) h(row, column) = h(column, row);
  system.gradient << sum(s.gt0), sum(s.gt1), sum(s.gt2), sum(s.gr0), sum(s.gr1), sum(s.gr2);
  system.cost = 0.5 * sum(s.cost);
}

/// Fills chi_square: squared residuals times information; infinite behind the camera.
inline void chi_squares(std::vector<ObservationBatch>& batches, const PoseView& view) {
#if defined(__x86_64__)
  if (simd_level() >= SimdLevel::avx2) {
    chi_squares_avx2(batches, view);
    return;
  }
#endif
  chi_squares_inline(batches, view);
}

}  // namespace holdfast::geometry::detail
