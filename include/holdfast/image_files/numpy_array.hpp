// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "holdfast/core/input_file.hpp"

namespace holdfast {

/// What the header of an array says that numpy.save() wrote (NEP 1, versions 1 to 3).
struct NumpyHeader {
  std::string type;  ///< of the values, as NumPy names it: <f8, |u1; empty for one that is not such a name
  bool has_fortran_order = false;
  std::vector<std::size_t> shape;
};

/// Reads the header from the beginning of a file and leaves it at the first value. `expected` says what the array
/// should be: throws InputError with what was found, followed by it.
NumpyHeader read_numpy_header(InputFile& input, const std::string& expected);

/// "6 x 8"; "one number" for an array without dimensions.
std::string shape_text(const NumpyHeader& header);

}  // namespace holdfast
