// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "holdfast/core/error.hpp"
#include "holdfast/core/id.hpp"

namespace holdfast {

/// A container of values that are referred to by stable ids instead of pointers. Insertion, look-up and removal take
/// constant time. Iteration is in slot order, which depends on the sequence of calls only and never on addresses.
/// References stay valid until the value is removed. Not synchronised.
template <class T, class Tag>
class SlotMap {
 public:
  using IdType = Id<Tag>;

  /// Inserts a value and returns its id.
  template <class... Arguments>
  IdType emplace(Arguments&&... arguments) {
    std::uint32_t slot;
    if (free_.empty()) {
      slot = used_slots_++;
      if (slot / chunk_size >= chunks_.size()) chunks_.push_back(std::make_unique<Chunk>());
    } else {
      slot = free_.back();
      free_.pop_back();
    }
    Slot& entry = at_slot(slot);
    entry.value.emplace(std::forward<Arguments>(arguments)...);
    ++size_;
    return {slot, entry.generation};
  }

  /// Removes a value and invalidates its id. Has no effect for an invalid id.
  void erase(IdType id) {
    if (!contains(id)) return;
    Slot& entry = at_slot(id.slot);
    entry.value.reset();
    ++entry.generation;
    free_.push_back(id.slot);
    --size_;
  }

  bool contains(IdType id) const {
    if (id.slot >= used_slots_) return false;
    const Slot& entry = at_slot(id.slot);
    return entry.value.has_value() && entry.generation == id.generation;
  }

  /// The value, or nullptr if the id is invalid or its value was removed.
  T* find(IdType id) { return contains(id) ? &*at_slot(id.slot).value : nullptr; }
  const T* find(IdType id) const { return contains(id) ? &*at_slot(id.slot).value : nullptr; }

  /// The value; throws CheckError if the id is invalid or its value was removed.
  T& at(IdType id) {
    T* value = find(id);
    HOLDFAST_CHECK(value != nullptr, "slot " << id.slot << " generation " << id.generation);
    return *value;
  }
  const T& at(IdType id) const { return const_cast<SlotMap*>(this)->at(id); }

  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  /// One past the largest slot ever used, which is the length of an array indexed by slot.
  std::uint32_t slot_count() const { return used_slots_; }

  void clear() {
    chunks_.clear();
    free_.clear();
    used_slots_ = 0;
    size_ = 0;
  }

  /// Calls function(id, value) for every value in slot order.
  template <class Function>
  void for_each(Function&& function) {
    for (std::uint32_t slot = 0; slot < used_slots_; ++slot) {
      Slot& entry = at_slot(slot);
      if (entry.value) function(IdType{slot, entry.generation}, *entry.value);
    }
  }
  template <class Function>
  void for_each(Function&& function) const {
    for (std::uint32_t slot = 0; slot < used_slots_; ++slot) {
      const Slot& entry = at_slot(slot);
      if (entry.value) function(IdType{slot, entry.generation}, *entry.value);
    }
  }

  /// All ids in slot order.
  std::vector<IdType> ids() const {
    std::vector<IdType> all;
    all.reserve(size_);
    for_each([&](IdType id, const T&) { all.push_back(id); });
    return all;
  }

 private:
  struct Slot {
    std::optional<T> value;
    std::uint32_t generation = 0;
  };
  static constexpr std::uint32_t chunk_size = 256;
  using Chunk = std::array<Slot, chunk_size>;

  Slot& at_slot(std::uint32_t slot) { return (*chunks_[slot / chunk_size])[slot % chunk_size]; }
  const Slot& at_slot(std::uint32_t slot) const { return (*chunks_[slot / chunk_size])[slot % chunk_size]; }

  std::vector<std::unique_ptr<Chunk>> chunks_;
  std::vector<std::uint32_t> free_;
  std::uint32_t used_slots_ = 0;
  std::size_t size_ = 0;
};

}  // namespace holdfast
