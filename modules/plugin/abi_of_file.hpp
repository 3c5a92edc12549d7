// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <optional>

#include "holdfast/plugin/abi.hpp"

namespace holdfast {

/// The record `holdfast_plugin_abi` of a shared library, read from its file: nothing of the library is loaded or run.
/// Nothing when the file is no 64 bit ELF file with that symbol. Of a record that is shorter than ours the rest is 0.
std::optional<AbiRecord> read_abi_of_file(const std::filesystem::path& file);

/// Whether the file is a shared library that ends too early, such as one that is still being copied. Loading it would
/// crash.
bool is_cut_off(const std::filesystem::path& file);

}  // namespace holdfast
