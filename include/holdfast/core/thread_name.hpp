// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#ifdef __linux__
#include <pthread.h>
#endif

namespace holdfast {

/// Names the calling thread for debuggers, profilers and `top -H`. Linux keeps the first 15 bytes; other systems keep
/// no name.
inline void name_this_thread([[maybe_unused]] const std::string& name) {
#ifdef __linux__
  pthread_setname_np(pthread_self(), name.substr(0, 15).c_str());
#endif
}

}  // namespace holdfast
