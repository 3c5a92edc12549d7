// SPDX-License-Identifier: BSD-3-Clause
#include "message.hpp"

#include <algorithm>

namespace holdfast::rosbag_plugin {

namespace {

class Ros1Reader final : public MessageReader {
 public:
  Ros1Reader(Bytes message, const std::string& place) : reader_(message, place) {}

  std::string text(const char* what) override { return reader_.text(what); }
  Bytes sequence(const char* what) override { return reader_.counted_bytes(what); }
  MessageStamp stamp() override {
    reader_.number<std::uint32_t>("sequence number");
    const auto seconds = reader_.number<std::uint32_t>("time stamp");
    return {seconds, reader_.number<std::uint32_t>("time stamp")};
  }

 private:
  void read_number(void* value, std::size_t size, const char* what) override {
    std::memcpy(value, reader_.bytes(size, what).data(), size);
  }

  ByteReader reader_;
};

class CdrReader final : public MessageReader {
 public:
  CdrReader(Bytes message, const std::string& place) : reader_(message, place), place_(place) {
    const Bytes encapsulation = reader_.bytes(4, "encapsulation header");
    if (encapsulation[0] != 0 || encapsulation[1] > 1)
      throw InputError({place}, "is serialised in the representation " + std::to_string(encapsulation[0]) + '.' +
                                    std::to_string(encapsulation[1]) +
                                    " of CDR; expected 0.0 or 0.1, plain CDR of either byte order, as ROS 2 writes it; "
                                    "the message is damaged, or of another program");
    is_big_endian_ = encapsulation[1] == 0;
  }

  std::string text(const char* what) override {
    const Bytes characters = sequence(what);
    // The length counts the zero at the end. Some writers give an empty text the length 0.
    if (characters.empty()) return {};
    if (characters.back() != 0)
      throw InputError({place_}, std::string("has a text without its end as ") + what + "; the message is damaged");
    return {characters.begin(), characters.end() - 1};
  }
  Bytes sequence(const char* what) override {
    const auto count = number<std::uint32_t>(what);
    position_ += count;
    return reader_.bytes(count, what);
  }
  MessageStamp stamp() override {
    const auto seconds = number<std::int32_t>("time stamp");
    if (seconds < 0)
      throw InputError({place_}, "has a time stamp of " + std::to_string(seconds) +
                                     " s; expected one that is not negative; the message is damaged");
    return {static_cast<std::uint32_t>(seconds), number<std::uint32_t>("time stamp")};
  }

 private:
  void read_number(void* value, std::size_t size, const char* what) override {
    const std::size_t gap = (size - position_ % size) % size;
    position_ += gap + size;
    reader_.bytes(gap, what);
    const Bytes stored = reader_.bytes(size, what);
    auto* to = static_cast<std::uint8_t*>(value);
    if (is_big_endian_)
      std::reverse_copy(stored.begin(), stored.end(), to);
    else
      std::copy(stored.begin(), stored.end(), to);
  }

  ByteReader reader_;
  std::string place_;
  std::size_t position_ = 0;  // after the encapsulation header
  bool is_big_endian_ = false;
};

template <class Reader>
class EncodingOf final : public MessageEncoding {
 public:
  std::unique_ptr<MessageReader> open(Bytes message, const std::string& place) const override {
    return std::make_unique<Reader>(message, place);
  }
};

}  // namespace

const MessageEncoding& ros1_encoding() {
  static const EncodingOf<Ros1Reader> encoding;
  return encoding;
}

const MessageEncoding& cdr_encoding() {
  static const EncodingOf<CdrReader> encoding;
  return encoding;
}

const MessageEncoding* find_encoding(const std::string& name) {
  if (name == "ros1") return &ros1_encoding();
  if (name == "cdr") return &cdr_encoding();
  return nullptr;
}

}  // namespace holdfast::rosbag_plugin
