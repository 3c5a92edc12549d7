// SPDX-License-Identifier: BSD-3-Clause
#include "scale_drift.hpp"

#include <algorithm>

namespace holdfast {

namespace {

constexpr std::size_t window_count = 10, fewest_pairs = 10;

/// The pairs [begin, end), whose estimates have the scale of the whole; empty without motion.
std::optional<ScaleDrift::Window> window_of(const std::vector<EvaluatedPose>& poses, std::size_t begin,
                                            std::size_t end) {
  const auto count = static_cast<Eigen::Index>(end - begin);
  Eigen::Matrix3Xd truth(3, count), estimate(3, count);
  for (std::size_t i = begin; i < end; ++i) {
    truth.col(static_cast<Eigen::Index>(i - begin)) = poses[i].truth;
    estimate.col(static_cast<Eigen::Index>(i - begin)) = poses[i].estimate;
  }
  // Where nothing moves there is no scale. The position is a part of the estimate that rounding errors are relative to.
  const auto spread = [](const Eigen::Matrix3Xd& positions) {
    return (positions.colwise() - Eigen::Vector3d(positions.rowwise().mean())).norm();
  };
  const double rounding = 1e-9 * (1.0 + estimate.norm());
  if (!(spread(truth) > rounding && spread(estimate) > rounding)) return std::nullopt;
  const double scale = align_positions(estimate, truth, AlignmentKind::sim3).scale;
  return ScaleDrift::Window{poses[begin].timestamp, poses[end - 1].timestamp, end - begin, scale};
}

}  // namespace

std::optional<ScaleDrift> scale_drift(const std::vector<EvaluatedPose>& poses) {
  std::vector<double> way(poses.size(), 0.0);
  for (std::size_t i = 1; i < poses.size(); ++i) way[i] = way[i - 1] + (poses[i].truth - poses[i - 1].truth).norm();
  ScaleDrift result;
  std::size_t begin = 0;
  for (std::size_t w = 0; w < window_count; ++w) {
    const double limit = way.back() * static_cast<double>(w + 1) / window_count;
    const auto last = w + 1 == window_count ? way.end() : std::upper_bound(way.begin(), way.end(), limit);
    const auto end = static_cast<std::size_t>(last - way.begin());
    if (end >= begin + fewest_pairs)
      if (const auto window = window_of(poses, begin, end)) result.windows.push_back(*window);
    begin = std::max(begin, end);
  }
  if (result.windows.size() < 2) return std::nullopt;
  const auto [least, most] =
      std::minmax_element(result.windows.begin(), result.windows.end(),
                          [](const ScaleDrift::Window& a, const ScaleDrift::Window& b) { return a.scale < b.scale; });
  if (!(least->scale > 0.0)) return std::nullopt;
  result.spread = most->scale / least->scale - 1.0;
  result.drift = result.windows.back().scale / result.windows.front().scale - 1.0;
  return result;
}

}  // namespace holdfast
