// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/inference/model_metadata.hpp"

#include <algorithm>
#include <cctype>
#include <set>
#include <tuple>
#include <utility>

namespace holdfast {

namespace {

constexpr std::size_t most_names = 10000;

/// Reads literals of Python and JSON from a text, one after the other.
class LiteralReader {
 public:
  explicit LiteralReader(const std::string& text) : text_(text) {}

  bool is_at_end() {
    skip_spaces();
    return at_ == text_.size();
  }
  bool take(char wanted) {
    skip_spaces();
    if (at_ == text_.size() || text_[at_] != wanted) return false;
    ++at_;
    return true;
  }
  std::optional<std::string> quoted() {
    const char quote = take('\'') ? '\'' : take('"') ? '"' : '\0';
    if (quote == '\0') return std::nullopt;
    std::string result;
    for (; at_ < text_.size(); ++at_) {
      if (text_[at_] == quote) {
        ++at_;
        return result;
      }
      if (text_[at_] == '\\' && at_ + 1 < text_.size()) ++at_;
      result += text_[at_];
    }
    return std::nullopt;
  }
  /// A number without a sign, below `limit`.
  std::optional<std::size_t> number(std::size_t limit) {
    skip_spaces();
    std::size_t value = 0, digits = 0;
    for (; at_ < text_.size() && std::isdigit(static_cast<unsigned char>(text_[at_])) != 0; ++at_, ++digits) {
      value = value * 10 + static_cast<std::size_t>(text_[at_] - '0');
      if (value >= limit) return std::nullopt;
    }
    return digits > 0 ? std::optional(value) : std::nullopt;
  }

 private:
  void skip_spaces() {
    while (at_ < text_.size() && std::isspace(static_cast<unsigned char>(text_[at_])) != 0) ++at_;
  }

  const std::string& text_;
  std::size_t at_ = 0;
};

/// A key of the dictionary, a number that may be quoted, and its colon.
std::optional<std::size_t> read_key(LiteralReader& reader) {
  std::optional<std::size_t> key = reader.number(most_names);
  if (!key) {
    const std::optional<std::string> text = reader.quoted();
    if (!text) return std::nullopt;
    LiteralReader inner(*text);
    key = inner.number(most_names);
    if (!inner.is_at_end()) return std::nullopt;
  }
  if (!reader.take(':')) return std::nullopt;
  return key;
}

/// Two numbers, [height, width], or one for both.
std::pair<int, int> read_image_size(const std::string& text) {
  constexpr std::size_t limit = 8193;
  LiteralReader reader(text);
  const bool is_list = reader.take('[') || reader.take('(');
  const std::optional<std::size_t> height = reader.number(limit);
  std::optional<std::size_t> width = height;
  if (is_list && reader.take(',')) width = reader.number(limit);
  if (!height || !width) return {0, 0};
  return {static_cast<int>(*height), static_cast<int>(*width)};
}

std::string value_of(const std::map<std::string, std::string>& metadata, const char* key) {
  const auto found = metadata.find(key);
  return found == metadata.end() ? "" : found->second;
}

void make_distinct(std::vector<std::string>& names) {
  std::set<std::string> known;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (names[i].empty()) names[i] = "class " + std::to_string(i);
    while (!known.insert(names[i]).second) names[i] += " " + std::to_string(i);
  }
}

}  // namespace

std::optional<std::vector<std::string>> read_class_names(const std::string& text) {
  LiteralReader reader(text);
  const bool is_dictionary = reader.take('{');
  if (!is_dictionary && !reader.take('[')) return std::nullopt;
  const char end = is_dictionary ? '}' : ']';
  std::vector<std::string> names;
  for (bool is_first = true; !reader.take(end); is_first = false) {
    if (!is_first && !reader.take(',')) return std::nullopt;
    if (!is_first && reader.take(end)) break;  // a comma behind the last one
    const std::optional<std::size_t> key = is_dictionary ? read_key(reader) : names.size();
    std::optional<std::string> name = reader.quoted();
    if (!key || !name || *key >= most_names) return std::nullopt;
    names.resize(std::max(names.size(), *key + 1));
    names[*key] = std::move(*name);
  }
  if (!reader.is_at_end()) return std::nullopt;
  make_distinct(names);
  return names;
}

ModelMetadata read_model_metadata(const std::map<std::string, std::string>& metadata) {
  ModelMetadata result;
  if (auto names = read_class_names(value_of(metadata, "names"))) result.names = std::move(*names);
  result.task = value_of(metadata, "task");
  std::tie(result.height, result.width) = read_image_size(value_of(metadata, "imgsz"));
  return result;
}

}  // namespace holdfast
