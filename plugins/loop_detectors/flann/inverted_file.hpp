// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <span>
#include <vector>

namespace holdfast::flann_plugin {

/// A keyframe with a word, and the number of its occurrences. Keyframes are small integers here, below most_keyframes.
struct Posting {
  std::uint32_t keyframe : 24;
  std::uint32_t count : 8;  ///< saturates at 255
};
static_assert(sizeof(Posting) == 4);
inline constexpr std::uint32_t most_keyframes = 1U << 24;

/// Inverted file: the contiguous postings of each word in one pool. A single posting, by far the most frequent case, is
/// stored in the entry of the word; longer lists have a block of 2, 4, 8, ... in the pool, and blocks are reused.
class InvertedFile {
 public:
  /// The keyframe must not have the word yet.
  void add(std::uint32_t word, std::uint32_t keyframe);
  /// Returns whether this was the last keyframe of the word. Throws CheckError if the keyframe does not have the word.
  bool remove(std::uint32_t word, std::uint32_t keyframe);
  /// In no particular order. Valid until the next change.
  std::span<const std::uint32_t> keyframes(std::uint32_t word) const;

 private:
  struct Entry {
    std::uint32_t length = 0;
    std::uint32_t value = 0;  ///< length 1: the keyframe; more: where in pool_
  };

  std::uint32_t take_room(std::uint32_t capacity);
  void give_back(std::uint32_t room, std::uint32_t capacity);
  void move_to_room(Entry& entry, std::uint32_t old_capacity, std::uint32_t new_capacity, std::uint32_t length);

  std::deque<Entry> entries_;  // by word
  std::vector<std::uint32_t> pool_;
  std::vector<std::vector<std::uint32_t>> free_rooms_;  // by the logarithm of their capacity
};

}  // namespace holdfast::flann_plugin
