// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/image_files/image_list.hpp"

#include <cmath>
#include <cstdio>
#include <functional>
#include <string_view>

#include "holdfast/core/counted.hpp"
#include "holdfast/core/error.hpp"
#include "holdfast/core/parsed_number.hpp"
#include "holdfast/core/stamp_unit.hpp"
#include "holdfast/core/text_file.hpp"

namespace holdfast {

namespace {

std::vector<std::string_view> split(std::string_view line) {
  std::vector<std::string_view> words;
  while (true) {
    const std::size_t begin = line.find_first_not_of(" \t\r");
    if (begin == std::string_view::npos) return words;
    line.remove_prefix(begin);
    const std::size_t end = std::min(line.find_first_of(" \t\r"), line.size());
    words.push_back(line.substr(0, end));
    line.remove_prefix(end);
  }
}

/// One line of a list being read: where it stands and its words.
class ListLine {
 public:
  ListLine(const std::filesystem::path& file, int number, std::string_view text, const char* form)
      : file_(file), number_(number), text_(text), words_(split(text)), form_(form) {}

  [[noreturn]] void fail(const std::string& found) const {
    throw InputError({file_.string(), number_},
                     found + "; expected a line '" + form_ + "'; correct the line or take it out");
  }

  void require_words(std::size_t count) const {
    if (words_.size() != count)
      fail("found " + counted(words_.size(), "word") + " in '" + std::string(text_.substr(0, 80)) + "'");
  }

  ListedImage image(std::size_t first_word, bool has_name) const {
    std::string_view word = words_[first_word];
    ListedImage result;
    const auto stamp = parsed_number<double>(word);
    if (!stamp) fail("found '" + std::string(word) + "' where a time stamp should be");
    result.timestamp = *stamp;
    if (!std::isfinite(result.timestamp)) fail("found the time stamp '" + std::string(word) + "', which is not finite");
    if (const std::string unit = stamp_magnitude_suspicion(result.timestamp); !unit.empty())
      throw InputError({file_.string(), number_},
                       "found the time stamp '" + std::string(word) + "', but time stamps are seconds; they " + unit);
    if (has_name) result.name = words_[first_word + 1];
    result.line = number_;
    return result;
  }

  bool is_blank() const { return words_.empty() || words_.front().front() == '#'; }

 private:
  const std::filesystem::path& file_;
  int number_;
  std::string_view text_;
  std::vector<std::string_view> words_;
  const char* form_;
};

void require_rising(const std::filesystem::path& file, const ListedImage& previous, const ListedImage& current) {
  if (current.timestamp > previous.timestamp) return;
  const bool same = current.timestamp == previous.timestamp;
  throw InputError(
      {file.string(), current.line},
      std::string("found the time stamp ") + stamp_text(current.timestamp) +
          (same ? ", the same as in line " : ", earlier than " + stamp_text(previous.timestamp) + " in line ") +
          std::to_string(previous.line) + "; expected stamps that rise from line to line; " +
          (same ? "take one of the two lines out" : "sort the list by time"));
}

/// Calls read for every line that is neither blank nor a comment; read returns what must rise in time.
void read_lines(const std::filesystem::path& file, const char* form,
                const std::function<ListedImage(const ListLine&)>& read) {
  std::error_code error;
  if (!std::filesystem::exists(file, error))
    throw InputError({file.string()}, std::string("is missing; expected a list with lines '") + form +
                                          "'; does the path name the folder of the recording?");
  LineReader reader(file, std::string("a list with lines '") + form + "'");
  ListedImage previous;
  std::string text;
  int lines = 0;
  while (reader.next(text)) {
    const ListLine line(file, reader.number(), text, form);
    if (line.is_blank()) continue;
    const ListedImage current = read(line);
    if (lines++ > 0) require_rising(file, previous, current);
    previous = current;
  }
  if (lines == 0)
    throw InputError({file.string()},
                     std::string("is an empty list; expected lines '") + form + "'; complete the recording");
}

}  // namespace

std::vector<ListedImage> read_image_list(const std::filesystem::path& file) {
  std::vector<ListedImage> images;
  read_lines(file, "timestamp filename", [&](const ListLine& line) {
    line.require_words(2);
    return images.emplace_back(line.image(0, true));
  });
  return images;
}

std::vector<ListedPair> read_association_list(const std::filesystem::path& file) {
  std::vector<ListedPair> pairs;
  read_lines(file, "colour_timestamp colour_file depth_timestamp depth_file", [&](const ListLine& line) {
    line.require_words(4);
    return pairs.emplace_back(ListedPair{line.image(0, true), line.image(2, true)}).colour;
  });
  return pairs;
}

std::vector<ListedImage> read_stamp_list(const std::filesystem::path& file) {
  std::vector<ListedImage> stamps;
  read_lines(file, "timestamp", [&](const ListLine& line) {
    line.require_words(1);
    return stamps.emplace_back(line.image(0, false));
  });
  return stamps;
}

std::string stamp_text(double timestamp) {
  char text[400];
  std::snprintf(text, sizeof(text), "%.6f", timestamp);
  return text;
}

}  // namespace holdfast
