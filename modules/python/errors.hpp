// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pybind11/pybind11.h>

#include <filesystem>
#include <string>

#include "gil.hpp"
#include "holdfast/core/error.hpp"

/// Errors on their way between C++ and Python.
namespace holdfast::python {

/// An error of Python code that C++ called: passes through C++ as an InputError with the traceback in its text, and
/// arrives in Python with the original exception as its cause.
class CausedError : public InputError {
 public:
  CausedError(const InputError& error, SharedObject cause) : InputError(error), cause_(std::move(cause)) {}
  const SharedObject& cause() const { return cause_; }

 private:
  SharedObject cause_;
};

/// Makes C++ errors arrive as exceptions of holdfast._errors, with the same text.
void translate_errors();

/// Throws CausedError for what Python code of `file` raised while `doing` ("Segmenter.segment"). A KeyboardInterrupt is
/// raised again in the main thread, as soon as Python has the lock there.
[[noreturn]] void throw_caused_error(const pybind11::error_already_set& raised, const std::filesystem::path& file,
                                     const std::string& doing);

}  // namespace holdfast::python
