// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/bench/robustness.hpp"

#include <gmock/gmock.h>

#include "bench/matrix_fixture.hpp"
#include "holdfast/bench/bench_report.hpp"
#include "holdfast/bench/machine_load.hpp"
#include "holdfast/bench/tables.hpp"

namespace holdfast {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

struct BlurSettings {
  double blur = 0.0;
  double noise = 0.0;
  static void describe(ParameterTable<BlurSettings>& table) {
    table.add("blur", &BlurSettings::blur, "of images").at_least(0.0).unit("px");
    table.add("noise", &BlurSettings::noise, "of images").at_least(0.0);
  }
};

class RobustnessTest : public test::MatrixTest {
 protected:
  RunPlan perturbed_plan(const std::string& axis) {
    write("matrix.yaml",
          "axes:\n  method: { a: { configuration: plain.yaml }, b: { configuration: masked.yaml } }\n  perturbation: " +
              axis + "\nsequences: { one: { source: { tum: { path: one } }, camera: tum_fr3 } }\n");
    diagnostics_.clear();
    Registry registry = test::test_registry();
    test::add<Segmenter, test::MaskSettings>(registry, "masks");
    test::add<Segmenter, NoSettings>(registry, "network");
    std::vector<SectionDescription> sections = test::test_sections();
    sections.push_back({"perturbation", "", ParameterTable<BlurSettings>().parameters()});
    Matrix matrix = read_matrix(folder_ / "matrix.yaml", {}, diagnostics_);
    return make_run_plan(std::move(matrix), registry, sections, diagnostics_);
  }
};

TEST_F(RobustnessTest, AnAxisOfStrengthsHasAValueForEachAndOneWithout) {
  const RunPlan plan =
      perturbed_plan("{ blur: [4, 8.5], noise: [10], both: { perturbation.blur: 4, perturbation.noise: 10 } }");
  ASSERT_TRUE(problems().empty()) << problems().front();
  EXPECT_THAT(ids(plan),
              ElementsAre("a+none/one/seed1-repeat1", "a+blur-4/one/seed1-repeat1", "a+blur-8.5/one/seed1-repeat1",
                          "a+noise-10/one/seed1-repeat1", "a+both/one/seed1-repeat1", "b+none/one/seed1-repeat1",
                          "b+blur-4/one/seed1-repeat1", "b+blur-8.5/one/seed1-repeat1", "b+noise-10/one/seed1-repeat1",
                          "b+both/one/seed1-repeat1"));
  EXPECT_THAT(plan.runs[2].request, HasSubstr("perturbation:\n  blur: 8.5\n  noise: 0.0\n"));
  EXPECT_EQ(plan.perturbation_units.at("blur"), "px");
}

TEST_F(RobustnessTest, WrongStrengthsAreErrorsWithTheirPlace) {
  perturbed_plan("{ blur: [0, much, -1], glue: [1] }");
  EXPECT_THAT(problems(), AllOf(testing::Contains(HasSubstr("matrix.yaml:3:26: found '0' for the strength of 'blur'")),
                                testing::Contains(HasSubstr("'much'")), testing::Contains(HasSubstr("-1")),
                                testing::Contains(AllOf(HasSubstr("'glue'"), HasSubstr("matrix.yaml:3")))));
}

TEST_F(RobustnessTest, CurvesFollowTheStrengths) {
  const RunPlan plan = perturbed_plan("{ blur: [8, 4], noise: [10] }");
  BenchResults results;
  for (const PlannedRun& run : plan.runs) {
    RunResult result;
    result.status = RunStatus::finished;
    result.frames = 100;
    result.has_errors = true;
    const std::string& name = plan.variants[run.variant].name;
    const double strength = name.ends_with("-8") ? 8 : name.ends_with("-4") ? 4 : name.ends_with("-10") ? 10 : 0;
    result.poses = 100 - static_cast<std::size_t>(strength);
    for (SixStatistics& each : result.errors) each.fill(0.01 * (1.0 + strength));
    if (name == "b+noise-10") result.status = RunStatus::crashed;
    results.results.emplace_back(result);
    results.costs.emplace_back(RunCost{});
  }
  const Analysis analysis = analyse(plan, results);
  const std::vector<RobustnessCurve> curves = robustness_curves(plan, analysis);
  ASSERT_EQ(curves.size(), 4U);
  EXPECT_EQ(curves[1].kind + " " + curves[1].method + " " + curves[1].unit, "blur b px");
  EXPECT_EQ(to_csv(robustness_table({curves[0], curves[3]})),
            "perturbation,unit,method,strength,runs,counted,ate_rmse_m,coverage\n"
            "blur,px,a,0,1,1,0.01,1\nblur,px,a,4,1,1,0.05,0.96\nblur,px,a,8,1,1,0.09,0.92\n"
            "noise,,b,0,1,1,0.01,1\nnoise,,b,10,1,0,,0.9\n");
  EXPECT_EQ(robustness_text({curves[2], curves[3]}),
            "| noise | a | b |\n|---|---:|---:|\n| 0 | 0.0100, 100.0 % | 0.0100, 100.0 % |\n"
            "| 10 | 0.1100, 90.0 % | -, 90.0 %, 1 of 1 without a figure |\n\n");
  const std::vector<RobustnessPlot> plots = robustness_plots(curves);
  ASSERT_EQ(plots.size(), 4U);
  EXPECT_EQ(plots[0].name, "blur_error");
  EXPECT_THAT(plots[0].plot.lines[0].x, ElementsAre(0, 4, 8));
  EXPECT_THAT(accuracy_report(plan, results, analysis, {}), HasSubstr("## Robustness"));
}

TEST(MachineLoadTest, ReadsWhatTheSystemSays) {
  const MachineLoad load =
      parse_machine_load("1.25 0.90 0.50 2/300 1234\n", "cpu  100 20 30 4000 50 6 7 8 90 0\ncpu0 1\n", 100.0);
  EXPECT_DOUBLE_EQ(load.load_average, 1.25);
  EXPECT_DOUBLE_EQ(load.busy_seconds, 1.71);
  EXPECT_TRUE(std::isnan(parse_machine_load("", "", 100.0).busy_seconds));
  EXPECT_TRUE(std::isnan(parse_machine_load("", "cpu 1 2", 100.0).busy_seconds));
}

/// Two runs: one with company by other programs, one by another run.
TEST(CostReportTest, SaysWhichRunsWereNotAlone) {
  RunPlan plan;
  plan.variants.resize(1);
  plan.variants[0].name = "plain";
  plan.matrix.sequences.resize(1);
  plan.runs.resize(2);
  BenchResults results;
  for (int i = 0; i < 2; ++i) {
    RunCost cost;
    cost.alone = true;
    cost.process.wall_seconds = 10.0;
    cost.process.user_seconds = 8.0;
    cost.process.system_seconds = 1.0;
    cost.load_average = 0.5;
    cost.other_processors = 0.01;
    cost.machine = "one processor, 2 cores";
    results.results.emplace_back(RunResult{});
    results.costs.emplace_back(cost);
  }
  const auto report = [&] { return cost_report(plan, results, analyse(plan, results), {}); };
  EXPECT_THAT(report(), AllOf(HasSubstr("Every run was alone"), HasSubstr("Load average when runs began: 0.50")));
  results.costs[1]->other_processors = 0.75;
  EXPECT_THAT(report(),
              AllOf(HasSubstr("**1 run of 2 had other programs beside them**, which kept up to 0.75 processors"),
                    Not(HasSubstr("Every run was alone"))));
  results.costs[0]->alone = false;
  results.costs[0]->machine = "another";
  EXPECT_THAT(report(), AllOf(HasSubstr("**1 run of 2 had other runs of this bench beside them**"),
                              HasSubstr("2 kinds of machine**: times are compared within one only"),
                              HasSubstr("### another\n"), HasSubstr("### one processor, 2 cores\n")));
  EXPECT_THAT(report(), Not(HasSubstr("SIMD")));
  results.costs[0]->simd = "avx512";
  EXPECT_THAT(report(), AllOf(HasSubstr("SIMD level of Holdfast: avx512.\n"), Not(HasSubstr("several SIMD levels"))));
  results.costs[1]->simd = "sse4";
  EXPECT_THAT(report(), HasSubstr("**Runs of Holdfast used several SIMD levels**"));
}

}  // namespace
}  // namespace holdfast
