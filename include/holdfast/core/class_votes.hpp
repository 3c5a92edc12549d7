// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "holdfast/core/cell_mask.hpp"

namespace holdfast {

/// Histogram of classes: how many masks gave a map point each label. Sparse, because a point has one or two classes;
/// without votes it allocates nothing. CellMask::unknown is no class and is not counted.
class ClassVotes {
 public:
  /// A label and how many masks gave it.
  struct Entry {
    std::uint8_t label = 0;   ///< index into Map::classes()
    std::uint32_t votes = 0;  ///< at least 1
    friend bool operator==(const Entry&, const Entry&) = default;
  };

  void add(std::uint8_t label, std::uint32_t votes = 1) {
    if (label == CellMask::unknown || votes == 0) return;
    const auto place = std::lower_bound(entries_.begin(), entries_.end(), label,
                                        [](const Entry& entry, std::uint8_t wanted) { return entry.label < wanted; });
    if (place != entries_.end() && place->label == label)
      place->votes += votes;
    else
      entries_.insert(place, {label, votes});
  }
  void add(const ClassVotes& others) {
    for (const Entry& entry : others.entries_) add(entry.label, entry.votes);
  }
  void clear() { entries_.clear(); }

  bool empty() const { return entries_.empty(); }
  /// By increasing label.
  const std::vector<Entry>& entries() const { return entries_; }
  std::uint64_t total() const {
    std::uint64_t sum = 0;
    for (const Entry& entry : entries_) sum += entry.votes;
    return sum;
  }
  /// Fraction of the votes for a label, 0 to 1; 0 without votes.
  double share(std::uint8_t label) const {
    std::uint64_t sum = 0, wanted = 0;
    for (const Entry& entry : entries_) sum += entry.votes, wanted += entry.label == label ? entry.votes : 0;
    return sum == 0 ? 0.0 : static_cast<double>(wanted) / static_cast<double>(sum);
  }
  /// The most frequent label; of equal counts, the lowest; CellMask::unknown without votes.
  std::uint8_t winner() const {
    const auto most = std::max_element(entries_.begin(), entries_.end(),
                                       [](const Entry& a, const Entry& b) { return a.votes < b.votes; });
    return most == entries_.end() ? CellMask::unknown : most->label;
  }
  friend bool operator==(const ClassVotes&, const ClassVotes&) = default;

 private:
  std::vector<Entry> entries_;
};

}  // namespace holdfast
