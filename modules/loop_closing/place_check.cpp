// SPDX-License-Identifier: BSD-3-Clause
#include "place_check.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>

#include "holdfast/core/hamming.hpp"
#include "holdfast/geometry/alignment.hpp"

namespace holdfast {
namespace {

/// Features whose place in space is known and which belong to the static world as far as one knows.
std::vector<std::uint32_t> solid_features(const Frame& frame) {
  std::vector<std::uint32_t> features;
  for (std::uint32_t i = 0; i < frame.size(); ++i)
    if (frame.has_depth(i) && frame.static_probability[i] >= 0.5F) features.push_back(i);
  return features;
}

/// Nearest point of the place for each feature; each point keeps its nearest feature. The runner-up of the ratio test
/// is the nearest point elsewhere: a place that was mapped twice is no reason to doubt a match.
std::vector<PointMatch> match_descriptors(const LoopClosingSettings& settings, const Frame& frame,
                                          const PlacePoints& place) {
  constexpr double same_spot = 0.1;  // m
  constexpr int unmatched = std::numeric_limits<int>::max();
  std::vector<PointMatch> best_of_point(place.size(), PointMatch{0, 0, unmatched});
  std::vector<std::uint32_t> all(place.size());
  std::iota(all.begin(), all.end(), 0U);
  std::vector<std::uint16_t> distances(place.size());
  for (const std::uint32_t feature : solid_features(frame)) {
    hamming_distances(frame.features.descriptors[feature], place.descriptors.data(), all, distances.data());
    const auto best =
        static_cast<std::uint32_t>(std::min_element(distances.begin(), distances.end()) - distances.begin());
    const int distance = distances[best];
    if (distance > settings.match_distance || distance >= best_of_point[best].distance) continue;
    const bool is_clear = std::none_of(all.begin(), all.end(), [&](std::uint32_t i) {
      return distance > settings.match_ratio * distances[i] &&
             (place.positions[i] - place.positions[best]).squaredNorm() > same_spot * same_spot;
    });
    if (is_clear) best_of_point[best] = {best, feature, distance};
  }
  std::erase_if(best_of_point, [](const PointMatch& match) { return match.distance == unmatched; });
  return best_of_point;
}

/// How many cells of a 4 by 4 grid over the image hold at least two of the features.
int filled_cells(const Frame& frame, std::span<const PointMatch> matches) {
  constexpr int side = 4;
  std::array<int, side * side> cells{};
  for (const PointMatch& match : matches) {
    const float x = frame.x[match.feature] / static_cast<float>(frame.camera->width);
    const float y = frame.y[match.feature] / static_cast<float>(frame.camera->height);
    ++cells[static_cast<std::size_t>(std::clamp(static_cast<int>(y * side), 0, side - 1) * side +
                                     std::clamp(static_cast<int>(x * side), 0, side - 1))];
  }
  return static_cast<int>(std::count_if(cells.begin(), cells.end(), [](int n) { return n >= 2; }));
}

}  // namespace

CheckedPlace check_place(const LoopClosingSettings& settings, Optimizer& optimizer, const Frame& frame,
                         const PlacePoints& place, std::uint64_t seed) {
  CheckedPlace result;
  if (place.size() == 0) return result;
  const std::vector<PointMatch> matches = match_descriptors(settings, frame, place);
  result.matches = static_cast<int>(matches.size());
  if (result.matches < settings.minimum_aligned) return result;

  result.verdict = LoopVerdict::no_alignment;
  std::vector<Eigen::Vector3d> in_camera, in_world;
  for (const PointMatch& match : matches) {
    in_camera.push_back(frame.camera_point(match.feature));
    in_world.push_back(place.positions[match.point]);
  }
  const auto aligned = geometry::align_points_ransac(in_camera, in_world,
                                                     {.threshold = settings.alignment_threshold,
                                                      .iterations = settings.alignment_iterations,
                                                      .minimum_inliers = settings.minimum_aligned,
                                                      .seed = seed});
  if (!aligned) return result;
  result.aligned = aligned->inliers;
  result.T_camera_world = aligned->similarity.motion().inverse();

  // The alignment is as good as depth is; the second search starts from a pose adjusted to pixels.
  result.verdict = LoopVerdict::few_inliers;
  PointSearch search;
  for (const double radius : {2.0 * settings.search_radius, settings.search_radius}) {
    search = find_points(place, frame, result.T_camera_world, radius, settings.match_distance);
    PoseProblem problem = pose_problem_of(place, frame, search.matches, result.T_camera_world);
    if (!optimizer.optimize_pose(problem).usable) return result;
    result.T_camera_world = problem.T_camera_world;
    result.inliers.clear();
    for (std::size_t i = 0; i < search.matches.size(); ++i)
      if (problem.inlier[i] != 0) result.inliers.push_back(search.matches[i]);
  }
  result.expected = search.expected;
  result.cells = filled_cells(frame, result.inliers);
  const int inliers = static_cast<int>(result.inliers.size());
  if (inliers < settings.minimum_inliers) return result;
  if (inliers < settings.minimum_share * result.expected)
    result.verdict = LoopVerdict::small_share;
  else if (result.cells < settings.minimum_cells)
    result.verdict = LoopVerdict::one_corner;
  else
    result.verdict = LoopVerdict::closed;
  return result;
}

}  // namespace holdfast
