// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "holdfast/bench/external_system.hpp"
#include "holdfast/bench/matrix.hpp"
#include "holdfast/config/configuration.hpp"

namespace holdfast {

/// A variant: one value of every axis, or an external system.
struct Variant {
  /// The values' names joined by '+', or the system's, with '+' and the perturbation where there is one.
  std::string name;
  std::vector<std::size_t> choices;   ///< value of each axis; empty for a system
  std::optional<std::size_t> system;  ///< of Matrix::systems
  /// Of a system: the value of the axis `perturbation`, where the matrix has one.
  std::optional<std::size_t> perturbation;
  std::optional<std::size_t> baseline;  ///< the variant it is measured against; nothing for a baseline itself
  bool alone = false;                   ///< its runs are executed alone

  bool is_external() const { return system.has_value(); }
};

/// One process with its results folder.
struct PlannedRun {
  std::string id;  ///< variant/sequence/run: its folder below `runs`
  std::size_t variant = 0;
  std::size_t sequence = 0;
  std::uint64_t seed = 0;  ///< 0 for an external system, which has its own randomness
  int repeat = 1;          ///< from 1
  bool alone = false;
  double time_limit = 0.0;          ///< [s]
  std::optional<std::size_t> copy;  ///< of RunPlan::copies, which an external system gets in place of the recording
  /// All input of the run: the resolved configuration, or the call of an external system. A finished run with the same
  /// request is not repeated.
  std::string request;
};

/// All runs of a matrix in the order of execution: sequence by sequence, so that an interrupted benchmark has complete
/// rows.
struct RunPlan {
  Matrix matrix;
  std::vector<Variant> variants;
  std::vector<PlannedRun> runs;
  std::vector<std::pair<std::size_t, std::size_t>> comparisons;  ///< (before, after): every variant with its baseline
  std::vector<std::optional<RecordedSequence>> recordings;       ///< by sequence: those that external systems run on
  std::vector<RecordedCopy> copies;                              ///< that external systems need
  std::map<std::string, std::string> perturbation_units;         ///< unit of a strength by name of the perturbation
  std::vector<Diagnostic> missing;  ///< missing folders, files and programs, with their origin
};

/// Files in a run's folder that hold PlannedRun::request.
inline constexpr const char* configuration_file = "config.yaml";
inline constexpr const char* external_request_file = "request.json";

/// Expands a matrix: variants are the product of the axes (the first one varies slowest), then the systems; every
/// configuration is built and checked as `holdfast check` does. Errors are appended to `diagnostics`, each once; data
/// that are missing on this machine to RunPlan::missing. Plugins that configurations name are loaded into `registry`.
/// With the id of a run in `only`, the other cells are left out of RunPlan::runs, and are not checked.
///
/// `try_out` makes the modules of a configuration and throws what does not fit, such as a filter with a class that the
/// segmenter does not have. It is called once for each segmenter with its filters, where nothing is missing; a
/// ConfigurationError is appended to `diagnostics`, any other Error to RunPlan::missing.
RunPlan make_run_plan(Matrix matrix, Registry& registry, const std::vector<SectionDescription>& sections,
                      std::vector<Diagnostic>& diagnostics, const std::string& only = "",
                      const std::function<void(const Configuration&)>& try_out = {});

/// Output of `--dry-run`: all runs, their number, remarks, and missing data.
std::string plan_text(const RunPlan& plan);

}  // namespace holdfast
