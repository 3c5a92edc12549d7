// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/optical_flow/point_flow.hpp"

#include "follow.hpp"
#include "holdfast/core/check.hpp"

namespace holdfast {

void PointFlow::resize(std::size_t count) {
  for (std::vector<float>* values : {&from_x, &from_y, &to_x, &to_y}) values->resize(count);
  found.resize(count);
}

void follow_points(const ImagePyramid& from, const ImagePyramid& to, const PointFlowSettings& settings, PointFlow& flow,
                   SimdLevel simd) {
  HOLDFAST_CHECK(from.size() == to.size(), "images of " << from.size().width << " x " << from.size().height << " and "
                                                        << to.size().width << " x " << to.size().height << " px");
#if defined(__x86_64__)
  if (simd >= SimdLevel::avx2) return point_flow::follow_avx2(from, to, settings, flow);
  if (simd >= SimdLevel::sse4) return point_flow::follow_sse4(from, to, settings, flow);
#elif defined(__aarch64__)
  if (simd == SimdLevel::neon) return point_flow::follow_neon(from, to, settings, flow);
#endif
  point_flow::follow_scalar(from, to, settings, flow);
}

}  // namespace holdfast
