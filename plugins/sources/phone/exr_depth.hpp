// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <opencv2/core/mat.hpp>

namespace holdfast::phone_plugin {

/// Decodes an OpenEXR image of depth in metres to 32FC1: the first of its channels R, Y and Z; what is not finite or
/// not positive becomes 0, no value. Throws InputError with the file for a file that is missing, damaged, without such
/// a channel or larger than the image of a camera, and in a build without OpenEXR.
cv::Mat read_exr_depth(const std::filesystem::path& file);

}  // namespace holdfast::phone_plugin
