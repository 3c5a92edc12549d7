// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "container.hpp"
#include "holdfast/core/map.hpp"
#include "records.hpp"

namespace holdfast::map_io {

enum class FeatureReading {
  all,
  none,  ///< their checksums are verified, but keyframes stay without features
};

struct FileContent {
  MapContent map;
  SharedTables tables;
  std::uint64_t features = 0;
};

/// All sections of a file, in their order, each number checked by itself; whether references agree is left to
/// Map::restore(). Throws InputError.
FileContent read_content(ContainerReader& container, FeatureReading features);

}  // namespace holdfast::map_io
