// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/tracking/stereo_matcher.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <numeric>

#include "eight_words.hpp"
#include "holdfast/core/descriptor_distance.hpp"
#include "holdfast/core/median.hpp"

namespace holdfast {

void StereoMatcher::sort_by_row(const Features& features, int rows) {
  const auto row_of = [&](std::size_t i) {
    return static_cast<std::size_t>(std::clamp(static_cast<int>(features.y[i]), 0, rows - 1));
  };
  row_begin_.assign(static_cast<std::size_t>(rows) + 1, 0);
  for (std::size_t i = 0; i < features.size(); ++i) ++row_begin_[row_of(i) + 1];
  for (std::size_t row = 0; row < static_cast<std::size_t>(rows); ++row) row_begin_[row + 1] += row_begin_[row];
  by_row_.resize(features.size());
  for (std::size_t i = features.size(); i-- > 0;) by_row_[--row_begin_[row_of(i) + 1]] = static_cast<std::uint32_t>(i);
  // The decrements have moved the beginning of each row to its predecessor's place.
  std::rotate(row_begin_.begin(), row_begin_.begin() + 1, row_begin_.end());
  row_begin_.back() = static_cast<std::uint32_t>(features.size());
}

void StereoMatcher::find_matches(const Frame& frame, const Features& right, float max_disparity,
                                 const PairErrors& errors) {
  const Features& left = frame.features;
  const int rows = static_cast<int>(row_begin_.size()) - 1;
  const DescriptorView left_descriptors = left.descriptors, right_descriptors = right.descriptors;
  const DescriptorDistances distances(left_descriptors.type());
  const float max_distance = distance_limit(settings_.maximum_distance, left_descriptors.type().distance_between(0.5F));
  matches_.clear();
  for (std::size_t i = 0; i < left.size(); ++i) {
    const float tolerance = static_cast<float>(settings_.row_tolerance) * frame.pyramid->scale[left.octave[i]];
    const float row = left.y[i] + static_cast<float>(errors.row(*frame.camera, left.x[i], left.y[i]));
    const float infinity = left.x[i] + static_cast<float>(errors.column(*frame.camera, left.x[i], left.y[i]));
    const int first = std::clamp(static_cast<int>(row - tolerance), 0, rows - 1);
    const int last = std::clamp(static_cast<int>(row + tolerance), 0, rows - 1);
    // Both positions have an error of the size of a pixel of their level.
    const float least = infinity - max_disparity, most = infinity + frame.pyramid->scale[left.octave[i]];
    candidates_.clear();
    for (std::uint32_t k = row_begin_[static_cast<std::size_t>(first)];
         k < row_begin_[static_cast<std::size_t>(last) + 1]; ++k) {
      const std::uint32_t candidate = by_row_[k];
      if (right.x[candidate] < least || right.x[candidate] > most || std::abs(right.y[candidate] - row) > tolerance ||
          std::abs(static_cast<int>(right.octave[candidate]) - static_cast<int>(left.octave[i])) > 1)
        continue;
      candidates_.push_back(candidate);
    }
    if (candidates_.empty()) continue;
    distances_.resize(candidates_.size());
    distances.of_candidates(left_descriptors.row(i), right_descriptors.row(0), candidates_, distances_.data());
    const auto nearest = std::min_element(distances_.begin(), distances_.end());
    const Match best{static_cast<std::uint32_t>(i), candidates_[static_cast<std::size_t>(nearest - distances_.begin())],
                     *nearest};
    if (best.distance <= max_distance) matches_.push_back(best);
  }
}

void StereoMatcher::keep_best_of_each_right_feature(const Features& right) {
  match_of_right_.assign(right.size(), -1);
  for (std::size_t k = 0; k < matches_.size(); ++k) {
    std::int32_t& best = match_of_right_[matches_[k].right];
    if (best < 0 || matches_[k].distance < matches_[static_cast<std::size_t>(best)].distance)
      best = static_cast<std::int32_t>(k);
  }
  std::size_t kept = 0;
  for (std::size_t k = 0; k < matches_.size(); ++k)
    if (match_of_right_[matches_[k].right] == static_cast<std::int32_t>(k)) matches_[kept++] = matches_[k];
  matches_.resize(kept);
}

namespace {

constexpr int max_reach = 12, max_radius = 15;  // px, of the search and of the patch
constexpr int lanes = 8;                        // columns that are compared at once
constexpr int max_shifts = (2 * max_reach + 1 + lanes - 1) / lanes * lanes, max_side = 2 * max_radius + 1;

/// The part of the right image that the patches of one feature are compared with: as a view of the image, or, between
/// two of its rows, interpolated.
struct Strip {
  const std::uint8_t* data;
  std::ptrdiff_t step;
  const std::uint8_t* row(int k) const { return data + k * step; }
};
using StripBuffer = std::array<std::uint8_t, static_cast<std::size_t>(max_side) * (max_side + max_shifts)>;

Strip strip_of(const cv::Mat& right, int column, float top, int width, int side, StripBuffer& buffer) {
  const float whole = std::floor(top);
  const int first = static_cast<int>(whole), part = static_cast<int>(std::lround(64.0F * (top - whole)));
  if (part == 0) return {right.ptr<std::uint8_t>(first) + column, static_cast<std::ptrdiff_t>(right.step)};
  for (int row = 0; row < side; ++row) {
    const std::uint8_t* above = right.ptr<std::uint8_t>(first + row) + column;
    const std::uint8_t* below = right.ptr<std::uint8_t>(first + row + 1) + column;
    std::uint8_t* to = buffer.data() + static_cast<std::ptrdiff_t>(row) * width;
    for (int k = 0; k < width; ++k)
      to[k] = static_cast<std::uint8_t>((above[k] * (64 - part) + below[k] * part + 32) / 64);
  }
  return {buffer.data(), width};
}

/// The strip's rows as words, and the sums of its columns.
struct Columns {
  static constexpr int width = (max_side - 1 + max_shifts + lanes - 1) / lanes * lanes + lanes;
  std::array<std::array<std::int16_t, width>, max_side> rows;
  std::array<std::int16_t, width> sums;

  Columns(const Strip& strip, int used, int side) {
    std::array<std::uint8_t, width> bytes{};
    const int end = (used + lanes - 1) / lanes * lanes + lanes;  // what comes after the last shift is read as well
    std::fill(sums.begin(), sums.begin() + end, std::int16_t{0});
    for (int row = 0; row < side; ++row) {
      std::copy_n(strip.row(row), used, bytes.begin());
      for (int k = 0; k < end; k += lanes) {
        const EightWords values = pixels_at(bytes.data() + k), sum = words_at(sums.data() + k) + values;
        std::memcpy(rows[static_cast<std::size_t>(row)].data() + k, &values, sizeof values);
        std::memcpy(sums.data() + k, &sum, sizeof sum);  // 31 times 255 at most
      }
    }
  }
};

/// Sums of absolute differences between a patch of the left image, centred at (x, y), and those of the strip, the first
/// of which is at its left end. The mean difference is subtracted: it is one of exposure.
void compare_patches(const cv::Mat& left, int x, int y, const Strip& strip, int shifts, int radius,
                     std::array<int, max_shifts>& costs) {
  const int side = 2 * radius + 1;
  const Columns right(strip, side - 1 + shifts, side);
  const auto left_row = [&](int row) { return left.ptr<std::uint8_t>(y - radius + row) + x - radius; };
  int left_sum = 0;
  for (int row = 0; row < side; ++row) left_sum = std::accumulate(left_row(row), left_row(row) + side, left_sum);
  std::array<std::int16_t, max_shifts> means{};
  int right_sum = std::accumulate(right.sums.begin(), right.sums.begin() + side, 0);
  for (int shift = 0; shift < shifts; ++shift) {
    means[static_cast<std::size_t>(shift)] = static_cast<std::int16_t>((left_sum - right_sum) / (side * side));
    right_sum += right.sums[static_cast<std::size_t>(shift + side)] - right.sums[static_cast<std::size_t>(shift)];
  }

  costs.fill(0);
  for (int block = 0; block < shifts; block += lanes) {
    const EightWords mean = words_at(means.data() + block);
    for (int row = 0; row < side; ++row) {
      const std::uint8_t* a = left_row(row);
      const std::int16_t* b = right.rows[static_cast<std::size_t>(row)].data() + block;
      EightWords sums{};  // the differences of one row, 31 times 510 at most, fit into 16 bits
      for (int k = 0; k < side; ++k) sums += absolute(static_cast<std::int16_t>(a[k]) - mean - words_at(b + k));
      for (int lane = 0; lane < lanes; ++lane) costs[static_cast<std::size_t>(block + lane)] += sums[lane];
    }
  }
}

}  // namespace

float StereoMatcher::refine(const cv::Mat& left, const cv::Mat& right, cv::Point2f left_at, cv::Point2f right_at,
                            float scale, float& difference) const {
  constexpr float none = std::numeric_limits<float>::quiet_NaN();
  const int radius = settings_.patch_radius;
  const int reach = std::min(max_reach, 2 + static_cast<int>(std::ceil(2.0F * scale)));
  const int x = static_cast<int>(std::lround(left_at.x)), y = static_cast<int>(std::lround(left_at.y));
  const int there = static_cast<int>(std::lround(right_at.x));
  const float top = static_cast<float>(y - radius) + (right_at.y - left_at.y);
  if (y - radius < 0 || y + radius >= left.rows || x - radius < 0 || x + radius >= left.cols || top < 0.0F ||
      top + static_cast<float>(2 * radius + 1) > static_cast<float>(right.rows))
    return none;
  const int first = std::max(there - reach, radius), last = std::min(there + reach, right.cols - 1 - radius);
  if (last - first < 2) return none;

  std::array<int, max_shifts> costs;
  const int side = 2 * radius + 1, area = side * side, shifts = last - first + 1;
  StripBuffer buffer;
  const Strip strip = strip_of(right, first - radius, top, side - 1 + shifts, side, buffer);
  compare_patches(left, x, y, strip, shifts, radius, costs);
  const auto count = static_cast<std::size_t>(last - first + 1);
  const std::size_t best = static_cast<std::size_t>(
      std::min_element(costs.begin(), costs.begin() + static_cast<std::ptrdiff_t>(count)) - costs.begin());
  if (best == 0 || best + 1 == count) return none;
  const float before = static_cast<float>(costs[best - 1]), at = static_cast<float>(costs[best]),
              after = static_cast<float>(costs[best + 1]);
  const float curvature = before + after - 2.0F * at;
  const float fraction = curvature > 0.0F ? 0.5F * (before - after) / curvature : 0.0F;
  difference = at / static_cast<float>(area);
  return static_cast<float>(x - first - static_cast<int>(best)) - fraction;
}

void StereoMatcher::match(const cv::Mat& left, const cv::Mat& right, const Features& right_features, Frame& frame,
                          const PairErrors& errors) {
  constexpr double row_sigma = 0.7;  // px at level 0, of the difference between two keypoints
  const std::size_t count = frame.size();
  frame.depth.assign(count, 0.0F);
  frame.right_x.assign(count, std::numeric_limits<float>::quiet_NaN());
  const float fx_baseline = static_cast<float>(frame.camera->fx * frame.camera->baseline);
  const float max_disparity = fx_baseline / static_cast<float>(settings_.minimum_depth);
  sort_by_row(right_features, left.rows);
  find_matches(frame, right_features, max_disparity, errors);
  keep_best_of_each_right_feature(right_features);

  disparity_.resize(matches_.size());
  difference_.resize(matches_.size());
  sorted_.clear();
  row_differences_.clear();
  for (std::size_t k = 0; k < matches_.size(); ++k) {
    const std::size_t i = matches_[k].left;
    const cv::Point2f at(frame.features.x[i], frame.features.y[i]);
    const float there = right_features.x[matches_[k].right];
    const auto below = static_cast<float>(errors.row(*frame.camera, there, at.y));
    const float shown =
        refine(left, right, at, {there, at.y + below}, frame.pyramid->scale[frame.features.octave[i]], difference_[k]);
    disparity_[k] = shown + static_cast<float>(errors.column(*frame.camera, at.x - shown, at.y));
    if (disparity_[k] >= 0.0F) sorted_.push_back(difference_[k]);
  }
  if (sorted_.empty()) return;
  // Patches that differ much more than those of the others do not show the same surface.
  const float limit = 2.1F * upper_median(sorted_);  // 1.5 standard deviations of 1.4 medians, as Mur-Artal and Tardos
  for (std::size_t k = 0; k < matches_.size(); ++k) {
    const float disparity = disparity_[k];
    if (!(disparity >= static_cast<float>(settings_.minimum_disparity)) || disparity > max_disparity ||
        difference_[k] > limit)
      continue;
    const std::size_t i = matches_[k].left;
    frame.depth[i] = fx_baseline / disparity;
    frame.right_x[i] = frame.x[i] - disparity;
    // The keypoints are the same point if the patches agree with them.
    const double scale = frame.pyramid->scale[frame.features.octave[i]], x = frame.x[i], y = frame.y[i];
    const std::size_t other = matches_[k].right;
    const double there = right_features.x[other];
    if (std::abs(x - disparity + errors.column(*frame.camera, there, y) - there) < scale)
      row_differences_.push_back({there, y, right_features.y[other] - y, row_sigma * scale});
  }
}

}  // namespace holdfast
