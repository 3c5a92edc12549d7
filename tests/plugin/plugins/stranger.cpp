// SPDX-License-Identifier: BSD-3-Clause
// A plugin that was built for another Eigen alignment and another version.
#include "holdfast/plugin/abi.hpp"

namespace {
constexpr holdfast::AbiRecord strange_record() {
  holdfast::AbiRecord record = holdfast::compiled_abi();
  record.eigen_alignment = 1024;
  record.holdfast_version[0] = '9';
  return record;
}
}  // namespace

extern "C" __attribute__((visibility("default"))) const holdfast::AbiRecord holdfast_plugin_abi;
const holdfast::AbiRecord holdfast_plugin_abi = strange_record();
extern "C" __attribute__((visibility("default"))) void holdfast_register_plugin() { __builtin_trap(); }
