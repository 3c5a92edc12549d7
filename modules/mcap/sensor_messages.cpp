// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/mcap/sensor_messages.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <initializer_list>
#include <string_view>
#include <utility>
#include <vector>

#include "holdfast/core/byte_writer.hpp"
#include "holdfast/core/check.hpp"
#include "holdfast/core/error.hpp"

namespace holdfast::mcap {

namespace {

constexpr std::uint64_t second = 1'000'000'000;

/// Writes the fields of a message in the order of its definition.
class CdrWriter {
 public:
  explicit CdrWriter(const MessageHeader& header) {
    number(static_cast<std::int32_t>(header.stamp / second));
    number(static_cast<std::uint32_t>(header.stamp % second));
    text(header.frame);
  }
  /// Numbers are aligned to their size, as counted from the end of the encapsulation header.
  template <class Number>
  void number(Number value) {
    while (bytes_.size() % sizeof(Number) != 0) bytes_.put(std::uint8_t{0});
    bytes_.put(value);
  }
  void numbers(std::initializer_list<double> values) {
    for (const double value : values) number(value);
  }
  /// With the zero at its end, which counts.
  void text(const std::string& value) {
    number(static_cast<std::uint32_t>(value.size() + 1));
    bytes_.put_bytes(value);
    bytes_.put(std::uint8_t{0});
  }
  void sequence(std::string_view bytes) {
    number(static_cast<std::uint32_t>(bytes.size()));
    bytes_.put_bytes(bytes);
  }
  std::string finish() const {
    constexpr std::string_view little_endian("\0\x01\0\0", 4);
    return std::string(little_endian) + bytes_.bytes();
  }

 private:
  ByteWriter bytes_;
};

// The definitions of sensor_msgs (docs.ros.org), without comments.
constexpr const char* image_fields =
    "std_msgs/Header header\nuint32 height\nuint32 width\nstring encoding\nuint8 is_bigendian\nuint32 step\n"
    "uint8[] data\n";
constexpr const char* compressed_image_fields = "std_msgs/Header header\nstring format\nuint8[] data\n";
constexpr const char* camera_info_fields =
    "std_msgs/Header header\nuint32 height\nuint32 width\nstring distortion_model\nfloat64[] d\nfloat64[9] k\n"
    "float64[9] r\nfloat64[12] p\nuint32 binning_x\nuint32 binning_y\nsensor_msgs/RegionOfInterest roi\n"
    "================================================================================\n"
    "MSG: sensor_msgs/RegionOfInterest\n"
    "uint32 x_offset\nuint32 y_offset\nuint32 height\nuint32 width\nbool do_rectify\n";
constexpr const char* imu_fields =
    "std_msgs/Header header\ngeometry_msgs/Quaternion orientation\nfloat64[9] orientation_covariance\n"
    "geometry_msgs/Vector3 angular_velocity\nfloat64[9] angular_velocity_covariance\n"
    "geometry_msgs/Vector3 linear_acceleration\nfloat64[9] linear_acceleration_covariance\n"
    "================================================================================\n"
    "MSG: geometry_msgs/Quaternion\nfloat64 x 0\nfloat64 y 0\nfloat64 z 0\nfloat64 w 1\n"
    "================================================================================\n"
    "MSG: geometry_msgs/Vector3\nfloat64 x\nfloat64 y\nfloat64 z\n";
constexpr const char* header_fields =
    "================================================================================\n"
    "MSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n"
    "================================================================================\n"
    "MSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n";

constexpr std::pair<const char*, const char*> definitions[] = {{"Image", image_fields},
                                                               {"CompressedImage", compressed_image_fields},
                                                               {"CameraInfo", camera_info_fields},
                                                               {"Imu", imu_fields}};

const char* distortion_model(const Distortion& distortion) {
  if (distortion.lens == Lens::fisheye) return "equidistant";
  return distortion.is_rational() ? "rational_polynomial" : "plumb_bob";
}

/// `x`: the fourth number of P, -fx times the distance from the left camera.
std::string camera_info_of(const MessageHeader& header, const Camera& camera, double x) {
  std::vector<double> coefficients = camera.distortion.coefficients();
  if (camera.distortion.is_zero()) coefficients.assign(5, 0.0);
  CdrWriter message(header);
  message.number(static_cast<std::uint32_t>(camera.height));
  message.number(static_cast<std::uint32_t>(camera.width));
  message.text(distortion_model(camera.distortion));
  message.number(static_cast<std::uint32_t>(coefficients.size()));
  for (const double coefficient : coefficients) message.number(coefficient);
  message.numbers({camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1});
  message.numbers({1, 0, 0, 0, 1, 0, 0, 0, 1});
  message.numbers({camera.fx, 0, camera.cx, x, 0, camera.fy, camera.cy, 0, 0, 0, 1, 0});
  for (int i = 0; i < 6; ++i) message.number(std::uint32_t{0});  // no binning, and the whole image
  message.number(std::uint8_t{0});
  return message.finish();
}

}  // namespace

std::uint64_t message_stamp(double seconds) {
  constexpr double end = 2147483648.0;  // of 31 bits
  if (!(seconds >= 0.0 && seconds < end - 1.0))
    throw Error("the time stamp " + std::to_string(seconds) +
                " s does not fit into a message of ROS 2; expected 0 to 2^31 s");
  // The decimals of the number as a list of images has it, which a reader of the message gets back.
  char text[400];
  const std::string_view number(
      text,
      static_cast<std::size_t>(std::to_chars(text, text + sizeof(text), seconds, std::chars_format::fixed).ptr - text));
  const std::size_t point = std::min(number.find('.'), number.size());
  std::string decimals(number.substr(std::min(point + 1, number.size())));
  const double whole = std::floor(seconds);
  if (decimals.size() > 9)
    return static_cast<std::uint64_t>(whole) * second +
           static_cast<std::uint64_t>(std::llround((seconds - whole) * 1e9));
  decimals.resize(9, '0');
  return static_cast<std::uint64_t>(whole) * second + std::stoull(decimals);
}

Channel sensor_channel(const std::string& topic, const std::string& type) {
  for (const auto& [name, fields] : definitions)
    if (type == name) return {topic, "cdr", "sensor_msgs/msg/" + type, "ros2msg", std::string(fields) + header_fields};
  HOLDFAST_CHECK(false, "type " << type);
  return {};
}

std::string image_message(const MessageHeader& header, const std::string& encoding, const cv::Mat& pixels) {
  const cv::Mat rows = pixels.isContinuous() ? pixels : pixels.clone();
  CdrWriter message(header);
  message.number(static_cast<std::uint32_t>(rows.rows));
  message.number(static_cast<std::uint32_t>(rows.cols));
  message.text(encoding);
  message.number(std::uint8_t{0});
  message.number(static_cast<std::uint32_t>(rows.elemSize() * static_cast<std::size_t>(rows.cols)));
  message.sequence({reinterpret_cast<const char*>(rows.data), rows.total() * rows.elemSize()});
  return message.finish();
}

std::string compressed_image_message(const MessageHeader& header, const std::string& format, const std::string& bytes) {
  CdrWriter message(header);
  message.text(format);
  message.sequence(bytes);
  return message.finish();
}

std::string camera_info_message(const MessageHeader& header, const Camera& camera) {
  return camera_info_of(header, camera, 0.0);
}

std::string right_camera_info_message(const MessageHeader& header, const Camera& camera) {
  return camera_info_of(header, camera, -camera.fx * camera.baseline);
}

std::string imu_message(const MessageHeader& header, const ImuSample& sample) {
  const auto unknown = [](CdrWriter& message, double first) {
    message.number(first);
    for (int i = 1; i < 9; ++i) message.number(0.0);
  };
  const Eigen::Vector3d &w = sample.angular_velocity, &a = sample.acceleration;
  CdrWriter message(header);
  message.numbers({0, 0, 0, 1});
  unknown(message, -1.0);  // there is no orientation
  message.numbers({w.x(), w.y(), w.z()});
  unknown(message, 0.0);
  message.numbers({a.x(), a.y(), a.z()});
  unknown(message, 0.0);
  return message.finish();
}

}  // namespace holdfast::mcap
