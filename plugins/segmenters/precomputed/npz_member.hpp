// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

#include "holdfast/core/input_file.hpp"

namespace holdfast::precomputed_plugin {

/// Finds the array of labels in an archive of arrays that numpy.savez() wrote (.npz, a ZIP file without compression):
/// the only one, or the one that is called labels, masks, instances or arr_0, in this order. Leaves the file at its
/// first byte and returns its number of bytes. Throws InputError with what was found, followed by `expected`, for other
/// files and compressed arrays.
std::uint64_t seek_label_array(InputFile& input, const std::string& expected);

}  // namespace holdfast::precomputed_plugin
