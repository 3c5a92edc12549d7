// SPDX-License-Identifier: BSD-3-Clause
#include "spread.hpp"

#include <algorithm>
#include <array>
#include <bit>

namespace holdfast::orb_plugin {

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

void EvenSpread::divide(std::size_t wanted) {
  nodes_.clear();  // those that stay as they are
  const auto bits = static_cast<int>(std::bit_width(sorted_.back().key));
  splittable_.assign(1, {0, static_cast<std::uint32_t>(sorted_.size()), (bits + 1) / 2 * 2 - 2});
  while (!splittable_.empty() && nodes_.size() + splittable_.size() < wanted) {
    // Fullest first matters in the last round only, where not all can be split.
    const auto is_fuller = [](const Node& a, const Node& b) {
      return a.end - a.begin != b.end - b.begin ? a.end - a.begin > b.end - b.begin : a.begin < b.begin;
    };
    if (nodes_.size() + 4 * splittable_.size() > wanted) std::sort(splittable_.begin(), splittable_.end(), is_fuller);
    next_.clear();
    std::size_t i = 0;
    for (; i < splittable_.size(); ++i) {
      if (nodes_.size() + next_.size() + (splittable_.size() - i) >= wanted) break;
      split(splittable_[i]);
    }
    next_.insert(next_.end(), splittable_.begin() + static_cast<std::ptrdiff_t>(i), splittable_.end());
    splittable_.swap(next_);
  }
  nodes_.insert(nodes_.end(), splittable_.begin(), splittable_.end());
}

void EvenSpread::take_strongest_of_squares(std::size_t max_count, const std::vector<Corner>& corners) {
  const auto score = [&](std::uint32_t i) { return corners[sorted_[i].index].score; };
  best_.clear();
  for (const Node& node : nodes_) {
    std::uint32_t best = node.begin;
    for (std::uint32_t i = node.begin + 1; i < node.end; ++i)
      if (score(i) > score(best)) best = i;
    best_.push_back(best);
  }
  if (best_.size() > max_count) {  // the last split may have given up to three squares too many
    std::sort(best_.begin(), best_.end(),
              [&](std::uint32_t a, std::uint32_t b) { return score(a) != score(b) ? score(a) > score(b) : a < b; });
    best_.resize(max_count);
  }
  for (const std::uint32_t i : best_) is_taken_[i] = 1;
}

void EvenSpread::take_strongest_left(std::size_t count, const std::vector<Corner>& corners) {
  std::array<std::size_t, 256> of_score{};
  for (std::size_t i = 0; i < sorted_.size(); ++i)
    if (is_taken_[i] == 0) ++of_score[corners[sorted_[i].index].score];
  // All above a score are taken, and of that score as many as are left to take.
  int limit = 255;
  while (limit > 0 && of_score[limit] <= count) count -= of_score[limit--];
  for (std::size_t i = 0; i < sorted_.size(); ++i) {
    const int score = corners[sorted_[i].index].score;
    if (is_taken_[i] != 0 || score < limit || (score == limit && count == 0)) continue;
    if (score == limit) --count;
    is_taken_[i] = 1;
  }
}

void EvenSpread::select(std::size_t wanted, std::size_t spread, std::vector<Corner>& corners) {
  if (corners.size() <= wanted) return;
  sort(corners);
  is_taken_.assign(corners.size(), 0);
  if (spread > 0) {
    divide(spread);
    take_strongest_of_squares(spread, corners);
  }
  take_strongest_left(wanted - (spread > 0 ? best_.size() : 0), corners);

  chosen_.clear();
  for (std::size_t i = 0; i < sorted_.size(); ++i)
    if (is_taken_[i] != 0) chosen_.push_back(corners[sorted_[i].index]);
  corners = chosen_;
}

}  // namespace holdfast::orb_plugin
