// SPDX-License-Identifier: BSD-3-Clause
// The right symbol with something else in it.
extern "C" __attribute__((visibility("default"))) const unsigned holdfast_plugin_abi;
const unsigned holdfast_plugin_abi = 42;
extern "C" __attribute__((visibility("default"))) void holdfast_register_plugin() { __builtin_trap(); }
