// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/bench/report_page.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "bench/matrix_fixture.hpp"

namespace holdfast {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::Not;

/// A bench of one sequence, whose runs left the tracks that are written for them.
class ReportPageTest : public test::MatrixTest {
 protected:
  void add_run(const std::string& id, bool has_errors) {
    if (plan_.matrix.sequences.empty()) plan_.matrix.sequences.emplace_back();
    PlannedRun run;
    run.id = id;
    plan_.runs.push_back(run);
    RunResult result;
    result.has_errors = has_errors;
    results_.results.emplace_back(result);
    results_.costs.emplace_back();
  }
  /// A position every `step` seconds from `begin` on, with an error of 1 cm that has one peak.
  static json tracks(int count, double begin, double step, int peak, int gap_at, int gap_length) {
    json truth = json::array(), estimate = json::array(), error = json::array();
    for (int i = 0; i < count; ++i) {
      const double t = begin + step * i;
      truth.push_back({t, std::cos(t), std::sin(t), 0.5});
      if (i >= gap_at && i < gap_at + gap_length) continue;
      estimate.push_back({t, std::cos(t), std::sin(t), 0.51});
      error.push_back({t, i == peak ? 0.7 : 0.01});
    }
    return {{"truth", truth}, {"estimate", estimate}, {"error", error}};
  }

  RunPlan plan_;
  BenchResults results_;
};

TEST_F(ReportPageTest, ThinsTracksButKeepsPeaksAndGaps) {
  add_run("long", true);
  add_run("none", false);
  add_run("late", true);
  write("runs/long/tracks.json", tracks(6000, 100.0, 0.01, 3001, 1000, 200).dump());
  write("runs/late/tracks.json", tracks(100, 130.0, 0.01, -1, -1, 0).dump());
  const json thinned = json::parse(thinned_tracks_json(folder_, plan_, results_));

  const json& truth = thinned.at("truth").at(0);
  EXPECT_LE(truth.at("t").size(), points_of_a_line + 1);
  EXPECT_EQ(truth.at("t").size(), truth.at("z").size());
  EXPECT_EQ(truth.at("t").front(), 0.0);
  EXPECT_NEAR(truth.at("t").back(), 59.99, 1e-9) << "the end is kept";

  EXPECT_TRUE(thinned.at("runs").at(1).is_null());
  const json& run = thinned.at("runs").at(0);
  double largest = 0.0;
  std::size_t breaks = 0;
  for (const json& error : run.at("error").at("e")) {
    if (error.is_null())
      ++breaks;
    else
      largest = std::max(largest, error.get<double>());
  }
  EXPECT_EQ(largest, 0.7);
  EXPECT_EQ(breaks, 1u);
  const json& x = run.at("track").at("x");
  EXPECT_EQ(std::count(x.begin(), x.end(), json(nullptr)), 1);

  // Few poses, each far from the next: every one stands alone.
  results_.results[1]->has_errors = true;
  json sparse = tracks(6000, 100.0, 0.01, -1, -1, 0);
  sparse["estimate"] = {{101.0, 1.0, 2.0, 3.0}, {102.0, 1.0, 2.0, 3.0}, {103.0, 1.0, 2.0, 3.0}};
  write("runs/none/tracks.json", sparse.dump());
  const json few = json::parse(thinned_tracks_json(folder_, plan_, results_)).at("runs").at(1).at("track").at("x");
  EXPECT_EQ(few, json({1.0, nullptr, 1.0, nullptr, 1.0}));
  EXPECT_NEAR(thinned.at("runs").at(2).at("track").at("t").front(), 30.0, 1e-9) << "one clock for a sequence";
}

TEST_F(ReportPageTest, SaysWhichFileOfTracksIsNone) {
  add_run("broken", true);
  write("runs/broken/tracks.json", "{\"truth\": [");
  try {
    thinned_tracks_json(folder_, plan_, results_);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("runs/broken/tracks.json"));
  }
}

TEST_F(ReportPageTest, RefusesRowsOfOtherLengths) {
  add_run("odd", true);
  for (const char* text :
       {R"({"truth": [], "estimate": [[], []], "error": []})", R"({"truth": [[1, 0, 0]], "estimate": [], "error": []})",
        R"({"truth": [[1, 0, 0, 0]], "estimate": [], "error": [[1, 0.1], [2]]})"}) {
    write("runs/odd/tracks.json", text);
    try {
      thinned_tracks_json(folder_, plan_, results_);
      ADD_FAILURE() << text;
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), ::testing::AllOf(HasSubstr("runs/odd/tracks.json: is no file of tracks: row "),
                                                 HasSubstr("let --resume repeat it")));
    }
  }
}

TEST_F(ReportPageTest, NothingInItEndsAScriptOrLoadsAFile) {
  const std::string page = report_page("a </title><script>", R"({"title": "</script><!-- {{main.js}}"})", "{}");
  EXPECT_THAT(page, HasSubstr("<title>a &lt;/title&gt;&lt;script&gt;</title>"));
  EXPECT_THAT(page, HasSubstr(R"({"title": "\u003c/script>\u003c!-- {{main.js}}"})"));
  EXPECT_THAT(page, HasSubstr("Copyright (c) 2022 Leon Sorokin")) << "the library's licence goes with it";
  for (const char* loading : {" src=", "<link", "@import", "url(", "fetch("})
    EXPECT_THAT(page, Not(HasSubstr(loading)));
}

}  // namespace
}  // namespace holdfast
