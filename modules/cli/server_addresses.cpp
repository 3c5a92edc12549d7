// SPDX-License-Identifier: BSD-3-Clause
#include "server_addresses.hpp"

#include <cstdio>

#ifdef HOLDFAST_WEB_SERVER
#include "holdfast/web_server/socket_server.hpp"
#endif

namespace holdfast {

void print_server_addresses() {
#ifdef HOLDFAST_WEB_SERVER
  for (const auto& [name, address] : running_servers()) std::printf("%-20s %s\n", name.c_str(), address.c_str());
  std::fflush(stdout);  // whoever reads it through a pipe wants to look now
#endif
}

}  // namespace holdfast
