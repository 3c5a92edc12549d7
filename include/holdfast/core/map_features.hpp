// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "holdfast/core/descriptor.hpp"

namespace holdfast {

/// Type of the features of a map. Features of different extractors cannot be compared.
struct MapFeatures {
  std::string extractor = "orb";  ///< name of the module; empty if an object without a name extracted them
  DescriptorType descriptors;
  bool operator==(const MapFeatures&) const = default;
};

}  // namespace holdfast
