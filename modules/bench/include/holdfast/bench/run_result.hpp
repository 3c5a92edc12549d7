// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "holdfast/bench/process.hpp"
#include "holdfast/evaluation/evaluation.hpp"
#include "holdfast/evaluation/statistics.hpp"

namespace holdfast {

/// How a run ended.
enum class RunStatus {
  finished,     ///< by itself, with exit code 0
  failed,       ///< by itself, with another exit code
  crashed,      ///< by a signal that we did not send
  timed_out,    ///< we stopped it at its time limit
  not_started,  ///< the program is not there or cannot be executed
};
const char* to_string(RunStatus status);

/// The errors that are reported.
enum class Quantity { ate, rpe_translation, rpe_rotation };
inline constexpr std::array all_quantities = {Quantity::ate, Quantity::rpe_translation, Quantity::rpe_rotation};
const char* to_string(Quantity quantity);  ///< "ATE", "RPE translation", "RPE rotation"
const char* unit_of(Quantity quantity);    ///< "m", "m/s", "deg/s"

/// The six statistics of an error, in the order of table 2 of Zeng et al., Remote Sens. 2023, 15, 5479.
inline constexpr std::array<const char*, 6> statistic_names = {"RMSE", "mean", "median", "S.D.", "min", "max"};
using SixStatistics = std::array<double, 6>;  ///< NaN where there are none
SixStatistics six_statistics(const Statistics& statistics);

/// Result of a run without costs: it depends on frames, configuration and seed only, so that sequential repetitions
/// give the same bytes.
struct RunResult {
  RunStatus status = RunStatus::not_started;
  int code = 0;                              ///< exit code, or the signal of a crash
  std::size_t frames = 0;                    ///< colour-depth pairs of the sequence; 0 = the run did not live to say
  std::size_t poses = 0;                     ///< frames with a pose
  std::size_t not_finite = 0;                ///< poses of an external system that are no numbers
  std::size_t malformed = 0;                 ///< lines of an external system's trajectory that are no pose
  bool has_errors = false;                   ///< the statistics below
  std::array<SixStatistics, 3> errors = {};  ///< by Quantity
  /// Strengths of the perturbations by name; empty for an external system.
  std::map<std::string, double> perturbation;
  std::string truth_frame = "raw";  ///< EvaluationOptions::truth_frame of the errors
  std::string no_errors;            ///< why there are none

  double coverage() const { return frames == 0 ? 0.0 : static_cast<double>(poses) / static_cast<double>(frames); }
  /// Whether its errors are included in tables and tests; those of unfinished runs are only shown.
  bool counts() const { return status == RunStatus::finished && has_errors; }
};

/// One line for people: "finished", "crashed (signal 11), 45.0 % of the poses", ...
std::string outcome_text(const RunResult& result);

/// Time of one stage of a run of ours.
struct StageCost {
  std::string name;
  double median = 0.0;  ///< [s]
  double total = 0.0;   ///< [s]
};

/// Cost of a run and its machine; differs between repetitions.
struct RunCost {
  ProcessEnd process;
  bool alone = false;  ///< nothing else of the bench ran beside it
  /// Load average over a minute when it began, and mean number of processors that other programs kept busy while it
  /// ran; NaN where the system does not say.
  double load_average = std::numeric_limits<double>::quiet_NaN();
  double other_processors = std::numeric_limits<double>::quiet_NaN();
  double tracking = std::numeric_limits<double>::quiet_NaN();  ///< median per frame [s]; NaN: not said
  std::string version;                                         ///< of Holdfast, with its commit; "" of others
  std::string machine;                                         ///< processor and cores, see machine_name()
  std::string simd;                                            ///< SIMD level of Holdfast's kernels; "" of others
  std::vector<StageCost> stages;

  /// User and system time / wall time: mean number of processors that the run kept busy.
  double processor_ratio() const;
  /// Whether its times were disturbed by no other run or program, as far as known.
  bool is_undisturbed() const { return alone && !(other_processors > most_other_processors); }

  static constexpr double most_other_processors = 0.1;  ///< what an idle system uses
};

std::string to_json(const RunResult& result);
std::string to_json(const RunCost& cost);
/// Read the output of to_json(). Throw InputError for any other content.
RunResult read_run_result(const std::filesystem::path& file);
RunCost read_run_cost(const std::filesystem::path& file);

/// Sets the errors of an evaluation.
void take_errors(const Evaluation& evaluation, RunResult& result);
/// The same from the folder of `holdfast run` (run.json, evaluation.json); missing files are ignored.
void read_own_run(const std::filesystem::path& folder, RunResult& result, RunCost& cost);

}  // namespace holdfast
