// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <opencv2/core/version.hpp>
#include <string>
#include <vector>

#include "holdfast/core/version.hpp"

namespace holdfast {

/// What must agree between the program and a plugin for objects to be passed between them. Plain data of fixed layout,
/// read before any function of the plugin is called.
struct AbiRecord {
  unsigned magic;  ///< abi_magic; guards against a symbol of that name that is something else
  unsigned record_size;
  char holdfast_version[16];
  long cpp_standard;    ///< __cplusplus
  int eigen_alignment;  ///< EIGEN_MAX_ALIGN_BYTES
  int eigen_version;    ///< world * 10000 + major * 100 + minor
  int opencv_version;   ///< major * 10000 + minor * 100 + revision
  int compiler_abi;     ///< __GXX_ABI_VERSION
  int new_string_abi;   ///< _GLIBCXX_USE_CXX11_ABI
};

inline constexpr unsigned abi_magic = 0x48464142;  // "HFAB"

/// The record of the code that includes this header.
constexpr AbiRecord compiled_abi() {
  AbiRecord record{abi_magic,
                   sizeof(AbiRecord),
                   HOLDFAST_VERSION,
                   __cplusplus,
                   EIGEN_MAX_ALIGN_BYTES,
                   EIGEN_WORLD_VERSION * 10000 + EIGEN_MAJOR_VERSION * 100 + EIGEN_MINOR_VERSION,
                   CV_VERSION_MAJOR * 10000 + CV_VERSION_MINOR * 100 + CV_VERSION_REVISION,
                   __GXX_ABI_VERSION,
                   _GLIBCXX_USE_CXX11_ABI};
  return record;
}

/// Every difference in words ("Eigen alignment: program 16, plugin 32"); empty when they fit.
std::vector<std::string> abi_differences(const AbiRecord& program, const AbiRecord& plugin);

}  // namespace holdfast
