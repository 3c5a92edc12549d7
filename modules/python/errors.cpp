// SPDX-License-Identifier: BSD-3-Clause
#include "errors.hpp"

#include <exception>
#include <memory>

#include "python_error.hpp"

namespace holdfast::python {

namespace py = pybind11;

namespace {

/// File names in messages need not be UTF-8.
py::object text_of(const std::string& text) {
  return py::reinterpret_steal<py::object>(
      PyUnicode_DecodeUTF8(text.data(), static_cast<Py_ssize_t>(text.size()), "replace"));
}

py::tuple location_of(const SourceLocation& location) {
  return py::make_tuple(text_of(location.file), location.line, location.column);
}

/// Raises holdfast._errors.`type`(text), with `attribute` set to `value`.
void raise(const char* type, const std::exception& error, const char* attribute = nullptr,
           const py::object& value = py::none(), const SharedObject* cause = nullptr) {
  const py::object exception = py::module_::import("holdfast._errors").attr(type)(text_of(error.what()));
  if (attribute != nullptr) exception.attr(attribute) = value;
  if (cause != nullptr) PyException_SetCause(exception.ptr(), py::object(cause->get()).release().ptr());
  PyErr_SetObject(reinterpret_cast<PyObject*>(Py_TYPE(exception.ptr())), exception.ptr());
}

py::list diagnostics_of(const ConfigurationError& error) {
  py::list diagnostics;
  for (const Diagnostic& diagnostic : error.diagnostics())
    diagnostics.append(py::module_::import("holdfast._errors")
                           .attr("Diagnostic")(text_of(diagnostic.location.file), diagnostic.location.line,
                                               diagnostic.location.column, text_of(diagnostic.message)));
  return diagnostics;
}

void translate(std::exception_ptr thrown) {
  if (!thrown) return;
  try {
    std::rethrow_exception(thrown);
  } catch (const CausedError& error) {
    if (PyErr_GivenExceptionMatches(error.cause().get().ptr(), PyExc_KeyboardInterrupt) != 0) {
      if (PyErr_CheckSignals() == 0) PyErr_SetNone(PyExc_KeyboardInterrupt);
      return;
    }
    raise("InputError", error, "location", location_of(error.location()), &error.cause());
  } catch (const ConfigurationError& error) {
    raise("ConfigurationError", error, "diagnostics", diagnostics_of(error));
  } catch (const InputError& error) {
    raise("InputError", error, "location", location_of(error.location()));
  } catch (const PluginError& error) {
    raise("PluginError", error);
  } catch (const Error& error) {
    raise("Error", error);
  } catch (const CheckError& error) {
    raise("CheckError", error);
  }
}

}  // namespace

void translate_errors() { py::register_exception_translator(translate); }

void throw_caused_error(const py::error_already_set& raised, const std::filesystem::path& file,
                        const std::string& doing) {
  const SharedObject cause(raised.value());
  try {
    python_plugin::throw_python_error(raised, file, doing, "");
  } catch (const InputError& error) {
    // A run that it ends asks for signals at its end. Only now: any code of Python would take it.
    if (raised.matches(PyExc_KeyboardInterrupt)) PyErr_SetInterrupt();
    throw CausedError(error, cause);
  }
}

}  // namespace holdfast::python
