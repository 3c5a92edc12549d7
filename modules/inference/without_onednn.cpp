// SPDX-License-Identifier: BSD-3-Clause
// The engine onednn in builds without its library.
#include "holdfast/core/check.hpp"
#include "holdfast/core/error.hpp"
#include "holdfast/inference/network.hpp"
#include "network_runner.hpp"

namespace holdfast {

bool has_onednn() { return false; }

void require_onednn(NetworkPrecision) {
  throw ConfigurationError(SourceLocation{},
                           "engine: found onednn, but this build has no oneDNN; expected opencv; or install oneDNN "
                           "(Debian: libdnnl-dev), configure with -DHOLDFAST_ONEDNN=ON and build again");
}

std::unique_ptr<NetworkRunner> load_with_onednn(const std::filesystem::path&, std::span<const std::uint8_t>,
                                                const OnnxNet::Use&, NetworkPrecision, int) {
  HOLDFAST_CHECK(false, "this build has no oneDNN");
  return nullptr;
}

}  // namespace holdfast
