// SPDX-License-Identifier: BSD-3-Clause
// The cameras of a build without OpenNI 2.
#include "depth_camera.hpp"
#include "holdfast/core/error.hpp"

namespace holdfast::openni2_plugin {

std::unique_ptr<DepthCamera> open_depth_camera(const DepthCameraRequest&) {
  throw PluginError("this build has no OpenNI 2 (Debian: libopenni2-dev)");
}

}  // namespace holdfast::openni2_plugin
