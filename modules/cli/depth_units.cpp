// SPDX-License-Identifier: BSD-3-Clause
#include "depth_units.hpp"

#include <algorithm>
#include <cmath>

namespace holdfast {

cv::Mat to_depth_units(const cv::Mat& depth, double factor) {
  cv::Mat units(depth.size(), CV_16UC1);
  for (int y = 0; y < depth.rows; ++y) {
    const auto* from = depth.ptr<float>(y);
    auto* to = units.ptr<std::uint16_t>(y);
    for (int x = 0; x < depth.cols; ++x) {
      const double value = from[x] * factor + 0.5;  // positive, so that the integer part is the nearest number
      to[x] = value < 65536.0 ? static_cast<std::uint16_t>(value) : 0;
    }
  }
  return units;
}

cv::Mat depth_of_units(const cv::Mat& units, double factor) {
  cv::Mat depth(units.size(), CV_32FC1);
  const auto convert = [&](auto divisor) {
    for (int y = 0; y < depth.rows; ++y) {
      const auto* from = units.ptr<std::uint16_t>(y);
      auto* to = depth.ptr<float>(y);
      for (int x = 0; x < depth.cols; ++x)
        to[x] = static_cast<float>(static_cast<decltype(divisor)>(from[x]) / divisor);
    }
  };
  // Arithmetic with floats is exact in this sense where the factor is one.
  if (const auto single = static_cast<float>(factor); single == factor)
    convert(single);
  else
    convert(factor);
  return depth;
}

double exact_depth_factor(const cv::Mat& depth, const std::vector<double>& factors) {
  const auto is_exact = [&](double factor) {
    return is_same_depth(depth_of_units(to_depth_units(depth, factor), factor), depth);
  };
  const auto found = std::find_if(factors.begin(), factors.end(), is_exact);
  return found == factors.end() ? 0.0 : *found;
}

bool is_same_depth(const cv::Mat& a, const cv::Mat& b) {
  for (int y = 0; y < a.rows; ++y)
    if (!std::equal(a.ptr<float>(y), a.ptr<float>(y) + a.cols, b.ptr<float>(y))) return false;
  return true;
}

}  // namespace holdfast
