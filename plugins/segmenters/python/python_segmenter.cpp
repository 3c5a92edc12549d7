// SPDX-License-Identifier: BSD-3-Clause
#include "python_segmenter.hpp"

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <algorithm>
#include <atomic>
#include <charconv>
#include <filesystem>
#include <utility>

#include "class_names.hpp"
#include "holdfast/core/error.hpp"
#include "interpreter.hpp"
#include "labels.hpp"
#include "python_error.hpp"

namespace holdfast::python_plugin {

namespace py = pybind11;

struct PythonSegmenter::Python {
  Interpreter interpreter;
  py::object instance, segment;
};

namespace {

/// A value of `parameters`, as Python would understand it. YAML's quotes are gone by now, so that a text that reads as
/// a number is one.
py::object python_value(const std::string& text) {
  if (text == "true") return py::bool_(true);
  if (text == "false") return py::bool_(false);
  const char* const end = text.data() + text.size();
  long long whole = 0;
  if (const auto [last, error] = std::from_chars(text.data(), end, whole); error == std::errc() && last == end)
    return py::int_(whole);
  double real = 0.0;
  if (const auto [last, error] = std::from_chars(text.data(), end, real); error == std::errc() && last == end)
    return py::float_(real);
  return py::str(text);
}

/// Runs the file as a module of its own. What lies beside it can be imported, as if the file were run by `python3`.
py::object run_file(const std::filesystem::path& file) {
  static std::atomic<int> count = 0;
  py::list path = py::module_::import("sys").attr("path");
  const py::str folder(file.parent_path().string());
  if (!path.contains(folder)) path.insert(0, folder);
  const py::module_ util = py::module_::import("importlib.util");
  const std::string name = "holdfast_segmenter_" + std::to_string(++count);
  const py::object loader = py::module_::import("importlib.machinery").attr("SourceFileLoader")(name, file.string());
  const py::object spec = util.attr("spec_from_file_location")(name, file.string(), py::arg("loader") = loader);
  py::object module = util.attr("module_from_spec")(spec);
  py::module_::import("sys").attr("modules")[py::str(name)] = module;
  spec.attr("loader").attr("exec_module")(module);
  return module;
}

/// A copy of the image's own, so that Python code may keep and change it.
py::array image_of(const cv::Mat& colour, bool rgb) {
  py::array_t<std::uint8_t> image({colour.rows, colour.cols, 3});
  for (int y = 0; y < colour.rows; ++y) {
    const std::uint8_t* from = colour.ptr<std::uint8_t>(y);
    std::uint8_t* to = image.mutable_data(y, 0, 0);
    if (rgb)
      for (int x = 0; x < colour.cols; ++x, from += 3, to += 3) to[0] = from[2], to[1] = from[1], to[2] = from[0];
    else
      std::copy_n(from, 3 * colour.cols, to);
  }
  return image;
}

}  // namespace

PythonSegmenter::PythonSegmenter(const PythonSettings& settings, const CreationContext&)
    : file_(std::filesystem::absolute(settings.file).lexically_normal()), rgb_(settings.colour_order == "rgb") {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(file_, ignored))
    throw InputError({file_.string()},
                     std::string(std::filesystem::exists(file_, ignored) ? "is no file" : "is missing") +
                         "; expected a Python file with `class Segmenter`; set `segmenter.python.file`");
  python_ = std::make_unique<Python>();
  const Lock lock;
  try {
    load(settings);
    classes_ = read_classes(python_->instance, "Segmenter", file_);
    movable_ = read_movable(python_->instance, "Segmenter", classes_, file_);
  } catch (...) {
    python_->segment = python_->instance = py::object();  // while the lock is held
    throw;
  }
}

PythonSegmenter::~PythonSegmenter() {
  const Lock lock;
  python_->segment = python_->instance = py::object();
}

void PythonSegmenter::load(const PythonSettings& settings) {
  try {
    py::module_::import("numpy");
  } catch (const py::error_already_set& raised) {
    throw_python_error(raised, file_, "`import numpy`",
                       "numpy, in which images and labels are handed over: install python3-numpy, or numpy in the "
                       "virtual environment that is active");
  }
  py::object module;
  try {
    module = run_file(file_);
  } catch (const py::error_already_set& raised) {
    throw_python_error(raised, file_, "running the file", "");
  }
  if (!py::hasattr(module, "Segmenter"))
    throw InputError({file_.string()},
                     "has no `class Segmenter`; expected class Segmenter: classes = [...]; def segment(self, image)");
  try {
    py::dict parameters;
    for (const auto& [name, text] : settings.parameters) parameters[py::str(name)] = python_value(text);
    python_->instance = module.attr("Segmenter")(**parameters);
  } catch (const py::error_already_set& raised) {
    throw_python_error(raised, file_, "making Segmenter with `segmenter.python.parameters`", "");
  }
  if (!py::hasattr(python_->instance, "segment") ||
      PyCallable_Check(py::object(python_->instance.attr("segment")).ptr()) == 0)
    throw InputError({file_.string()}, "`class Segmenter` has no method segment; expected def segment(self, image)");
  python_->segment = python_->instance.attr("segment");
}

Segmentation PythonSegmenter::segment(const SensorFrame& frame) {
  const cv::Mat& colour = frame.colour;
  if (colour.empty() || colour.type() != CV_8UC3)
    throw InputError({file_.string()}, "cannot be given frame " + std::to_string(frame.index) +
                                           ", which has no colour image of 8 bit and three channels");
  const Lock lock;
  try {
    const py::object result = python_->segment(image_of(colour, rgb_));
    return read_result(result, colour.size(), classes_.size(), "Segmenter", file_);
  } catch (const py::error_already_set& raised) {
    throw_python_error(raised, file_, "Segmenter.segment", "labels for frame " + std::to_string(frame.index));
  }
}

}  // namespace holdfast::python_plugin
