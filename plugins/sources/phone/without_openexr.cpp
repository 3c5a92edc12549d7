// SPDX-License-Identifier: BSD-3-Clause
// Depth of Record3D, in a build without OpenEXR.
#include "exr_depth.hpp"
#include "holdfast/core/error.hpp"

namespace holdfast::phone_plugin {

cv::Mat read_exr_depth(const std::filesystem::path& file) {
  throw InputError({file.string()},
                   "is an OpenEXR image, but OpenEXR was not found when Holdfast was configured; install it (Debian: "
                   "libopenexr-dev), configure and build again");
}

}  // namespace holdfast::phone_plugin
