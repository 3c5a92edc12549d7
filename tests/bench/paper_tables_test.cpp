// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/bench/paper_tables.hpp"

#include <gmock/gmock.h>

#include <fstream>

#include "bench/results_fixture.hpp"
#include "holdfast/bench/tables.hpp"

namespace holdfast {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

class PaperTablesTest : public test::ResultsTest {
 protected:
  std::vector<PaperTable> tables(const std::string& name) const {
    return paper_tables(name, plan_, analyse(plan_, results_), published_);
  }
  static std::vector<std::string> texts(const PaperTable::Row& row) {
    std::vector<std::string> cells;
    for (const PaperTable::Cell& cell : row.cells) cells.push_back(cell.text);
    return cells;
  }
};

/// The mean of the runs, where the report has their median.
TEST_F(PaperTablesTest, GivesMeansOfRunsAndImprovements) {
  for (const double rmse : {0.1, 0.2, 0.6}) add(0, 0, rmse);
  add(1, 0, 0.15);
  const std::vector<PaperTable> paper2 = tables("paper2");
  ASSERT_EQ(paper2.size(), 1U);
  EXPECT_EQ(paper2[0].caption, "ATE [m], mean of 1 to 3 runs");
  EXPECT_THAT(paper2[0].header, ElementsAre("Sequence", "Statistic", "plain", "better", "over plain"));
  ASSERT_EQ(paper2[0].rows.size(), 6U);
  EXPECT_THAT(texts(paper2[0].rows[0]), ElementsAre("s0", "RMSE", "0.3000", "0.1500", "50.00 %"));
  EXPECT_THAT(texts(paper2[0].rows[1]), ElementsAre("", "S.D.", "0.1500", "0.0750", "50.00 %"));
  EXPECT_THAT(texts(paper2[0].rows[2]), ElementsAre("", "Max", "0.6000", "0.3000", "50.00 %"));
  EXPECT_THAT(texts(paper2[0].rows[3]), ElementsAre("", "Min", "0.0300", "0.0150", "50.00 %"));
  EXPECT_THAT(texts(paper2[0].rows[4]), ElementsAre("", "Mean", "0.2700", "0.1350", "50.00 %"));
  EXPECT_THAT(texts(paper2[0].rows[5]), ElementsAre("", "Median", "0.2400", "0.1200", "50.00 %"));

  const std::vector<PaperTable> paper3 = tables("paper3");
  ASSERT_EQ(paper3.size(), 2U);
  EXPECT_EQ(paper3[0].caption, "RPE translation [m/s], mean of 1 to 3 runs");
  EXPECT_EQ(paper3[1].caption, "RPE rotation [deg/s], mean of 1 to 3 runs");
  EXPECT_THAT(to_csv(paper_figures("paper3", plan_, analyse(plan_, results_))),
              AllOf(HasSubstr("RPE translation,m/s,s0,S.D.,better,1,1,0.075,plain,50\n"),
                    HasSubstr("RPE rotation,deg/s,s0,RMSE,plain,3,1,0.3"), Not(HasSubstr("ATE"))));
}

TEST_F(PaperTablesTest, HasTheRmseAloneAndColumnsOfOtherNames) {
  plan_.matrix.analysis.statistics = {0};
  plan_.matrix.analysis.columns = {{PlacedText{"better", {}}, "Ours"}, {PlacedText{"plain", {}}, "ORB"}};
  for (const std::size_t sequence : {0, 1}) {
    add(0, sequence, 0.2);
    add(1, sequence, 0.1);
  }
  const PaperTable table = tables("paper2").front();
  EXPECT_EQ(table.caption, "ATE RMSE [m], mean of 1 run");
  EXPECT_THAT(table.header, ElementsAre("Sequence", "ORB", "Ours", "over ORB"));
  ASSERT_EQ(table.rows.size(), 2U);
  EXPECT_THAT(texts(table.rows[1]), ElementsAre("s1", "0.2000", "0.1000", "50.00 %"));
  EXPECT_THAT(to_latex(table), AllOf(HasSubstr("\\begin{tabular}{lrrr}"),
                                     HasSubstr("s0 & 0.2000 & \\textbf{0.1000} & 50.00 \\% \\\\\ns1 & ")));
  // Programs read the same names and all statistics.
  EXPECT_THAT(to_csv(paper_figures("paper2", plan_, analyse(plan_, results_))), HasSubstr("ATE,m,s0,S.D.,better,"));
  plan_.matrix.analysis.statistics = {3, 0};
  EXPECT_THAT(texts(tables("paper2").front().rows[0]), ElementsAre("s0", "RMSE", "0.2000", "0.1000", "50.00 %"));
  EXPECT_THAT(texts(tables("paper2").front().rows[1]), ElementsAre("", "S.D.", "0.1000", "0.0500", "50.00 %"));
}

TEST_F(PaperTablesTest, WritesLatexByteForByte) {
  plan_.variants[0].name = "a_b";
  plan_.matrix.analysis.decimals = 2;
  add(0, 0, 0.5);
  add(1, 0, 0.25);
  PaperTable table = tables("paper2").front();
  table.rows.resize(1);
  EXPECT_EQ(to_latex(table),
            "% \\usepackage{booktabs}\n\\begin{table}\n\\centering\n\\caption{ATE [m], mean of 1 run}\n"
            "\\label{tab:paper2}\n\\begin{tabular}{llrrr}\n\\toprule\n"
            "Sequence & Statistic & a\\_b & better & over a\\_b \\\\\n\\midrule\n"
            "s0 & RMSE & 0.50 & \\textbf{0.25} & 50.00 \\% \\\\\n\\bottomrule\n\\end{tabular}\n\n\\smallskip\n"
            "\\footnotesize Improvements in per cent: (baseline - value) / baseline. The smallest value of a row is "
            "bold.\n\\end{table}\n");
  table.rows[0].cells[4].text = "-10.72 %";
  table.rows[0].cells[3].text = "-";
  EXPECT_THAT(to_latex(table), HasSubstr("\\textbf{--} & $-$10.72 \\% \\\\\n"));
  EXPECT_EQ(latex_text("100 % of {a} & \\b~^$#"),
            "100 \\% of \\{a\\} \\& \\textbackslash{}b\\textasciitilde{}\\textasciicircum{}\\$\\#");
}

TEST_F(PaperTablesTest, AShortTrajectoryIsMarkedAndNeverTheBest) {
  add(0, 0, 0.5);
  add(1, 0, 0.1).poses = 50;
  add(0, 1, 0.5);
  add(1, 1, 0.1).status = RunStatus::crashed;
  const std::string text = to_markdown(tables("paper2").front());
  EXPECT_THAT(text, AllOf(HasSubstr("| s0 | RMSE | 0.5000 | 0.1000\\* | 80.00 % |"), HasSubstr("\\* Fewer than 90 %"),
                          HasSubstr("| s1 | RMSE | 0.5000 | - | - |")));
}

class PublishedFileTest : public PaperTablesTest {
 protected:
  PublishedResults read(const std::string& text) {
    const auto file = std::filesystem::temp_directory_path() / ("holdfast_published_" + std::to_string(getpid()));
    std::ofstream(file) << text;
    diagnostics_.clear();
    PublishedResults results = read_published(file, diagnostics_);
    std::filesystem::remove(file);
    return results;
  }
  std::vector<Diagnostic> diagnostics_;
};

TEST_F(PublishedFileTest, PrintsWhatIsPublishedInItsDigitsAndSaysWhatIsNotComparable) {
  published_ = read(
      "sources:\n"
      "  one: { citation: 'First, table 2', protocol: mean of 5 }\n"
      "  two: { citation: Second, protocol: unknown, alignment: sim3, input: mono }\n"
      "results:\n"
      "  - { system: A, source: one, values: { s0: { rmse: 0.4200, max: 1.10 }, s1: 0.010 } }\n"
      "  - { system: B, source: two, values: { s0: 0.005 } }\n"
      "  - { system: C, source: two, input: rgbd, values: { s0: 0.006 } }\n"
      "  - { system: D, source: one, values: { elsewhere: 0.1 } }\n");
  ASSERT_TRUE(diagnostics_.empty());
  add(0, 0, 0.5);
  add(0, 1, 0.5);
  const std::vector<PaperTable> paper2 = tables("paper2");
  ASSERT_EQ(paper2.size(), 2U);
  EXPECT_THAT(paper2[0].header, ElementsAre("Sequence", "Statistic", "plain", "A, as printed"));
  EXPECT_EQ(paper2[0].rows[0].cells[3].text, "0.4200");
  EXPECT_EQ(paper2[0].rows[1].cells[3].text, "-") << "a statistic that is not printed";
  EXPECT_EQ(paper2[0].rows[2].cells[3].text, "1.10");
  const std::string text = to_markdown(paper2[1]);
  EXPECT_THAT(text,
              AllOf(HasSubstr("| A [1] | 0.4200 | 0.010 |"), HasSubstr("| B (monocular, Sim(3)) [2] | 0.005 | - |"),
                    HasSubstr("| C (Sim(3)) [2] | 0.006 | - |"), HasSubstr("| plain (here) | 0.5000 | 0.5000 |"),
                    HasSubstr("[1] First, table 2."), Not(HasSubstr("| D"))));
}

TEST_F(PublishedFileTest, RefusesWhatItDoesNotKnow) {
  read(
      "sources:\n  one: { citation: x, protocol: y, alignment: sim2 }\n"
      "results:\n  - { system: A, source: one, values: { s0: { rmse: 0.1, sigma: 0.2 }, s1: -1 } }\n");
  std::string text;
  for (const Diagnostic& each : diagnostics_) text += each.to_string() + "\n";
  EXPECT_THAT(text, AllOf(HasSubstr(":2:47: found 'sim2' for 'alignment' of source 'one'; expected se3 or sim3"),
                          HasSubstr("'sigma'"), HasSubstr("for 's1'")));
}

}  // namespace
}  // namespace holdfast
