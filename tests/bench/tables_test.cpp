// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/bench/tables.hpp"

#include <gmock/gmock.h>
#include <unistd.h>

#include <cstring>

#include "bench/results_fixture.hpp"
#include "holdfast/bench/bench_report.hpp"

namespace holdfast {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

using TablesTest = test::ResultsTest;

TEST_F(TablesTest, WritesCellsByteForByte) {
  add(0, 0, 0.5);
  add(0, 0, 0.25);
  add(0, 0, 1.0).status = RunStatus::crashed;
  add(1, 0, 0.125).poses = 50;
  EXPECT_EQ(to_csv(cells_table(plan_, analyse(plan_, results_))),
            "variant,sequence,runs,counted,coverage_median,coverage_least,coverage_most,ate_rmse_median_m,"
            "ate_rmse_least_m,ate_rmse_most_m,rpe_translation_rmse_median_m,rpe_translation_rmse_least_m,"
            "rpe_translation_rmse_most_m,rpe_rotation_rmse_median_deg,rpe_rotation_rmse_least_deg,"
            "rpe_rotation_rmse_most_deg\n"
            "plain,s0,3,2,1,1,1,0.375,0.25,0.5,0.375,0.25,0.5,0.375,0.25,0.5\n"
            "better,s0,1,1,0.5,0.5,0.5,0.125,0.125,0.125,0.125,0.125,0.125,0.125,0.125,0.125\n");
  EXPECT_THAT(report(),
              AllOf(HasSubstr("| s0 | 0.3750 (0.2500 to 0.5000), 1 of 3 without a figure | 0.1250, 50.00 % |"),
                    HasSubstr("| plain/s0/3 | crashed (signal 0) | 100.00 % | 1.0000 |"),
                    HasSubstr("| better/s0/1 | finished, short | 50.00 % | 0.1250 |")));
}

TEST_F(TablesTest, GivesImprovementsInPerCentOfTheBaseline) {
  add(0, 0, 0.4);
  add(1, 0, 0.1);
  const Analysis analysis = analyse(plan_, results_);
  ASSERT_EQ(analysis.improvements.size(), 1U);
  for (std::size_t q = 0; q < 3; ++q)
    for (std::size_t s = 0; s < 6; ++s) EXPECT_NEAR(analysis.improvements[0].percent[q][s], 75.0, 1e-9);
  EXPECT_THAT(to_csv(improvements_table(plan_, analysis)), HasSubstr("better,plain,s0,ATE,m,S.D.,0.2,0.05,75\n"));
  EXPECT_THAT(report(), HasSubstr("| s0 | 0.4000 to 0.1000: 75.00 % | 0.3600 to 0.0900: 75.00 % |"));
}

TEST_F(TablesTest, TestsSixPairsAndSaysSo) {
  add_pairs(6);
  Comparison comparison = analyse(plan_, results_).comparisons.front();
  EXPECT_TRUE(comparison.enough);
  EXPECT_DOUBLE_EQ(comparison.test.p, 0.03125);
  EXPECT_STREQ(comparison.verdict(), "significant");
  EXPECT_EQ(comparison.better, 6U);
  EXPECT_NEAR(comparison.gain, 0.125, 1e-12);
  EXPECT_NEAR(comparison.gain_percent, 62.5, 1e-9);
  EXPECT_THAT(sentence(plan_, comparison),
              AllOf(HasSubstr("`better` against `plain`: smaller ATE RMSE on 6 of 6 sequences, by 0.1250 m (median "
                              "of the differences; of the ratios 62.5 %)"),
                    HasSubstr("is significant (p = 0.0312, 6 pairs")));
  comparison.adjusted = 0.3125;
  EXPECT_STREQ(comparison.verdict(), "significant alone");
}

TEST_F(TablesTest, TestsNothingBelowSixPairs) {
  add_pairs(5);
  const Comparison comparison = analyse(plan_, results_).comparisons.front();
  EXPECT_FALSE(comparison.is_significant());
  EXPECT_THAT(sentence(plan_, comparison), AllOf(HasSubstr("Too few to tell: 5 pairs"), Not(HasSubstr("p ="))));
  EXPECT_THAT(to_csv(comparisons_table(plan_, analyse(plan_, results_))), HasSubstr(",,5,,,,too few to tell,1,1\n"));
}

TEST_F(TablesTest, SaysPlainlyWhatIsNotSignificantAndWhatIsLeftOut) {
  for (std::size_t s = 0; s < 7; ++s) {
    add(0, s, 0.1);
    add(1, s, s % 2 == 0 ? 0.09 : 0.12);
  }
  results_.results.back()->status = RunStatus::timed_out;
  results_.results.front()->poses = 40;
  const std::string text = sentence(plan_, analyse(plan_, results_).comparisons.front());
  EXPECT_THAT(text, AllOf(HasSubstr("not significant"), HasSubstr("do not tell which is better"),
                          HasSubstr("1 sequence left out"), HasSubstr("Coverage falls to 40.0 % (`plain`)")));
}

/// Neither a browser nor a terminal that shows the reports may be commanded by a text of the matrix.
TEST_F(TablesTest, EscapesTextsFromFiles) {
  add(0, 0, 0.5);
  add(1, 0, 0.25);
  plan_.matrix.title = "<script>alert(1)</script>\nsecond line \x1b[2J";
  plan_.matrix.about = "an \x07 alarm <img src=x>";
  published_.results.resize(1);
  published_.results[0].system = "a | b <b>\n\x7f";
  published_.results[0].citation = "somebody";
  published_.results[0].values["s0"] = 0.1;
  const std::string report = this->report();
  EXPECT_THAT(report, AllOf(HasSubstr("# &lt;script>alert(1)&lt;/script> second line \\x1b[2J\n"),
                            HasSubstr("an \\x07 alarm &lt;img src=x>"), HasSubstr("| a \\| b &lt;b> \\x7f |")));
  for (const char c : cost_report(plan_, results_, analyse(plan_, results_), published_) + report)
    EXPECT_TRUE(c == '\n' || (static_cast<unsigned char>(c) >= 0x20 && c != 0x7f && c != '<'));
}

TEST_F(TablesTest, NeverGivesAPublishedFigureWithoutItsSource) {
  add(0, 0, 0.1);
  plan_.matrix.sequences[0].published = "known";
  published_.results = {{"Other, \"one\"", "Somebody, table 2", "median of 10", {{"known", 0.25}, {"else", 1.0}}}};
  EXPECT_EQ(to_csv(published_table(plan_, published_)),
            "system,sequence,ate_rmse_m,alignment,input,source,protocol\n"
            "\"Other, \"\"one\"\"\",s0,0.25,SE(3),RGB-D,\"Somebody, table 2\",median of 10\n");
  EXPECT_THAT(report(), HasSubstr("| Other, \"one\" | 0.2500 | Somebody, table 2 | median of 10 |"));
}

TEST_F(TablesTest, ResultsComeBackFromTheirFiles) {
  RunResult result = add(0, 0, 1.0 / 3.0);
  result.errors[1][2] = Statistics::none;
  result.not_finite = 4;
  const auto file = std::filesystem::temp_directory_path() / ("holdfast_result_" + std::to_string(getpid()));
  write_file_atomically(file, to_json(result));
  EXPECT_EQ(to_json(read_run_result(file)), to_json(result));
  for (const auto& [from, to] :
       {std::pair("\"frames\": 100", "\"frames\": -1"), std::pair("\"poses\": 100", "\"poses\": 1.5"),
        std::pair("\"finished\"", "\"perhaps\"")}) {
    std::string text = to_json(result);
    ASSERT_NE(text.find(from), std::string::npos) << text;
    write_file_atomically(file, text.replace(text.find(from), std::strlen(from), to));
    EXPECT_THROW(read_run_result(file), InputError) << to;
  }
  RunCost cost;
  cost.process.peak_memory = 12345678;
  cost.stages = {{"frame", 0.1, 2.5}};
  write_file_atomically(file, to_json(cost));
  EXPECT_EQ(to_json(read_run_cost(file)), to_json(cost));
  EXPECT_THROW(read_run_result(file), InputError);
  std::filesystem::remove(file);
}

TEST_F(TablesTest, SaysWhichTruthTheErrorsReferTo) {
  add_pairs(2);
  EXPECT_THAT(report(), HasSubstr("Truth: raw, as recorded."));
  EXPECT_THAT(report(), Not(HasSubstr("transformed")));
  for (std::size_t i = 0; i < plan_.runs.size(); ++i)
    if (plan_.runs[i].sequence == 1) results_.results[i]->truth_frame = "transformed";
  EXPECT_THAT(report(),
              AllOf(HasSubstr("| s1 (transformed truth) |"), HasSubstr("| s0 |"),
                    HasSubstr("to the camera (`source.tum.truth_frame`, `truth_left`, `truth_right`) on s1;")));
  EXPECT_THAT(to_csv(runs_table(plan_, results_)), AllOf(HasSubstr(",0,0,raw,0.2"), HasSubstr(",0,0,transformed,0.2")));
}

}  // namespace
}  // namespace holdfast
