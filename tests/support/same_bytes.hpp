// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <opencv2/core/mat.hpp>

namespace holdfast::test {

/// Whether two images of unbroken memory have size, type and every byte in common.
inline bool same_bytes(const cv::Mat& a, const cv::Mat& b) {
  if (a.size() != b.size() || a.type() != b.type() || !a.isContinuous() || !b.isContinuous()) return false;
  return std::equal(a.datastart, a.dataend, b.datastart);
}

}  // namespace holdfast::test
