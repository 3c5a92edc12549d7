// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/plugin/abi.hpp"

#include <cstring>

namespace holdfast {

namespace {

std::string dotted(int version) {
  return std::to_string(version / 10000) + '.' + std::to_string(version / 100 % 100) + '.' +
         std::to_string(version % 100);
}

// A plugin may contain anything, so that a text is not trusted to be null-terminated.
template <std::size_t size>
std::string text_of(const char (&text)[size]) {
  return {text, strnlen(text, size)};
}

std::string sanitizer_text(int sanitizers) {
  if (sanitizers == 0) return "none";
  std::string text = (sanitizers & 1) != 0 ? "address" : "";
  if ((sanitizers & 2) != 0) text += text.empty() ? "thread" : " and thread";
  return text;
}

/// Includes the compiler, because few readers know the ABI number.
std::string compiler_text(const AbiRecord& record) {
  return std::to_string(record.compiler_abi) + " (" + text_of(record.compiler) + ")";
}

}  // namespace

std::vector<std::string> abi_differences(const AbiRecord& program, const AbiRecord& plugin) {
  std::vector<std::string> differences;
  const auto compare = [&](const char* what, const std::string& ours, const std::string& theirs) {
    if (ours != theirs) differences.push_back(std::string(what) + ": program " + ours + ", plugin " + theirs);
  };
  if (plugin.magic != program.magic) return {"the plugin's record does not begin with Holdfast's mark"};
  // The version has the same position in every record; the members after it are only valid if the sizes agree.
  compare("Holdfast version", text_of(program.holdfast_version), text_of(plugin.holdfast_version));
  compare("size of the ABI record", std::to_string(program.record_size), std::to_string(plugin.record_size));
  if (program.record_size != plugin.record_size) return differences;
  const auto compare_numbers = [&](const char* what, long ours, long theirs) {
    compare(what, std::to_string(ours), std::to_string(theirs));
  };
  compare_numbers("C++ standard", program.cpp_standard, plugin.cpp_standard);
  compare_numbers("Eigen alignment", program.eigen_alignment, plugin.eigen_alignment);
  compare_numbers("Eigen alignment inside structs", program.eigen_static_alignment, plugin.eigen_static_alignment);
  compare_numbers("size of Eigen's index", program.eigen_index_size, plugin.eigen_index_size);
  compare_numbers("EIGEN_DEFAULT_TO_ROW_MAJOR", program.eigen_row_major, plugin.eigen_row_major);
  compare("Eigen version", dotted(program.eigen_version), dotted(plugin.eigen_version));
  compare("OpenCV version", dotted(program.opencv_version), dotted(plugin.opencv_version));
  if (program.compiler_abi != plugin.compiler_abi)
    compare("compiler ABI (__GXX_ABI_VERSION)", compiler_text(program), compiler_text(plugin));
  compare_numbers("_GLIBCXX_USE_CXX11_ABI", program.new_string_abi, plugin.new_string_abi);
  compare_numbers("_GLIBCXX_DEBUG", program.debug_containers, plugin.debug_containers);
  compare("sanitizers", sanitizer_text(program.sanitizers), sanitizer_text(plugin.sanitizers));
  return differences;
}

}  // namespace holdfast
