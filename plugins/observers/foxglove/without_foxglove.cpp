// SPDX-License-Identifier: BSD-3-Clause
// The observer of a build without Boost: its parameters are known, but it cannot be made.
#include "foxglove_description.hpp"
#include "holdfast/core/error.hpp"
#include "holdfast/interfaces/observer.hpp"
#include "holdfast/plugin/plugin.hpp"
#include "holdfast/settings/foxglove.hpp"

namespace holdfast {

namespace {

std::unique_ptr<Observer> make_no_connection(const FoxgloveSettings&, const CreationContext&) {
  throw PluginError("this build has no connection to Foxglove (Debian: libboost-dev)");
}

}  // namespace

HOLDFAST_PLUGIN(foxglove, registry) {
  registry.add<Observer, FoxgloveSettings>(foxglove_plugin::description(), make_no_connection);
}

}  // namespace holdfast
