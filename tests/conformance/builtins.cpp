// SPDX-License-Identifier: BSD-3-Clause
// Everything that is linked in, as one static plugin: so the suite tests each built-in module, also the next one.
#include "holdfast/plugin/builtin.hpp"
#include "holdfast/plugin/plugin.hpp"

HOLDFAST_PLUGIN(builtins, registry) { holdfast::register_builtin_plugins(registry); }
