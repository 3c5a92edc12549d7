// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/plugin/abi.hpp"

#include <cstring>

namespace holdfast {

namespace {

std::string dotted(int version) {
  return std::to_string(version / 10000) + '.' + std::to_string(version / 100 % 100) + '.' +
         std::to_string(version % 100);
}

// As a plugin may hold anything, the text is not trusted to end.
std::string version_text(const AbiRecord& record) {
  return {record.holdfast_version, strnlen(record.holdfast_version, sizeof record.holdfast_version)};
}

}  // namespace

std::vector<std::string> abi_differences(const AbiRecord& program, const AbiRecord& plugin) {
  std::vector<std::string> differences;
  const auto compare = [&](const char* what, const std::string& ours, const std::string& theirs) {
    if (ours != theirs) differences.push_back(std::string(what) + ": program " + ours + ", plugin " + theirs);
  };
  if (plugin.magic != program.magic) return {"the plugin's record does not begin with Holdfast's mark"};
  compare("size of the ABI record", std::to_string(program.record_size), std::to_string(plugin.record_size));
  // What follows the size is only known to be there when the sizes agree.
  if (!differences.empty()) return differences;
  compare("Holdfast version", version_text(program), version_text(plugin));
  compare("C++ standard", std::to_string(program.cpp_standard), std::to_string(plugin.cpp_standard));
  compare("Eigen alignment", std::to_string(program.eigen_alignment), std::to_string(plugin.eigen_alignment));
  compare("Eigen version", dotted(program.eigen_version), dotted(plugin.eigen_version));
  compare("OpenCV version", dotted(program.opencv_version), dotted(plugin.opencv_version));
  compare("compiler ABI (__GXX_ABI_VERSION)", std::to_string(program.compiler_abi),
          std::to_string(plugin.compiler_abi));
  compare("_GLIBCXX_USE_CXX11_ABI", std::to_string(program.new_string_abi), std::to_string(plugin.new_string_abi));
  return differences;
}

}  // namespace holdfast
