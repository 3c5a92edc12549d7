// SPDX-License-Identifier: BSD-3-Clause
#include <pybind11/stl.h>

#include "bindings.hpp"
#include "command_line.hpp"
#include "gil.hpp"
#include "registry.hpp"

namespace holdfast::python {

namespace py = pybind11;

namespace {

/// The built-in modules, and those that Python code has registered.
Registry program_modules() {
  const Lock lock;
  Registry registry = builtin_modules();
  add_registered(registry);
  return registry;
}

}  // namespace

void bind_program(py::module_& module) {
  // The signals are the program's while it runs, as they are without Python.
  module.def(
      "run_program",
      [](const std::vector<std::string>& words, const std::vector<std::string>& command) {
        std::vector<const char*> arguments{"holdfast"};
        for (const std::string& word : words) arguments.push_back(word.c_str());
        const ProgramHost host{.modules = program_modules, .command = command};
        const Unlock unlock;
        return run_program(static_cast<int>(arguments.size()), arguments.data(), host);
      },
      py::arg("words"), py::arg("command"));
}

}  // namespace holdfast::python
