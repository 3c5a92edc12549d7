// SPDX-License-Identifier: BSD-3-Clause
// The part that is always linked in: it knows the parameters, so that the reference is the same in every build, and
// fetches the part that needs Python when a configuration asks for it.
#include "holdfast/core/error.hpp"
#include "holdfast/interfaces/segmenter.hpp"
#include "holdfast/plugin/loader.hpp"
#include "holdfast/plugin/plugin.hpp"
#include "settings.hpp"

namespace holdfast::python_plugin {

namespace {

constexpr const char* library = "holdfast_python";
constexpr const char* remedy =
    "To have it: install python3-dev, pybind11-dev and python3-numpy (names of Debian; `sh "
    "cmake/install_dependencies.sh --python` does it), configure Holdfast with -DHOLDFAST_PYTHON=ON, build and install "
    "it again; for a program outside that installation name the folder of the library in HOLDFAST_PLUGIN_PATH";

std::unique_ptr<Segmenter> make(const PythonSettings& settings, const CreationContext& context) {
  Registry registry;
  try {
    load_plugin(registry, library);
  } catch (const PluginError& error) {
    throw PluginError(std::string("the segmenter 'python' needs Python in this build of Holdfast, and its library '") +
                      library + "' cannot be used: " + error.what() + ". " + remedy);
  }
  return registry.create<Segmenter>("python", ParameterTable<PythonSettings>().values(settings), context);
}

}  // namespace

}  // namespace holdfast::python_plugin

HOLDFAST_PLUGIN(python, registry) {
  using namespace holdfast;
  registry.add<Segmenter, python_plugin::PythonSettings>(
      {.name = "python", .summary = "A segmenter written in Python: a file with `class Segmenter`."},
      python_plugin::make);
  if (!can_find_plugin(python_plugin::library))
    registry.add_unusable("segmenter", "python",
                          std::string("it needs Python in this build of Holdfast, and its library '") +
                              python_plugin::library + "' is not there. " + python_plugin::remedy);
}
