// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>

#include "holdfast/core/simd.hpp"

/// The inner loops of bundle adjustment. Observations lie in groups of four of the same point, so that each vector
/// operation treats four observations; all levels compute the same sums in the same order, so that their results are
/// bit-identical.
namespace holdfast::schur_plugin {

inline constexpr std::size_t lanes = 4;
/// Doubles per pose: the rows of (rotation | translation) of T_camera_world.
inline constexpr std::size_t pose_size = 12;
/// Doubles per free observation in BundleSystem::couplings: three columns of six, and two zeros.
inline constexpr std::size_t coupling_size = 20;
/// Doubles per block of the reduced camera system: 6 x 6, column by column.
inline constexpr std::size_t block_size = 36;
/// Doubles per camera in BundleSystem::cameras: Hessian (36), gradient (6), reduced gradient (6).
inline constexpr std::size_t camera_size = 48;
/// Doubles per point in BundleSystem::points: inverse of the Cholesky factor (6: 00 10 11 20 21 22), that inverse times
/// the gradient (3), damping (3).
inline constexpr std::size_t elimination_size = 12;

/// The observations of a bundle in structure of arrays, and the state that they are evaluated at. Group g holds the
/// entries 4 g to 4 g + 3 of every array of observations. Within a point the observations of free poses come first, in
/// the order of their poses; entries that fill up the last group have the weight zero.
struct BundleView {
  double fx, fy, cx, cy;  ///< [px]
  double baseline;        ///< [m]
  double chi_square_2d, chi_square_3d;
  double disparity_scale;  ///< inverse of the standard deviation of a disparity [1/px]
  double disparity_limit;  ///< squared threshold of Huber's cost of the scaled disparity
  bool is_robust;          ///< Huber's cost instead of plain squares

  std::size_t point_count;
  const std::uint32_t* first_group;      ///< of each point; point_count + 1 entries
  const std::uint32_t* first_coupling;   ///< number of free observations before each point; point_count + 1 entries
  const std::size_t* first_pair;         ///< number of pairs of free observations before each point
  const float *x, *y;                    ///< undistorted [px]
  const float* right_x;                  ///< [px], NaN = none
  const float *inverse_sigma2, *weight;  ///< [1/px^2], 0 to 1
  const std::int32_t* pose;              ///< index into `poses`; free poses have the first indices
  const double* poses;                   ///< pose_size each
  const double* points;                  ///< three each, world [m]
};

/// Memory for the derivatives of one group.
struct alignas(32) Scratch {
  double numbers[26 * lanes];
};

/// Normal equations after the elimination of the points (Triggs et al. 2000, section 6.1), as sums over points.
struct BundleSystem {
  const std::uint32_t* pair_block;  ///< index of the block of each pair (a, b), b <= a, of free observations of a point
  double* blocks;                   ///< in and out: minus the sum of coupling * coupling^T
  double* cameras;                  ///< in and out
  double* couplings;                ///< out: coupling of camera and point, W L^-T, where the point's Hessian is L L^T
  double* points;                   ///< out
  Scratch* scratch;                 ///< as many as the point with most groups has
};

struct Kernels {
  /// Half the sum of robust squares. With `chi_squares`, writes the squared residual over its variance of every entry,
  /// weights left out; infinite behind the camera.
  double (*cost)(const BundleView& view, double* chi_squares);
  /// Adds up the system with each diagonal element d of the Hessian increased by damping * clamp(d, 1e-6, 1e32); that
  /// of the cameras is the caller's part.
  void (*eliminate)(const BundleView& view, double damping, const BundleSystem& system);
  /// Steps of the points for given steps of the free cameras, coupling_size numbers each: the six of the step in
  /// repetition. Writes the points after the step and returns the decrease of the cost that the points' part of the
  /// linearisation predicts.
  double (*substitute)(const BundleView& view, const BundleSystem& system, const double* steps, double* points);
};

/// The kernels of a level, which the processor must support.
const Kernels& kernels(SimdLevel level);

const Kernels& baseline_kernels();
#if defined(__x86_64__)
const Kernels& avx2_kernels();
#endif

}  // namespace holdfast::schur_plugin
