// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pybind11/pybind11.h>

namespace holdfast::python_plugin {

/// Python in this process. There can be one only, so all segmenters share it: started with the first of them, ended
/// when the process ends, so that what Python code registered with `atexit` runs and its output is written. It is left
/// running when a segmenter still lives then. A program that has Python in it already keeps its own. Signals stay with
/// the program: Ctrl-C is no KeyboardInterrupt.
class Interpreter {
 public:
  /// Starts Python where it does not run yet; any thread. Throws Error with the reason when it cannot be started.
  Interpreter();
  ~Interpreter();
  Interpreter(const Interpreter&) = delete;
  Interpreter& operator=(const Interpreter&) = delete;
};

/// Holds Python's global lock: nothing of Python may be touched without it. Any thread; may be nested.
class Lock {
 public:
  Lock() : state_(PyGILState_Ensure()) {}
  ~Lock() { PyGILState_Release(state_); }
  Lock(const Lock&) = delete;
  Lock& operator=(const Lock&) = delete;

 private:
  PyGILState_STATE state_;
};

}  // namespace holdfast::python_plugin
