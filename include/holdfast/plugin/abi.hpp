// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <opencv2/core/version.hpp>
#include <string>
#include <vector>

#include "holdfast/core/version.hpp"

namespace holdfast {

/// The properties of a build that must agree between the program and a plugin so that objects can be passed between
/// them. Plain data of fixed layout, read from the plugin's file before the plugin is loaded. The first three members
/// keep their position in every version.
struct AbiRecord {
  unsigned magic;  ///< abi_magic; detects an unrelated symbol of the same name
  unsigned record_size;
  char holdfast_version[16];
  char compiler[24];           ///< for messages only: different compilers may share one ABI
  long cpp_standard;           ///< __cplusplus
  int eigen_alignment;         ///< EIGEN_MAX_ALIGN_BYTES: alignment of Eigen's dynamic memory
  int eigen_static_alignment;  ///< alignof(Eigen::Vector4d), which depends on further macros
  int eigen_index_size;        ///< sizeof(Eigen::Index)
  int eigen_row_major;         ///< 1 with EIGEN_DEFAULT_TO_ROW_MAJOR
  int eigen_version;           ///< world * 10000 + major * 100 + minor
  int opencv_version;          ///< major * 10000 + minor * 100 + revision
  int compiler_abi;            ///< __GXX_ABI_VERSION
  int new_string_abi;          ///< _GLIBCXX_USE_CXX11_ABI
  int debug_containers;        ///< 1 with _GLIBCXX_DEBUG, which changes the layout of containers
  int sanitizers;              ///< bit 0: address, bit 1: thread sanitizer; their runtimes must be loaded first
};

inline constexpr unsigned abi_magic = 0x48464142;  // "HFAB"

#define HOLDFAST_TEXT_OF_VALUE(value) #value
#define HOLDFAST_TEXT_OF(macro) HOLDFAST_TEXT_OF_VALUE(macro)
#if defined(__clang__)
#define HOLDFAST_COMPILER "Clang " HOLDFAST_TEXT_OF(__clang_major__) "." HOLDFAST_TEXT_OF(__clang_minor__)
#else
#define HOLDFAST_COMPILER "GCC " HOLDFAST_TEXT_OF(__GNUC__) "." HOLDFAST_TEXT_OF(__GNUC_MINOR__)
#endif

namespace detail {

constexpr int compiled_sanitizers() {
  int sanitizers = 0;
#if defined(__SANITIZE_ADDRESS__)
  sanitizers |= 1;
#endif
#if defined(__SANITIZE_THREAD__)
  sanitizers |= 2;
#endif
#if defined(__has_feature)
#if __has_feature(address_sanitizer)
  sanitizers |= 1;
#endif
#if __has_feature(thread_sanitizer)
  sanitizers |= 2;
#endif
#endif
  return sanitizers;
}

constexpr bool compiled_debug_containers() {
#if defined(_GLIBCXX_DEBUG)
  return true;
#else
  return false;
#endif
}

}  // namespace detail

/// The record of the translation unit that includes this header.
constexpr AbiRecord compiled_abi() {
  AbiRecord record{abi_magic,
                   sizeof(AbiRecord),
                   HOLDFAST_VERSION,
                   HOLDFAST_COMPILER,
                   __cplusplus,
                   EIGEN_MAX_ALIGN_BYTES,
                   static_cast<int>(alignof(Eigen::Vector4d)),
                   static_cast<int>(sizeof(Eigen::Index)),
                   Eigen::MatrixXd::IsRowMajor,
                   EIGEN_WORLD_VERSION * 10000 + EIGEN_MAJOR_VERSION * 100 + EIGEN_MINOR_VERSION,
                   CV_VERSION_MAJOR * 10000 + CV_VERSION_MINOR * 100 + CV_VERSION_REVISION,
                   __GXX_ABI_VERSION,
                   _GLIBCXX_USE_CXX11_ABI,
                   detail::compiled_debug_containers(),
                   detail::compiled_sanitizers()};
  return record;
}

/// Describes every difference ("Eigen alignment: program 16, plugin 32"); empty if the two are compatible.
std::vector<std::string> abi_differences(const AbiRecord& program, const AbiRecord& plugin);

}  // namespace holdfast
