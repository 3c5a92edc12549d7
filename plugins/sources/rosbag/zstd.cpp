// SPDX-License-Identifier: BSD-3-Clause
#include <unistd.h>
#include <zstd.h>

#include <cstdio>
#include <cstdlib>
#include <memory>
#include <optional>
#include <utility>

#include "chunk.hpp"
#include "holdfast/core/input_file.hpp"
#include "zstd_file.hpp"

namespace holdfast::rosbag_plugin {

namespace {

using ZstdContext = std::unique_ptr<ZSTD_DCtx, std::size_t (*)(ZSTD_DCtx*)>;

[[noreturn]] void throw_damaged_zstd(const std::string& place) {
  throw InputError({place}, "is damaged or truncated: zstd cannot decompress it; copy the bag again");
}

/// Decompresses a part of the input into a part of the output. Returns whether a frame ended.
bool decompress_part(const ZstdContext& context, ZSTD_inBuffer& input, ZSTD_outBuffer& output,
                     const std::string& place) {
  const std::size_t wanted = ZSTD_decompressStream(context.get(), &output, &input);
  if (ZSTD_isError(wanted) != 0) throw_damaged_zstd(place);
  return wanted == 0;
}

/// A new file in the folder of temporary files, open for writing.
class UnpackedFile {
 public:
  explicit UnpackedFile(const std::filesystem::path& packed) : packed_(packed) {
    std::string name = (std::filesystem::temp_directory_path() / "holdfast_bag_XXXXXX").string();
    const int descriptor = mkstemp(name.data());
    if (descriptor < 0) fail("no file can be made");
    file_.emplace(name);
    stream_.reset(fdopen(descriptor, "wb"));
    if (!stream_) {
      close(descriptor);
      fail("no file can be made");
    }
  }
  void write(const std::vector<std::uint8_t>& bytes, std::size_t count) {
    written_ += count;
    if (std::fwrite(bytes.data(), 1, count, stream_.get()) != count) fail("no room is left");
  }
  std::uint64_t written() const { return written_; }
  std::filesystem::path finish() {
    if (std::fclose(stream_.release()) != 0) fail("no room is left");
    return file_->release();
  }

 private:
  struct Removed {
    explicit Removed(std::string file) : name(std::move(file)) {}
    ~Removed() {
      if (!name.empty()) std::remove(name.c_str());
    }
    std::string release() { return std::exchange(name, {}); }
    std::string name;
  };
  [[noreturn]] void fail(const char* problem) const {
    throw InputError({packed_.string()}, std::string("cannot be decompressed: ") + problem + " in " +
                                             std::filesystem::temp_directory_path().string() +
                                             "; set TMPDIR to a folder with room, or decompress the file by `zstd -d`");
  }

  std::filesystem::path packed_;
  std::optional<Removed> file_;
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> stream_{nullptr, &std::fclose};
  std::uint64_t written_ = 0;
};

/// More than this is no recording: it would fill the disk.
std::uint64_t largest_content(std::uint64_t compressed) { return (std::uint64_t{1} << 30) + 1000 * compressed; }

}  // namespace

std::vector<std::uint8_t> decompress_zstd(Bytes compressed, std::size_t size, const std::string& place) {
  const ZstdContext context(ZSTD_createDCtx(), &ZSTD_freeDCtx);
  if (!context) throw_damaged_zstd(place);
  ZSTD_inBuffer input{compressed.data(), compressed.size(), 0};
  std::vector<std::uint8_t> bytes;
  std::size_t used = 0;
  bool is_at_end = false;  // of a frame, of which there may be several
  while (used <= size && !(is_at_end && input.pos == input.size)) {
    make_room(bytes, used, size + 1);  // one more tells a longer one
    ZSTD_outBuffer output{bytes.data() + used, bytes.size() - used, 0};
    const std::size_t read = input.pos;
    is_at_end = decompress_part(context, input, output, place);
    if (!is_at_end && input.pos == read && output.pos == 0) throw_damaged_zstd(place);  // it is cut short
    used += output.pos;
  }
  bytes.resize(used);
  return bytes;
}

std::filesystem::path unpack_to_temporary_file(const std::filesystem::path& file) {
  const std::string place = file.string();
  const ZstdContext context(ZSTD_createDCtx(), &ZSTD_freeDCtx);
  if (!context) throw_damaged_zstd(place);
  InputFile packed(file, largest_file::unbounded, "a recording of ROS");
  UnpackedFile unpacked(file);
  std::vector<std::uint8_t> from(std::size_t{1} << 20), to(std::size_t{1} << 20);
  bool is_at_end = false;
  while (const std::size_t count = packed.read(from.data(), from.size())) {
    ZSTD_inBuffer input{from.data(), count, 0};
    ZSTD_outBuffer output{to.data(), to.size(), to.size()};
    // A full output may be followed by more without more input.
    while (input.pos < input.size || (!is_at_end && output.pos == output.size)) {
      output.pos = 0;
      is_at_end = decompress_part(context, input, output, place);
      unpacked.write(to, output.pos);
      if (unpacked.written() > largest_content(packed.size()))
        throw InputError({place},
                         "has more than " + std::to_string(largest_content(packed.size())) +
                             " bytes, decompressed, which no recording has; decompress it by `zstd -d` to see");
    }
  }
  if (!is_at_end) throw_damaged_zstd(place);
  return unpacked.finish();
}

}  // namespace holdfast::rosbag_plugin
