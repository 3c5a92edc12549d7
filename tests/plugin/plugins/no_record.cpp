// SPDX-License-Identifier: BSD-3-Clause
extern "C" __attribute__((visibility("default"))) void holdfast_register_plugin() { __builtin_trap(); }
