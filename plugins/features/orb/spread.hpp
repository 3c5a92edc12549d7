// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "detector.hpp"

namespace holdfast::orb_plugin {

/// Chooses corners that are strong and evenly spread (the aim of Mur-Artal et al. 2015, section IV): the image is
/// divided like a quad-tree, fullest square first, until there are as many squares as corners wanted, and the strongest
/// corner of each is kept. Corners are sorted along a Z-order curve once; a square is a run of them. An even spread
/// takes weak corners, which are found again less often, so only a part is chosen so and the rest by strength alone.
class EvenSpread {
 public:
  /// Shortens `corners` to at most `wanted`, of which `spread` (at most `wanted`) are chosen by squares. When there are
  /// more, the result is ordered along the curve and depends only on the set of corners; of equal ones the first along
  /// the curve wins.
  void select(std::size_t wanted, std::size_t spread, std::vector<Corner>& corners);

 private:
  struct Node {
    std::uint32_t begin, end;  // of sorted_
    int shift;                 // children differ in key bits shift + 1 and shift; negative: a single position
  };
  struct Item {
    std::uint32_t key, index;
  };

  void sort(const std::vector<Corner>& corners);
  void split(const Node& node);
  void divide(std::size_t wanted);
  void take_strongest_of_squares(std::size_t max_count, const std::vector<Corner>& corners);
  void take_strongest_left(std::size_t count, const std::vector<Corner>& corners);

  std::vector<Item> sorted_, scratch_;
  std::vector<Node> nodes_, next_, splittable_;
  std::vector<std::uint32_t> best_;     // of the squares, positions in sorted_
  std::vector<std::uint8_t> is_taken_;  // by position in sorted_
  std::vector<Corner> chosen_;
};

}  // namespace holdfast::orb_plugin
