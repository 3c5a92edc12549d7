// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "holdfast/optical_flow/point_flow.hpp"

/// follow_points() for each set of instructions; all give the same bits.
namespace holdfast::point_flow {

void follow_scalar(const ImagePyramid& from, const ImagePyramid& to, const PointFlowSettings& settings,
                   PointFlow& flow);
#if defined(__x86_64__)
void follow_sse4(const ImagePyramid& from, const ImagePyramid& to, const PointFlowSettings& settings, PointFlow& flow);
void follow_avx2(const ImagePyramid& from, const ImagePyramid& to, const PointFlowSettings& settings, PointFlow& flow);
#endif

}  // namespace holdfast::point_flow
