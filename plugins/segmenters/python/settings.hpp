// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>

#include "holdfast/plugin/parameter_table.hpp"

namespace holdfast::python_plugin {

struct PythonSettings {
  std::filesystem::path file;
  std::string colour_order = "rgb";
  TextMap parameters;
  std::string process = "shared";
  double timeout = 30.0;

  static void describe(ParameterTable<PythonSettings>& table) {
    using S = PythonSettings;
    table.add("file", &S::file, "Python file with `class Segmenter`").required();
    table.add("colour_order", &S::colour_order, "order of the channels that segment() gets").one_of({"rgb", "bgr"});
    table.add("parameters", &S::parameters,
              "handed to the class by name, as Segmenter(name=value); what reads as a number, true or false is one");
    table
        .add("process", &S::process,
             "where Python runs: in the process of the program, or in its own, whose crash costs the masks of a frame "
             "instead of the run, and which leaves Python's lock to others")
        .one_of({"shared", "own"});
    table.add("timeout", &S::timeout, "of a frame; a process of its own that takes longer is ended and started anew")
        .range(0.01, 86400)
        .unit("s");
  }
};

}  // namespace holdfast::python_plugin
