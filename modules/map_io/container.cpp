// SPDX-License-Identifier: BSD-3-Clause
#include "container.hpp"

#include <algorithm>
#include <cctype>
#include <string_view>

#include "crc32c.hpp"
#include "holdfast/core/counted.hpp"
#include "holdfast/core/error.hpp"

namespace holdfast::map_io {

namespace {

/// As in PNG: a byte above 127, line ends of both kinds and the end-of-file of old systems show a transfer as text.
constexpr std::string_view magic("\x89HFM\r\n\x1a\n", 8);
constexpr std::size_t library_version_size = 16;
constexpr std::size_t largest_header = 4096;

constexpr const char* expected = "expected a map file (.hfm) as `holdfast run` writes it";
constexpr const char* damaged = "the file is damaged: use another copy of it, or make the map again";

std::string hexadecimal(std::uint32_t value) {
  constexpr const char* digits = "0123456789abcdef";
  std::string text = "0x";
  for (int shift = 28; shift >= 0; shift -= 4) text += digits[(value >> shift) & 0xFU];
  return text;
}

std::string checksum_text(const char* of, std::uint64_t offset, std::uint32_t found, std::uint32_t written) {
  return std::string("the checksum of ") + of + " at byte " + std::to_string(offset) + " is " + hexadecimal(found) +
         ", the file says " + hexadecimal(written) + "; " + damaged;
}

}  // namespace

std::string encode(const FileHeader& header) {
  ByteWriter writer;
  writer.put_bytes(magic);
  writer.put(header.version);
  writer.put(static_cast<std::uint32_t>(header_size));
  std::string library_version = header.library_version.substr(0, library_version_size);
  library_version.resize(library_version_size, '\0');
  writer.put_bytes(library_version);
  writer.put(header.file_size);
  writer.put(header.sections);
  writer.put(header.keyframes);
  writer.put(header.points);
  writer.put(header.sensor);
  writer.put(header.observations);
  writer.put(header.next_sequence);
  writer.put(crc32c(writer.bytes().data(), writer.size()));
  return writer.bytes();
}

std::string encode_section_header(const std::string& type, const std::string& payload, std::uint32_t flags) {
  ByteWriter writer;
  writer.put_bytes(type);
  writer.put(flags);
  writer.put(static_cast<std::uint64_t>(payload.size()));
  writer.put(crc32c(payload.data(), payload.size()));
  writer.put(crc32c(writer.bytes().data(), writer.size()));
  return writer.bytes();
}

void ContainerReader::fail(const std::string& message) const { throw InputError({name_}, message); }

ContainerReader::ContainerReader(const std::filesystem::path& file) : name_(file.string()) {
  std::error_code status;
  if (!std::filesystem::exists(file, status)) fail(std::string("no such file; ") + expected);
  if (!std::filesystem::is_regular_file(file, status))
    fail(std::filesystem::is_directory(file, status) ? std::string("found a folder; ") + expected
                                                     : std::string("found no regular file; ") + expected);
  stream_.open(file, std::ios::binary);
  size_ = std::filesystem::file_size(file, status);
  if (!stream_ || status) fail(std::string("cannot be opened for reading; ") + expected);
  read_header();
}

std::string ContainerReader::read(std::size_t count) {
  std::string bytes(count, '\0');
  stream_.read(bytes.data(), static_cast<std::streamsize>(count));
  if (stream_.gcount() != static_cast<std::streamsize>(count))
    fail("reading stopped at byte " + std::to_string(position_ + static_cast<std::uint64_t>(stream_.gcount())) +
         " of " + std::to_string(size_) + "; is the disk in order, and nobody else writing?");
  position_ += count;
  return bytes;
}

void ContainerReader::read_header() {
  if (size_ == 0) fail(std::string("the file is empty; ") + expected);
  constexpr std::size_t start_size = magic.size() + 8;
  std::string bytes = read(static_cast<std::size_t>(std::min<std::uint64_t>(size_, start_size)));
  const std::size_t compared = std::min(bytes.size(), magic.size());
  if (std::string_view(bytes).substr(0, compared) != magic.substr(0, compared))
    fail(std::string("found a file of another kind, which does not begin as a map does; ") + expected);
  const auto too_short = [&] {
    fail("the file ends after " + std::to_string(size_) + " bytes, in its header: it was cut off; " + damaged);
  };
  if (bytes.size() < start_size) too_short();
  const auto version = from_little_endian<std::uint32_t>(bytes.data() + 8);
  const auto length = from_little_endian<std::uint32_t>(bytes.data() + 12);
  if (length < start_size + 4 || length > largest_header)
    fail("the header says it has " + std::to_string(length) + " bytes; expected " + std::to_string(header_size) + "; " +
         damaged);
  if (length > size_) too_short();
  bytes += read(length - start_size);
  const auto written = from_little_endian<std::uint32_t>(bytes.data() + length - 4);
  const std::uint32_t found = crc32c(bytes.data(), length - 4);
  if (found != written) fail(checksum_text("the header", 0, found, written));
  // Only now: a damaged number must not be taken for a newer version.
  if (version > format_version)
    fail("found format version " + std::to_string(version) + "; this Holdfast reads versions up to " +
         std::to_string(format_version) + ": use a newer Holdfast");
  if (version == 0 || length < header_size)
    fail("found format version " + std::to_string(version) + " with a header of " + std::to_string(length) +
         " bytes; the file was written wrongly: make the map again");

  ByteReader reader(bytes, name_, "header", 0);
  reader.get_bytes(start_size);
  header_.version = version;
  const std::string_view library = reader.get_bytes(library_version_size);
  for (const char letter : library.substr(0, library.find('\0')))
    header_.library_version += std::isprint(static_cast<unsigned char>(letter)) != 0 ? letter : '?';
  header_.file_size = reader.get<std::uint64_t>();
  header_.sections = reader.get<std::uint32_t>();
  header_.keyframes = reader.get<std::uint32_t>();
  header_.points = reader.get<std::uint32_t>();
  header_.sensor = reader.get<std::uint32_t>();
  header_.observations = reader.get<std::uint64_t>();
  header_.next_sequence = reader.get<std::uint64_t>();
  if (header_.file_size != size_)
    fail("the file has " + std::to_string(size_) + " bytes; expected " + std::to_string(header_.file_size) +
         (size_ < header_.file_size ? ": it was cut off; " : ": something was added; ") + damaged);
}

bool ContainerReader::next() {
  if (sections_read_ == header_.sections) {
    if (position_ != size_) fail("found " + counted(size_ - position_, "byte") + " after the last section; " + damaged);
    return false;
  }
  const std::uint64_t begin = position_;
  if (size_ - position_ < section_header_size)
    fail("the file ends before section " + std::to_string(sections_read_ + 1) + " of " +
         std::to_string(header_.sections) + "; " + damaged);
  const std::string bytes = read(section_header_size);
  const std::uint32_t found = crc32c(bytes.data(), section_header_size - 4);
  const auto written = from_little_endian<std::uint32_t>(bytes.data() + section_header_size - 4);
  if (found != written) fail(checksum_text("the section header", begin, found, written));
  type_ = bytes.substr(0, 4);
  for (char& letter : type_)
    if (std::isprint(static_cast<unsigned char>(letter)) == 0) letter = '?';
  flags_ = from_little_endian<std::uint32_t>(bytes.data() + 4);
  const auto length = from_little_endian<std::uint64_t>(bytes.data() + 8);
  if (length > size_ - position_)
    fail("section '" + type_ + "' at byte " + std::to_string(begin) + " says it has " + std::to_string(length) +
         " bytes; the file has " + std::to_string(size_ - position_) + " more; " + damaged);
  payload_offset_ = position_;
  payload_ = read(static_cast<std::size_t>(length));
  const auto payload_checksum = from_little_endian<std::uint32_t>(bytes.data() + 16);
  const std::uint32_t payload_found = crc32c(payload_.data(), payload_.size());
  if (payload_found != payload_checksum)
    fail(checksum_text(("section '" + type_ + "'").c_str(), begin, payload_found, payload_checksum));
  ++sections_read_;
  return true;
}

}  // namespace holdfast::map_io
