// SPDX-License-Identifier: BSD-3-Clause
// The record of however this file is compiled. It must not come to loading what does not fit.
#include "holdfast/plugin/abi.hpp"

extern "C" __attribute__((visibility("default"))) const holdfast::AbiRecord holdfast_plugin_abi;
const holdfast::AbiRecord holdfast_plugin_abi = holdfast::compiled_abi();
extern "C" __attribute__((visibility("default"))) void holdfast_register_plugin() { __builtin_trap(); }

namespace {
const struct Loaded {
  Loaded() { __builtin_trap(); }
} loaded;
}  // namespace
