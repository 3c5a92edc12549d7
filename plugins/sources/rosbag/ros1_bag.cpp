// SPDX-License-Identifier: BSD-3-Clause
#include "ros1_bag.hpp"

#include <algorithm>
#include <string_view>

namespace holdfast::rosbag_plugin {

namespace {

using Fields = std::map<std::string, std::string>;

// Kinds of records.
constexpr char message_record = 0x02, file_record = 0x03, index_record = 0x04, chunk_record = 0x05;
constexpr char chunk_info_record = 0x06, connection_record = 0x07;

constexpr std::uint64_t largest_header = 1U << 20;  // bytes; names and numbers
constexpr std::uint64_t most_chunks = 1U << 24;

/// The fields of a record's header, each a length and "name=value".
Fields read_fields(Bytes bytes, const std::string& place) {
  Fields fields;
  ByteReader reader(bytes, place);
  while (!reader.is_at_end()) {
    const std::string field = reader.text("header");
    const std::size_t separator = field.find('=');
    if (separator == std::string::npos)
      throw InputError({place}, "has a header field without '='; the bag is damaged, copy it again");
    fields[field.substr(0, separator)] = field.substr(separator + 1);
  }
  return fields;
}

template <class Number>
Number number_in(const Fields& fields, const char* name, const std::string& place) {
  const auto field = fields.find(name);
  if (field == fields.end() || field->second.size() != sizeof(Number))
    throw InputError({place}, std::string("has no field '") + name + "' of " + std::to_string(sizeof(Number)) +
                                  " bytes; the bag is damaged, copy it again");
  return ByteReader({reinterpret_cast<const std::uint8_t*>(field->second.data()), sizeof(Number)}, place)
      .number<Number>(name);
}

std::string text_in(const Fields& fields, const char* name, const std::string& place) {
  const auto field = fields.find(name);
  if (field == fields.end())
    throw InputError({place}, std::string("has no field '") + name + "'; the bag is damaged, copy it again");
  return field->second;
}

bool is_kind(const Fields& fields, char kind) {
  const auto field = fields.find("op");
  return field != fields.end() && field->second == std::string(1, kind);
}

/// Two halves of 32 bits, seconds and nanoseconds [ns].
std::uint64_t read_time(ByteReader& reader) {
  const auto seconds = reader.number<std::uint32_t>("time");
  return std::uint64_t{seconds} * 1'000'000'000 + reader.number<std::uint32_t>("time");
}

}  // namespace

Ros1Bag::Ros1Bag(const std::filesystem::path& file, const std::filesystem::path& shown)
    : Bag(shown), file_(file, largest_file::unbounded, "a bag of ROS 1") {
  const std::uint64_t index = read_header();
  std::uint64_t position = index;
  std::vector<Record> infos;
  while (position < file_.size()) {
    const Record record = read_record(position, file_.size(), "a record of the index");
    position = record.end();
    if (is_kind(record.fields, connection_record))
      read_connection(record);
    else if (is_kind(record.fields, chunk_info_record))
      infos.push_back(record);
  }
  for (const Record& info : infos) read_chunk_info(info);
}

std::uint64_t Ros1Bag::read_header() {
  const Record header = read_record(std::string_view(ros1_magic).size(), file_.size(), "its first record");
  if (!is_kind(header.fields, file_record))
    fail("does not begin with the record of a bag; it is damaged, copy it again");
  if (const auto encryptor = header.fields.find("encryptor");
      encryptor != header.fields.end() && !encryptor->second.empty())
    fail("is encrypted by '" + encryptor->second + "'; expected a bag without encryption");
  const auto index = number_in<std::uint64_t>(header.fields, "index_pos", path().string());
  const auto connections = number_in<std::uint32_t>(header.fields, "conn_count", path().string());
  const auto chunks = number_in<std::uint32_t>(header.fields, "chunk_count", path().string());
  if (index == 0)
    fail("has no index, because its recording did not come to its end; `rosbag reindex " + path().string() +
         "` writes the index");
  if (index > file_.size() || (index == file_.size() && connections > 0))
    fail("is truncated: it has " + std::to_string(file_.size()) + " bytes, and its index begins at byte " +
         std::to_string(index) + "; copy it again, or `rosbag reindex` what is left of it");
  if (chunks > most_chunks) fail("has " + std::to_string(chunks) + " chunks; it is damaged, copy it again");
  return index;
}

void Ros1Bag::read_bytes(std::uint64_t position, std::uint64_t count, std::vector<std::uint8_t>& bytes) {
  if (position > file_.size() || count > file_.size() - position)
    fail("is truncated: " + std::to_string(count) + " bytes at byte " + std::to_string(position) +
         " are beyond its end; copy it again, or `rosbag reindex` what is left of it");
  bytes.resize(count);
  file_.seek(position);
  if (file_.read(bytes.data(), count) != count) fail("became shorter while it was read; copy it again");
}

Ros1Bag::Record Ros1Bag::read_record(std::uint64_t position, std::uint64_t end, const char* what) {
  const std::string place = path().string() + ": " + what + " at byte " + std::to_string(position);
  const auto length_at = [&](std::uint64_t at) {
    if (at > end || end - at < 4)
      throw InputError({place}, "is cut short; the bag is truncated or damaged, copy it again");
    std::vector<std::uint8_t> bytes;
    read_bytes(at, 4, bytes);
    return std::uint64_t{ByteReader(bytes, place).number<std::uint32_t>("length")};
  };
  const std::uint64_t header_size = length_at(position);
  if (header_size > largest_header || header_size > end - position - 4)
    throw InputError({place}, "has a header of " + std::to_string(header_size) +
                                  " bytes; the bag is truncated or damaged, copy it again");
  std::vector<std::uint8_t> header;
  read_bytes(position + 4, header_size, header);
  Record record;
  record.fields = read_fields(header, place);
  record.size = length_at(position + 4 + header_size);
  record.content = position + 8 + header_size;
  if (record.size > end - record.content)
    throw InputError({place}, "is cut short: it says " + std::to_string(record.size) + " bytes, and " +
                                  std::to_string(end - record.content) +
                                  " are left; the bag is truncated or damaged, copy it again");
  return record;
}

void Ros1Bag::read_connection(const Record& record) {
  const std::string place = path().string() + ": a connection";
  const auto id = number_in<std::uint32_t>(record.fields, "conn", place);
  std::vector<std::uint8_t> bytes;
  read_bytes(record.content, record.size, bytes);
  const Fields fields = read_fields(bytes, place);
  if (!add_connection(id, {text_in(record.fields, "topic", place), text_in(fields, "type", place), "ros1", {}}))
    fail("has connection " + std::to_string(id) + " twice; it is damaged, copy it again");
}

void Ros1Bag::read_chunk_info(const Record& record) {
  const std::string place = path().string() + ": the index of a chunk";
  const auto position = number_in<std::uint64_t>(record.fields, "chunk_pos", place);
  const auto count = number_in<std::uint32_t>(record.fields, "count", place);
  const Record stored = read_record(position, file_.size(), "a chunk");
  if (!is_kind(stored.fields, chunk_record))
    fail("has no chunk at byte " + std::to_string(position) + ", where its index says; it is damaged, copy it again");
  Chunk chunk;
  chunk.position = stored.content;
  chunk.stored_size = stored.size;
  chunk.size = number_in<std::uint32_t>(stored.fields, "size", place);
  chunk.compression = text_in(stored.fields, "compression", place);
  if (chunk.compression == "none" && chunk.size != chunk.stored_size)
    fail("has a chunk of " + std::to_string(chunk.stored_size) + " bytes that says " + std::to_string(chunk.size) +
         "; it is damaged, copy it again");
  if (chunk.compression != "none" && chunk.size > largest_chunk)
    fail("has a chunk of " + std::to_string(chunk.size) + " bytes, decompressed; expected " +
         std::to_string(largest_chunk) + " at most; write the bag anew with smaller chunks");
  chunks_.push_back(chunk);
  std::uint64_t index = stored.end();
  for (std::uint32_t i = 0; i < count; ++i) {
    const Record entries = read_record(index, file_.size(), "the index of a chunk");
    read_index(entries, static_cast<std::uint32_t>(chunks_.size() - 1));
    index = entries.end();
  }
}

void Ros1Bag::read_index(const Record& record, std::uint32_t chunk) {
  const std::string place = path().string() + ": the index of a chunk";
  if (!is_kind(record.fields, index_record)) throw InputError({place}, "is missing; copy the bag again");
  const auto connection = number_in<std::uint32_t>(record.fields, "conn", place);
  const auto count = number_in<std::uint32_t>(record.fields, "count", place);
  constexpr std::uint64_t entry = 12;  // bytes: time and offset
  if (record.size != count * entry || !has_connection(connection))
    throw InputError({place}, "is damaged: " + std::to_string(record.size) + " bytes for " + std::to_string(count) +
                                  " messages of connection " + std::to_string(connection) + "; copy the bag again");
  // So that the same entries, named many times, do not fill the memory.
  entries_ += count;
  if (entries_ > file_.size() / entry) fail("has more messages in its index than bytes; it is damaged, copy it again");
  std::vector<std::uint8_t> bytes;
  read_bytes(record.content, record.size, bytes);
  ByteReader reader(bytes, place);
  for (std::uint32_t i = 0; i < count; ++i) {
    BagMessage message;
    message.time = read_time(reader);
    message.offset = reader.number<std::uint32_t>("offset");
    message.chunk = chunk;
    message.connection = connection;
    add_message(message);
  }
}

void Ros1Bag::check_message(const Fields& fields, const BagMessage& message) const {
  const std::string place = place_of(message);
  if (!is_kind(fields, message_record) || number_in<std::uint32_t>(fields, "conn", place) != message.connection)
    throw InputError({place}, "is not where the index says; the bag is damaged, `rosbag reindex` may help");
}

const std::vector<std::uint8_t>& Ros1Bag::decompressed(std::uint32_t number) {
  static constexpr Compression known[] = {{"bz2", &decompress_bz2}, {"lz4", &decompress_lz4}};
  return cache_.get(number, [&] {
    const Chunk& chunk = chunks_[number];
    std::vector<std::uint8_t> stored;
    read_bytes(chunk.position, chunk.stored_size, stored);
    return decompress_chunk(known, chunk.compression, stored, chunk.size,
                            path().string() + ": chunk " + std::to_string(number));
  });
}

Bytes Ros1Bag::read(const BagMessage& message, std::uint64_t most) {
  const Chunk& chunk = chunks_[message.chunk];
  const std::string place = place_of(message);
  if (message.offset >= chunk.size)
    throw InputError({place}, "lies beyond the end of its chunk; the bag is damaged, `rosbag reindex` may help");
  if (chunk.compression == "none") {
    const Record record = read_record(chunk.position + message.offset, chunk.position + chunk.stored_size, "a message");
    check_message(record.fields, message);
    read_bytes(record.content, std::min(record.size, most), buffer_);
    return buffer_;
  }
  ByteReader reader(Bytes(decompressed(message.chunk)).subspan(message.offset), place);
  check_message(read_fields(reader.counted_bytes("header"), place), message);
  const Bytes content = reader.counted_bytes("content");
  return content.first(std::min<std::uint64_t>(content.size(), most));
}

}  // namespace holdfast::rosbag_plugin
