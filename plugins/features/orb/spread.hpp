// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "detector.hpp"

namespace holdfast::orb {

/// Chooses corners that are strong and evenly spread (the aim of Mur-Artal et al. 2015, section IV): the image is
/// divided like a quad-tree, fullest square first, until there are as many squares as corners wanted, and the strongest
/// corner of each is kept. Corners are sorted along a Z-order curve once; a square is a run of them.
class EvenSpread {
 public:
  /// Reorders `corners` and shortens them to at most `wanted`. The result depends only on the set of corners; of equal
  /// ones the first along the curve wins.
  void select(std::size_t wanted, std::vector<Corner>& corners);

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

  std::vector<Item> sorted_, scratch_;
  std::vector<Node> nodes_, next_, splittable_;
  std::vector<Corner> chosen_;
};

}  // namespace holdfast::orb
