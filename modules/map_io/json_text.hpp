// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <concepts>
#include <optional>
#include <string>
#include <string_view>

#include "holdfast/core/camera.hpp"
#include "holdfast/core/map_inertia.hpp"

namespace holdfast::map_io {

/// Length of the UTF-8 sequence at the beginning of a text that is not empty; 0 where it begins with none.
inline std::size_t utf8_length(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned char first = byte(0);
  if (first < 0x80) return 1;
  const std::size_t length = first < 0xc2 ? 0 : first < 0xe0 ? 2 : first < 0xf0 ? 3 : first < 0xf5 ? 4 : 0;
  if (length == 0 || length > text.size()) return 0;
  for (std::size_t i = 1; i < length; ++i)
    if ((byte(i) & 0xc0) != 0x80) return 0;
  // Longer than necessary, halves of surrogate pairs, and beyond the last character.
  const bool is_none = (first == 0xe0 && byte(1) < 0xa0) || (first == 0xed && byte(1) > 0x9f) ||
                       (first == 0xf0 && byte(1) < 0x90) || (first == 0xf4 && byte(1) > 0x8f);
  return is_none ? 0 : length;
}

/// The control character (U+0001 to U+001F, U+007F to U+009F) that a text begins with; 0 where it begins with none.
inline unsigned char control_character(std::string_view text) {
  const auto first = static_cast<unsigned char>(text[0]);
  if (first < 0x20 || first == 0x7f) return first;
  const auto second = static_cast<unsigned char>(text.size() > 1 ? text[1] : 0);
  return first == 0xc2 && second >= 0x80 && second < 0xa0 ? second : 0;
}

/// Appends JSON to a text. A map has millions of numbers: they go straight into the text, not through a document.
class JsonText {
 public:
  /// Appends text unchanged: brackets, commas, keys.
  JsonText& operator<<(std::string_view text) {
    text_ += text;
    return *this;
  }
  /// The shortest text that is parsed as the same number; null if it is not finite, which JSON cannot represent.
  template <class T>
  requires std::integral<T> || std::floating_point<T> JsonText& operator<<(T value) {
    if constexpr (std::floating_point<T>)
      if (!std::isfinite(value)) return *this << "null";
    std::array<char, 32> digits;
    text_.append(digits.data(), std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr);
    return *this;
  }
  JsonText& operator<<(const Eigen::Vector3d& v) {
    return *this << "[" << v.x() << "," << v.y() << "," << v.z() << "]";
  }
  /// A string with its quotes; bytes that are not UTF-8 become U+FFFD. Control characters are escaped, those that JSON
  /// allows too, since JSON may be printed on a terminal.
  JsonText& quote(std::string_view string) {
    text_ += '"';
    while (!string.empty()) {
      constexpr const char* digits = "0123456789abcdef";
      const char letter = string.front();
      const std::size_t length = utf8_length(string);
      if (letter == '"' || letter == '\\') text_ += '\\';
      if (length == 0)
        text_ += "\xef\xbf\xbd";
      else if (const unsigned char control = control_character(string); control != 0 || letter == '\0')
        (text_ += "\\u00") += {digits[control >> 4], digits[control & 15]};
      else
        text_ += string.substr(0, length);
      string.remove_prefix(std::max<std::size_t>(length, 1));
    }
    text_ += '"';
    return *this;
  }
  JsonText& operator<<(const Camera& camera) {
    *this << R"({"name":)";
    quote(camera.name) << R"(,"width":)" << camera.width << R"(,"height":)" << camera.height << R"(,"fx":)" << camera.fx
                       << R"(,"fy":)" << camera.fy << R"(,"cx":)" << camera.cx << R"(,"cy":)" << camera.cy;
    const Distortion& d = camera.distortion;
    return *this << R"(,"k1":)" << d.k1 << R"(,"k2":)" << d.k2 << R"(,"p1":)" << d.p1 << R"(,"p2":)" << d.p2
                 << R"(,"k3":)" << d.k3 << R"(,"k4":)" << d.k4 << R"(,"k5":)" << d.k5 << R"(,"k6":)" << d.k6
                 << R"(,"lens":")" << lens_name(d.lens) << R"(","baseline":)" << camera.baseline << R"(,"frame_rate":)"
                 << camera.frame_rate << "}";
  }
  /// Null without any.
  JsonText& operator<<(const std::optional<MapInertia>& inertia) {
    if (!inertia) return *this << "null";
    return *this << R"({"gravity":)" << inertia->gravity << R"(,"scale":)" << inertia->scale << R"(,"gyroscope_bias":)"
                 << inertia->bias.gyroscope << R"(,"accelerometer_bias":)" << inertia->bias.accelerometer
                 << R"(,"time_offset":)" << inertia->time_offset << "}";
  }
  template <class Values>
  JsonText& list(const Values& values, std::string_view separator) {
    bool first = true;
    for (const auto& value : values) {
      if (!first) text_ += separator;
      first = false;
      *this << value;
    }
    return *this;
  }

  std::string& text() { return text_; }

 private:
  std::string text_;
};

}  // namespace holdfast::map_io
