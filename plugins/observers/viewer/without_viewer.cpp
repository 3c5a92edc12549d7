// SPDX-License-Identifier: BSD-3-Clause
// The observer of a build without Boost: its parameters are known, but it cannot be made.
#include "holdfast/core/error.hpp"
#include "holdfast/interfaces/observer.hpp"
#include "holdfast/plugin/plugin.hpp"
#include "holdfast/settings/viewer.hpp"
#include "viewer_description.hpp"

namespace holdfast {

namespace {

std::unique_ptr<Observer> make_no_viewer(const ViewerSettings&, const CreationContext&) {
  throw PluginError("this build has no viewer (Debian: libboost-dev)");
}

}  // namespace

HOLDFAST_PLUGIN(viewer, registry) {
  registry.add<Observer, ViewerSettings>(viewer_plugin::description(), make_no_viewer);
}

}  // namespace holdfast
