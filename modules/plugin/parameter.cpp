// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/plugin/parameter.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "holdfast/core/parsed_number.hpp"

namespace holdfast {

namespace {

template <class Number>
std::string shortest_text(Number number) {
  std::array<char, 32> buffer;
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), number).ptr;
  return {buffer.data(), end};
}

std::string yaml_real(double number) {
  if (std::isnan(number)) return ".nan";
  if (std::isinf(number)) return number > 0 ? ".inf" : "-.inf";
  std::string text = shortest_text(number);
  // A real stays visibly one.
  if (text.find_first_of(".e") == std::string::npos) text += ".0";
  return text;
}

bool is_plain(const std::string& text) {
  static constexpr std::array keywords{"true", "false", "yes", "no", "on", "off", "null", "y", "n"};
  const auto is_letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; };
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  if (text.empty()) return false;
  const bool is_path = text.starts_with('/') || text.starts_with("./") || text.starts_with("../");
  if (!is_letter(text.front()) && !is_path) return false;
  for (char c : text)
    if (!is_letter(c) && !is_digit(c) && c != '/' && c != '.' && c != '-' && c != '+') return false;
  std::string lower = text;
  std::transform(lower.begin(), lower.end(), lower.begin(), [](unsigned char c) { return std::tolower(c); });
  return std::find(keywords.begin(), keywords.end(), lower) == keywords.end();
}

std::string yaml_text(const std::string& text) {
  if (is_plain(text)) return text;
  std::string quoted = "\"";
  for (char c : text) {
    if (c == '"' || c == '\\')
      quoted += '\\', quoted += c;
    else if (c == '\n')
      quoted += "\\n";
    else if (c == '\t')
      quoted += "\\t";
    else if (static_cast<unsigned char>(c) < 0x20) {
      static constexpr char digits[] = "0123456789abcdef";
      quoted += "\\x", quoted += digits[c >> 4], quoted += digits[c & 15];
    } else
      quoted += c;
  }
  return quoted + '"';
}

template <class Items, class Function>
std::string joined(const Items& items, Function text_of) {
  std::string text;
  for (const auto& item : items) text += (text.empty() ? "" : ", ") + text_of(item);
  return text;
}

struct YamlText {
  std::string operator()(bool value) const { return value ? "true" : "false"; }
  std::string operator()(std::int64_t value) const { return std::to_string(value); }
  std::string operator()(double value) const { return yaml_real(value); }
  std::string operator()(const std::string& value) const { return yaml_text(value); }
  std::string operator()(const std::vector<std::string>& value) const { return '[' + joined(value, yaml_text) + ']'; }
  std::string operator()(const std::vector<double>& value) const { return '[' + joined(value, yaml_real) + ']'; }
  std::string operator()(const RealTable& value) const {
    return '[' + joined(value, [this](const std::vector<double>& row) { return (*this)(row); }) + ']';
  }
  std::string operator()(const TextMap& value) const {
    return '{' + joined(value, [](const auto& pair) { return yaml_text(pair.first) + ": " + yaml_text(pair.second); }) +
           '}';
  }
  std::string operator()(const RealMap& value) const {
    return '{' + joined(value, [](const auto& pair) { return yaml_text(pair.first) + ": " + yaml_real(pair.second); }) +
           '}';
  }
};

/// For people to read: 100000 rather than 1e+05.
std::string number_text(double number) {
  constexpr double largest_plain = 1e9;
  if (std::abs(number) < largest_plain && number == std::trunc(number))
    return std::to_string(static_cast<std::int64_t>(number));
  return shortest_text(number);
}

bool has_type(const ParameterValue& value, ParameterType type) {
  switch (type) {
    case ParameterType::boolean:
      return std::holds_alternative<bool>(value);
    case ParameterType::integer:
      return std::holds_alternative<std::int64_t>(value);
    case ParameterType::real:
      return std::holds_alternative<double>(value);
    case ParameterType::text:
    case ParameterType::path:
      return std::holds_alternative<std::string>(value);
    case ParameterType::text_list:
      return std::holds_alternative<std::vector<std::string>>(value);
    case ParameterType::real_list:
      return std::holds_alternative<std::vector<double>>(value);
    case ParameterType::text_map:
      return std::holds_alternative<TextMap>(value);
    case ParameterType::real_table:
      return std::holds_alternative<RealTable>(value);
    case ParameterType::real_map:
      return std::holds_alternative<RealMap>(value);
  }
  return false;
}

bool is_collection(ParameterType type) {
  return type == ParameterType::real_list || type == ParameterType::real_table || type == ParameterType::real_map;
}

}  // namespace

const char* to_string(ParameterType type) {
  switch (type) {
    case ParameterType::boolean:
      return "boolean";
    case ParameterType::integer:
      return "integer";
    case ParameterType::real:
      return "real";
    case ParameterType::text:
      return "text";
    case ParameterType::path:
      return "path";
    case ParameterType::text_list:
      return "list of texts";
    case ParameterType::real_list:
      return "list of reals";
    case ParameterType::text_map:
      return "map of texts";
    case ParameterType::real_table:
      return "list of lists of reals";
    case ParameterType::real_map:
      return "map of reals";
  }
  return "unknown";
}

std::string to_string(const ParameterValue& value) { return std::visit(YamlText{}, value); }

double shortest_double(float number) {
  if (!std::isfinite(number)) return number;
  return *parsed_number<double>(shortest_text(number));
}

std::string Parameter::range_text() const {
  const bool has_low = minimum.has_value();
  const bool has_high = maximum.has_value();
  if (has_low && has_high) return "from " + number_text(*minimum) + " to " + number_text(*maximum);
  if (has_low) return "of at least " + number_text(*minimum);
  if (has_high) return "of at most " + number_text(*maximum);
  return "";
}

std::string Parameter::expectation() const {
  const std::string choice = joined(allowed, [](const std::string& text) { return text; });
  std::string text;
  switch (type) {
    case ParameterType::boolean:
      return "true or false";
    case ParameterType::integer:
      text = "an integer";
      break;
    case ParameterType::real:
      text = "a number";
      break;
    case ParameterType::text:
      text = allowed.empty() ? "a text" : "one of " + choice;
      break;
    case ParameterType::path:
      text = "a path";
      break;
    case ParameterType::text_list:
      text = allowed.empty() ? "a list of texts" : "a list of " + choice;
      break;
    case ParameterType::real_list:
      text = "a list of numbers";
      break;
    case ParameterType::text_map:
      text = "a map from text to text";
      break;
    case ParameterType::real_table:
      text = "a list of lists of numbers";
      break;
    case ParameterType::real_map:
      text = "a map from names to numbers";
      break;
  }
  if (const std::string range = range_text(); !range.empty()) text += (is_collection(type) ? ", each " : " ") + range;
  if (!unit_name.empty()) text += " [" + unit_name + "]";
  return text;
}

std::optional<std::string> Parameter::reject(const ParameterValue& value) const {
  if (!has_type(value, type)) return to_string(value) + " is no " + holdfast::to_string(type);
  const auto check_number = [&](double number) -> std::optional<std::string> {
    if (!std::isfinite(number)) return yaml_real(number) + " is not finite";
    if (minimum && number < *minimum) return number_text(number) + " is below " + number_text(*minimum);
    if (maximum && number > *maximum) return number_text(number) + " is above " + number_text(*maximum);
    return std::nullopt;
  };
  const auto check_text = [&](const std::string& text) -> std::optional<std::string> {
    if (allowed.empty() || std::find(allowed.begin(), allowed.end(), text) != allowed.end()) return std::nullopt;
    return "'" + text + "' is not among them";
  };
  if (const auto* number = std::get_if<std::int64_t>(&value)) {
    if (*number < min_integer || *number > max_integer)
      return std::to_string(*number) + " is outside what can be stored, " + std::to_string(min_integer) + " to " +
             std::to_string(max_integer);
    return check_number(static_cast<double>(*number));
  }
  if (const auto* number = std::get_if<double>(&value)) return check_number(*number);
  if (const auto* text = std::get_if<std::string>(&value)) return check_text(*text);
  if (const auto* numbers = std::get_if<std::vector<double>>(&value)) {
    for (double number : *numbers)
      if (auto reason = check_number(number)) return reason;
  }
  if (const auto* table = std::get_if<RealTable>(&value)) {
    for (const std::vector<double>& row : *table)
      for (double number : row)
        if (auto reason = check_number(number)) return reason;
  }
  if (const auto* map = std::get_if<RealMap>(&value)) {
    for (const auto& [name, number] : *map)
      if (auto reason = check_number(number)) return "'" + name + "': " + *reason;
  }
  if (const auto* texts = std::get_if<std::vector<std::string>>(&value)) {
    for (const std::string& text : *texts)
      if (auto reason = check_text(text)) return reason;
  }
  return std::nullopt;
}

}  // namespace holdfast
