// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "holdfast/conformance/suite.hpp"
#include "holdfast/core/module.hpp"

namespace holdfast::conformance {

/// The camera that modules are made for, and whose frames they get: 320x240, no distortion.
Camera standard_camera();
/// What modules are told: sequential mode, the standard camera, the classes of the scene.
CreationContext standard_context();

/// Makes the module under test as a configuration would, as often as a check wants one.
class Maker {
 public:
  Maker(std::shared_ptr<const Registry> registry, const ModuleEntry& entry, ParameterValues values)
      : registry_(std::move(registry)), entry_(&entry), values_(std::move(values)) {}

  const ModuleEntry& entry() const { return *entry_; }
  template <class Interface>
  std::unique_ptr<Interface> make(const CreationContext& context = standard_context()) const {
    return std::unique_ptr<Interface>(static_cast<Interface*>(entry_->create(values_, context).release()));
  }

 private:
  std::shared_ptr<const Registry> registry_;  // owns the entry
  const ModuleEntry* entry_;
  ParameterValues values_;
};

/// A test of one sentence. `run` speaks through GoogleTest's expectations, from the thread that called it.
struct Check {
  const char* name;
  Promise promise;
  void (*run)(const Maker& maker);
};

std::vector<Check> module_checks();
std::vector<Check> feature_extractor_checks();
std::vector<Check> segmenter_checks();
std::vector<Check> dynamic_filter_checks();
std::vector<Check> optimizer_checks();
std::vector<Check> loop_detector_checks();

/// Runs both at the same time, each in a thread of its own, and passes on what they throw.
void run_side_by_side(const std::function<void()>& first, const std::function<void()>& second);

/// Runs a call that may refuse its input by an Error. Returns whether it did; fails when the error says nothing.
bool refused(const std::function<void()>& call);

/// Runs the call `times` times and reports the median as the test's property median_ms and in the output.
void report_time(const std::string& what, int times, const std::function<void()>& call);

}  // namespace holdfast::conformance
