// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "holdfast/interfaces/segmenter.hpp"
#include "settings.hpp"

namespace holdfast::python_plugin {

/// `class Segmenter` of a Python file in a process of its own, the program holdfast_python_worker beside this library.
/// A process that ends or takes longer than `timeout` for a frame gives no segmentation for this frame, and is started
/// anew for the next one; warnings() says how often. May be used from any thread, one at a time.
class ProcessSegmenter final : public Segmenter {
 public:
  /// Throws InputError as PythonSegmenter, and for a process that ends before it is ready.
  ProcessSegmenter(const PythonSettings& settings, const CreationContext& context);
  ~ProcessSegmenter() override;

  const std::vector<std::string>& classes() const override { return classes_; }
  std::vector<std::string> movable() const override { return movable_; }
  Warnings warnings() const override;
  /// Throws InputError for an error in Python, as PythonSegmenter, and after three failures in succession.
  Segmentation segment(const SensorFrame& frame) override;

 private:
  class Worker;  // the process
  void start();
  /// Counts a failure; throws InputError if it is the third in succession.
  void count_failure(const std::string& what);

  PythonSettings settings_;
  std::vector<std::string> classes_, movable_;
  std::unique_ptr<Worker> worker_;
  std::size_t frames_ = 0, failures_ = 0, failures_in_succession_ = 0;
  std::string last_failure_;
};

}  // namespace holdfast::python_plugin
