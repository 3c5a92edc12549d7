// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/plugin/plugin.hpp"

#include "process_segmenter.hpp"
#include "python_segmenter.hpp"

namespace holdfast::python_plugin {

namespace {

std::unique_ptr<Segmenter> make_segmenter(const PythonSettings& settings, const CreationContext& context) {
  if (settings.process == "own") return std::make_unique<ProcessSegmenter>(settings, context);
  return std::make_unique<PythonSegmenter>(settings, context);
}

}  // namespace

}  // namespace holdfast::python_plugin

HOLDFAST_PLUGIN(holdfast_python, registry) {
  using namespace holdfast;
  registry.add<Segmenter, python_plugin::PythonSettings>(
      {.name = "python", .summary = "A segmenter written in Python: a file with `class Segmenter`."},
      python_plugin::make_segmenter);
}
