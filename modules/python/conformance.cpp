// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/conformance/suite.hpp"

#include <gtest/gtest.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include "gil.hpp"
#include "holdfast/core/error.hpp"

/// The extension holdfast._conformance: the conformance tests for the modules that the extension holdfast._core holds.
/// It is one of its own, so that the package needs no GoogleTest. Errors are translated by holdfast._core.
namespace holdfast::python {

namespace py = pybind11;

namespace {

const Registry* tested = nullptr;

void add_tested(Registry& registry) {
  for (const std::string& kind : tested->kinds())
    for (const ModuleEntry* entry : tested->of_kind(kind)) registry.add(*entry);
}

int run(const py::capsule& registry, const std::vector<std::string>& modules, const std::vector<std::string>& exclude,
        const std::string& parameters, const std::string& folder, std::vector<std::string> options) {
  if (tested != nullptr) throw Error("the conformance tests run once in a process; start another one");
  tested = registry.get_pointer<Registry>();
  options.insert(options.begin(), "holdfast.conformance");
  std::vector<char*> words;
  for (std::string& option : options) words.push_back(option.data());
  auto count = static_cast<int>(words.size());
  words.push_back(nullptr);
  testing::InitGoogleTest(&count, words.data());
  conformance::add_tests({.register_modules = add_tested,
                          .plugin = "of this process",
                          .modules = modules,
                          .except = exclude,
                          .parameters = parameters,
                          .parameters_name = "parameters",
                          .folder = folder});
  const Unlock unlock;
  return RUN_ALL_TESTS();
}

}  // namespace

}  // namespace holdfast::python

PYBIND11_MODULE(_conformance, module) {
  namespace py = pybind11;
  module.doc() = "The conformance tests of the package holdfast; private.";
  module.def("run", &holdfast::python::run, py::arg("registry"), py::arg("modules"), py::arg("exclude"),
             py::arg("parameters"), py::arg("folder"), py::arg("options"));
}
