// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <compare>
#include <cstdint>
#include <functional>
#include <limits>

namespace holdfast {

/// Identifies an entry of a SlotMap. An id is stable during the lifetime of its entry and is never reused: the
/// generation counts how often the slot was reused. Ids are ordered by slot, then generation, so that sorted containers
/// of ids iterate deterministically.
template <class Tag>
struct Id {
  std::uint32_t slot = std::numeric_limits<std::uint32_t>::max();
  std::uint32_t generation = 0;

  bool valid() const { return slot != std::numeric_limits<std::uint32_t>::max(); }
  friend auto operator<=>(const Id&, const Id&) = default;
};

using KeyFrameId = Id<struct KeyFrameTag>;
using MapPointId = Id<struct MapPointTag>;

}  // namespace holdfast

namespace std {

/// Allows ids as keys of unordered containers.
template <class Tag>
struct hash<holdfast::Id<Tag>> {
  std::size_t operator()(const holdfast::Id<Tag>& id) const noexcept {
    return (static_cast<std::size_t>(id.generation) << 32) ^ id.slot;
  }
};

}  // namespace std
