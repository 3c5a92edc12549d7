// SPDX-License-Identifier: BSD-3-Clause
#include "intrinsics.hpp"

#include <yaml-cpp/yaml.h>

#include <array>
#include <charconv>
#include <cmath>
#include <set>
#include <string>

#include "holdfast/core/error.hpp"

namespace holdfast::folder_plugin {

namespace {

constexpr const char* expected_keys =
    "fx, fy, cx, cy, width, height, and optionally k1, k2, p1, p2, k3, baseline, name";

/// Marks of the parser count from 0; a node that does not exist has none.
SourceLocation location(const std::filesystem::path& file, const YAML::Mark& mark) {
  return mark.is_null() ? SourceLocation{file.string()} : SourceLocation{file.string(), mark.line + 1, mark.column + 1};
}

struct NumberKey {
  const char* name;
  double Camera::*member;
  double Distortion::*distortion_member;
  bool required, positive;
};

constexpr std::array<NumberKey, 10> number_keys = {{
    {"fx", &Camera::fx, nullptr, true, true},
    {"fy", &Camera::fy, nullptr, true, true},
    {"cx", &Camera::cx, nullptr, true, false},
    {"cy", &Camera::cy, nullptr, true, false},
    {"k1", nullptr, &Distortion::k1, false, false},
    {"k2", nullptr, &Distortion::k2, false, false},
    {"p1", nullptr, &Distortion::p1, false, false},
    {"p2", nullptr, &Distortion::p2, false, false},
    {"k3", nullptr, &Distortion::k3, false, false},
    {"baseline", &Camera::baseline, nullptr, false, true},
}};

[[noreturn]] void reject(const std::filesystem::path& file, const YAML::Node& node, const std::string& key,
                         const std::string& expected) {
  throw InputError(location(file, node.Mark()), "found '" +
                                                    (node.IsScalar() ? node.Scalar() : std::string("no value")) +
                                                    "' for " + key + "; expected " + expected + "; correct the value");
}

double read_number(const std::filesystem::path& file, const YAML::Node& node, const NumberKey& key) {
  const char* expected = key.positive ? "a number greater than 0" : "a number";
  if (!node.IsScalar()) reject(file, node, key.name, expected);
  const std::string& text = node.Scalar();
  double value = 0.0;
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || stop != text.data() + text.size() || !std::isfinite(value) ||
      (key.positive && value <= 0.0))
    reject(file, node, key.name, expected);
  return value;
}

int read_size(const std::filesystem::path& file, const YAML::Node& node, const char* key) {
  constexpr const char* expected = "a whole number of pixels from 1 to 32768";
  if (!node.IsScalar()) reject(file, node, key, expected);
  const std::string& text = node.Scalar();
  int value = 0;
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || stop != text.data() + text.size() || value < 1 || value > 32768)
    reject(file, node, key, expected);
  return value;
}

YAML::Node load(const std::filesystem::path& file) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error))
    throw InputError({file.string()}, std::string("is missing or not a file; expected a YAML or JSON file with ") +
                                          expected_keys + "; correct `source.folder.intrinsics`");
  try {
    return YAML::LoadFile(file.string());
  } catch (const YAML::ParserException& problem) {
    throw InputError(location(file, problem.mark), problem.msg + "; expected YAML or JSON");
  } catch (const YAML::Exception&) {
    throw InputError({file.string()}, "cannot be read; check its permissions");
  }
}

/// Reads the entry of a key; false for a key that is not known.
bool read_entry(const std::filesystem::path& file, const std::string& key, const YAML::Node& value, Camera& camera) {
  for (const NumberKey& number_key : number_keys) {
    if (key != number_key.name) continue;
    const double number = read_number(file, value, number_key);
    if (number_key.member != nullptr)
      camera.*number_key.member = number;
    else
      camera.distortion.*number_key.distortion_member = number;
    return true;
  }
  if (key == "width")
    camera.width = read_size(file, value, "width");
  else if (key == "height")
    camera.height = read_size(file, value, "height");
  else if (key == "name" && value.IsScalar())
    camera.name = value.Scalar();
  else
    return false;
  return true;
}

}  // namespace

Camera read_intrinsics(const std::filesystem::path& file, const Camera& defaults) {
  const YAML::Node root = load(file);
  if (!root.IsMap())
    throw InputError(location(file, root.Mark()), std::string("holds no keys; expected ") + expected_keys);
  Camera camera = defaults;
  camera.name = file.filename().string();
  camera.distortion = {};
  std::set<std::string> seen;
  for (const auto& entry : root) {
    const std::string key = entry.first.IsScalar() ? entry.first.Scalar() : std::string();
    const SourceLocation place = location(file, entry.first.Mark());
    if (!seen.insert(key).second) throw InputError(place, "key '" + key + "' is given twice; take one of them out");
    if (!read_entry(file, key, entry.second, camera))
      throw InputError(place, "unknown key '" + key + "'; expected " + expected_keys);
  }
  std::string missing;
  for (const char* key : {"fx", "fy", "cx", "cy", "width", "height"})
    if (!seen.contains(key)) missing += (missing.empty() ? "" : ", ") + std::string(key);
  if (!missing.empty()) throw InputError({file.string()}, "lacks " + missing + "; expected " + expected_keys);
  return camera;
}

}  // namespace holdfast::folder_plugin
