// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "holdfast/core/input_file.hpp"

namespace holdfast {

/// Header of an array file of numpy.save() (NEP 1, versions 1 to 3).
struct NumpyHeader {
  std::string type;  ///< of the values, as NumPy names it: <f8, |u1; empty for one that is not such a name
  bool has_fortran_order = false;
  std::vector<std::size_t> shape;
};

/// Reads the header at the beginning of a file; the position is then that of the first value. Throws InputError with
/// the finding and `expected`.
NumpyHeader read_numpy_header(InputFile& input, const std::string& expected);

/// "6 x 8"; "one number" for an array without dimensions.
std::string shape_text(const NumpyHeader& header);

}  // namespace holdfast
