// SPDX-License-Identifier: BSD-3-Clause
// What `bench --resume` reads of earlier runs: result.json, cost.json, run.json and tracks.json.
#include "fuzz.hpp"
#include "holdfast/bench/report_page.hpp"
#include "holdfast/bench/run_result.hpp"

using namespace holdfast;

namespace {

struct OneRun {
  RunPlan plan;
  BenchResults results;
  std::filesystem::path folder;
};

OneRun one_run() {
  OneRun run;
  run.plan.matrix.sequences.resize(1);
  run.plan.runs.resize(1);
  run.plan.runs[0].id = "variant/sequence/run";
  run.results.results.resize(1);
  run.results.results[0].emplace();
  run.results.results[0]->has_errors = true;
  run.folder = fuzz::folder().path() / "runs" / run.plan.runs[0].id;
  std::filesystem::create_directories(run.folder);
  return run;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const OneRun run = one_run();
  const std::string folder = std::filesystem::relative(run.folder, fuzz::folder().path()).string();
  const auto file = fuzz::folder().write(folder + "/run.json", {data, size});
  fuzz::accepts([&] {
    const RunResult result = read_run_result(file);
    outcome_text(result);
    to_json(result);
  });
  fuzz::accepts([&] { to_json(read_run_cost(file)); });
  fuzz::accepts([&] {
    RunResult result;
    RunCost cost;
    read_own_run(run.folder, result, cost);
    to_json(result);
    to_json(cost);
  });
  std::filesystem::rename(file, run.folder / "tracks.json");
  fuzz::accepts([&] { thinned_tracks_json(fuzz::folder().path(), run.plan, run.results); });
  return 0;
}
