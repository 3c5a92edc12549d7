// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/bench/run_result.hpp"

#include <nlohmann/json.hpp>

#include "error_keys.hpp"
#include "holdfast/core/error.hpp"
#include "holdfast/core/input_file.hpp"
#include "holdfast/evaluation/number_text.hpp"

namespace holdfast {

namespace {

using Json = nlohmann::ordered_json;

constexpr std::array statuses = {RunStatus::finished, RunStatus::failed, RunStatus::crashed, RunStatus::timed_out,
                                 RunStatus::not_started};

double number(const Json& json) { return json.is_number() ? json.get<double>() : Statistics::none; }

Json read_json(const std::filesystem::path& file) {
  const std::string text = file_content(file, largest_file::json, "a result of the bench");
  try {
    return Json::parse(text);
  } catch (const Json::exception& error) {
    throw InputError({file.string()},
                     std::string("is no result of the bench: ") + error.what() + "; remove its folder");
  }
}

/// A count, which conversion would also take from a negative or a broken number.
std::size_t count(const Json& json, const char* key) {
  const Json& value = json.at(key);
  if (!value.is_number_unsigned())
    throw Error("'" + std::string(key) + "' is " + value.dump(-1, ' ', false, Json::error_handler_t::replace) +
                "; expected a whole number of at least 0");
  return value;
}

RunStatus status_of_json(const Json& json) {
  for (const RunStatus status : statuses)
    if (json == to_string(status)) return status;
  throw Error("'status' is " + json.dump(-1, ' ', false, Json::error_handler_t::replace) +
              "; expected what the bench writes, such as \"finished\"");
}

/// Runs read; a value that is missing or of another type is the file's fault.
template <class Read>
auto read_values(const std::filesystem::path& file, const Read& read) {
  const Json json = read_json(file);
  try {
    return read(json);
  } catch (const Json::exception& error) {
    throw InputError({file.string()},
                     std::string("is no result of the bench: ") + error.what() + "; remove its folder");
  } catch (const Error& error) {
    throw InputError({file.string()},
                     std::string("is no result of the bench: ") + error.what() + "; remove its folder");
  }
}

Json statistics_json(const SixStatistics& values) {
  Json json;
  for (std::size_t i = 0; i < values.size(); ++i) json[statistic_keys[i]] = values[i];
  return json;
}

SixStatistics statistics_of_json(const Json& json) {
  SixStatistics values;
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = number(json.at(statistic_keys[i]));
  return values;
}

void take_perturbation(const Json& json, RunResult& result) {
  if (const auto found = json.find("perturbation"); found != json.end())
    for (const auto& [name, strength] : found->items()) result.perturbation[name] = strength.get<double>();
}

}  // namespace

const char* to_string(RunStatus status) {
  switch (status) {
    case RunStatus::finished:
      return "finished";
    case RunStatus::failed:
      return "failed";
    case RunStatus::crashed:
      return "crashed";
    case RunStatus::timed_out:
      return "timed out";
    case RunStatus::not_started:
      return "not started";
  }
  return "";
}

const char* to_string(Quantity quantity) {
  switch (quantity) {
    case Quantity::ate:
      return "ATE";
    case Quantity::rpe_translation:
      return "RPE translation";
    case Quantity::rpe_rotation:
      return "RPE rotation";
  }
  return "";
}

const char* unit_of(Quantity quantity) {
  switch (quantity) {
    case Quantity::ate:
      return "m";
    case Quantity::rpe_translation:
      return "m/s";
    case Quantity::rpe_rotation:
      return "deg/s";
  }
  return "";
}

SixStatistics six_statistics(const Statistics& s) {
  return {s.rmse, s.mean, s.median, s.standard_deviation, s.minimum, s.maximum};
}

std::string outcome_text(const RunResult& result) {
  std::string text = to_string(result.status);
  if (result.status == RunStatus::failed) text += " (exit code " + std::to_string(result.code) + ")";
  if (result.status == RunStatus::crashed) text += " (signal " + std::to_string(result.code) + ")";
  if (!result.has_errors) text += ", no figures: " + (result.no_errors.empty() ? "no trajectory" : result.no_errors);
  const auto add = [&](std::size_t count, const char* one, const char* many) {
    if (count > 0) text += ", " + std::to_string(count) + (count == 1 ? one : many);
  };
  add(result.not_finite, " pose is not finite", " poses are not finite");
  add(result.malformed, " line is no pose", " lines are no pose");
  return text;
}

std::string to_json(const RunResult& result) {
  Json json = {{"status", to_string(result.status)},
               {"code", result.code},
               {"frames", result.frames},
               {"poses", result.poses},
               {"coverage", result.coverage()},
               {"not_finite", result.not_finite},
               {"malformed", result.malformed}};
  json["perturbation"] = Json::object();
  for (const auto& [name, strength] : result.perturbation) json["perturbation"][name] = strength;
  json["truth_frame"] = result.truth_frame;
  json["no_errors"] = result.has_errors ? Json(nullptr) : Json(result.no_errors);
  Json& errors = json["errors"] = nullptr;
  if (result.has_errors)
    for (std::size_t i = 0; i < quantity_keys.size(); ++i) errors[quantity_keys[i]] = statistics_json(result.errors[i]);
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

double RunCost::processor_ratio() const {
  return (process.user_seconds + process.system_seconds) / process.wall_seconds;
}

std::string to_json(const RunCost& cost) {
  const ProcessEnd& process = cost.process;
  Json json = {{"wall_s", process.wall_seconds},
               {"user_s", process.user_seconds},
               {"system_s", process.system_seconds},
               {"peak_memory_bytes", process.peak_memory},
               {"processor_ratio", cost.processor_ratio()},
               {"alone", cost.alone},
               {"load_average", cost.load_average},
               {"other_processors", cost.other_processors},
               {"tracking_median_s", cost.tracking},
               {"version", cost.version},
               {"machine", cost.machine},
               {"simd", cost.simd}};
  Json& stages = json["stages"] = Json::array();
  for (const StageCost& stage : cost.stages)
    stages.push_back({{"stage", stage.name}, {"median_s", stage.median}, {"total_s", stage.total}});
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

RunResult read_run_result(const std::filesystem::path& file) {
  return read_values(file, [](const Json& json) {
    RunResult result;
    result.status = status_of_json(json.at("status"));
    result.code = json.at("code");
    result.frames = count(json, "frames");
    result.poses = count(json, "poses");
    result.not_finite = count(json, "not_finite");
    result.malformed = count(json, "malformed");
    take_perturbation(json, result);
    result.truth_frame = json.value("truth_frame", "raw");
    const Json& errors = json.at("errors");
    result.has_errors = errors.is_object();
    if (!result.has_errors) result.no_errors = json.at("no_errors");
    for (std::size_t i = 0; result.has_errors && i < quantity_keys.size(); ++i)
      result.errors[i] = statistics_of_json(errors.at(quantity_keys[i]));
    return result;
  });
}

RunCost read_run_cost(const std::filesystem::path& file) {
  return read_values(file, [](const Json& json) {
    RunCost cost;
    cost.process.wall_seconds = json.at("wall_s");
    cost.process.user_seconds = json.at("user_s");
    cost.process.system_seconds = json.at("system_s");
    cost.process.peak_memory = count(json, "peak_memory_bytes");
    cost.alone = json.at("alone");
    cost.load_average = number(json.value("load_average", Json()));
    cost.other_processors = number(json.value("other_processors", Json()));
    cost.tracking = number(json.at("tracking_median_s"));
    cost.version = json.at("version");
    cost.machine = json.at("machine");
    cost.simd = json.value("simd", "");
    for (const Json& stage : json.at("stages"))
      cost.stages.push_back({stage.at("stage"), number(stage.at("median_s")), number(stage.at("total_s"))});
    return cost;
  });
}

void take_errors(const Evaluation& evaluation, RunResult& result) {
  result.has_errors = true;
  result.truth_frame = evaluation.options.truth_frame;
  result.errors = {six_statistics(evaluation.absolute_error), six_statistics(evaluation.error_per_time.translation),
                   six_statistics(evaluation.error_per_time.rotation)};
  if (!evaluation.coverage) return;
  result.frames = evaluation.coverage->frames;
  result.poses = evaluation.coverage->poses;
}

void read_own_run(const std::filesystem::path& folder, RunResult& result, RunCost& cost) {
  std::error_code ignored;
  if (!std::filesystem::exists(folder / "run.json", ignored)) return;
  read_values(folder / "run.json", [&](const Json& json) {
    take_perturbation(json, result);
    result.frames = count(json.at("frames"), "expected");
    result.poses = count(json.at("frames"), "poses");
    cost.tracking = number(json.at("tracking").at("median_s"));
    cost.version = json.at("holdfast").get<std::string>() + " (" + json.at("commit").get<std::string>() + ")";
    cost.simd = json.at("machine").at("simd").get<std::string>();
    for (const Json& stage : json.at("stages"))
      cost.stages.push_back({stage.at("stage"), number(stage.at("median_s")), number(stage.at("total_s"))});
    const Json& evaluation = json.at("evaluation");
    if (!evaluation.is_object()) {
      result.no_errors = result.poses == 0 ? "no frame has a pose" : "the poses cannot be compared with the truth";
      return 0;
    }
    result.has_errors = true;
    result.truth_frame = evaluation.at("truth").value("frame", "raw");
    result.errors = {statistics_of_json(evaluation.at("ate_m")),
                     statistics_of_json(evaluation.at("rpe_per_time").at("translation_m")),
                     statistics_of_json(evaluation.at("rpe_per_time").at("rotation_deg"))};
    const Json& coverage = evaluation.at("coverage");
    if (coverage.is_object()) {
      result.frames = count(coverage, "frames");
      result.poses = count(coverage, "poses");
    }
    return 0;
  });
}

}  // namespace holdfast
