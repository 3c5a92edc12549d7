// SPDX-License-Identifier: BSD-3-Clause
#include "window_costs.hpp"

#include <algorithm>

namespace holdfast {

namespace {

constexpr std::int16_t max_difference = 40;  // grey levels

int mirrored(int place, int size) { return cv::borderInterpolate(place, size, cv::BORDER_REFLECT_101); }

}  // namespace

void WindowCosts::begin(const cv::Mat& left, const cv::Mat& right, const cv::Mat& half_disparity) {
  left_ = left;
  right_ = right;
  half_disparity_ = half_disparity;
  const auto columns = static_cast<std::size_t>(left.cols);
  right_row_.resize(columns + sizeof(Lanes));
  differences_.resize(kept_rows * columns);
  costs_.resize(columns + 7);
  column_sums_.assign(columns, Lanes{});
  row_ = compared_ = 0;
  for (int row = -radius; row < radius; ++row) add(row, 1);
}

WindowCosts::Lanes* WindowCosts::differences_of(int row) {
  return differences_.data() + static_cast<std::size_t>(row % kept_rows) * column_sums_.size();
}

void WindowCosts::compare(int row) {
  const std::uint8_t* left = left_.ptr<std::uint8_t>(row);
  const std::int16_t* disparity = half_row(half_disparity_, row);
  const int columns = left_.cols, last = half_disparity_.cols - 1;
  std::copy_n(right_.ptr<std::uint8_t>(row), columns, right_row_.begin());
  Lanes* to = differences_of(row);
  for (int column = 0; column < columns; ++column) {
    const int found = disparity[std::min(column / 2, last)], place = eighths * column - found;
    const int whole = place >> 3;
    const auto part = static_cast<std::int16_t>(place & 7);
    if (found < eighths || whole < reach || whole + reach + 1 >= columns) {
      to[column] = Lanes{} + max_difference;
      continue;
    }
    const std::uint8_t* from = right_row_.data() + whole - reach;
    const Lanes first = pixels_at(from), second = pixels_at(from + 1);
    const Lanes value =
        (first * static_cast<std::int16_t>(eighths) + (second - first) * part + std::int16_t{eighths / 2}) >> 3;
    const Lanes difference = absolute(static_cast<std::int16_t>(left[column]) - value);
    to[column] = difference < max_difference ? difference : Lanes{} + max_difference;
  }
}

void WindowCosts::add(int row, int sign) {
  row = mirrored(row, left_.rows);
  for (; compared_ <= row; ++compared_) compare(compared_);
  const Lanes* from = differences_of(row);
  for (std::size_t column = 0; column < column_sums_.size(); ++column)
    column_sums_[column] += sign > 0 ? from[column] : -from[column];
}

const WindowCosts::Lanes* WindowCosts::next_row() {
  add(row_ + radius, 1);
  if (row_ > 0) add(row_ - radius - 1, -1);
  ++row_;
  const int columns = left_.cols;
  const auto sums_at = [&](int column) { return column_sums_[static_cast<std::size_t>(mirrored(column, columns))]; };
  Lanes sum{};
  for (int column = -radius; column < radius; ++column) sum += sums_at(column);
  for (int column = 0; column < columns; ++column) {
    const bool is_inside = column > radius && column + radius < columns;
    sum += is_inside ? column_sums_[static_cast<std::size_t>(column + radius)] : sums_at(column + radius);
    costs_[static_cast<std::size_t>(column)] = sum;
    sum -= column >= radius ? column_sums_[static_cast<std::size_t>(column - radius)] : sums_at(column - radius);
  }
  return costs_.data();
}

}  // namespace holdfast
