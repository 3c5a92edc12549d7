// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/plugin/plugin.hpp"

#include "python_segmenter.hpp"

HOLDFAST_PLUGIN(holdfast_python, registry) {
  using namespace holdfast;
  registry.add<Segmenter, python_plugin::PythonSegmenter, python_plugin::PythonSettings>(
      {.name = "python", .summary = "A segmenter written in Python: a file with `class Segmenter`."});
}
