// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "holdfast/geometry/epipolar.hpp"
#include "holdfast/matching/nearest.hpp"
#include "holdfast/matching/traits.hpp"

namespace holdfast::matching {

/// Settings of an epipolar search.
struct EpipolarSearchSettings {
  float max_distance = 50.0F;  ///< of the descriptors, in their unit (bits for binary ones)
  /// Ratio test: maximum ratio of the smallest to the second smallest distance near the line, because repeated texture
  /// is ambiguous. 1 = no test.
  float ratio = 0.8F;
  /// Chi-square limit (95 %, one degree of freedom) of the distance from the epipolar line.
  double chi_square = 3.841;
};

/// Matches features of one view, a, with those of another, b, whose relative pose is known: the nearest descriptor near
/// the epipolar line (Mur-Artal et al. 2015, section VI-D). An object keeps its buffers between calls and serves one
/// thread. The views must outlive it.
template <FeatureView View>
class EpipolarSearch {
 public:
  using Traits = ViewTraits<View>;
  using Distance = DistanceOf<typename Traits::Descriptors>;

  /// `fundamental`: pixel_b^T * fundamental * pixel_a = 0 for undistorted pixels; see geometry::fundamental_matrix().
  EpipolarSearch(const View& a, const View& b, const Eigen::Matrix3d& fundamental,
                 const EpipolarSearchSettings& settings = {})
      : a_(a), b_(b), fundamental_(fundamental), settings_(settings) {}

  /// Returns the feature of b that matches a feature of a, among `candidates` of b; ties are resolved by their order.
  std::optional<std::uint32_t> find(std::uint32_t feature, std::span<const std::uint32_t> candidates) {
    const geometry::EpipolarLine line =
        geometry::epipolar_line(fundamental_, {Traits::x(a_, feature), Traits::y(a_, feature)});
    near_line_.clear();
    for (const std::uint32_t other : candidates)
      if (line.is_near(Traits::x(b_, other), Traits::y(b_, other),
                       Traits::inverse_sigma2(b_, Traits::octave(b_, other)), settings_.chi_square))
        near_line_.push_back(other);
    const NearestTwo<Distance> nearest = nearest_two(Traits::descriptors(a_), feature, Traits::descriptors(b_),
                                                     std::span<const std::uint32_t>(near_line_), distances_);
    if (!nearest.has_best() || static_cast<float>(nearest.best_distance) > settings_.max_distance) return std::nullopt;
    if (nearest.has_second() &&
        static_cast<float>(nearest.best_distance) > settings_.ratio * static_cast<float>(nearest.second_distance))
      return std::nullopt;
    return nearest.best;
  }

 private:
  const View& a_;
  const View& b_;
  Eigen::Matrix3d fundamental_;
  EpipolarSearchSettings settings_;
  std::vector<std::uint32_t> near_line_;
  std::vector<Distance> distances_;
};

}  // namespace holdfast::matching
