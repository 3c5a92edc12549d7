// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "holdfast/plugin/abi.hpp"
#include "holdfast/plugin/registry.hpp"

/// The door through which every module enters, built in or from outside:
///
///     HOLDFAST_PLUGIN(my_segmenter, registry) {
///       registry.add<holdfast::Segmenter, MySegmenter, MySettings>({.name = "mine", .summary = "..."});
///     }
///
/// In a shared plugin this defines `extern "C" void holdfast_register_plugin(holdfast::Registry&)` and the record
/// `holdfast_plugin_abi` that the loader compares with its own; with HOLDFAST_STATIC_PLUGIN (set by CMake) the function
/// is called holdfast_register_plugin_my_segmenter, so that many fit into one program.
#if defined(HOLDFAST_STATIC_PLUGIN)
#define HOLDFAST_PLUGIN(name, registry) extern "C" void holdfast_register_plugin_##name(::holdfast::Registry& registry)
#else
#define HOLDFAST_PLUGIN(name, registry)                                                              \
  extern "C" __attribute__((visibility("default"))) const ::holdfast::AbiRecord holdfast_plugin_abi; \
  const ::holdfast::AbiRecord holdfast_plugin_abi = ::holdfast::compiled_abi();                      \
  extern "C" __attribute__((visibility("default"))) void holdfast_register_plugin(::holdfast::Registry& registry)
#endif
