// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/core/text_file.hpp"

#include <algorithm>
#include <string_view>

namespace holdfast {

LineReader::LineReader(const std::filesystem::path& file, const std::string& expected, std::uint64_t most_bytes)
    : file_(file, most_bytes, expected), expected_(expected), buffer_(1 << 16) {}

bool LineReader::fill() {
  begin_ = 0;
  end_ = file_.read(buffer_.data(), buffer_.size());
  return end_ > 0;
}

bool LineReader::next(std::string& line) {
  line.clear();
  if (begin_ == end_ && !fill()) return false;
  ++number_;
  do {
    const char* first = buffer_.data() + begin_;
    const char* last = buffer_.data() + end_;
    const char* stop = std::find(first, last, '\n');
    line.append(first, stop);
    if (line.size() > longest_line)
      throw InputError(location(),
                       "found a line of more than " + std::to_string(longest_line) + " bytes; expected " + expected_);
    begin_ = static_cast<std::size_t>(stop - buffer_.data()) + (stop != last ? 1 : 0);
    if (stop != last) break;
  } while (fill());
  constexpr std::string_view byte_order_mark = "\xef\xbb\xbf";
  if (number_ == 1 && line.starts_with(byte_order_mark)) line.erase(0, byte_order_mark.size());
  return true;
}

}  // namespace holdfast
