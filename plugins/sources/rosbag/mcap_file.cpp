// SPDX-License-Identifier: BSD-3-Clause
#include "mcap_file.hpp"

#include <algorithm>
#include <cstdio>

#include "holdfast/core/crc32.hpp"

namespace holdfast::rosbag_plugin {

namespace {

// Kinds of records that are read; others are passed over, as the specification wants.
constexpr std::uint8_t header_kind = 0x01, footer_kind = 0x02, schema_kind = 0x03, channel_kind = 0x04;
constexpr std::uint8_t message_kind = 0x05, chunk_kind = 0x06, statistics_kind = 0x0B, data_end_kind = 0x0F;

constexpr std::uint64_t magic_bytes = 8, record_prefix = 9;  // kind and length
constexpr std::uint64_t message_prefix = 22;                 // channel, sequence number, two times
constexpr std::uint64_t largest_definition = 1U << 24;       // bytes of a schema or channel
constexpr std::uint64_t piece = 1U << 20;                    // bytes that are read at once

std::string hexadecimal(std::uint32_t value) {
  char text[16];
  std::snprintf(text, sizeof(text), "%08x", value);
  return text;
}

}  // namespace

McapFile::McapFile(const std::filesystem::path& file, const std::filesystem::path& shown)
    : Bag(shown), file_(file, largest_file::unbounded, "an MCAP file") {
  read_records();
}

Bytes McapFile::file_bytes(std::uint64_t position, std::uint64_t count) {
  if (position > file_.size() || count > file_.size() - position) fail("is truncated or damaged; copy it again");
  buffer_.resize(count);
  file_.seek(position);
  if (file_.read(buffer_.data(), count) != count) fail("became shorter while it was read; copy it again");
  return buffer_;
}

McapFile::Region McapFile::region_of_file(std::uint64_t begin, std::uint64_t end, bool is_of_chunk,
                                          const std::string& place) {
  return {[this](std::uint64_t position, std::uint64_t count) { return file_bytes(position, count); },
          begin,
          end,
          0,
          is_of_chunk,
          place};
}

/// The record that begins there; nothing if it does not end within the region.
std::optional<McapFile::Record> McapFile::record_at(const Region& region, std::uint64_t position) const {
  if (region.end - position < record_prefix) return std::nullopt;
  ByteReader reader(region.bytes(position, record_prefix), region.place);
  Record record;
  record.kind = reader.number<std::uint8_t>("kind");
  record.size = reader.number<std::uint64_t>("length");
  record.content = position + record_prefix;
  if (record.size > region.end - record.content) return std::nullopt;
  return record;
}

void McapFile::read_records() {
  const Region file = region_of_file(magic_bytes, file_.size(), false, path().string());
  std::uint64_t position = std::min(magic_bytes, file_.size());
  std::optional<Record> data_end;
  for (auto record = record_at(file, position); record && record->kind != 0; record = record_at(file, position)) {
    if (position == magic_bytes && record->kind != header_kind)
      fail("does not begin with the header of an MCAP file; it is damaged, copy it again");
    // After the data come copies of schemas and channels, and indexes.
    if (!data_end && record->kind == chunk_kind) read_chunk(*record);
    if (!data_end && record->kind != chunk_kind) read_small_record(file, *record);
    if (data_end && record->kind == statistics_kind) check_count(*record);
    if (record->kind == data_end_kind && !data_end) {
      data_end = record;
      check_data(*record);
    }
    position = record->end();
    if (record->kind == footer_kind) break;
  }
  end_at(position, data_end.has_value());
}

/// Tells a file that is cut off from a damaged one: behind `position` no record follows.
void McapFile::end_at(std::uint64_t position, bool has_data_end) {
  const std::uint64_t left = file_.size() - position;
  const auto is_magic = [&](Bytes bytes) { return std::string(bytes.begin(), bytes.end()) == mcap_magic; };
  const bool has_end = file_.size() >= 2 * magic_bytes && is_magic(file_bytes(file_.size() - magic_bytes, magic_bytes));
  if (has_end && left == magic_bytes) return;
  bool is_empty = !has_end;  // a lost power supply leaves zeros
  if (left >= record_prefix && file_bytes(position, 1)[0] == 0)
    for (std::uint64_t at = position; at < file_.size() && is_empty; at += piece)
      for (const std::uint8_t byte : file_bytes(at, std::min(piece, file_.size() - at)))
        is_empty = is_empty && byte == 0;
  const std::string where = "byte " + std::to_string(position);
  if (!is_empty) fail("has no record at " + where + ", where one must be; it is damaged, copy it again");
  if (has_data_end)
    return suspect("is truncated at " + where + ": its summary is not complete; all its messages are read; copy it " +
                   "again if its original is whole");
  if (messages_.empty()) fail("is truncated at " + where + ", before its first message; copy it again");
  suspect("is truncated at " + where + ": the " + std::to_string(messages_.size()) +
          " messages before are read; copy it again if its original is whole");
}

void McapFile::read_small_record(const Region& region, const Record& record) {
  if (record.kind == message_kind) return read_message(region, record);
  if (record.kind != schema_kind && record.kind != channel_kind) return;
  const std::string place = region.place + ": record at byte " + std::to_string(record.content);
  if (record.size > largest_definition)
    throw InputError({place}, "has a definition of " + std::to_string(record.size) +
                                  " bytes; it is damaged, copy the "
                                  "bag again");
  const Bytes content = region.bytes(record.content, record.size);
  record.kind == schema_kind ? read_schema(content, place) : read_channel(content, place);
}

void McapFile::read_schema(Bytes content, const std::string& place) {
  ByteReader reader(content, place);
  const auto id = reader.number<std::uint16_t>("number");
  if (id == 0) throw InputError({place}, "is a schema of number 0; the bag is damaged, copy it again");
  schemas_[id] = {reader.text("name")};
}

void McapFile::read_channel(Bytes content, const std::string& place) {
  ByteReader reader(content, place);
  const auto id = reader.number<std::uint16_t>("number");
  const auto schema = reader.number<std::uint16_t>("schema");
  const std::string topic = reader.text("topic");
  const std::string encoding = reader.text("encoding");
  const auto known = schemas_.find(schema);
  if (schema != 0 && known == schemas_.end())
    throw InputError({place}, "is the channel of '" + topic + "' with the schema " + std::to_string(schema) +
                                  ", which is not there; the bag is damaged, copy it again");
  const std::string type = schema == 0 ? "" : known->second.name;
  if (add_connection(id, {topic, type, encoding, {}})) return;
  // Writers repeat channels in each chunk.
  if (connection(id).topic != topic || connection(id).encoding_name != encoding)
    throw InputError({place}, "gives channel " + std::to_string(id) + " of '" + connection(id).topic + "' to '" +
                                  topic + "'; the bag is damaged, copy it again");
}

void McapFile::read_message(const Region& region, const Record& record) {
  const std::string place = region.place + ": message at byte " + std::to_string(record.content);
  if (record.size < message_prefix)
    throw InputError({place}, "has " + std::to_string(record.size) + " bytes; expected " +
                                  std::to_string(message_prefix) + " at least; the bag is damaged, copy it again");
  Place stored{record.content + message_prefix, record.size - message_prefix, {}};
  const std::uint64_t head = std::min<std::uint64_t>(stored.size, stamp_bytes);
  ByteReader reader(region.bytes(record.content, message_prefix + head), place);
  BagMessage message;
  message.connection = reader.number<std::uint16_t>("channel");
  reader.number<std::uint32_t>("sequence number");
  message.time = reader.number<std::uint64_t>("time");
  reader.number<std::uint64_t>("time");
  const Bytes begin = reader.bytes(head, "content");
  std::copy(begin.begin(), begin.end(), stored.head.begin());
  if (!has_connection(message.connection))
    throw InputError({place}, "is of channel " + std::to_string(message.connection) +
                                  ", which is not there; the bag is damaged, copy it again");
  // So that chunks of many small messages, compressed to little, do not fill the memory.
  if (messages_.size() >= file_.size()) fail("has more messages than bytes; it is damaged, copy it again");
  message.chunk = region.chunk;
  message.offset = messages_.size();
  messages_.push_back(stored);
  add_message(message);
  has_messages_outside_ = has_messages_outside_ || !region.is_of_chunk;
}

void McapFile::read_chunk(const Record& record) {
  const std::string place = path().string() + ": chunk at byte " + std::to_string(record.content);
  const auto prefix = std::min<std::uint64_t>(record.size, 256);
  ByteReader reader(file_bytes(record.content, prefix), place);
  Chunk chunk;
  reader.bytes(16, "times");
  chunk.size = reader.number<std::uint64_t>("size");
  const auto expected = reader.number<std::uint32_t>("checksum");
  chunk.compression = reader.text("compression");
  chunk.stored_size = reader.number<std::uint64_t>("compressed size");
  chunk.position = record.content + 16 + 8 + 4 + 4 + chunk.compression.size() + 8;
  if (chunk.stored_size != record.end() - chunk.position)
    throw InputError({place}, "has " + std::to_string(record.end() - chunk.position) + " bytes where it says " +
                                  std::to_string(chunk.stored_size) + "; the bag is damaged, copy it again");
  if (chunk.compression.empty()) {
    if (chunk.size != chunk.stored_size)
      throw InputError({place}, "has " + std::to_string(chunk.stored_size) + " bytes where it says " +
                                    std::to_string(chunk.size) + "; the bag is damaged, copy it again");
    if (expected != 0) check_sum(chunk.position, record.end(), expected, place);
    return read_chunk_records(region_of_file(chunk.position, record.end(), true, place));
  }
  if (chunk.size > largest_chunk)
    throw InputError({place}, "has " + std::to_string(chunk.size) + " bytes, decompressed; expected " +
                                  std::to_string(largest_chunk) + " at most; write the bag anew with smaller chunks");
  const std::vector<std::uint8_t> bytes = decompress(chunk, place);
  if (const std::uint32_t found = Crc32().add(bytes).value(); expected != 0 && found != expected)
    throw InputError({place}, "has the checksum " + hexadecimal(found) + " where it says " + hexadecimal(expected) +
                                  "; the bag is damaged, copy it again");
  chunks_.push_back(chunk);
  const auto part = [&](std::uint64_t position, std::uint64_t count) { return Bytes(bytes).subspan(position, count); };
  read_chunk_records({part, 0, bytes.size(), static_cast<std::uint32_t>(chunks_.size()), true, place});
}

void McapFile::read_chunk_records(const Region& region) {
  for (std::uint64_t position = region.begin; position < region.end;) {
    const std::optional<Record> record = record_at(region, position);
    if (!record || record->kind == 0 || record->kind == chunk_kind)
      throw InputError({region.place}, "has no record at its byte " + std::to_string(position - region.begin) +
                                           "; the bag is damaged, copy it again");
    read_small_record(region, *record);
    position = record->end();
  }
}

std::vector<std::uint8_t> McapFile::decompress(const Chunk& chunk, const std::string& place) {
  static constexpr Compression known[] = {{"zstd", &decompress_zstd}, {"lz4", &decompress_lz4}};
  return decompress_chunk(known, chunk.compression, file_bytes(chunk.position, chunk.stored_size), chunk.size, place);
}

void McapFile::check_sum(std::uint64_t begin, std::uint64_t end, std::uint32_t expected, const std::string& place) {
  Crc32 sum;
  for (std::uint64_t at = begin; at < end; at += piece) sum.add(file_bytes(at, std::min(piece, end - at)));
  if (sum.value() != expected)
    throw InputError({place}, "has the checksum " + hexadecimal(sum.value()) + " where it says " +
                                  hexadecimal(expected) + "; the bag is damaged, copy it again");
}

/// The checksum of all data protects messages that lie in no chunk.
void McapFile::check_data(const Record& data_end) {
  const std::string place = path().string() + ": the data section";
  const auto expected =
      ByteReader(file_bytes(data_end.content, data_end.size), place).number<std::uint32_t>("checksum");
  if (expected != 0 && has_messages_outside_) check_sum(0, data_end.content - record_prefix, expected, place);
}

/// A record whose kind is damaged is passed over, and its messages are missing.
void McapFile::check_count(const Record& statistics) {
  const std::string place = path().string() + ": its statistics";
  const auto expected = ByteReader(file_bytes(statistics.content, std::min<std::uint64_t>(statistics.size, 8)), place)
                            .number<std::uint64_t>("messages");
  if (messages_.size() < expected)
    fail("has " + std::to_string(messages_.size()) + " messages where its statistics say " + std::to_string(expected) +
         "; it is damaged, copy it again");
}

Bytes McapFile::read(const BagMessage& message, std::uint64_t most) {
  const Place& stored = messages_[message.offset];
  const std::uint64_t count = std::min(stored.size, most);
  if (count <= stored.head.size()) return Bytes(stored.head).first(count);
  if (message.chunk == 0) return file_bytes(stored.position, count);
  const std::vector<std::uint8_t>& bytes = cache_.get(message.chunk, [&] {
    const Chunk& chunk = chunks_[message.chunk - 1];
    return decompress(chunk, path().string() + ": chunk at byte " + std::to_string(chunk.position));
  });
  return Bytes(bytes).subspan(stored.position, count);
}

}  // namespace holdfast::rosbag_plugin
