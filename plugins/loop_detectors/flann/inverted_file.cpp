// SPDX-License-Identifier: BSD-3-Clause
#include "inverted_file.hpp"

#include <algorithm>
#include <bit>

#include "holdfast/core/error.hpp"

namespace holdfast::flann_plugin {

void InvertedFile::add(std::uint32_t word, std::uint32_t keyframe) {
  if (word >= entries_.size()) entries_.resize(word + 1);
  Entry& entry = entries_[word];
  if (entry.length == 0) {
    entry.value = keyframe;
    entry.length = 1;
    return;
  }
  if (entry.length == 1) {
    const std::uint32_t first = entry.value;
    entry.value = take_room(2);
    pool_[entry.value] = first;
  } else if (std::has_single_bit(entry.length)) {
    move_to_room(entry, entry.length, 2 * entry.length, entry.length);
  }
  pool_[entry.value + entry.length++] = keyframe;
}

bool InvertedFile::remove(std::uint32_t word, std::uint32_t keyframe) {
  HOLDFAST_CHECK(word < entries_.size(), "word " << word << " of " << entries_.size());
  Entry& entry = entries_[word];
  const auto list = keyframes(word);
  const auto found = std::find(list.begin(), list.end(), keyframe);
  HOLDFAST_CHECK(found != list.end(), "keyframe " << keyframe << " does not have word " << word);
  if (entry.length == 1) {
    entry = {};
    return true;
  }
  pool_[entry.value + static_cast<std::uint32_t>(found - list.begin())] = list.back();
  const std::uint32_t capacity = std::bit_ceil(entry.length--);
  if (entry.length == 1) {
    const std::uint32_t room = entry.value;
    entry.value = pool_[room];
    give_back(room, capacity);
  } else if (std::bit_ceil(entry.length) < capacity) {
    move_to_room(entry, capacity, capacity / 2, entry.length);
  }
  return false;
}

std::span<const std::uint32_t> InvertedFile::keyframes(std::uint32_t word) const {
  if (word >= entries_.size()) return {};
  const Entry& entry = entries_[word];
  if (entry.length <= 1) return {&entry.value, entry.length};
  return {pool_.data() + entry.value, entry.length};
}

std::uint32_t InvertedFile::take_room(std::uint32_t capacity) {
  const std::size_t size_class = static_cast<std::size_t>(std::bit_width(capacity));
  if (size_class < free_rooms_.size() && !free_rooms_[size_class].empty()) {
    const std::uint32_t room = free_rooms_[size_class].back();
    free_rooms_[size_class].pop_back();
    return room;
  }
  const std::size_t room = pool_.size();
  if (room + capacity > pool_.capacity()) pool_.reserve(room + room / 4 + capacity);
  pool_.resize(room + capacity);
  return static_cast<std::uint32_t>(room);
}

void InvertedFile::give_back(std::uint32_t room, std::uint32_t capacity) {
  const std::size_t size_class = static_cast<std::size_t>(std::bit_width(capacity));
  if (size_class >= free_rooms_.size()) free_rooms_.resize(size_class + 1);
  free_rooms_[size_class].push_back(room);
}

void InvertedFile::move_to_room(Entry& entry, std::uint32_t old_capacity, std::uint32_t new_capacity,
                                std::uint32_t length) {
  const std::uint32_t old_room = entry.value;
  entry.value = take_room(new_capacity);
  std::copy_n(pool_.begin() + old_room, length, pool_.begin() + entry.value);
  give_back(old_room, old_capacity);
}

}  // namespace holdfast::flann_plugin
