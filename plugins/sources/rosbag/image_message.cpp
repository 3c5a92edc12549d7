// SPDX-License-Identifier: BSD-3-Clause
#include "image_message.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <memory>
#include <optional>

#include "holdfast/core/error.hpp"
#include "holdfast/core/sensor_frame.hpp"
#include "holdfast/image_files/ros_encodings.hpp"

namespace holdfast::rosbag_plugin {

namespace {

constexpr std::uint32_t largest_side = 1U << 15;  // as of image files

[[noreturn]] void refuse(const std::string& place, const std::string& problem) { throw InputError({place}, problem); }

/// std_msgs/Header.
void read_message_header(MessageReader& reader) {
  reader.stamp();
  reader.text("frame name");
}

/// A sensor_msgs/Image; its pixels lie in the message.
struct RawImage {
  cv::Size size;
  std::string encoding;
  bool is_big_endian = false;
  std::size_t bytes_to_next_row = 0;
  Bytes pixels;
};

RawImage read_image(const Message& message) {
  const std::string& place = message.place;
  const std::unique_ptr<MessageReader> reader = message.open();
  read_message_header(*reader);
  const auto height = reader->number<std::uint32_t>("height");
  const auto width = reader->number<std::uint32_t>("width");
  RawImage image;
  image.encoding = reader->text("encoding");
  image.is_big_endian = reader->number<std::uint8_t>("byte order") != 0;
  image.bytes_to_next_row = reader->number<std::uint32_t>("row length");
  image.pixels = reader->sequence("pixels");
  if (width < 1 || height < 1 || width > largest_side || height > largest_side)
    refuse(place, "is an image of " + std::to_string(width) + "x" + std::to_string(height) + "; expected 1 to " +
                      std::to_string(largest_side) + " pixels in width and height");
  image.size = {static_cast<int>(width), static_cast<int>(height)};
  return image;
}

/// Throws unless the message has rows of pixels of so many bytes.
void check_pixels(const RawImage& image, std::size_t bytes_of_pixel, const std::string& place) {
  const auto width = static_cast<std::size_t>(image.size.width), height = static_cast<std::size_t>(image.size.height);
  if (image.bytes_to_next_row >= width * bytes_of_pixel && image.pixels.size() >= image.bytes_to_next_row * height)
    return;
  refuse(place, "has " + std::to_string(image.pixels.size()) + " bytes of pixels in rows of " +
                    std::to_string(image.bytes_to_next_row) + "; an image of " + std::to_string(width) + "x" +
                    std::to_string(height) + ", " + image.encoding + " has " +
                    std::to_string(width * height * bytes_of_pixel) + " in rows of " +
                    std::to_string(width * bytes_of_pixel) + "; the message is damaged");
}

/// The pixels as an image of that type, without a copy.
cv::Mat view_of(const RawImage& image, int type) {
  return {image.size, type, const_cast<std::uint8_t*>(image.pixels.data()), image.bytes_to_next_row};
}

/// A sensor_msgs/CompressedImage; its bytes lie in the message.
struct CompressedImage {
  std::string format;
  Bytes bytes;
};

CompressedImage read_compressed(const Message& message) {
  const std::unique_ptr<MessageReader> reader = message.open();
  read_message_header(*reader);
  CompressedImage image;
  image.format = reader->text("format");
  image.bytes = reader->sequence("compressed image");
  return image;
}

float metres_of(float value) { return is_measured_depth(value) ? value : 0.0F; }

/// Numbers of `Stored` that lie anywhere in memory, each through `to_metres`.
template <class Stored, class Convert>
cv::Mat convert_depth(const RawImage& image, const std::string& place, const Convert& to_metres) {
  check_pixels(image, sizeof(Stored), place);
  cv::Mat depth(image.size, CV_32FC1);
  for (int y = 0; y < depth.rows; ++y) {
    const std::uint8_t* from = image.pixels.data() + image.bytes_to_next_row * static_cast<std::size_t>(y);
    auto* to = depth.ptr<float>(y);
    for (int x = 0; x < depth.cols; ++x) {
      Stored value;
      std::memcpy(&value, from + sizeof(Stored) * static_cast<std::size_t>(x), sizeof(Stored));
      to[x] = to_metres(value);
    }
  }
  return depth;
}

/// The distortion whose inverse, from raw to undistorted positions, has the coefficients of the camera: the
/// least-squares solution for k1, k2, p1, p2, k3 in positions all over the image, which are linear in them.
Distortion inverse_of(Camera camera, const std::string& place) {
  constexpr int steps = 16;
  constexpr double tolerance = 0.1;  // [px]
  const Camera inverse = camera;
  const auto undistorted = [&](double u, double v) { return inverse.distort(Eigen::Vector2d(u, v)); };
  Eigen::Matrix<double, Eigen::Dynamic, 5> rows(2 * (steps + 1) * (steps + 1), 5);
  Eigen::VectorXd shifts(rows.rows());
  const auto pixel_of = [&](int i) {
    return Eigen::Vector2d((camera.width - 1.0) * (i % (steps + 1)) / steps,
                           (camera.height - 1.0) * (i / (steps + 1)) / steps);
  };
  for (int i = 0; i < (steps + 1) * (steps + 1); ++i) {
    const Eigen::Vector2d raw = pixel_of(i), pixel = undistorted(raw.x(), raw.y());
    const Eigen::Vector2d n = camera.normalised(pixel.x(), pixel.y()), to = camera.normalised(raw.x(), raw.y());
    const double x = n.x(), y = n.y(), r = n.squaredNorm();
    rows.row(2 * i) << x * r, x * r * r, 2 * x * y, r + 2 * x * x, x * r * r * r;
    rows.row(2 * i + 1) << y * r, y * r * r, r + 2 * y * y, 2 * x * y, y * r * r * r;
    shifts.segment<2>(2 * i) = to - n;
  }
  const Eigen::Matrix<double, 5, 1> k = rows.colPivHouseholderQr().solve(shifts);
  camera.distortion = {.k1 = k[0], .k2 = k[1], .p1 = k[2], .p2 = k[3], .k3 = k[4]};
  for (int i = 0; i < (steps + 1) * (steps + 1); ++i) {
    const Eigen::Vector2d raw = pixel_of(i);
    if ((camera.distort(undistorted(raw.x(), raw.y())) - raw).norm() > tolerance)
      refuse(place,
             "has an inverse distortion (Inverse Brown Conrady) that no k1, k2, p1, p2, k3 describe to 0.1 pixels; "
             "calibrate the camera, give it under `camera:`, and set `camera_info: none`");
  }
  return camera.distortion;
}

/// The fields that are used.
struct InfoFields {
  std::uint32_t height = 0, width = 0;
  std::string model;
  std::uint32_t count = 0;  ///< of distortion coefficients
  double d[14] = {}, k[9] = {}, p[12] = {};
};

InfoFields read_info_fields(const Message& message) {
  const std::string& place = message.place;
  const std::unique_ptr<MessageReader> owner = message.open();
  MessageReader& reader = *owner;
  InfoFields fields;
  read_message_header(reader);
  fields.height = reader.number<std::uint32_t>("height");
  fields.width = reader.number<std::uint32_t>("width");
  fields.model = reader.text("distortion model");
  fields.count = reader.number<std::uint32_t>("number of coefficients");
  if (fields.count > 14)
    refuse(place,
           "has " + std::to_string(fields.count) + " distortion coefficients; expected 14 at most; it is damaged");
  for (std::uint32_t i = 0; i < fields.count; ++i) fields.d[i] = reader.number<double>("distortion");
  for (double& number : fields.k) number = reader.number<double>("K");
  for (int i = 0; i < 9; ++i) reader.number<double>("R");
  for (double& number : fields.p) number = reader.number<double>("P");
  const auto binning_x = reader.number<std::uint32_t>("binning");
  const auto binning_y = reader.number<std::uint32_t>("binning");
  if (binning_x > 1 || binning_y > 1)
    refuse(place, "is of an image with " + std::to_string(binning_x) + "x" + std::to_string(binning_y) +
                      " pixels put together; expected none; give the camera under `camera:` and `camera_info: none`");
  return fields;
}

}  // namespace

double read_stamp(const Message& message) {
  const auto [seconds, nanoseconds] = message.open()->stamp();
  if (nanoseconds >= 1'000'000'000)
    throw InputError({message.place}, "has a time stamp with " + std::to_string(nanoseconds) +
                                          " nanoseconds; expected less than a second; the message is damaged");
  // The number nearest to the decimal one, which is what a list of images gives.
  char text[32];
  const int length = std::snprintf(text, sizeof(text), "%u.%09u", seconds, nanoseconds);
  double stamp = 0.0;
  std::from_chars(text, text + length, stamp);
  return stamp;
}

std::string encoding_of(const Message& message) {
  if (message.type == compressed_image_type) return read_compressed(message).format;
  return read_image(message).encoding;
}

bool is_depth_encoding(const std::string& encoding) {
  return encoding == "32FC1" || encoding == "mono16" || encoding.starts_with("16UC1") ||
         encoding.find("compressedDepth") != std::string::npos;
}

cv::Mat ImageMessages::colour(const Message& message, const ImageDecoder::SizeCheck& check_size) {
  const std::string& place = message.place;
  if (message.type == compressed_image_type)
    return decoder_.decode_widened(read_compressed(message).bytes, place, check_size);
  const RawImage image = read_image(message);
  const RosColourEncoding* encoding = find_ros_colour_encoding(image.encoding);
  if (encoding == nullptr)
    refuse(place, "has the encoding '" + image.encoding + "'; expected a colour image, one of " +
                      ros_colour_encodings() + "; choose another topic with `colour`, or convert it with image_proc");
  check_pixels(image, CV_ELEM_SIZE(encoding->type), place);
  check_size(image.size);
  return to_blue_green_red(view_of(image, encoding->type), *encoding);
}

cv::Mat ImageMessages::depth(const Message& message, const DepthEncoding& encoding,
                             const ImageDecoder::SizeCheck& check_size) {
  const std::string& place = message.place;
  if (message.type == compressed_image_type) {
    CompressedImage image = read_compressed(message);
    constexpr std::size_t settings = 12;  // bytes that compressed_depth_image_transport writes before the PNG
    if (image.format.find("compressedDepth") != std::string::npos) {
      if (image.format.starts_with("32FC1"))
        refuse(place,
               "is depth of 32FC1 that was quantised by compressed_depth; expected 16UC1; choose another topic "
               "with `depth`, or republish it as `raw`");
      if (image.format.find("rvl") != std::string::npos)
        refuse(place,
               "is depth that compressed_depth compressed by rvl; expected png; choose another topic with `depth`, or "
               "republish it as `raw`");
      if (image.bytes.size() < settings) refuse(place, "is cut short: it has no image; the message is damaged");
      image.bytes = image.bytes.subspan(settings);
    }
    return decoder_.decode_depth(image.bytes, place, encoding, check_size);
  }
  const RawImage image = read_image(message);
  if (!is_depth_encoding(image.encoding))
    refuse(place, "has the encoding '" + image.encoding +
                      "'; expected a depth image, 16UC1, mono16 or 32FC1; choose another topic with `depth`");
  if (image.is_big_endian)
    refuse(place,
           "has its bytes in the order of another processor; expected little-endian numbers; record the topic "
           "again on an ordinary computer");
  check_size(image.size);
  if (image.encoding == "32FC1") return convert_depth<float>(image, place, metres_of);
  // As the depth of files: the float nearest to the quotient.
  const int no_value = encoding.no_value;
  if (const auto factor = static_cast<float>(encoding.factor); factor == encoding.factor)
    return convert_depth<std::uint16_t>(
        image, place, [=](std::uint16_t v) { return v == no_value ? 0.0F : static_cast<float>(v) / factor; });
  return convert_depth<std::uint16_t>(image, place, [=, factor = encoding.factor](std::uint16_t v) {
    return v == no_value ? 0.0F : static_cast<float>(v / factor);
  });
}

Camera read_camera_info(const Message& message, bool is_rectified) {
  const std::string& place = message.place;
  const auto [height, width, model, count, d, k, p] = read_info_fields(message);
  Camera camera;
  camera.name = "camera_info";
  if (width < 1 || height < 1 || width > largest_side || height > largest_side)
    refuse(place, "is of an image of " + std::to_string(width) + "x" + std::to_string(height) +
                      "; expected the size of the images; give the camera under `camera:` and `camera_info: none`");
  camera.width = static_cast<int>(width);
  camera.height = static_cast<int>(height);
  const double* matrix = is_rectified ? p : k;
  const int row = is_rectified ? 4 : 3;
  camera.fx = matrix[0];
  camera.cx = matrix[2];
  camera.fy = matrix[row + 1];
  camera.cy = matrix[row + 2];
  bool is_calibrated = camera.fx > 0.0 && camera.fy > 0.0;
  for (const double number : {camera.fx, camera.fy, camera.cx, camera.cy})
    is_calibrated = is_calibrated && std::isfinite(number) && std::abs(number) < 1e6;
  if (!is_calibrated)
    refuse(place,
           "has a focal length or principal point that cannot be: the camera was not calibrated; give the "
           "camera under `camera:` and `camera_info: none`");
  for (const double number : d)
    if (!std::isfinite(number)) refuse(place, "has a distortion coefficient that is no number");
  if (is_rectified) return camera;

  // librealsense names its models in words; its coefficients k1, k2, p1, p2, k3 are mostly zero.
  const bool is_inverse = model == "Inverse Brown Conrady" && count == 5;
  const bool is_brown = model == "plumb_bob" || model == "Brown Conrady" || is_inverse;
  const bool is_fisheye = model == "equidistant" || model == "fisheye";
  const bool is_known = is_brown || model == "rational_polynomial" || is_fisheye;
  const bool is_without = count == 0 || (!is_fisheye && std::all_of(d, d + count, [](double c) { return c == 0.0; }));
  const std::uint32_t most = is_fisheye ? 4 : is_brown ? 5 : 8;
  bool is_within = count <= most;
  for (std::uint32_t i = most; i < count; ++i) is_within = d[i] == 0.0;  // thin prisms and tilt that are not there
  if (!is_without && (!is_known || !is_within || (is_fisheye && count != 4)))
    refuse(place, "has the distortion model '" + model + "' with " + std::to_string(count) +
                      " coefficients; expected plumb_bob (5), rational_polynomial (8) or equidistant (4); give the "
                      "camera under `camera:` and `camera_info: none`");
  camera.distortion =
      is_fisheye
          ? Distortion{.k1 = d[0], .k2 = d[1], .k3 = d[2], .k4 = d[3]}
          : Distortion{.k1 = d[0], .k2 = d[1], .p1 = d[2], .p2 = d[3], .k3 = d[4], .k4 = d[5], .k5 = d[6], .k6 = d[7]};
  if (is_fisheye && !is_without) camera.distortion.lens = Lens::fisheye;
  if (is_inverse && !is_without) camera.distortion = inverse_of(camera, place);
  if (const std::string trouble = camera.trouble(); !trouble.empty())
    refuse(place, trouble + "; give the camera under `camera:` and `camera_info: none`");
  return camera;
}

std::optional<double> read_baseline(const Message& message) {
  const InfoFields fields = read_info_fields(message);
  const double baseline = -fields.p[3] / fields.p[0];
  if (!(fields.p[0] > 0.0) || !(baseline > 0.0) || !std::isfinite(baseline)) return std::nullopt;
  return baseline;
}

Camera read_right_camera_info(const Message& message) {
  Camera camera = read_camera_info(message, true);
  const std::optional<double> baseline = read_baseline(message);
  if (!baseline)
    refuse(message.place,
           "has no baseline: the fourth number of P is " + std::to_string(read_info_fields(message).p[3]) +
               ", but is negative for the right camera of a rectified pair; exchange `source.rosbag.colour` and "
               "`source.rosbag.right`, or give camera and baseline under `camera:` and `camera_info: none`");
  camera.baseline = *baseline;
  return camera;
}

}  // namespace holdfast::rosbag_plugin
