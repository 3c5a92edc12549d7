// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/plugin/abi.hpp"

extern "C" __attribute__((visibility("default"))) const holdfast::AbiRecord holdfast_plugin_abi;
const holdfast::AbiRecord holdfast_plugin_abi = holdfast::compiled_abi();
