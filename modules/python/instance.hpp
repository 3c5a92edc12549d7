// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pybind11/pybind11.h>

#include <filesystem>
#include <memory>
#include <string>
#include <utility>

#include "errors.hpp"
#include "gil.hpp"
#include "holdfast/core/module.hpp"
#include "module_call.hpp"

namespace holdfast::python {

/// An object of a class that Python code registered as a module, and where its class is defined, for messages.
class Instance {
 public:
  /// The lock must be held.
  Instance(pybind11::object object, std::filesystem::path file)
      : object_(object),
        file_(std::move(file)),
        class_name_(pybind11::str(pybind11::type::of(object).attr("__name__"))),
        pipeline_(ModuleMaking::pipeline()) {}

  const std::filesystem::path& file() const { return file_; }
  const std::string& class_name() const { return class_name_; }
  /// The lock must be held.
  const pybind11::object& object() const { return object_.get(); }
  bool has(const char* member) const { return pybind11::hasattr(object(), member); }

  /// Calls `action` with the lock; what Python raises in it becomes an InputError with the traceback. `member` is what
  /// is called, for the message.
  template <class Action>
  auto with_lock(const char* member, Action action, MapLock map_lock = MapLock::free) const {
    const ModuleCall call(pipeline_, class_name_, member, map_lock);
    const Lock lock;
    try {
      return action(object());
    } catch (const pybind11::error_already_set& raised) {
      throw_caused_error(raised, file_, class_name_ + "." + member);
    }
  }
  /// Throws InputError "CLASS.MEMBER FOUND; expected EXPECTED", at the file of the class.
  [[noreturn]] void refuse(const char* member, const std::string& found, const std::string& expected) const {
    throw InputError({file_.string()}, class_name_ + "." + member + " " + found + "; expected " + expected);
  }

 private:
  SharedObject object_;
  std::filesystem::path file_;
  std::string class_name_;
  PipelineIdentity pipeline_;
};

/// The name of an object's type. The lock must be held.
inline std::string type_name(const pybind11::handle& object) {
  return pybind11::str(pybind11::type::of(object).attr("__name__"));
}

// Modules that call an object of Python. The lock must be held; each throws InputError for an object that does not keep
// the contract of its interface.
std::unique_ptr<Module> make_segmenter(Instance instance);
std::unique_ptr<Module> make_filter(Instance instance);
std::unique_ptr<Module> make_observer(Instance instance);
std::unique_ptr<Module> make_source(Instance instance);
std::unique_ptr<Module> make_extractor(Instance instance);

}  // namespace holdfast::python
