// SPDX-License-Identifier: BSD-3-Clause
#include "conversions.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <vector>

#include "holdfast/core/error.hpp"
#include "holdfast/core/sensor_frame.hpp"
#include "holdfast/image_files/ros_encodings.hpp"

namespace holdfast::bridge {

namespace {

constexpr std::uint32_t largest_side = 1U << 15;

[[noreturn]] void refuse(const char* what, const std::string& problem) { throw InputError({what}, problem); }

[[noreturn]] void refuse_encoding(const char* what, const std::string& encoding, const std::string& known) {
  refuse(what, "has the encoding '" + encoding + "'; expected one of " + known +
                   "; choose another topic, or convert it with image_proc");
}

/// The type of OpenCV of an encoding of depth.
int depth_type(const char* what, const std::string& encoding) {
  if (encoding == "16UC1" || encoding == "mono16") return CV_16UC1;
  if (encoding == "32FC1") return CV_32FC1;
  refuse_encoding(what, encoding, "16UC1, mono16, 32FC1");
}

/// The pixels of a message without a copy.
cv::Mat view_of(const RawImage& image, const char* what, int type) {
  if (image.width < 1 || image.height < 1 || image.width > largest_side || image.height > largest_side)
    refuse(what, "has " + std::to_string(image.width) + "x" + std::to_string(image.height) + " pixels; expected 1 to " +
                     std::to_string(largest_side) + " in width and height");
  const std::size_t row = image.width * CV_ELEM_SIZE(type);
  if (image.step < row || image.size < image.step * (image.height - 1) + row)
    refuse(what, "has " + std::to_string(image.size) + " bytes in rows of " + std::to_string(image.step) +
                     "; an image of " + std::to_string(image.width) + "x" + std::to_string(image.height) + ", " +
                     image.encoding + " has rows of " + std::to_string(row));
  if (image.is_big_endian && CV_ELEM_SIZE1(type) > 1)
    refuse(what, "has its bytes in the order of another processor; expected little-endian numbers");
  return {static_cast<int>(image.height), static_cast<int>(image.width), type, const_cast<std::uint8_t*>(image.data),
          image.step};
}

cv::Mat metres_of(const cv::Mat& view, double factor) {
  cv::Mat depth;
  view.convertTo(depth, CV_32FC1, view.type() == CV_32FC1 ? 1.0 : 1.0 / factor);
  if (view.type() != CV_32FC1) return depth;
  for (int y = 0; y < depth.rows; ++y) {
    auto* row = depth.ptr<float>(y);
    for (int x = 0; x < depth.cols; ++x)
      if (!is_measured_depth(row[x])) row[x] = 0.0F;
  }
  return depth;
}

cv::Mat decoded(const std::uint8_t* data, std::size_t size, int flags, const char* what) {
  const cv::Mat bytes(1, static_cast<int>(size), CV_8UC1, const_cast<std::uint8_t*>(data));
  cv::Mat image = size > 0 ? cv::imdecode(bytes, flags) : cv::Mat();
  if (image.empty()) refuse(what, "cannot be decoded; expected a whole JPEG or PNG image");
  return image;
}

Distortion distortion_of(const CameraInfo& info) {
  std::vector<double> d = info.D;
  const std::string& model = info.distortion_model;
  const bool is_fisheye = model == "equidistant" || model == "fisheye";
  const std::size_t most = is_fisheye ? 4 : model == "plumb_bob" ? 5 : 8;
  const bool is_none = std::all_of(d.begin(), d.end(), [](double number) { return number == 0.0; });
  if (is_none && !(is_fisheye && d.size() == 4)) return {};
  const bool is_known = model == "plumb_bob" || model == "rational_polynomial" || is_fisheye;
  const bool has_more = d.size() > most && std::any_of(d.begin() + static_cast<std::ptrdiff_t>(most), d.end(),
                                                       [](double number) { return number != 0.0; });
  if (!is_known || has_more || (is_fisheye && d.size() < 4))
    refuse("camera_info", "has the distortion model '" + model + "' with " + std::to_string(d.size()) +
                              " coefficients; expected plumb_bob (5), rational_polynomial (8) or equidistant (4); give "
                              "the camera in the configuration under `camera:`");
  d.resize(8, 0.0);
  if (is_fisheye) return {.k1 = d[0], .k2 = d[1], .k3 = d[2], .k4 = d[3], .lens = Lens::fisheye};
  return {.k1 = d[0], .k2 = d[1], .p1 = d[2], .p2 = d[3], .k3 = d[4], .k4 = d[5], .k5 = d[6], .k6 = d[7]};
}

}  // namespace

cv::Mat colour_of(const RawImage& image) {
  constexpr const char* what = "colour image";
  const RosColourEncoding* encoding = find_ros_colour_encoding(image.encoding);
  if (encoding == nullptr) refuse_encoding(what, image.encoding, ros_colour_encodings());
  return to_blue_green_red(view_of(image, what, encoding->type), *encoding);
}

cv::Mat colour_of(const CompressedImage& image) {
  return decoded(image.data, image.size, cv::IMREAD_COLOR, "compressed colour image");
}

cv::Mat depth_of(const RawImage& image, double factor) {
  constexpr const char* what = "depth image";
  return metres_of(view_of(image, what, depth_type(what, image.encoding)), factor);
}

cv::Mat depth_of(const CompressedImage& image, double factor) {
  constexpr const char* what = "compressed depth image";
  // compressed_depth_image_transport writes its settings before the PNG.
  constexpr std::size_t settings = 12;
  const bool has_settings = image.format.find("compressedDepth") != std::string::npos;
  if (has_settings && (image.format.rfind("32FC1", 0) == 0 || image.format.find("rvl") != std::string::npos))
    refuse(what, "has the format '" + image.format + "'; expected 16UC1 as png; republish it as raw");
  const std::size_t first = has_settings ? std::min(settings, image.size) : 0;
  const cv::Mat pixels = decoded(image.data + first, image.size - first, cv::IMREAD_UNCHANGED, what);
  if (pixels.type() != CV_16UC1) refuse(what, "is no image of 16 bits; expected depth as whole numbers");
  return metres_of(pixels, factor);
}

Camera camera_of(const CameraInfo& info, bool is_rectified) {
  if (info.binning_x > 1 || info.binning_y > 1)
    refuse("camera_info",
           "is of an image with pixels put together (binning); expected none; give the camera in the "
           "configuration under `camera:`");
  Camera camera;
  camera.width = static_cast<int>(std::min(info.width, largest_side));
  camera.height = static_cast<int>(std::min(info.height, largest_side));
  camera.fx = is_rectified ? info.P[0] : info.K[0];
  camera.fy = is_rectified ? info.P[5] : info.K[4];
  camera.cx = is_rectified ? info.P[2] : info.K[2];
  camera.cy = is_rectified ? info.P[6] : info.K[5];
  if (!is_rectified) camera.distortion = distortion_of(info);
  if (const std::string trouble = camera.trouble(); !trouble.empty())
    refuse("camera_info", trouble + "; calibrate the camera, or give it in the configuration under `camera:`");
  return camera;
}

std::optional<double> baseline_of(const CameraInfo& right) {
  if (!(right.P[0] > 0.0) || !(right.P[3] < 0.0)) return std::nullopt;
  return -right.P[3] / right.P[0];
}

std::string difference_of(const Camera& used, const Camera& told) {
  constexpr double share = 0.02;
  const double width = used.width;
  const bool is_near = used.width == told.width && used.height == told.height &&
                       std::abs(used.fx - told.fx) < share * used.fx && std::abs(used.fy - told.fy) < share * used.fy &&
                       std::abs(used.cx - told.cx) < share * width && std::abs(used.cy - told.cy) < share * width;
  if (is_near) return {};
  return "the camera of the configuration (fx " + std::to_string(used.fx) + ", " + std::to_string(used.width) + "x" +
         std::to_string(used.height) + ") is used, but camera_info tells another one (fx " + std::to_string(told.fx) +
         ", " + std::to_string(told.width) + "x" + std::to_string(told.height) +
         "); write `camera: auto` in the configuration to use that of camera_info";
}

}  // namespace holdfast::bridge
