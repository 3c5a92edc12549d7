// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "holdfast/core/descriptor.hpp"

namespace holdfast {

/// Which features a map consists of. Those of another extractor show other corners and cannot be compared.
struct MapFeatures {
  std::string extractor = "orb";  ///< name of the module; empty if an object without a name extracted them
  DescriptorType descriptors;
  bool operator==(const MapFeatures&) const = default;
};

}  // namespace holdfast
