// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "holdfast/optical_flow/point_flow.hpp"

/// follow_points() for each set of instructions; all give the same bits.
namespace holdfast::point_flow {

inline constexpr int window = 8;  ///< pixels, both ways
/// One row of the window. The width is fixed, so that sums have the same order whatever the processor offers.
using Row = float __attribute__((vector_size(4 * window)));

void follow_scalar(const ImagePyramid& from, const ImagePyramid& to, const PointFlowSettings& settings,
                   PointFlow& flow);
#if defined(__x86_64__)
void follow_sse4(const ImagePyramid& from, const ImagePyramid& to, const PointFlowSettings& settings, PointFlow& flow);
void follow_avx2(const ImagePyramid& from, const ImagePyramid& to, const PointFlowSettings& settings, PointFlow& flow);
#elif defined(__aarch64__)
void follow_neon(const ImagePyramid& from, const ImagePyramid& to, const PointFlowSettings& settings, PointFlow& flow);
#endif

}  // namespace holdfast::point_flow
