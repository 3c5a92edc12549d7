// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>

#include "bytes.hpp"

/// The frame around the content of a map file: a header and sections, each with its checksum. docs/map_format.md has
/// the layout; sizes and offsets here are those of that page.
namespace holdfast::map_io {

inline constexpr std::uint32_t format_version = 1;
inline constexpr std::size_t header_size = 76;
inline constexpr std::size_t section_header_size = 24;
inline constexpr std::uint32_t section_required = 1;  ///< flag: a reader that does not know the type must give up

struct FileHeader {
  std::uint32_t version = format_version;
  std::string library_version;
  std::uint64_t file_size = 0;
  std::uint32_t sections = 0;
  std::uint32_t keyframes = 0;
  std::uint32_t points = 0;
  std::uint64_t observations = 0;
  std::uint64_t next_sequence = 0;
  std::uint32_t sensor = 0;
};

/// The bytes of the header, checksum included.
std::string encode(const FileHeader& header);
/// The bytes before a section's payload; `type` has four letters.
std::string encode_section_header(const std::string& type, const std::string& payload,
                                  std::uint32_t flags = section_required);

/// Reads a map file from the front to the back and checks every byte: magic, version, sizes, checksums. Throws
/// InputError.
class ContainerReader {
 public:
  explicit ContainerReader(const std::filesystem::path& file);

  const FileHeader& header() const { return header_; }
  /// The next section; false after the last one. Its payload is held until the next call.
  bool next();
  const std::string& type() const { return type_; }
  bool required() const { return (flags_ & section_required) != 0; }
  /// Over the payload of the section.
  ByteReader payload() const { return {payload_, name_, type_, payload_offset_}; }
  [[noreturn]] void fail(const std::string& message) const;

 private:
  void read_header();
  std::string read(std::size_t count);

  std::string name_;
  std::ifstream stream_;
  std::uint64_t size_ = 0, position_ = 0, payload_offset_ = 0;
  FileHeader header_;
  std::uint32_t sections_read_ = 0, flags_ = 0;
  std::string type_, payload_;
};

}  // namespace holdfast::map_io
