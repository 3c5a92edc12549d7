// SPDX-License-Identifier: BSD-3-Clause
#include "spread.hpp"

#include <algorithm>
#include <array>
#include <bit>

namespace holdfast::orb {

namespace {

/// Puts a zero between all bits.
std::uint32_t separate_bits(std::uint32_t v) {
  v = (v | (v << 8)) & 0x00ff00ffU;
  v = (v | (v << 4)) & 0x0f0f0f0fU;
  v = (v | (v << 2)) & 0x33333333U;
  return (v | (v << 1)) & 0x55555555U;
}

std::uint32_t z_order(const Corner& corner) { return separate_bits(corner.x) | (separate_bits(corner.y) << 1); }

}  // namespace

void EvenSpread::sort(const std::vector<Corner>& corners) {
  sorted_.resize(corners.size());
  scratch_.resize(corners.size());
  std::uint32_t all_bits = 0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    sorted_[i] = {z_order(corners[i]), static_cast<std::uint32_t>(i)};
    all_bits |= sorted_[i].key;
  }
  constexpr int digit_bits = 10;
  const int key_bits = static_cast<int>(std::bit_width(all_bits));
  for (int shift = 0; shift < key_bits; shift += digit_bits) {
    std::array<std::uint32_t, (1 << digit_bits) + 1> begin{};
    const auto digit = [shift](std::uint32_t key) { return (key >> shift) & ((1U << digit_bits) - 1); };
    for (const Item& item : sorted_) ++begin[digit(item.key) + 1];
    for (std::size_t i = 1; i < begin.size(); ++i) begin[i] += begin[i - 1];
    for (const Item& item : sorted_) scratch_[begin[digit(item.key)]++] = item;
    sorted_.swap(scratch_);
  }
}

void EvenSpread::split(const Node& node) {
  std::uint32_t begin = node.begin;
  while (begin < node.end) {
    const std::uint32_t quadrant = sorted_[begin].key >> node.shift;
    const auto is_same = [&](const Item& item) { return item.key >> node.shift == quadrant; };
    const auto end = static_cast<std::uint32_t>(
        std::partition_point(sorted_.begin() + begin, sorted_.begin() + node.end, is_same) - sorted_.begin());
    const Node child{begin, end, node.shift - 2};
    (child.end - child.begin > 1 && child.shift >= 0 ? next_ : nodes_).push_back(child);
    begin = end;
  }
}

void EvenSpread::select(std::size_t wanted, std::vector<Corner>& corners) {
  if (corners.size() <= wanted || wanted == 0) {
    if (wanted == 0) corners.clear();
    return;
  }
  sort(corners);
  nodes_.clear();  // those that stay as they are
  const auto bits = static_cast<int>(std::bit_width(sorted_.back().key));
  splittable_.assign(1, {0, static_cast<std::uint32_t>(sorted_.size()), (bits + 1) / 2 * 2 - 2});
  while (!splittable_.empty() && nodes_.size() + splittable_.size() < wanted) {
    next_.clear();
    // Fullest first matters in the last round only, where not all can be split.
    const auto is_fuller = [](const Node& a, const Node& b) {
      return a.end - a.begin != b.end - b.begin ? a.end - a.begin > b.end - b.begin : a.begin < b.begin;
    };
    if (nodes_.size() + 4 * splittable_.size() > wanted) std::sort(splittable_.begin(), splittable_.end(), is_fuller);
    std::size_t i = 0;
    for (; i < splittable_.size(); ++i) {
      if (nodes_.size() + next_.size() + (splittable_.size() - i) >= wanted) break;
      split(splittable_[i]);
    }
    next_.insert(next_.end(), splittable_.begin() + static_cast<std::ptrdiff_t>(i), splittable_.end());
    splittable_.swap(next_);
  }
  nodes_.insert(nodes_.end(), splittable_.begin(), splittable_.end());

  std::sort(nodes_.begin(), nodes_.end(), [](const Node& a, const Node& b) { return a.begin < b.begin; });
  chosen_.clear();
  for (const Node& node : nodes_) {
    const Corner* best = &corners[sorted_[node.begin].index];
    for (std::uint32_t i = node.begin + 1; i < node.end; ++i)
      if (const Corner& corner = corners[sorted_[i].index]; corner.score > best->score) best = &corner;
    chosen_.push_back(*best);
  }
  // The last split may have given up to three squares too many.
  while (chosen_.size() > wanted)
    chosen_.erase(std::min_element(chosen_.begin(), chosen_.end(),
                                   [](const Corner& a, const Corner& b) { return a.score < b.score; }));
  corners = chosen_;
}

}  // namespace holdfast::orb
