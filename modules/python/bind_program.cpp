// SPDX-License-Identifier: BSD-3-Clause
#include <pybind11/stl.h>

#include "bindings.hpp"
#include "command_line.hpp"
#include "gil.hpp"

namespace holdfast::python {

namespace py = pybind11;

void bind_program(py::module_& module) {
  // The signals are the program's while it runs, as they are without Python.
  module.def(
      "run_program",
      [](const std::vector<std::string>& words) {
        std::vector<const char*> arguments{"holdfast"};
        for (const std::string& word : words) arguments.push_back(word.c_str());
        const Unlock unlock;
        return run_program(static_cast<int>(arguments.size()), arguments.data());
      },
      py::arg("words"));
}

}  // namespace holdfast::python
