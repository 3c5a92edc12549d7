// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/tracking/undistortion_table.hpp"

#include <algorithm>

namespace holdfast {

UndistortionTable::UndistortionTable(const Camera& camera) : identity_(camera.distortion.is_zero()) {
  if (identity_) return;
  columns_ = camera.width / step + 2;
  rows_ = camera.height / step + 2;
  knots_.resize(static_cast<std::size_t>(columns_) * rows_ * 2);
  for (int row = 0; row < rows_; ++row)
    for (int column = 0; column < columns_; ++column) {
      const Eigen::Vector2d pixel =
          camera.undistort({static_cast<double>(column * step), static_cast<double>(row * step)});
      const std::size_t knot = (static_cast<std::size_t>(row) * columns_ + column) * 2;
      knots_[knot] = static_cast<float>(pixel.x());
      knots_[knot + 1] = static_cast<float>(pixel.y());
    }
}

void UndistortionTable::undistort(const std::vector<float>& x, const std::vector<float>& y, std::vector<float>& out_x,
                                  std::vector<float>& out_y) const {
  const std::size_t count = x.size();
  out_x.resize(count);
  out_y.resize(count);
  if (identity_) {
    std::copy(x.begin(), x.end(), out_x.begin());
    std::copy(y.begin(), y.end(), out_y.begin());
    return;
  }
  constexpr float inverse_step = 1.0F / step;
  for (std::size_t i = 0; i < count; ++i) {
    const float column = std::clamp(x[i] * inverse_step, 0.0F, static_cast<float>(columns_ - 2));
    const float row = std::clamp(y[i] * inverse_step, 0.0F, static_cast<float>(rows_ - 2));
    const int left = static_cast<int>(column), top = static_cast<int>(row);
    const float u = column - static_cast<float>(left), v = row - static_cast<float>(top);
    const float* upper = &knots_[(static_cast<std::size_t>(top) * columns_ + left) * 2];
    const float* lower = upper + static_cast<std::size_t>(columns_) * 2;
    const auto mix = [&](int k) {
      return (1 - v) * ((1 - u) * upper[k] + u * upper[k + 2]) + v * ((1 - u) * lower[k] + u * lower[k + 2]);
    };
    out_x[i] = mix(0);
    out_y[i] = mix(1);
  }
}

}  // namespace holdfast
