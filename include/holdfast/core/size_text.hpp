// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace holdfast {

/// A size of an image in pixels as messages write it, such as "640x480".
inline std::string size_text(int width, int height) { return std::to_string(width) + "x" + std::to_string(height); }

}  // namespace holdfast
