// SPDX-License-Identifier: BSD-3-Clause
#include "mcap_writer.hpp"

#include <algorithm>
#include <cerrno>
#include <concepts>
#include <limits>
#include <system_error>

#include "holdfast/core/crc32.hpp"
#include "holdfast/core/error.hpp"

namespace holdfast::mcap_plugin {

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

/// The content of a record. Numbers are little-endian; a text has its length before it.
class Content {
 public:
  template <std::unsigned_integral Number>
  Content& add(Number value) {
    for (std::size_t i = 0; i < sizeof(Number); ++i)
      bytes_.push_back(static_cast<char>(static_cast<std::uint64_t>(value) >> (8 * i) & 0xFFU));
    return *this;
  }
  Content& add(std::string_view text) {
    add(static_cast<std::uint32_t>(text.size()));
    bytes_ += text;
    return *this;
  }
  Content& add_raw(std::string_view bytes) {
    bytes_ += bytes;
    return *this;
  }
  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

std::string record(Kind kind, const Content& content) {
  return Content()
      .add(static_cast<std::uint8_t>(kind))
      .add(static_cast<std::uint64_t>(content.bytes().size()))
      .add_raw(content.bytes())
      .bytes();
}

std::uint32_t checksum(const std::string& bytes) {
  return Crc32().add({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()}).value();
}

}  // namespace

McapWriter::McapWriter(std::filesystem::path file) : file_(std::move(file)) {
  std::error_code error;
  std::filesystem::create_directories(file_.parent_path(), error);
  stream_.open(file_, std::ios::binary | std::ios::trunc);
  put(magic);
  put(record(Kind::header, Content().add(std::string_view("")).add(std::string_view("holdfast"))));
}

void McapWriter::fail() const {
  throw InputError({file_.string()}, "cannot be written: " + std::system_category().message(errno));
}

void McapWriter::put(std::string_view bytes) {
  if (!stream_.write(bytes.data(), static_cast<std::streamsize>(bytes.size()))) fail();
  written_ += bytes.size();
}

std::uint16_t McapWriter::add_channel(const std::string& topic, const std::string& schema_name,
                                      const std::string& schema) {
  channels_.push_back({topic, schema_name, schema});
  return static_cast<std::uint16_t>(channels_.size());
}

/// Schemas and channels as records.
std::string McapWriter::definitions() const {
  std::string records;
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    const auto id = static_cast<std::uint16_t>(i + 1);
    const Definition& definition = channels_[i];
    Content schema, channel;
    schema.add(id).add(std::string_view(definition.schema_name)).add(std::string_view("jsonschema"));
    schema.add(std::string_view(definition.schema));
    channel.add(id).add(id).add(std::string_view(definition.topic)).add(std::string_view("json"));
    channel.add(std::uint32_t{0});  // no metadata
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
  Content content;
  content.add(channel).add(static_cast<std::uint32_t>(channels_[channel - 1].messages++)).add(time).add(time);
  chunk_ += record(Kind::message, content.add_raw(message));
  if (chunk_.size() >= chunk_bytes) put_chunk();
}

void McapWriter::put_chunk() {
  if (chunk_.empty()) return;
  ChunkIndex index{.begin = chunk_begin_, .end = chunk_end_, .offset = written_, .size = chunk_.size()};
  Content content;
  content.add(chunk_begin_).add(chunk_end_).add(static_cast<std::uint64_t>(chunk_.size())).add(checksum(chunk_));
  content.add(std::string_view("")).add(static_cast<std::uint64_t>(chunk_.size())).add_raw(chunk_);
  put(record(Kind::chunk, content));
  index.length = written_ - index.offset;
  for (const auto& [channel, messages] : chunk_messages_) {
    index.index_offsets[channel] = written_;
    Content entries;
    for (const auto& [time, offset] : messages) entries.add(time).add(offset);
    put(record(Kind::message_index, Content().add(channel).add(std::string_view(entries.bytes()))));
  }
  index.index_length = written_ - index.offset - index.length;
  chunks_.push_back(std::move(index));
  chunk_.clear();
  chunk_messages_.clear();
  if (!stream_.flush()) fail();
}

std::string McapWriter::statistics() const {
  std::uint64_t messages = 0, begin = std::numeric_limits<std::uint64_t>::max(), end = 0;
  Content counts;
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    messages += channels_[i].messages;
    counts.add(static_cast<std::uint16_t>(i + 1)).add(channels_[i].messages);
  }
  for (const ChunkIndex& chunk : chunks_) begin = std::min(begin, chunk.begin), end = std::max(end, chunk.end);
  const auto count = static_cast<std::uint32_t>(channels_.size());
  Content content;
  content.add(messages).add(static_cast<std::uint16_t>(count)).add(count);
  content.add(std::uint32_t{0}).add(std::uint32_t{0}).add(static_cast<std::uint32_t>(chunks_.size()));
  content.add(chunks_.empty() ? std::uint64_t{0} : begin).add(end).add(std::string_view(counts.bytes()));
  return record(Kind::statistics, content);
}

void McapWriter::close() {
  put_chunk();
  put(record(Kind::data_end, Content().add(std::uint32_t{0})));
  const std::uint64_t summary = written_;
  put(definitions());
  for (const ChunkIndex& chunk : chunks_) {
    Content offsets, content;
    for (const auto& [channel, offset] : chunk.index_offsets) offsets.add(channel).add(offset);
    content.add(chunk.begin).add(chunk.end).add(chunk.offset).add(chunk.length);
    content.add(std::string_view(offsets.bytes())).add(chunk.index_length).add(std::string_view(""));
    put(record(Kind::chunk_index, content.add(chunk.size).add(chunk.size)));
  }
  put(statistics());
  put(record(Kind::footer, Content().add(summary).add(std::uint64_t{0}).add(std::uint32_t{0})));
  put(magic);
  stream_.close();
  if (!stream_) fail();
}

}  // namespace holdfast::mcap_plugin
