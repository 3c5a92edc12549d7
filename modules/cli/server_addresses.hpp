// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace holdfast {

/// Prints where the servers of this process can be reached, such as those of the observers `viewer` and `foxglove`, a
/// line for each. Nothing in a build without servers.
void print_server_addresses();

}  // namespace holdfast
