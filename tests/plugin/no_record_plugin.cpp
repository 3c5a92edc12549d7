// SPDX-License-Identifier: BSD-3-Clause
extern "C" __attribute__((visibility("default"))) int holdfast_some_library() { return 1; }
