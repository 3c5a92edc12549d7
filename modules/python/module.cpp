// SPDX-License-Identifier: BSD-3-Clause
#include "bindings.hpp"
#include "errors.hpp"
#include "holdfast/core/version.hpp"
#include "holdfast/run/results.hpp"

PYBIND11_MODULE(_core, module) {
  using namespace holdfast;
  module.doc() = "The C++ side of the package holdfast; private.";
  module.attr("version") = HOLDFAST_VERSION;
  module.attr("commit") = build_commit();
  python::translate_errors();
  // What others name in their signatures comes first.
  python::bind_cameras(module);
  python::bind_frames(module);
  python::bind_trajectories(module);
  python::bind_configurations(module);
  python::bind_maps(module);
  python::bind_results(module);
  python::bind_filter_context(module);
  python::bind_modules(module);
  python::bind_pipeline(module);
  python::bind_run(module);
  python::bind_simulation(module);
  python::bind_program(module);
}
