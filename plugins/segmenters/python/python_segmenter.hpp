// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "holdfast/core/module.hpp"
#include "holdfast/interfaces/segmenter.hpp"
#include "settings.hpp"

namespace holdfast::python_plugin {

/// `class Segmenter` of a Python file. Each instance runs the file anew, in a module of its own; modules that the file
/// imports are shared by all. May be used from any thread: calls wait for Python's lock, one at a time in the process.
class PythonSegmenter final : public Segmenter {
 public:
  /// Throws InputError, with Python's traceback, for a file that cannot be run or whose class is not as expected.
  PythonSegmenter(const PythonSettings& settings, const CreationContext& context);
  ~PythonSegmenter() override;

  const std::vector<std::string>& classes() const override { return classes_; }
  std::vector<std::string> movable() const override { return movable_; }
  Segmentation segment(const SensorFrame& frame) override;

 private:
  struct Python;  // its objects, which the lock guards
  void load(const PythonSettings& settings);

  std::filesystem::path file_;
  bool rgb_;
  std::vector<std::string> classes_, movable_;
  std::unique_ptr<Python> python_;
};

}  // namespace holdfast::python_plugin
