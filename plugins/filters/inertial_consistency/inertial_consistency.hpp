// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "holdfast/interfaces/dynamic_filter.hpp"
#include "holdfast/settings/inertial_consistency.hpp"

namespace holdfast::inertial_consistency_plugin {

/// Tests matched features against the pose that inertial measurements predict, which nothing that moves before the
/// camera can bias. The innovation e of a feature is its pixel (with the virtual right column if there is depth) minus
/// the projection of its map point by the predicted pose; its covariance is
///
///   S = J P J^T + sigma^2 I
///
/// with the covariance P of the predicted pose, the Jacobian J of the projection, and the variance sigma^2 of pixels at
/// the feature's pyramid level. The feature moves if e^T S^-1 e exceeds a quantile of the chi-square distribution
/// (Bar-Shalom, Li and Kirubarajan, "Estimation with applications to tracking and navigation", 2001, section 5.4).
///
/// Nothing is judged without a prediction, where few matches agree with it, and where J P J^T is so large that the test
/// could not tell. The evidence is measurements, in the order of features.
class InertialConsistency final : public DynamicFilter {
 public:
  InertialConsistency(const InertialConsistencySettings& settings, const CreationContext&) : settings_(settings) {}

  Needs needs() const override { return {.pose_prior = true, .matches = true, .inertia = true}; }
  void apply(const FilterContext& context, StaticEvidence& evidence) override;

 private:
  /// Squared normalised innovation over the threshold; empty where the filter cannot tell.
  std::optional<double> innovation(const FilterContext& context, std::size_t feature) const;

  struct Judged {
    std::size_t feature;
    double error;  // above 1, the feature moves
  };
  InertialConsistencySettings settings_;
  std::vector<Judged> judged_;
};

}  // namespace holdfast::inertial_consistency_plugin
