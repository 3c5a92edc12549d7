// SPDX-License-Identifier: BSD-3-Clause
#include "support/bag_writer.hpp"

#include <bzlib.h>
#include <lz4frame.h>

#include <algorithm>
#include <stdexcept>

namespace holdfast::test {

namespace {

constexpr std::size_t header_bytes = 4096;  // of the first record, with what follows it
const std::string bag_magic = "#ROSBAG V2.0\n";

template <class Number>
std::string bytes_of(Number value) {
  return ByteText().number(value).bytes;
}

std::string time_bytes(std::uint64_t time) {
  return ByteText()
      .number(static_cast<std::uint32_t>(time / 1'000'000'000))
      .number(static_cast<std::uint32_t>(time % 1'000'000'000))
      .bytes;
}

ByteText message_header(std::uint64_t stamp) {
  ByteText text;
  text.number(std::uint32_t{7});
  text.bytes += time_bytes(stamp);
  return text.text("camera_frame");
}

std::string compressed(const std::string& bytes, const std::string& compression) {
  if (compression == "none") return bytes;
  std::string result;
  if (compression == "lz4") {
    result.resize(LZ4F_compressFrameBound(bytes.size(), nullptr));
    result.resize(LZ4F_compressFrame(result.data(), result.size(), bytes.data(), bytes.size(), nullptr));
    return result;
  }
  auto size = static_cast<unsigned>(bytes.size() + bytes.size() / 50 + 1000);
  result.resize(size);
  if (BZ2_bzBuffToBuffCompress(result.data(), &size, const_cast<char*>(bytes.data()),
                               static_cast<unsigned>(bytes.size()), 9, 0, 0) != BZ_OK)
    throw std::runtime_error("cannot compress");
  result.resize(size);
  return result;
}

}  // namespace

std::string image_message(std::uint64_t stamp, const std::string& encoding, std::uint32_t width, std::uint32_t height,
                          std::uint32_t step, const std::string& bytes) {
  return message_header(stamp)
      .number(height)
      .number(width)
      .text(encoding)
      .number(std::uint8_t{0})
      .number(step)
      .text(bytes)
      .bytes;
}

std::string image_message(std::uint64_t stamp, const std::string& encoding, const cv::Mat& pixels) {
  const std::size_t row = pixels.elemSize() * static_cast<std::size_t>(pixels.cols);
  std::string bytes;
  for (int y = 0; y < pixels.rows; ++y) {
    bytes.append(reinterpret_cast<const char*>(pixels.ptr(y)), row);
    bytes.append(3, 'x');  // rows may be longer than their pixels, and need not lie at multiples of 4 bytes
  }
  return image_message(stamp, encoding, static_cast<std::uint32_t>(pixels.cols),
                       static_cast<std::uint32_t>(pixels.rows), static_cast<std::uint32_t>(row + 3), bytes);
}

std::string compressed_message(std::uint64_t stamp, const std::string& format, const std::string& bytes) {
  return message_header(stamp).text(format).text(bytes).bytes;
}

std::string camera_info_message(std::uint64_t stamp, std::uint32_t width, std::uint32_t height,
                                const std::string& model, const std::vector<double>& distortion,
                                const std::vector<double>& k, const std::vector<double>& p) {
  ByteText text = message_header(stamp);
  text.number(height).number(width).text(model).number(static_cast<std::uint32_t>(distortion.size()));
  for (const double number : distortion) text.number(number);
  for (const double number : k) text.number(number);
  for (int i = 0; i < 9; ++i) text.number(i % 4 == 0 ? 1.0 : 0.0);
  for (const double number : p) text.number(number);
  for (int i = 0; i < 6; ++i) text.number(std::uint32_t{0});
  return text.number(std::uint8_t{0}).bytes;
}

std::string cdr_image_message(std::uint64_t stamp, const std::string& encoding, const cv::Mat& pixels) {
  const auto width = static_cast<std::uint32_t>(pixels.cols), height = static_cast<std::uint32_t>(pixels.rows);
  const std::size_t row = pixels.elemSize() * static_cast<std::size_t>(pixels.cols);
  std::string bytes;
  for (int y = 0; y < pixels.rows; ++y) bytes.append(reinterpret_cast<const char*>(pixels.ptr(y)), row);
  ByteText text;  // numbers lie at multiples of their size
  const auto align = [&] { text.bytes.resize((text.bytes.size() + 3) / 4 * 4); };
  text.bytes = time_bytes(stamp);
  text.text(std::string("camera", 7));
  align();
  text.number(height).number(width).text(encoding + '\0').number(std::uint8_t{0});
  align();
  return std::string("\0\x01\0\0", 4) + text.number(static_cast<std::uint32_t>(row)).text(bytes).bytes;
}

McapWriter::McapWriter() : bytes_("\x89MCAP0\r\n") { add_record(0x01, ByteText().text("ros2").text("test").bytes); }

void McapWriter::add_record(std::uint8_t kind, const std::string& content) {
  bytes_ += ByteText().number(kind).number(std::uint64_t{content.size()}).bytes + content;
}

void McapWriter::add(const std::string& topic, const std::string& type, std::uint64_t time,
                     const std::string& message) {
  const auto [channel, is_new] = channels_.try_emplace(topic, static_cast<std::uint16_t>(channels_.size() + 1));
  if (is_new) {
    add_record(0x03, ByteText().number(channel->second).text(type).text("ros2msg").text("").bytes);
    add_record(0x04, ByteText().number(channel->second).number(channel->second).text(topic).text("cdr").text("").bytes);
  }
  add_record(0x05,
             ByteText().number(channel->second).number(std::uint32_t{0}).number(time).number(time).bytes + message);
}

std::string McapWriter::finish() {
  add_record(0x0F, ByteText().number(std::uint32_t{0}).bytes);
  add_record(0x02, ByteText().number(std::uint64_t{0}).number(std::uint64_t{0}).number(std::uint32_t{0}).bytes);
  return bytes_ + "\x89MCAP0\r\n";
}

std::string BagWriter::record(const std::map<std::string, std::string>& fields, const std::string& content) {
  ByteText header;
  for (const auto& [name, value] : fields) header.text(name + "=" + value);
  return ByteText().text(header.bytes).text(content).bytes;
}

std::string BagWriter::connection_record(const Connection& connection) {
  const ByteText header = ByteText()
                              .text("topic=" + connection.topic)
                              .text("type=" + connection.type)
                              .text("md5sum=*")
                              .text("message_definition=with = in it");
  return record({{"op", "\x07"}, {"conn", bytes_of(connection.id)}, {"topic", connection.topic}}, header.bytes);
}

void BagWriter::add(const std::string& topic, const std::string& type, std::uint64_t time, const std::string& message) {
  auto connection = std::find_if(connections_.begin(), connections_.end(),
                                 [&](const Connection& known) { return known.topic == topic; });
  if (connection == connections_.end()) {
    connections_.push_back({static_cast<std::uint32_t>(connections_.size()), topic, type});
    connection = connections_.end() - 1;
    chunk_ += connection_record(*connection);
  }
  index_[connection->id] += time_bytes(time) + bytes_of(static_cast<std::uint32_t>(chunk_.size()));
  chunk_ += record({{"op", "\x02"}, {"conn", bytes_of(connection->id)}, {"time", time_bytes(time)}}, message);
  if (++in_chunk_ == messages_in_chunk_) end_chunk();
}

void BagWriter::end_chunk() {
  if (in_chunk_ == 0) return;
  const std::uint64_t position = bag_magic.size() + header_bytes + chunks_.size();
  chunks_ += record(
      {{"op", "\x05"}, {"compression", compression_}, {"size", bytes_of(static_cast<std::uint32_t>(chunk_.size()))}},
      compressed(chunk_, compression_));
  std::string counts;
  for (const auto& [connection, entries] : index_) {
    const auto count = static_cast<std::uint32_t>(entries.size() / 12);
    chunks_ += record({{"op", "\x04"},
                       {"ver", bytes_of(std::uint32_t{1})},
                       {"conn", bytes_of(connection)},
                       {"count", bytes_of(count)}},
                      entries);
    counts += bytes_of(connection) + bytes_of(count);
  }
  infos_ += record({{"op", "\x06"},
                    {"ver", bytes_of(std::uint32_t{1})},
                    {"chunk_pos", bytes_of(position)},
                    {"start_time", time_bytes(0)},
                    {"end_time", time_bytes(0)},
                    {"count", bytes_of(static_cast<std::uint32_t>(index_.size()))}},
                   counts);
  ++chunk_count_;
  in_chunk_ = 0;
  chunk_.clear();
  index_.clear();
}

std::string BagWriter::finish() {
  end_chunk();
  std::string index;
  for (const Connection& connection : connections_) index += connection_record(connection);
  index += infos_;
  const std::map<std::string, std::string> fields = {
      {"op", "\x03"},
      {"index_pos", bytes_of(std::uint64_t{bag_magic.size() + header_bytes + chunks_.size()})},
      {"conn_count", bytes_of(static_cast<std::uint32_t>(connections_.size()))},
      {"chunk_count", bytes_of(chunk_count_)}};
  const std::size_t padding = header_bytes - record(fields, "").size();
  return bag_magic + record(fields, std::string(padding, ' ')) + chunks_ + index;
}

}  // namespace holdfast::test
