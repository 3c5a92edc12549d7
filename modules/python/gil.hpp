// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pybind11/pybind11.h>

#include <memory>
#include <utility>

namespace holdfast::python {

/// Python's global lock (GIL), taken for the life of the object: nothing of Python may be touched without it. Any
/// thread; may be nested.
using Lock = pybind11::gil_scoped_acquire;
/// Python's global lock given up for the life of the object, so that other threads of Python go on while C++ works.
using Unlock = pybind11::gil_scoped_release;

/// A Python object that C++ may copy and destroy in any thread, with or without the lock. To use it, hold the lock.
class SharedObject {
 public:
  SharedObject() = default;
  explicit SharedObject(pybind11::object object)
      : object_(new pybind11::object(std::move(object)), [](pybind11::object* held) {
          // After the end of the interpreter there is nothing left to release.
          if (Py_IsInitialized() == 0) return;
          const Lock lock;
          delete held;
        }) {}

  const pybind11::object& get() const { return *object_; }
  explicit operator bool() const { return object_ != nullptr; }

 private:
  std::shared_ptr<pybind11::object> object_;
};

}  // namespace holdfast::python
