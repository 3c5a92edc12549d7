// SPDX-License-Identifier: BSD-3-Clause
#include "abi_of_file.hpp"

#include <elf.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <string>
#include <vector>

namespace holdfast {

namespace {

/// Reads a file at given offsets; reading beyond its end fails.
class ElfFile {
 public:
  explicit ElfFile(const std::filesystem::path& file) : stream_(file, std::ios::binary) {
    if (stream_.seekg(0, std::ios::end)) size_ = static_cast<std::uint64_t>(stream_.tellg());
  }

  bool read(std::uint64_t offset, void* into, std::uint64_t size) {
    stream_.clear();
    return stream_.seekg(static_cast<std::streamoff>(offset)) &&
           stream_.read(static_cast<char*>(into), static_cast<std::streamsize>(size));
  }
  template <class Item>
  std::vector<Item> table(std::uint64_t offset, std::uint64_t count) {
    // A damaged file must not exhaust the memory: no table is larger than the file.
    std::vector<Item> items(offset <= size_ && count <= (size_ - offset) / sizeof(Item) ? count : 0);
    if (items.empty() || !read(offset, items.data(), items.size() * sizeof(Item))) items.clear();
    return items;
  }

 private:
  std::ifstream stream_;
  std::uint64_t size_ = 0;
};

/// File offset of a virtual address of the library.
std::optional<std::uint64_t> file_offset(const std::vector<Elf64_Phdr>& segments, std::uint64_t address) {
  for (const Elf64_Phdr& segment : segments)
    if (segment.p_type == PT_LOAD && address >= segment.p_vaddr && address - segment.p_vaddr < segment.p_filesz)
      return address - segment.p_vaddr + segment.p_offset;
  return std::nullopt;
}

std::optional<Elf64_Sym> find_symbol(ElfFile& file, const Elf64_Ehdr& header, const std::string& wanted) {
  const auto sections = file.table<Elf64_Shdr>(header.e_shoff, header.e_shnum);
  // A library has one section of dynamic symbols.
  const auto section = std::find_if(sections.begin(), sections.end(),
                                    [](const Elf64_Shdr& candidate) { return candidate.sh_type == SHT_DYNSYM; });
  if (section == sections.end() || section->sh_link >= sections.size()) return std::nullopt;
  const Elf64_Shdr& text = sections[section->sh_link];
  const auto names = file.table<char>(text.sh_offset, text.sh_size);
  for (const Elf64_Sym& symbol : file.table<Elf64_Sym>(section->sh_offset, section->sh_size / sizeof(Elf64_Sym))) {
    if (symbol.st_shndx == SHN_UNDEF || symbol.st_name >= names.size()) continue;
    const char* name = names.data() + symbol.st_name;
    if (wanted == std::string(name, strnlen(name, names.size() - symbol.st_name))) return symbol;
  }
  return std::nullopt;
}

/// The header of a 64 bit ELF file.
std::optional<Elf64_Ehdr> read_header(ElfFile& file) {
  Elf64_Ehdr header = {};
  if (!file.read(0, &header, sizeof header) || std::memcmp(header.e_ident, ELFMAG, SELFMAG) != 0 ||
      header.e_ident[EI_CLASS] != ELFCLASS64 || header.e_phentsize != sizeof(Elf64_Phdr))
    return std::nullopt;
  return header;
}

}  // namespace

std::optional<AbiRecord> read_abi_of_file(const std::filesystem::path& path) {
  ElfFile file(path);
  const auto header = read_header(file);
  if (!header || header->e_shentsize != sizeof(Elf64_Shdr)) return std::nullopt;
  const auto symbol = find_symbol(file, *header, "holdfast_plugin_abi");
  if (!symbol) return std::nullopt;
  const auto offset = file_offset(file.table<Elf64_Phdr>(header->e_phoff, header->e_phnum), symbol->st_value);
  AbiRecord record = {};
  if (!offset || !file.read(*offset, &record, std::min<std::uint64_t>(symbol->st_size, sizeof record)))
    return std::nullopt;
  return record;
}

bool is_cut_off(const std::filesystem::path& path) {
  std::error_code error;
  const std::uint64_t size = std::filesystem::file_size(path, error);
  ElfFile file(path);
  const auto header = read_header(file);
  if (error || !header) return false;
  const auto segments = file.table<Elf64_Phdr>(header->e_phoff, header->e_phnum);
  return segments.empty() || std::any_of(segments.begin(), segments.end(), [&](const Elf64_Phdr& segment) {
           return segment.p_type == PT_LOAD && (segment.p_offset > size || segment.p_filesz > size - segment.p_offset);
         });
}

}  // namespace holdfast
