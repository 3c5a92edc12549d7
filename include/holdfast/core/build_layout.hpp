// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

/// Compiler flags that the layout of types in public headers depends on. A program compiled with flags that differ from
/// those of the library in one of these does not link: `-march=native` and `-mavx2` change the alignment of Eigen's
/// matrices, as do EIGEN_MAX_ALIGN_BYTES and EIGEN_MAX_STATIC_ALIGN_BYTES. Each object file refers to the static member
/// `is_that_of_the_library` of its own BuildLayout, and the library defines this member for its own layout only. The
/// linker's message therefore states the flags of the program. The remedies are in docs/embedding.md.
///
/// Plugins in shared libraries are compared with the program when they are loaded (AbiRecord in plugin/abi.hpp).
namespace holdfast::build_layout {

enum class EigenMaxAlignBytes : int {};       ///< alignment of dynamic memory
enum class EigenAlignmentInStructs : int {};  ///< alignof(Eigen::Vector4d)
enum class EigenIndexBytes : int {};          ///< EIGEN_DEFAULT_DENSE_INDEX_TYPE
enum class EigenRowMajor : bool {};           ///< EIGEN_DEFAULT_TO_ROW_MAJOR
enum class GlibcxxDebug : bool {};            ///< _GLIBCXX_DEBUG: layout of the standard containers

/// A layout; its arguments determine it and appear in the linker's message.
template <EigenMaxAlignBytes, EigenAlignmentInStructs, EigenIndexBytes, EigenRowMajor, GlibcxxDebug>
struct BuildLayout {
  static const char is_that_of_the_library;  ///< defined for the library's layout alone
};

constexpr GlibcxxDebug compiled_glibcxx_debug() {
#if defined(_GLIBCXX_DEBUG)
  return GlibcxxDebug{true};
#else
  return GlibcxxDebug{false};
#endif
}

/// The layout of the translation unit that includes this header.
using ThisBuildLayout =
    BuildLayout<EigenMaxAlignBytes{EIGEN_MAX_ALIGN_BYTES}, EigenAlignmentInStructs{alignof(Eigen::Vector4d)},
                EigenIndexBytes{sizeof(Eigen::Index)}, EigenRowMajor{bool{Eigen::MatrixXd::IsRowMajor}},
                compiled_glibcxx_debug()>;

template <>
const char ThisBuildLayout::is_that_of_the_library;  // defined by the library, if this is its layout

/// The reference of this object file. It is static because the linker would merge inline variables of different flags.
[[gnu::used]] static const char* const this_build = &ThisBuildLayout::is_that_of_the_library;

}  // namespace holdfast::build_layout
