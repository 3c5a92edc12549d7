// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/mcap/mcap_writer.hpp"

#include <algorithm>
#include <cerrno>
#include <limits>
#include <system_error>

#include "holdfast/core/byte_writer.hpp"
#include "holdfast/core/crc32.hpp"
#include "holdfast/core/error.hpp"
#include "zstd_chunk.hpp"

namespace holdfast::mcap {

namespace {

constexpr std::string_view magic("\x89MCAP0\r\n", 8);
constexpr std::size_t chunk_bytes = 1U << 20;

enum class Kind : std::uint8_t {
  header = 0x01,
  footer = 0x02,
  schema = 0x03,
  channel = 0x04,
  message = 0x05,
  chunk = 0x06,
  message_index = 0x07,
  chunk_index = 0x08,
  statistics = 0x0B,
  data_end = 0x0F,
};

/// A text has its length before it.
void put_text(ByteWriter& to, std::string_view text) {
  to.put(static_cast<std::uint32_t>(text.size()));
  to.put_bytes(text);
}

std::string record(Kind kind, const ByteWriter& content) {
  ByteWriter writer;
  writer.put(static_cast<std::uint8_t>(kind));
  writer.put(static_cast<std::uint64_t>(content.size()));
  writer.put_bytes(content.bytes());
  return writer.bytes();
}

std::uint32_t checksum(const std::string& bytes) {
  return Crc32().add({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()}).value();
}

}  // namespace

McapWriter::McapWriter(std::filesystem::path file, const std::string& profile, Compression compression)
    : file_(std::move(file)), compression_(has_zstd ? compression : Compression::none) {
  std::error_code error;
  std::filesystem::create_directories(file_.parent_path(), error);
  stream_.open(file_, std::ios::binary | std::ios::trunc);
  put(magic);
  ByteWriter header;
  put_text(header, profile);
  put_text(header, "holdfast");
  put(record(Kind::header, header));
}

/// After the first failure the stream refuses everything, and errno has another reason or none.
void McapWriter::fail() {
  if (failure_.empty()) failure_ = "cannot be written: " + std::system_category().message(errno);
  throw InputError({file_.string()}, failure_);
}

void McapWriter::put(std::string_view bytes) {
  if (!stream_.write(bytes.data(), static_cast<std::streamsize>(bytes.size()))) fail();
  written_ += bytes.size();
}

std::uint16_t McapWriter::add_channel(const Channel& channel) {
  channels_.push_back({channel});
  return static_cast<std::uint16_t>(channels_.size());
}

/// Schemas and channels as records.
std::string McapWriter::definitions() const {
  std::string records;
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    const auto id = static_cast<std::uint16_t>(i + 1);
    const Definition& definition = channels_[i];
    ByteWriter schema, channel;
    schema.put(id);
    put_text(schema, definition.schema_name);
    put_text(schema, definition.schema_encoding);
    put_text(schema, definition.schema);
    channel.put(id);
    channel.put(id);  // of the schema
    put_text(channel, definition.topic);
    put_text(channel, definition.message_encoding);
    put_text(channel, "");  // no metadata
    records += record(Kind::schema, schema) + record(Kind::channel, channel);
  }
  return records;
}

void McapWriter::write(std::uint16_t channel, std::uint64_t time, std::string_view message) {
  if (channels_written_ < channels_.size()) {
    put(definitions());
    channels_written_ = channels_.size();
  }
  if (chunk_.empty()) chunk_begin_ = chunk_end_ = time;
  chunk_begin_ = std::min(chunk_begin_, time);
  chunk_end_ = std::max(chunk_end_, time);
  chunk_messages_[channel].emplace_back(time, chunk_.size());
  ByteWriter content;
  content.put(channel);
  content.put(static_cast<std::uint32_t>(channels_[channel - 1U].messages++));
  content.put(time);
  content.put(time);
  content.put_bytes(message);
  chunk_ += record(Kind::message, content);
  if (chunk_.size() >= chunk_bytes) put_chunk();
}

const char* McapWriter::compression_name() const { return compression_ == Compression::zstd ? "zstd" : ""; }

void McapWriter::put_chunk() {
  if (chunk_.empty()) return;
  ChunkIndex index{.begin = chunk_begin_, .end = chunk_end_, .offset = written_, .size = chunk_.size()};
  ByteWriter content;
  content.put(chunk_begin_);
  content.put(chunk_end_);
  content.put(index.size);
  content.put(checksum(chunk_));
  if (compression_ == Compression::zstd) chunk_ = compress_zstd(chunk_);
  index.stored = chunk_.size();
  put_text(content, compression_name());
  content.put(index.stored);
  content.put_bytes(chunk_);
  put(record(Kind::chunk, content));
  index.length = written_ - index.offset;
  put_message_indexes(index);
  chunks_.push_back(std::move(index));
  chunk_.clear();
  chunk_messages_.clear();
  if (!stream_.flush()) fail();
}

void McapWriter::put_message_indexes(ChunkIndex& index) {
  for (const auto& [channel, messages] : chunk_messages_) {
    index.index_offsets[channel] = written_;
    ByteWriter entries, content;
    for (const auto& [time, offset] : messages) {
      entries.put(time);
      entries.put(offset);
    }
    content.put(channel);
    put_text(content, entries.bytes());
    put(record(Kind::message_index, content));
  }
  index.index_length = written_ - index.offset - index.length;
}

ByteWriter McapWriter::content_of(const ChunkIndex& chunk) const {
  ByteWriter offsets, content;
  for (const auto& [channel, offset] : chunk.index_offsets) {
    offsets.put(channel);
    offsets.put(offset);
  }
  for (const std::uint64_t number : {chunk.begin, chunk.end, chunk.offset, chunk.length}) content.put(number);
  put_text(content, offsets.bytes());
  content.put(chunk.index_length);
  put_text(content, compression_name());
  content.put(chunk.stored);
  content.put(chunk.size);
  return content;
}

std::string McapWriter::statistics() const {
  std::uint64_t messages = 0, begin = std::numeric_limits<std::uint64_t>::max(), end = 0;
  ByteWriter counts;
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    messages += channels_[i].messages;
    counts.put(static_cast<std::uint16_t>(i + 1));
    counts.put(channels_[i].messages);
  }
  for (const ChunkIndex& chunk : chunks_) begin = std::min(begin, chunk.begin), end = std::max(end, chunk.end);
  const auto count = static_cast<std::uint32_t>(channels_.size());
  ByteWriter content;
  content.put(messages);
  content.put(static_cast<std::uint16_t>(count));  // schemas
  content.put(count);                              // channels
  content.put(std::uint32_t{0});                   // attachments
  content.put(std::uint32_t{0});                   // metadata
  content.put(static_cast<std::uint32_t>(chunks_.size()));
  content.put(chunks_.empty() ? std::uint64_t{0} : begin);
  content.put(end);
  put_text(content, counts.bytes());
  return record(Kind::statistics, content);
}

void McapWriter::close() {
  put_chunk();
  ByteWriter data_end;
  data_end.put(std::uint32_t{0});  // no checksum of the data
  put(record(Kind::data_end, data_end));
  const std::uint64_t summary = written_;
  put(definitions());
  for (const ChunkIndex& chunk : chunks_) put(record(Kind::chunk_index, content_of(chunk)));
  put(statistics());
  ByteWriter footer;
  footer.put(summary);
  footer.put(std::uint64_t{0});  // no offsets of the summary's parts
  footer.put(std::uint32_t{0});  // no checksum of the summary
  put(record(Kind::footer, footer));
  put(magic);
  stream_.close();
  if (!stream_) fail();
}

}  // namespace holdfast::mcap
