// SPDX-License-Identifier: BSD-3-Clause
#include "bench/matrix_fixture.hpp"

namespace holdfast::test {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

TEST_F(MatrixTest, ExpandsAxesSequencesSeedsAndRepeats) {
  const RunPlan p = plan(R"(
base: plain.yaml
axes:
  features.orb.count: [500, 2000]
  window: { narrow: { tracking.window: 5 }, wide: { tracking: { window: 50 } } }
sequences:
  one: { source: { tum: { path: one } }, camera: tum_fr1 }
  two: { source: { tum: { path: two } }, camera: &camera tum_fr3 }
  three: { source: { tum: { path: two } }, camera: *camera }
seeds: [3, 4]
repeats: 2
mode: threaded
exclude:
  - { features.orb.count: 2000, sequence: [one, three] }
  - { window: wide }
  - { sequence: three }
)");
  EXPECT_THAT(problems(), IsEmpty());
  EXPECT_THAT(
      ids(p),
      ElementsAre("500+narrow/one/seed3-repeat1", "500+narrow/one/seed3-repeat2", "500+narrow/one/seed4-repeat1",
                  "500+narrow/one/seed4-repeat2", "500+narrow/two/seed3-repeat1", "500+narrow/two/seed3-repeat2",
                  "500+narrow/two/seed4-repeat1", "500+narrow/two/seed4-repeat2", "2000+narrow/two/seed3-repeat1",
                  "2000+narrow/two/seed3-repeat2", "2000+narrow/two/seed4-repeat1", "2000+narrow/two/seed4-repeat2"));
  const std::string& request = p.runs.back().request;
  EXPECT_THAT(request,
              AllOf(HasSubstr("path: " + (folder_ / "two").string()), HasSubstr("count: 2000"), HasSubstr("window: 5"),
                    HasSubstr("seed: 4"), HasSubstr("mode: threaded"), HasSubstr("fx: 535.4")));
  EXPECT_THAT(p.runs.front().request, AllOf(HasSubstr("count: 500"), HasSubstr("seed: 3"), HasSubstr("fx: 517.3")));
  EXPECT_THAT(plan_text(p), HasSubstr("12 runs: 4 variants, 3 sequences, 2 seeds, 2 repeats"));
}

TEST_F(MatrixTest, TakesWholeConfigurationsAndOverridesOnlyWhatTheyChose) {
  const RunPlan p = plan(R"(
axes:
  method:
    none: { configuration: plain.yaml }
    masks: { configuration: masked.yaml }
    network: { configuration: masked.yaml, segmenter: network }
sequences:
  one:
    source: { tum: { path: one } }
    overrides: { segmenter.masks.path: one/mask, tracking.window: 7 }
baseline: none
comparisons: [[masks, network]]
)");
  ASSERT_THAT(problems(), IsEmpty());
  ASSERT_EQ(p.runs.size(), 3U);
  EXPECT_THAT(p.runs[0].request, AllOf(HasSubstr("segmenter:\n  none"), HasSubstr("window: 7")));
  EXPECT_THAT(p.runs[1].request, HasSubstr("path: " + (folder_ / "one/mask").string()));
  EXPECT_THAT(p.runs[2].request, AllOf(HasSubstr("segmenter:\n  network"), Not(HasSubstr("one/mask"))));
  EXPECT_THAT(p.comparisons, ElementsAre(std::pair(0U, 1U), std::pair(0U, 2U), std::pair(1U, 2U)));
  EXPECT_THAT(p.missing, IsEmpty());
}

TEST_F(MatrixTest, FindsTheBaselineOfEachVariantByAxes) {
  const RunPlan p = plan(R"(
base: plain.yaml
axes:
  features.orb.count: [500, 1000]
  tracking.window: [10, 20]
sequences: { one: { source: { tum: { path: one } } } }
baseline: { features.orb.count: 500 }
)");
  ASSERT_THAT(problems(), IsEmpty());
  EXPECT_FALSE(p.variants[0].baseline || p.variants[1].baseline);
  EXPECT_EQ(p.variants[2].name, "1000+10");
  EXPECT_EQ(p.variants[2].baseline, 0U);
  EXPECT_EQ(p.variants[3].baseline, 1U);
}

TEST_F(MatrixTest, ReportsEverythingThatIsWrongAtOnce) {
  plan(R"(titel: Typo
base: plain.yaml
axes:
  features.orb.cuont: [500]
  tracking.window: [5, 500]
sequences:
  one: { source: { tum: { pth: one } }, overrides: { segmenter.maskss.path: x } }
  bad name: { source: { tun: {} } }
repeats: none
exclude: [ { trackin.window: 5 }, { sequence: thre } ]
baseline: 500+6
)");
  EXPECT_THAT(problems(),
              testing::UnorderedElementsAre(
                  HasSubstr("matrix.yaml:1:1: the matrix has no key 'titel'; did you mean 'title'?"),
                  HasSubstr("matrix.yaml:9:10: found 'none' for 'repeats'"),
                  HasSubstr("matrix.yaml:8:3: 'bad name' cannot be the name of a sequence"),
                  HasSubstr("matrix.yaml:4:3: features 'orb' has no parameter 'cuont'; did you mean 'count'?"),
                  HasSubstr("matrix.yaml:5:24: found '500' for 'window' of section 'tracking': 500 is above 200"),
                  HasSubstr("matrix.yaml:7:27: source 'tum' has no parameter 'pth'"),
                  HasSubstr("matrix.yaml:7:25: source 'tum' needs 'path'"),
                  HasSubstr("matrix.yaml:7:54: there is no segmenter module 'maskss'; did you mean 'masks'?"),
                  HasSubstr("matrix.yaml:8:25: there is no source module 'tun'; did you mean 'tum'?"),
                  HasSubstr("matrix.yaml:10:14: there is no axis 'trackin.window'; did you mean 'tracking.window'?"),
                  HasSubstr("matrix.yaml:10:47: there is no sequence 'thre'"),
                  HasSubstr("matrix.yaml:11:11: there is no variant '500+6'; did you mean '500+5'?")));
}

TEST_F(MatrixTest, AMissingBaseHidesNoOtherMistake) {
  plan(R"(base: absent.yaml
axes:
  features.orb.cuont: [500]
  filters: { none: { filters: [] } }
sequences:
  one: { source: { tum: { pth: one } } }
)");
  EXPECT_THAT(problems(), testing::UnorderedElementsAre(
                              testing::AllOf(HasSubstr("matrix.yaml:1:7: "), HasSubstr("there is no such file")),
                              HasSubstr("matrix.yaml:3:3: features 'orb' has no parameter 'cuont'"),
                              HasSubstr("matrix.yaml:6:27: source 'tum' has no parameter 'pth'"),
                              HasSubstr("matrix.yaml:6:25: source 'tum' needs 'path'")));
}

TEST_F(MatrixTest, RefusesWhatWouldSilentlyNotCount) {
  plan(R"(base: plain.yaml
axes:
  run.seed: [1, 2]
  run.mode: [sequential, threaded]
  file: { a: { configuration: plain.yaml } }
  other: { b: { configuration: masked.yaml } }
sequences: { one: { source: { tum: { path: one } } } }
mode: threaded
)");
  EXPECT_THAT(problems(), ElementsAre(HasSubstr("matrix.yaml:3:3: seeds are given by `seeds`"),
                                      HasSubstr("matrix.yaml:4:3: 'run.mode' is an axis, and the matrix has `mode`"),
                                      HasSubstr("matrix.yaml:6:3: the axes 'file' and 'other' both name")));
  plan("base: plain.yaml\nsequences: { one: { source: { tum: { path: one } } } }\nexclude: [ { sequence: one } ]\n");
  EXPECT_THAT(problems(), ElementsAre(HasSubstr("every run is excluded")));
  plan("sequences: { one: { source: { tum: { path: one } } } }\n");
  EXPECT_THAT(problems(), testing::Contains(HasSubstr("there is no configuration to begin with")));
}

TEST_F(MatrixTest, RefusesMergeKeys) {
  try {
    plan("base: plain.yaml\nsequences: { one: &one { source: { tum: { path: one } } }, two: { <<: *one } }\n");
    FAIL();
  } catch (const ConfigurationError& error) {
    EXPECT_THAT(error.what(), HasSubstr("matrix.yaml:2:67: merge keys (<<) are not supported"));
  }
}

TEST_F(MatrixTest, TakesVariablesAndExplainsWhatIsMissing) {
  const std::string text = R"(base: plain.yaml
sequences:
  one: { source: { tum: { path: "${BENCH_TEST_DATA}/one" } } }
  two: { source: { tum: { path: "${BENCH_TEST_DATA}/gone" } }, about: "ask Ada for it" }
)";
  unsetenv("BENCH_TEST_DATA");
  const RunPlan without = plan(text);
  EXPECT_THAT(problems(), IsEmpty());
  EXPECT_EQ(without.runs.size(), 2U);
  EXPECT_THAT(texts(without.missing),
              ElementsAre(HasSubstr("matrix.yaml:3:3: sequence 'one': the variable 'BENCH_TEST_DATA' is not set"),
                          AllOf(HasSubstr("BENCH_TEST_DATA"), HasSubstr("ask Ada for it"))));
  const RunPlan with = plan(text, {{"BENCH_TEST_DATA", folder_.string()}});
  EXPECT_THAT(texts(with.missing), ElementsAre(AllOf(HasSubstr("sequence 'two': the folder 'gone' is missing"),
                                                     HasSubstr("ask Ada for it"))));
  EXPECT_THAT(plan_text(with), HasSubstr("missing on this machine"));
  setenv("BENCH_TEST_DATA", folder_.c_str(), 1);
  EXPECT_EQ(plan(text).missing.size(), 1U);
  unsetenv("BENCH_TEST_DATA");
  plan("base: '${BENCH_TEST_DATA}/plain.yaml'\nsequences: { one: { source: { tum: { path: one } } } }\n");
  EXPECT_THAT(problems(), testing::Contains(HasSubstr("matrix.yaml:1:7: the variable 'BENCH_TEST_DATA' is not set")));
}

TEST_F(MatrixTest, ReadsSystems) {
  plan(R"(
systems:
  theirs: { command: [program, "{sequense}"], time_limit: fast }
sequences: { one: { source: { tum: { path: one } } } }
)");
  EXPECT_THAT(problems(), testing::UnorderedElementsAre(
                              HasSubstr("matrix.yaml:3:59: found 'fast' for 'time_limit' of system 'theirs'"),
                              HasSubstr("matrix.yaml:3:3: system 'theirs' has the unknown placeholder {sequense}; did "
                                        "you mean 'sequence'?"),
                              HasSubstr("matrix.yaml:4:14: sequence 'one' needs 'camera'")));
}

}  // namespace
}  // namespace holdfast::test
