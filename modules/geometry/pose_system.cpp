// SPDX-License-Identifier: BSD-3-Clause
#include "pose_system.hpp"

#include <cmath>
#include <limits>

#include "holdfast/core/error.hpp"
#include "holdfast/core/simd.hpp"
#include "holdfast/geometry/pose_adjustment.hpp"

namespace holdfast::geometry {
namespace {

/// What a point behind the camera costs, in units of its limit: more than any residual that matters, so that a step
/// which pushes points through the camera is refused.
constexpr double behind_cost = 100.0;

/// A residual e = projection - measurement has the Jacobian row (a, p x a) for the perturbation, with a its derivative
/// by the point p in the camera frame. With M = sum of information * a a^T over the rows of one observation, the blocks
/// of the Hessian are M, M C and C^T M C with C = -hat(p): rows p x m_i, then columns p x n_j. M(0,1) is zero.
struct alignas(32) Sums {
  Batch tt00, tt02, tt11, tt12, tt22;
  Batch tr00, tr01, tr02, tr10, tr11, tr12, tr20, tr21, tr22;
  Batch rr00, rr01, rr02, rr11, rr12, rr22;
  Batch gt0, gt1, gt2, gr0, gr1, gr2;
  Batch cost;
};

template <bool robust>
[[gnu::always_inline]] inline void accumulate(const std::vector<ObservationBatch>& batches, const PoseView& view,
                                              Sums& sums) {
  const double* r = view.rotation;
  const double* t = view.translation;
  const Batch one = Batch{} + 1.0;
  Sums s{};
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
    const Batch error_right = fx_x + view.cx - shift - o.right_x;
    const Batch chi =
        o.information * (error_x * error_x + error_y * error_y) + o.information_right * (error_right * error_right);
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
    const Batch w_right = weight * o.information_right;
    const Batch a2 = -fx_x * inverse_z;
    const Batch c2 = -fy_y * inverse_z;
    const Batch right2 = a2 + shift * inverse_z;
    const Batch m00 = (w + w_right) * a * a;
    const Batch m02 = a * (w * a2 + w_right * right2);
    const Batch m11 = w * c * c;
    const Batch m12 = w * c * c2;
    const Batch m22 = w * (a2 * a2 + c2 * c2) + w_right * right2 * right2;
    const Batch g0 = a * (w * error_x + w_right * error_right);
    const Batch g1 = c * w * error_y;
    const Batch g2 = w * (a2 * error_x + c2 * error_y) + w_right * right2 * error_right;
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
// Without FMA, and with the same lanes, AVX2 gives the same bits as the baseline.
__attribute__((target("avx2"))) void accumulate_avx2(const std::vector<ObservationBatch>& batches, const PoseView& view,
                                                     bool robust, Sums& sums) {
  robust ? accumulate<true>(batches, view, sums) : accumulate<false>(batches, view, sums);
}
__attribute__((target("avx2"))) void chi_squares_avx2(std::vector<ObservationBatch>& batches, const PoseView& view) {
  chi_squares_inline(batches, view);
}
#endif

void accumulate_baseline(const std::vector<ObservationBatch>& batches, const PoseView& view, bool robust, Sums& sums) {
  robust ? accumulate<true>(batches, view, sums) : accumulate<false>(batches, view, sums);
}

double sum(const Batch& batch) { return (batch[0] + batch[1]) + (batch[2] + batch[3]); }

}  // namespace

void check_pose_problem(const PoseProblem& problem) {
  const std::size_t size = problem.size();
  HOLDFAST_CHECK(problem.camera != nullptr, "a pose problem needs a camera");
  HOLDFAST_CHECK(problem.x.size() == size && problem.y.size() == size && problem.right_x.size() == size &&
                     problem.inverse_sigma2.size() == size && problem.weight.size() == size,
                 "points " << size << " x " << problem.x.size() << " y " << problem.y.size() << " right_x "
                           << problem.right_x.size() << " inverse_sigma2 " << problem.inverse_sigma2.size()
                           << " weight " << problem.weight.size());
}

PoseView::PoseView(const Camera& camera, const Eigen::Isometry3d& T_camera_world)
    : fx(camera.fx), fy(camera.fy), cx(camera.cx), cy(camera.cy), fx_baseline(camera.fx * camera.baseline) {
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) rotation[3 * row + column] = T_camera_world(row, column);
    translation[row] = T_camera_world(row, 3);
  }
}

void build_system(const std::vector<ObservationBatch>& batches, const PoseView& view, bool robust, PoseSystem& system) {
  Sums s;
#if defined(__x86_64__)
  if (simd_level() >= SimdLevel::avx2)
    accumulate_avx2(batches, view, robust, s);
  else
#endif
    accumulate_baseline(batches, view, robust, s);

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

void chi_squares(std::vector<ObservationBatch>& batches, const PoseView& view) {
#if defined(__x86_64__)
  if (simd_level() >= SimdLevel::avx2) {
    chi_squares_avx2(batches, view);
    return;
  }
#endif
  chi_squares_inline(batches, view);
}

}  // namespace holdfast::geometry
