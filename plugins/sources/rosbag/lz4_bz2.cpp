// SPDX-License-Identifier: BSD-3-Clause
#include "chunk.hpp"

#include <bzlib.h>
#include <lz4frame.h>

#include <memory>

namespace holdfast::rosbag_plugin {

namespace {

[[noreturn]] void throw_damaged(const std::string& place) {
  throw InputError({place}, "is damaged: it cannot be decompressed; copy the bag again");
}

}  // namespace

std::vector<std::uint8_t> decompress_lz4(Bytes compressed, std::size_t size, const std::string& place) {
  LZ4F_dctx* context = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&context, LZ4F_VERSION)) != 0) throw_damaged(place);
  const std::unique_ptr<LZ4F_dctx, LZ4F_errorCode_t (*)(LZ4F_dctx*)> owner(context, &LZ4F_freeDecompressionContext);
  std::vector<std::uint8_t> bytes;
  std::size_t used = 0, wanted = 1;
  while (wanted != 0 && used <= size) {
    make_room(bytes, used, size);
    std::size_t written = bytes.size() - used, read = compressed.size();
    wanted = LZ4F_decompress(context, bytes.data() + used, &written, compressed.data(), &read, nullptr);
    if (LZ4F_isError(wanted) != 0 || (written == 0 && read == 0 && wanted != 0)) throw_damaged(place);
    used += written;
    compressed = compressed.subspan(read);
  }
  bytes.resize(used);
  return bytes;
}

std::vector<std::uint8_t> decompress_bz2(Bytes compressed, std::size_t size, const std::string& place) {
  bz_stream stream{};
  if (BZ2_bzDecompressInit(&stream, 0, 0) != BZ_OK) throw_damaged(place);
  const std::unique_ptr<bz_stream, int (*)(bz_stream*)> owner(&stream, &BZ2_bzDecompressEnd);
  stream.next_in = reinterpret_cast<char*>(const_cast<std::uint8_t*>(compressed.data()));
  stream.avail_in = static_cast<unsigned>(compressed.size());
  std::vector<std::uint8_t> bytes;
  std::size_t used = 0;
  for (int result = BZ_OK; result != BZ_STREAM_END;) {
    make_room(bytes, used, size);
    stream.next_out = reinterpret_cast<char*>(bytes.data() + used);
    stream.avail_out = static_cast<unsigned>(bytes.size() - used);
    const unsigned left = stream.avail_in;
    result = BZ2_bzDecompress(&stream);
    const std::size_t written = bytes.size() - used - stream.avail_out;
    if ((result != BZ_OK && result != BZ_STREAM_END) || (result == BZ_OK && written == 0 && left == stream.avail_in))
      throw_damaged(place);
    used += written;
  }
  bytes.resize(used);
  return bytes;
}

}  // namespace holdfast::rosbag_plugin
