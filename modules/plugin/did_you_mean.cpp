// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/plugin/did_you_mean.hpp"

#include <algorithm>
#include <cctype>

namespace holdfast {

int edit_distance(std::string_view a, std::string_view b) {
  const std::size_t width = b.size() + 1;
  std::vector<int> table((a.size() + 1) * width);
  const auto at = [&](std::size_t i, std::size_t j) -> int& { return table[i * width + j]; };
  for (std::size_t i = 0; i <= a.size(); ++i) at(i, 0) = static_cast<int>(i);
  for (std::size_t j = 0; j <= b.size(); ++j) at(0, j) = static_cast<int>(j);
  for (std::size_t i = 1; i <= a.size(); ++i) {
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const int substitution = at(i - 1, j - 1) + (a[i - 1] == b[j - 1] ? 0 : 1);
      at(i, j) = std::min({at(i - 1, j) + 1, at(i, j - 1) + 1, substitution});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        at(i, j) = std::min(at(i, j), at(i - 2, j - 2) + 1);
    }
  }
  return at(a.size(), b.size());
}

namespace {
std::string normalised(std::string_view name) {
  std::string text(name);
  for (char& c : text) c = c == '-' ? '_' : static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}
}  // namespace

std::optional<std::string> nearest_name(std::string_view name, const std::vector<std::string>& known) {
  const std::string wanted = normalised(name);
  std::optional<std::string> nearest;
  int least = 0;
  for (const std::string& candidate : known) {
    const std::string other = normalised(candidate);
    int distance = edit_distance(wanted, other);
    if (wanted.size() >= 3 && other.starts_with(wanted)) distance = std::min(distance, 1);
    const int limit = std::max(1, static_cast<int>(std::max(wanted.size(), other.size()) / 3));
    // Every single letter is one edit away from every other one, which is not a similarity.
    const bool resembles = distance <= limit && distance < static_cast<int>(std::max(wanted.size(), other.size()));
    if (resembles && (!nearest || distance < least)) {
      nearest = candidate;
      least = distance;
    }
  }
  return nearest;
}

std::string did_you_mean(std::string_view name, const std::vector<std::string>& known) {
  if (const auto nearest = nearest_name(name, known)) return "did you mean '" + *nearest + "'?";
  if (known.empty()) return "none is known";
  std::string text = "known are ";
  for (std::size_t i = 0; i < known.size(); ++i) text += (i == 0 ? "" : ", ") + known[i];
  return text;
}

}  // namespace holdfast
