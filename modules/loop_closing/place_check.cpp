// SPDX-License-Identifier: BSD-3-Clause
#include "place_check.hpp"

#include <algorithm>
#include <array>
#include <numeric>

#include "class_evidence.hpp"
#include "holdfast/core/median.hpp"
#include "holdfast/geometry/alignment.hpp"
#include "holdfast/matching/frame_features.hpp"

namespace holdfast {
namespace {

/// Descriptor matching: nearest point of the candidate for each feature; each point keeps its nearest feature. The
/// ratio test ignores points within 0.1 m of the nearest one, which are duplicates of a place that was mapped twice.
/// Match::source is the feature of the frame, Match::feature the point.
std::vector<FeatureMatch> match_descriptors(const LoopClosingSettings& settings, const FeatureMatcher& matcher,
                                            const Frame& frame, const LocatedFeatures& located,
                                            const PlacePoints& place) {
  constexpr double same_spot = 0.1;  // m
  std::vector<std::uint32_t> all(place.size());
  std::iota(all.begin(), all.end(), 0U);
  const auto is_elsewhere = [&](std::uint32_t nearest, std::uint32_t other) {
    return (place.positions[other] - place.positions[nearest]).squaredNorm() > same_spot * same_spot;
  };
  std::vector<FeatureMatch> matches;
  matcher.match(side_of(frame, located.features), {.descriptors = place.block.descriptors, .selection = all},
                {.max_distance = match_distance(settings.match_distance, place.block.descriptors.type()),
                 .ratio = static_cast<float>(settings.match_ratio),
                 .is_rival = is_elsewhere},
                matches);
  return matches;
}

/// Number of cells of a 4 by 4 grid over the image with at least two of the features.
int filled_cells(const Frame& frame, std::span<const FeatureMatch> matches) {
  constexpr int side = 4;
  std::array<int, side * side> cells{};
  for (const FeatureMatch& match : matches) {
    const float x = frame.x[match.feature] / static_cast<float>(frame.camera->width);
    const float y = frame.y[match.feature] / static_cast<float>(frame.camera->height);
    ++cells[static_cast<std::size_t>(std::clamp(static_cast<int>(y * side), 0, side - 1) * side +
                                     std::clamp(static_cast<int>(x * side), 0, side - 1))];
  }
  return static_cast<int>(std::count_if(cells.begin(), cells.end(), [](int n) { return n >= 2; }));
}

/// Scale of the Sim(3) from keyframe to candidate: the median ratio of depths over the matches.
double scale_of_place(const LocatedFeatures& located, const PlacePoints& place, const CheckedPlace& checked) {
  std::vector<double> ratios;
  for (const FeatureMatch& match : checked.inliers) {
    const double own = located.in_camera[match.feature].z();
    const double there = (checked.T_camera_world * place.positions[match.source]).z();
    if (own > 0.0 && there > 0.0) ratios.push_back(there / own);
  }
  if (ratios.empty()) return checked.scale;
  return upper_median(ratios);
}

/// Judges inliers, share, coverage and classes of a place whose pose was found.
LoopVerdict judge(const LoopClosingSettings& settings, const ClassEvidence& evidence, int cells) {
  if (evidence.inliers < settings.minimum_inliers) return LoopVerdict::few_inliers;
  if (evidence.inliers < settings.minimum_share * evidence.expected) return LoopVerdict::small_share;
  if (cells < settings.minimum_cells) return LoopVerdict::poor_coverage;
  const bool is_compared = evidence.compared >= settings.minimum_aligned;
  if (is_compared && evidence.agreement < settings.class_agreement) return LoopVerdict::other_classes;
  return LoopVerdict::closed;
}

}  // namespace

LocatedFeatures located_features(const Frame& frame, const Map& map) {
  LocatedFeatures located;
  located.scale_is_free = !scale_is_known(map.sensor());
  located.in_camera.assign(frame.size(), Eigen::Vector3d::Zero());
  for (std::uint32_t i = 0; i < frame.size(); ++i) {
    if (!is_static(frame, i)) continue;
    if (frame.has_depth(i)) {
      located.in_camera[i] = frame.camera_point(i);
    } else {
      const MapPoint* point = located.scale_is_free ? map.find_point(frame.map_points[i]) : nullptr;
      if (point == nullptr) continue;
      located.in_camera[i] = frame.T_camera_world * point->position;
    }
    located.features.push_back(i);
  }
  return located;
}

CheckedPlace check_place(const LoopClosingSettings& settings, const FeatureMatcher& matcher, Optimizer& optimizer,
                         const Frame& frame, const LocatedFeatures& located, const PlacePoints& place,
                         std::uint64_t seed, const PlaceWeights& weights) {
  CheckedPlace result;
  if (place.size() == 0) return result;
  const std::vector<FeatureMatch> matches = match_descriptors(settings, matcher, frame, located, place);
  result.matches = static_cast<int>(matches.size());
  if (result.matches < settings.minimum_aligned) return result;

  result.verdict = LoopVerdict::no_alignment;
  std::vector<Eigen::Vector3d> in_camera, in_world;
  for (const FeatureMatch& match : matches) {
    in_camera.push_back(located.in_camera[match.source]);
    in_world.push_back(place.positions[match.feature]);
  }
  const auto aligned = geometry::align_points_ransac(in_camera, in_world,
                                                     {.with_scale = located.scale_is_free,
                                                      .threshold = settings.alignment_threshold,
                                                      .iterations = settings.alignment_iterations,
                                                      .minimum_inliers = settings.minimum_aligned,
                                                      .seed = seed});
  if (!aligned) return result;
  result.aligned = aligned->inliers;
  result.T_camera_world = aligned->similarity.motion().inverse();
  result.scale = aligned->similarity.scale;

  // The alignment is limited by the noise of depth; the second search starts from a pose adjusted to pixels.
  result.verdict = LoopVerdict::few_inliers;
  PointSearch search;
  for (const double radius : {2.0 * settings.search_radius, settings.search_radius}) {
    search = find_points(matcher, place.block, frame, result.T_camera_world, radius, settings.match_distance);
    PoseProblem problem = pose_problem_of(place, frame, search.matches, result.T_camera_world);
    if (!optimizer.optimize_pose(problem).usable) return result;
    result.T_camera_world = problem.T_camera_world;
    result.inliers.clear();
    for (std::size_t i = 0; i < search.matches.size(); ++i)
      if (problem.inlier[i] != 0) result.inliers.push_back(search.matches[i]);
  }
  if (located.scale_is_free) result.scale = scale_of_place(located, place, result);
  result.expected = search.expected;
  const ClassEvidence evidence = class_evidence(frame, place, search.visible, result.inliers, weights);
  result.cells = filled_cells(frame, evidence.solid);
  result.class_agreement = evidence.agreement;
  result.verdict = judge(settings, evidence, result.cells);
  return result;
}

}  // namespace holdfast
