// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <compare>
#include <cstdint>
#include <functional>
#include <limits>

namespace holdfast {

/// The name of an entry of a SlotMap: stable for the entry's life, never reused for another one (the generation counts
/// the reuse of the slot). Ordered by slot, then generation, so that sorted containers of ids iterate the same way in
/// every run.
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

/// Lets ids be keys of unordered containers.
template <class Tag>
struct hash<holdfast::Id<Tag>> {
  std::size_t operator()(const holdfast::Id<Tag>& id) const noexcept {
    return (static_cast<std::size_t>(id.generation) << 32) ^ id.slot;
  }
};

}  // namespace std
