// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace holdfast::viewer {

/// A message to the page: a JSON object and arrays of numbers.
///
/// Layout, little endian: length of the JSON text (u32), zero (u32), the text, spaces up to a multiple of 8, then the
/// arrays, each begun at a multiple of 8. The member "arrays" of the JSON object maps the name of each array to
/// [type, offset, count]: type is "u8", "u16", "u32", "f32" or "f64", the offset is in bytes from the end of the text.
class Message {
 public:
  nlohmann::json& json() { return json_; }
  bool empty() const { return json_.empty() && arrays_.empty(); }

  /// Adds an array; nothing if it is empty.
  void add(const char* name, const std::vector<std::uint8_t>& values) { add(name, "u8", values); }
  void add(const char* name, const std::vector<std::uint16_t>& values) { add(name, "u16", values); }
  void add(const char* name, const std::vector<std::uint32_t>& values) { add(name, "u32", values); }
  void add(const char* name, const std::vector<float>& values) { add(name, "f32", values); }
  void add(const char* name, const std::vector<double>& values) { add(name, "f64", values); }

  std::string bytes() const;

 private:
  template <class T>
  void add(const char* name, const char* type, const std::vector<T>& values) {
    if (values.empty()) return;
    arrays_[name] = {type, data_.size(), values.size()};
    data_.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
    data_.resize((data_.size() + 7) / 8 * 8, '\0');
  }

  nlohmann::json json_ = nlohmann::json::object();
  nlohmann::json arrays_ = nlohmann::json::object();
  std::string data_;
};

}  // namespace holdfast::viewer
