// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>

namespace holdfast::openni2_plugin {

/// An image of one of the two streams of a camera.
struct StreamImage {
  bool is_depth = false;
  std::uint64_t number = 0;  ///< as the camera counts: a gap is an image that was not fetched in time
  std::uint64_t time = 0;    ///< of the camera's clock [us]
  cv::Mat image;             ///< 8UC3, blue green red, or 32FC1 [m], 0 = no value
};

/// What is asked of a camera.
struct DepthCameraRequest {
  std::string device;         ///< its URI; empty = the first one
  int width = 0, height = 0;  ///< [px]
  double frame_rate = 0.0;    ///< [1/s]
  bool registers_depth = true;
};

/// A camera with colour and depth through OpenNI 2; tests give one of their own. Images are not
/// mirrored. Used by one thread.
class DepthCamera {
 public:
  virtual ~DepthCamera() = default;
  /// Waits for the next image of either stream; empty when there will be none, and within 0.1 s once `stop` is true,
  /// which another thread may set. Throws InputError for a camera that
  /// was unplugged, or that gives no images for five seconds.
  virtual std::optional<StreamImage> next(const std::function<bool()>& stop) = 0;
};

/// Opens a camera. Throws InputError for one that is missing or cannot be opened, for a size that it
/// does not have, with those that it has, and for a camera that cannot register its depth.
std::unique_ptr<DepthCamera> open_depth_camera(const DepthCameraRequest& request);

}  // namespace holdfast::openni2_plugin
