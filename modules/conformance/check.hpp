// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "holdfast/conformance/suite.hpp"
#include "holdfast/core/module.hpp"

namespace holdfast::conformance {

/// The camera of the modules under test and of their frames: 320x240, no distortion.
Camera standard_camera();
/// The context of the modules under test: sequential mode, the standard camera, the classes of the scene.
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

/// A test of one sentence. `run` reports through GoogleTest's expectations, in the calling thread.
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
std::vector<Check> feature_matcher_checks();
std::vector<Check> loop_detector_checks();
std::vector<Check> frame_source_checks();
std::vector<Check> observer_checks();

/// Runs both concurrently in separate threads and propagates their exceptions.
void run_side_by_side(const std::function<void()>& first, const std::function<void()>& second);

/// Runs a call that may reject its input with an Error. Returns whether it did; fails if the error has no message.
bool refused(const std::function<void()>& call);

/// Runs the call `times` times and reports the median as the test's property median_ms and in the output.
void report_time(const std::string& what, int times, const std::function<void()>& call);

}  // namespace holdfast::conformance
