// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "holdfast/core/error.hpp"
#include "holdfast/core/parsed_number.hpp"

namespace holdfast {

using ClassWeights = std::vector<std::pair<std::string, double>>;

inline constexpr const char* without_classes = "descriptors alone";

/// "descriptors alone", and the sets of weights of an argument, which ';' separates.
inline std::vector<std::string> weight_sets(const std::string& text) {
  std::vector<std::string> names = {without_classes};
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find(';', begin), text.size());
    names.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return names;
}

/// The weights of "chair=0.1,monitor=0.1"; none for "descriptors alone". Throws ConfigurationError.
inline ClassWeights class_weights_of(const std::string& text) {
  ClassWeights weights;
  if (text == without_classes) return weights;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size()), equals = text.find('=', begin);
    const auto number = equals < end ? parsed_number<double>(text.substr(equals + 1, end - equals - 1)) : std::nullopt;
    if (!number)
      throw ConfigurationError(SourceLocation{},
                               "found '" + text + "'; expected weights such as chair=0.1,monitor=0.1");
    weights.emplace_back(text.substr(begin, equals - begin), *number);
    begin = end + 1;
  }
  return weights;
}

}  // namespace holdfast
