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

  static void describe(ParameterTable<PythonSettings>& table) {
    using S = PythonSettings;
    table.add("file", &S::file, "Python file with `class Segmenter`").required();
    table.add("colour_order", &S::colour_order, "order of the channels that segment() gets").one_of({"rgb", "bgr"});
    table.add("parameters", &S::parameters,
              "handed to the class by name, as Segmenter(name=value); what reads as a number, true or false is one");
  }
};

}  // namespace holdfast::python_plugin
