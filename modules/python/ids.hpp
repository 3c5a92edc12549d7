// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "holdfast/core/id.hpp"

namespace holdfast::python {

/// An id of a keyframe or a map point as one number, generation * 2^32 + slot. The largest uint64 is no id.
template <class Tag>
std::uint64_t number_of(const Id<Tag>& id) {
  if (!id.valid()) return ~std::uint64_t{0};
  return (static_cast<std::uint64_t>(id.generation) << 32) | id.slot;
}

template <class Tag>
Id<Tag> id_of(std::uint64_t number) {
  return {static_cast<std::uint32_t>(number), static_cast<std::uint32_t>(number >> 32)};
}

}  // namespace holdfast::python
