// SPDX-License-Identifier: BSD-3-Clause
#include <cstdlib>

#include "holdfast/plugin/plugin.hpp"

namespace {
constexpr holdfast::AbiRecord other_abi() {
  holdfast::AbiRecord record = holdfast::compiled_abi();
  record.eigen_alignment *= 2;
  record.holdfast_version[0] = '9';
  return record;
}
}  // namespace

extern "C" __attribute__((visibility("default"))) const holdfast::AbiRecord holdfast_plugin_abi;
const holdfast::AbiRecord holdfast_plugin_abi = other_abi();
extern "C" __attribute__((visibility("default"))) void holdfast_register_plugin(holdfast::Registry&) { std::abort(); }
