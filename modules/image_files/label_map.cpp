// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/image_files/label_map.hpp"

#include <algorithm>
#include <optional>
#include <string_view>
#include <utility>

#include "holdfast/core/cell_mask.hpp"
#include "holdfast/core/error.hpp"
#include "holdfast/core/parsed_number.hpp"

namespace holdfast {

namespace {

constexpr std::uint16_t no_label = 256;
constexpr std::size_t most_values = 65536;

std::optional<std::size_t> value_of(std::string_view text) {
  const auto value = parsed_number<std::size_t>(text);
  return value && *value < most_values ? value : std::nullopt;
}

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
  while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
  return text;
}

/// "7" or "1-254".
std::optional<std::pair<std::size_t, std::size_t>> range_of(std::string_view text) {
  const std::size_t dash = text.find('-');
  const auto first = value_of(trimmed(text.substr(0, dash)));
  const auto last = dash == std::string_view::npos ? first : value_of(trimmed(text.substr(dash + 1)));
  if (!first || !last || *last < *first) return std::nullopt;
  return std::pair(*first, *last);
}

template <class Pixel>
cv::Mat look_up(const cv::Mat& values, const std::vector<std::uint16_t>& label_of_value,
                const std::filesystem::path& file) {
  cv::Mat labels(values.size(), CV_8UC1);
  for (int y = 0; y < values.rows; ++y) {
    const auto* from = values.ptr<Pixel>(y);
    auto* to = labels.ptr<std::uint8_t>(y);
    std::uint16_t all = 0;
    for (int x = 0; x < values.cols; ++x) {
      const std::uint16_t label = label_of_value[from[x]];
      all |= label;
      to[x] = static_cast<std::uint8_t>(label);
    }
    if ((all & no_label) == 0) continue;
    int x = 0;
    while (label_of_value[from[x]] != no_label) ++x;
    const std::string value = std::to_string(from[x]);
    throw InputError({file.string()}, "has the value " + value + " at pixel (" + std::to_string(x) + ", " +
                                          std::to_string(y) +
                                          "), which `labels` does not name; say what it means, such as `labels: { " +
                                          value + ": person }`, or `" + value + ": unknown`");
  }
  return labels;
}

}  // namespace

LabelMap::LabelMap(const TextMap& labels, const std::string& where)
    : classes_{"background"}, label_of_value_(most_values, no_label) {
  std::vector<Diagnostic> diagnostics;
  const auto problem = [&](const std::string& message) { diagnostics.push_back({{}, where + ": " + message}); };
  if (labels.empty())
    problem("is empty; expected values or ranges with the names of their classes, such as { 1-254: person }");
  std::vector<const std::string*> named_by(most_values, nullptr);
  for (const auto& [key, name] : labels) {
    const auto range = range_of(key);
    if (!range) {
      problem("found '" + key + "'; expected a value from 0 to 65535 or a range such as 1-254");
      continue;
    }
    if (name.empty()) {
      problem("'" + key + "' has no class name; expected one, such as person, background or unknown");
      continue;
    }
    std::size_t label = CellMask::unknown;
    if (name != "unknown") {
      label = static_cast<std::size_t>(std::find(classes_.begin(), classes_.end(), name) - classes_.begin());
      if (label == classes_.size()) classes_.push_back(name);
    }
    for (std::size_t value = range->first; value <= range->second; ++value) {
      if (named_by[value] != nullptr) {
        problem("'" + key + "' and '" + *named_by[value] + "' both name the value " + std::to_string(value) +
                "; expected ranges that do not overlap");
        break;  // the first value is enough to say, and many overlapping ranges would take long
      }
      named_by[value] = &key;
      label_of_value_[value] = static_cast<std::uint16_t>(label);
    }
  }
  if (classes_.size() > CellMask::unknown)
    problem("names " + std::to_string(classes_.size() - 1) + " classes; expected at most 254");
  if (!diagnostics.empty()) throw ConfigurationError(std::move(diagnostics));
  if (label_of_value_[0] == no_label) label_of_value_[0] = 0;
}

cv::Mat LabelMap::apply(const cv::Mat& values, const std::filesystem::path& file) const {
  return values.depth() == CV_8U ? look_up<std::uint8_t>(values, label_of_value_, file)
                                 : look_up<std::uint16_t>(values, label_of_value_, file);
}

}  // namespace holdfast
