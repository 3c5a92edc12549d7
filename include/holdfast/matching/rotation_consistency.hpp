// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

namespace holdfast::matching {

/// Rotation histogram test of ORB-SLAM (Mur-Artal et al. 2015, section V-C): a rotation of the camera rotates all
/// features alike, so matches outside the three most frequent of 30 bins are removed. The second and the third bin need
/// at least a tenth of the matches of the first. Of equal bins the lower one is preferred. `rotation(match)`: angle of
/// the feature minus that of the matched one [rad], modulo 2 pi.
template <class AnyMatch, class Rotation>
void keep_consistent_rotations(std::vector<AnyMatch>& matches, Rotation&& rotation) {
  constexpr int bins = 30, kept_bins = 3;
  const auto bin_of = [&](const AnyMatch& match) {
    float turn = rotation(match) / (2.0F * std::numbers::pi_v<float>);
    turn -= std::floor(turn);
    return std::min(static_cast<int>(turn * bins + 0.5F) % bins, bins - 1);
  };
  std::array<int, bins> histogram{};
  for (const AnyMatch& match : matches) ++histogram[bin_of(match)];
  std::array<int, bins> order;
  for (int i = 0; i < bins; ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return histogram[a] > histogram[b]; });
  std::array<bool, bins> kept{};
  for (int rank = 0; rank < kept_bins; ++rank)
    kept[order[rank]] = rank == 0 || histogram[order[rank]] * 10 >= histogram[order[0]];
  std::erase_if(matches, [&](const AnyMatch& match) { return !kept[bin_of(match)]; });
}

}  // namespace holdfast::matching
