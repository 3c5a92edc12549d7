// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "holdfast/interfaces/dynamic_filter.hpp"
#include "holdfast/settings/reprojection_error.hpp"

namespace holdfast::reprojection_error_plugin {

/// Tests matched features by their reprojection error under the pose that was estimated from the matches: the
/// chi-square test in pixels (with the virtual right column if there is depth), the stability of a point's matches, and
/// the agreement of its displacements in space between frames, which distinguishes moving objects from noise. A single
/// failure gives weak evidence, failures in several frames full evidence. If few of the trusted matches pass, the pose
/// is wrong, and no evidence is added. Trusted matches are those without negative evidence from other filters.
///
/// After Zeng et al.: A Semantics-Guided Visual SLAM with U-Net for Complex Dynamic Indoor Environments. Remote Sensing
/// 2023, 15, 5479 (steps 2 to 6). The evidence is measurements, in the order of features.
class ReprojectionError final : public DynamicFilter {
 public:
  ReprojectionError(const ReprojectionErrorSettings& settings, const CreationContext& context);

  Needs needs() const override { return {.pose_prior = true, .matches = true}; }
  void apply(const FilterContext& context, StaticEvidence& evidence) override;

 private:
  /// History of the observations of a map point, stored by its slot.
  struct History {
    std::uint32_t generation = 0;
    std::uint8_t observations = 0;  // at most 8
    std::uint8_t failures = 0;      // one bit per observation, the most recent one is the lowest
    Eigen::Vector3f displacement = Eigen::Vector3f::Zero();  // running mean, world [m]
    float length = 0.0F;                                     // running mean of the displacements' lengths [m]
  };
  /// A feature with a map point.
  struct Match {
    std::uint32_t feature;
    MapPointId point;
    float error;                   // squared, normalised by variance and threshold: a match above 1 fails
    Eigen::Vector3f displacement;  // from the map point to the observed point, world [m]; zero without depth
    float found_ratio;
  };

  bool collect(const FilterContext& context);
  History& remember(const Match& match);
  float log_odds(const Match& match, const History& history) const;

  ReprojectionErrorSettings settings_;
  std::vector<Match> matches_;
  std::vector<History> histories_;
};

}  // namespace holdfast::reprojection_error_plugin
