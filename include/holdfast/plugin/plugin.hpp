// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "holdfast/plugin/abi.hpp"
#include "holdfast/plugin/registry.hpp"

/// Defines the entry function of a plugin, which registers its modules. Built-in and external plugins use the same one:
///
///     HOLDFAST_PLUGIN(my_segmenter, registry) {
///       registry.add<holdfast::Segmenter, MySegmenter, MySettings>({.name = "mine", .summary = "..."});
///     }
///
/// In a shared plugin the macro defines `extern "C" void holdfast_register_plugin(holdfast::Registry&)` and the record
/// `holdfast_plugin_abi`, which the loader compares with its own. With HOLDFAST_STATIC_PLUGIN (set by CMake) the
/// function is called holdfast_register_plugin_my_segmenter, so that many plugins can be linked into one program.
#if defined(HOLDFAST_STATIC_PLUGIN)
#define HOLDFAST_PLUGIN(name, registry) extern "C" void holdfast_register_plugin_##name(::holdfast::Registry& registry)
#else
#define HOLDFAST_PLUGIN(name, registry)                                                              \
  extern "C" __attribute__((visibility("default"))) const ::holdfast::AbiRecord holdfast_plugin_abi; \
  const ::holdfast::AbiRecord holdfast_plugin_abi = ::holdfast::compiled_abi();                      \
  extern "C" __attribute__((visibility("default"))) void holdfast_register_plugin(::holdfast::Registry& registry)
#endif
