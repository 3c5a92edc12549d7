// SPDX-License-Identifier: BSD-3-Clause
#include "file_limit.hpp"

#include <csignal>

namespace holdfast {

void survive_file_limit() {
  struct sigaction earlier = {};
  if (sigaction(SIGXFSZ, nullptr, &earlier) != 0 || earlier.sa_handler == SIG_IGN) return;
  struct sigaction action = {};
  action.sa_handler = [](int) {};  // to ignore the signal would be inherited by programs that are started
  action.sa_flags = SA_RESTART;
  sigaction(SIGXFSZ, &action, nullptr);
}

}  // namespace holdfast
