// SPDX-License-Identifier: BSD-3-Clause
// Map files. The checksums are made anew, because no mutation would get past them otherwise; an input whose bytes have
// a sum that is divisible by 8 is read as it is.
#include <cstring>
#include <numeric>
#include <sstream>

#include "crc32c.hpp"
#include "fuzz.hpp"
#include "holdfast/map_io/map_export.hpp"
#include "holdfast/map_io/map_file.hpp"
#include "holdfast/map_io/map_info.hpp"

using namespace holdfast;

namespace {

template <class Number>
Number number_at(const std::string& bytes, std::size_t offset) {
  Number value = 0;
  std::memcpy(&value, bytes.data() + offset, sizeof value);
  return value;
}

void put(std::string& bytes, std::size_t offset, std::uint32_t value) {
  std::memcpy(bytes.data() + offset, &value, sizeof value);
}

/// docs/map_format.md: the header's checksum is its last member, those of a section follow its length.
void repair_checksums(std::string& bytes) {
  if (bytes.size() < 16) return;
  const std::size_t header = number_at<std::uint32_t>(bytes, 12);
  if (header < 16 || header > bytes.size()) return;
  put(bytes, header - 4, map_io::crc32c(bytes.data(), header - 4));
  for (std::size_t begin = header; bytes.size() - begin >= 24;) {
    const auto length = number_at<std::uint64_t>(bytes, begin + 8);
    if (length > bytes.size() - begin - 24) return;
    put(bytes, begin + 16, map_io::crc32c(bytes.data() + begin + 24, length));
    put(bytes, begin + 20, map_io::crc32c(bytes.data() + begin, 20));
    begin += 24 + length;
  }
}

std::string content(const std::filesystem::path& file) {
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return text.str();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::string bytes = fuzz::text_of({data, size});
  if (std::accumulate(data, data + size, std::size_t{0}) % 8 != 0) repair_checksums(bytes);
  const auto file =
      fuzz::folder().write("map.hfm", {reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
  const bool has_info = fuzz::accepts([&] {
    const MapInfo info = read_map_info(file);
    to_text(info);
    to_json(info);
  });
  Map map;
  if (!fuzz::accepts([&] { read_map(file, map); })) return 0;
  fuzz::require(has_info, "a map that can be read has key figures");
  points_ply(map);
  map_json(map);
  keyframe_trajectory(map);
  const auto copy = fuzz::folder().path() / "copy.hfm", second = fuzz::folder().path() / "second.hfm";
  write_map(copy, map);
  write_map(second, read_map(copy));
  fuzz::require(content(copy) == content(second), "a written map gives the same bytes again");
  return 0;
}
