// SPDX-License-Identifier: BSD-3-Clause
#include "npz_member.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <vector>

#include "holdfast/core/error.hpp"

namespace holdfast::precomputed_plugin {

namespace {

/// A file of a ZIP archive, as its central directory says it (APPNOTE 6.3, section 4.3.12).
struct Member {
  std::string name;
  bool is_compressed = false;
  std::uint64_t size = 0, header = 0;  ///< bytes, and where its local header begins
};

/// Reads the directory of an archive.
class ArchiveReader {
 public:
  ArchiveReader(InputFile& input, const std::string& expected) : input_(input), expected_(expected) {}

  [[noreturn]] void fail(const std::string& found) const {
    throw InputError({input_.path().string()}, found + expected_);
  }

  std::vector<Member> members() {
    const std::vector<std::uint8_t> end = last_bytes();
    constexpr std::size_t record = 22;
    std::optional<std::size_t> at;
    for (std::size_t i = 0; i + record <= end.size(); ++i)
      if (number(end, i, 4) == 0x06054B50) at = i;
    if (!at) fail("is no archive of arrays (.npz)");
    const std::uint64_t count = number(end, *at + 10, 2), size = number(end, *at + 12, 4);
    constexpr std::uint64_t most = 1 << 20;
    if (size > most) fail("is an archive with too many files");
    const std::vector<std::uint8_t> directory = bytes(number(end, *at + 16, 4), size);
    std::vector<Member> result;
    std::size_t place = 0;
    for (std::uint64_t i = 0; i < count; ++i) {
      constexpr std::size_t fixed = 46;
      if (place + fixed > directory.size() || number(directory, place, 4) != 0x02014B50) fail("is a damaged archive");
      const auto length = [&](std::size_t field) {
        return static_cast<std::size_t>(number(directory, place + field, 2));
      };
      const std::size_t name_length = length(28), next = place + fixed + name_length + length(30) + length(32);
      if (next > directory.size()) fail("is a damaged archive");
      Member member;
      member.name.assign(directory.begin() + static_cast<std::ptrdiff_t>(place + fixed),
                         directory.begin() + static_cast<std::ptrdiff_t>(place + fixed + name_length));
      member.is_compressed = number(directory, place + 10, 2) != 0;
      member.size = number(directory, place + 24, 4), member.header = number(directory, place + 42, 4);
      result.push_back(std::move(member));
      place = next;
    }
    return result;
  }

  /// Leaves the file at the first byte of a member.
  void seek(const Member& member) {
    constexpr std::uint64_t fixed = 30, of_other_kind = 0xFFFFFFFF;
    if (member.size == of_other_kind || member.header == of_other_kind) fail("has an array of more than 4 GiB");
    const std::vector<std::uint8_t> header = bytes(member.header, fixed);
    if (header.size() < fixed || number(header, 0, 4) != 0x04034B50) fail("is a damaged archive");
    input_.seek(member.header + fixed + number(header, 26, 2) + number(header, 28, 2));
  }

 private:
  static std::uint64_t number(const std::vector<std::uint8_t>& from, std::size_t at, std::size_t count) {
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < count && at + i < from.size(); ++i) value |= std::uint64_t{from[at + i]} << (8 * i);
    return value;
  }
  std::vector<std::uint8_t> bytes(std::uint64_t position, std::uint64_t count) {
    input_.seek(position);
    std::vector<std::uint8_t> result(static_cast<std::size_t>(count));
    result.resize(input_.read(result.data(), result.size()));
    return result;
  }
  std::vector<std::uint8_t> last_bytes() {
    constexpr std::uint64_t most = 65536;
    const std::uint64_t count = std::min(most, input_.size());
    return bytes(input_.size() - count, count);
  }

  InputFile& input_;
  const std::string& expected_;
};

}  // namespace

std::uint64_t seek_label_array(InputFile& input, const std::string& expected) {
  ArchiveReader archive(input, expected);
  const std::vector<Member> members = archive.members();
  const Member* chosen = members.size() == 1 ? &members.front() : nullptr;
  for (const char* name : {"labels.npy", "masks.npy", "instances.npy", "arr_0.npy"})
    for (const Member& member : members)
      if (chosen == nullptr && member.name == name) chosen = &member;
  if (chosen == nullptr) {
    std::string names;
    for (const Member& member : members) names += (names.empty() ? "" : ", ") + member.name;
    archive.fail("has the arrays " + (names.empty() ? std::string("(none)") : names) +
                 ", none of which is called labels, masks or instances");
  }
  if (chosen->is_compressed)
    archive.fail("has the compressed array " + chosen->name + "; save it with numpy.savez(), without compression");
  archive.seek(*chosen);
  return chosen->size;
}

}  // namespace holdfast::precomputed_plugin
