// SPDX-License-Identifier: BSD-3-Clause
#include "python_error.hpp"

#include "holdfast/core/error.hpp"

namespace holdfast::python_plugin {

namespace py = pybind11;

namespace {

/// What Python's own C code raises need not come through any line.
py::object trace_of(const py::error_already_set& raised) { return raised.trace() ? raised.trace() : py::none(); }

/// As Python itself would print it.
std::string traceback_of(const py::error_already_set& raised) {
  try {
    const py::object lines =
        py::module_::import("traceback").attr("format_exception")(raised.type(), raised.value(), trace_of(raised));
    std::string text = py::str(py::str("").attr("join")(lines));
    while (!text.empty() && text.back() == '\n') text.pop_back();
    return text;
  } catch (const std::exception&) {
    return raised.what();  // even printing it failed, as exceptions with a broken __str__ do
  }
}

std::string summary_of(const py::error_already_set& raised) {
  try {
    const std::string type = py::str(raised.type().attr("__name__"));
    const std::string text = py::str(raised.value());
    return text.empty() ? type : type + ": " + text;
  } catch (const std::exception&) {
    return "an exception that cannot be printed";
  }
}

/// The innermost line of the file that the exception came through; 0 when it did not.
int line_of(const py::error_already_set& raised, const std::string& file) {
  int line = 0;
  try {
    for (py::object trace = trace_of(raised); !trace.is_none(); trace = trace.attr("tb_next"))
      if (trace.attr("tb_frame").attr("f_code").attr("co_filename").cast<std::string>() == file)
        line = trace.attr("tb_lineno").cast<int>();
    if (line == 0 && raised.matches(PyExc_SyntaxError) &&
        py::str(raised.value().attr("filename")).cast<std::string>() == file)
      line = raised.value().attr("lineno").cast<int>();
  } catch (const std::exception&) {
    return line;  // whoever raised it left out what every exception has
  }
  return line;
}

}  // namespace

void throw_python_error(const py::error_already_set& raised, const std::filesystem::path& file,
                        const std::string& doing, const std::string& expected) {
  std::string message = doing + " raised " + summary_of(raised);
  if (!expected.empty()) message += "; expected " + expected;
  message += ". Python says:\n" + traceback_of(raised);
  throw InputError({file.string(), line_of(raised, file.string())}, message);
}

}  // namespace holdfast::python_plugin
