// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/tracking/stereo_matcher.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "holdfast/core/descriptor_distance.hpp"
#include "holdfast/core/median.hpp"
#include "patch_costs.hpp"

namespace holdfast {

void StereoMatcher::sort_by_row(const Features& features, int rows) {
  const auto row_of = [&](std::size_t i) {
    return static_cast<std::size_t>(std::clamp(static_cast<int>(features.y[i]), 0, rows - 1));
  };
  row_begin_.assign(static_cast<std::size_t>(rows) + 1, 0);
  for (std::size_t i = 0; i < features.size(); ++i) ++row_begin_[row_of(i) + 1];
  for (std::size_t row = 0; row < static_cast<std::size_t>(rows); ++row) row_begin_[row + 1] += row_begin_[row];
  by_row_.resize(features.size());
  for (std::size_t i = features.size(); i-- > 0;)
    by_row_[--row_begin_[row_of(i) + 1]] = {features.x[i], features.y[i], features.octave[i],
                                            static_cast<std::uint32_t>(i)};
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
  candidates_.resize(right.size() + 1);
  distances_.resize(right.size());
  for (std::size_t i = 0; i < left.size(); ++i) {
    const int octave = left.octave[i];
    const float scale = frame.pyramid->scale[left.octave[i]];
    const float tolerance = static_cast<float>(settings_.row_tolerance) * scale;
    const float row = left.y[i] + static_cast<float>(errors.row(*frame.camera, left.x[i], left.y[i]));
    const float infinity = left.x[i] + static_cast<float>(errors.column(*frame.camera, left.x[i], left.y[i]));
    const int first = std::clamp(static_cast<int>(row - tolerance), 0, rows - 1);
    const int last = std::clamp(static_cast<int>(row + tolerance), 0, rows - 1);
    // Both positions have an error of the size of a pixel of their level.
    const float least = infinity - max_disparity, most = infinity + scale;
    // Nine of ten are no candidates, in no order that a processor could predict: no branches.
    std::size_t count = 0;
    const std::uint32_t end = row_begin_[static_cast<std::size_t>(last) + 1];
    for (std::uint32_t k = row_begin_[static_cast<std::size_t>(first)]; k < end; ++k) {
      const RightFeature& other = by_row_[k];
      candidates_[count] = other.index;
      count += static_cast<std::size_t>(static_cast<int>(other.x >= least) & static_cast<int>(other.x <= most) &
                                        static_cast<int>(std::abs(other.y - row) <= tolerance) &
                                        static_cast<int>(static_cast<unsigned>(other.octave - octave + 1) <= 2U));
    }
    if (count == 0) continue;
    distances.of_candidates(left_descriptors.row(i), right_descriptors.row(0), std::span(candidates_.data(), count),
                            distances_.data());
    const auto nearest = std::min_element(distances_.data(), distances_.data() + count);
    const Match best{static_cast<std::uint32_t>(i), candidates_[static_cast<std::size_t>(nearest - distances_.data())],
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

float StereoMatcher::refine(const cv::Mat& left, const cv::Mat& right, cv::Point2f left_at, cv::Point2f right_at,
                            float scale, float& difference) const {
  constexpr float none = std::numeric_limits<float>::quiet_NaN();
  const int radius = settings_.patch_radius;
  constexpr int max_reach = 12;  // px, of the search
  static_assert(2 * max_reach + 1 <= max_patch_shifts);
  const int reach = std::min(max_reach, 2 + static_cast<int>(std::ceil(2.0F * scale)));
  const int x = static_cast<int>(std::lround(left_at.x)), y = static_cast<int>(std::lround(left_at.y));
  const int there = static_cast<int>(std::lround(right_at.x));
  const float top = static_cast<float>(y - radius) + (right_at.y - left_at.y);
  if (y - radius < 0 || y + radius >= left.rows || x - radius < 0 || x + radius >= left.cols || top < 0.0F ||
      top + static_cast<float>(2 * radius + 1) > static_cast<float>(right.rows))
    return none;
  const int first = std::max(there - reach, radius), last = std::min(there + reach, right.cols - 1 - radius);
  if (last - first < 2) return none;

  std::array<int, max_patch_shifts> costs;
  compare_patches(left, right, {x, y, radius, first, last - first + 1, top}, costs);
  const auto count = static_cast<std::size_t>(last - first + 1);
  const std::size_t best = static_cast<std::size_t>(
      std::min_element(costs.begin(), costs.begin() + static_cast<std::ptrdiff_t>(count)) - costs.begin());
  if (best == 0 || best + 1 == count) return none;
  const float before = static_cast<float>(costs[best - 1]), at = static_cast<float>(costs[best]),
              after = static_cast<float>(costs[best + 1]);
  const float curvature = before + after - 2.0F * at;
  const float fraction = curvature > 0.0F ? 0.5F * (before - after) / curvature : 0.0F;
  difference = at / static_cast<float>((2 * radius + 1) * (2 * radius + 1));
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
