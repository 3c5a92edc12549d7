// SPDX-License-Identifier: BSD-3-Clause
#include "class_names.hpp"

#include <algorithm>

#include "holdfast/core/error.hpp"
#include "holdfast/plugin/did_you_mean.hpp"

namespace holdfast::python_plugin {

namespace py = pybind11;

namespace {

std::vector<std::string> read_names(const py::object& names, const std::string& attribute,
                                    const std::filesystem::path& file) {
  const auto refuse = [&](const std::string& found) {
    throw InputError({file.string()}, attribute + " is " + found +
                                          "; expected a list of different names, such as ['background', 'person']");
  };
  if (!py::isinstance<py::list>(names) && !py::isinstance<py::tuple>(names)) refuse(py::repr(names));
  std::vector<std::string> result;
  for (const py::handle& name : names) {
    if (!py::isinstance<py::str>(name)) refuse(py::repr(names));
    result.push_back(name.cast<std::string>());
    if (result.back().empty() || std::count(result.begin(), result.end(), result.back()) > 1) refuse(py::repr(names));
  }
  return result;
}

}  // namespace

std::vector<std::string> read_classes(const py::object& segmenter, const std::string& owner,
                                      const std::filesystem::path& file) {
  if (!py::hasattr(segmenter, "classes"))
    throw InputError({file.string()}, "`class " + owner +
                                          "` has no `classes`; expected a list of names by label, such as classes = "
                                          "['background', 'person']");
  std::vector<std::string> classes = read_names(segmenter.attr("classes"), owner + ".classes", file);
  if (classes.empty() || classes.size() > 255)
    throw InputError({file.string()}, owner + ".classes has " + std::to_string(classes.size()) +
                                          " names; expected 1 to 255, the first being the background");
  return classes;
}

std::vector<std::string> read_movable(const py::object& segmenter, const std::string& owner,
                                      const std::vector<std::string>& classes, const std::filesystem::path& file) {
  if (!py::hasattr(segmenter, "movable")) return {};
  std::vector<std::string> movable = read_names(segmenter.attr("movable"), owner + ".movable", file);
  for (const std::string& name : movable)
    if (std::find(classes.begin(), classes.end(), name) == classes.end())
      throw InputError({file.string()}, owner + ".movable names '" + name + "', which is none of the classes; " +
                                            did_you_mean(name, classes));
  return movable;
}

}  // namespace holdfast::python_plugin
