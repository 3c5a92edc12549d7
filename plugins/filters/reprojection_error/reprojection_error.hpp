// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "holdfast/interfaces/dynamic_filter.hpp"
#include "holdfast/settings/reprojection_error.hpp"

namespace holdfast {

/// Judges matched features by how far from their map points they lie, under the pose that the matches gave: the
/// chi-square test in pixels (and the virtual right column, where there is depth), how stable a point's matches are,
/// and whether its displacements in space agree from frame to frame, as those of a thing that moves do and noise does
/// not. What fails once is doubted, what fails for several frames moves. When few of the trusted matches pass, the pose
/// is what is wrong, and nothing is said. Trusted is what other evidence does not speak against.
///
/// After Zeng et al.: A Semantics-Guided Visual SLAM with U-Net for Complex Dynamic Indoor Environments. Remote Sensing
/// 2023, 15, 5479 (steps 2 to 6). Statements
/// are measurements, in the order of features.
class ReprojectionError final : public DynamicFilter {
 public:
  ReprojectionError(const ReprojectionErrorSettings& settings, const CreationContext& context);

  Needs needs() const override { return {.pose_prior = true, .map = true, .matches = true}; }
  void apply(const FilterContext& context, StaticEvidence& evidence) override;

 private:
  /// What was seen of a map point; kept by its slot.
  struct History {
    std::uint32_t generation = 0;
    std::uint8_t sights = 0;                                 // at most 8
    std::uint8_t failures = 0;                               // one bit per sight, the last is the lowest
    Eigen::Vector3f displacement = Eigen::Vector3f::Zero();  // running mean, world [m]
    float length = 0.0F;                                     // running mean of the displacements' lengths [m]
  };
  /// A feature with a map point.
  struct Match {
    std::uint32_t feature;
    MapPointId point;
    float error;                   // squared, by variance and threshold: above 1 the feature fails
    Eigen::Vector3f displacement;  // of what the feature shows from the point, world [m]; zero without depth
    float found_ratio;
  };

  bool collect(const FilterContext& context);
  History& remember(const Match& match);
  float log_odds(const Match& match, const History& history) const;

  ReprojectionErrorSettings settings_;
  std::vector<Match> matches_;
  std::vector<History> histories_;
};

}  // namespace holdfast
