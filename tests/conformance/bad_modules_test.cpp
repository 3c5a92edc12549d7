// SPDX-License-Identifier: BSD-3-Clause
// A test of the tests: the program that a third party would run, on modules that break one promise each.
#include <gmock/gmock.h>
#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <map>
#include <set>
#include <sstream>

namespace holdfast::conformance {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using Names = std::set<std::string>;

struct Outcome {
  int exit_code = -1;
  std::string output;
};

Outcome run(const std::string& filter) {
  const std::string command = std::string(HOLDFAST_BAD_CONFORMANCE) + " --gtest_filter='" + filter + "' 2>&1";
  Outcome outcome;
  FILE* pipe = popen(command.c_str(), "r");
  if (pipe == nullptr) return outcome;
  std::array<char, 4096> buffer;
  while (const std::size_t count = std::fread(buffer.data(), 1, buffer.size(), pipe))
    outcome.output.append(buffer.data(), count);
  const int status = pclose(pipe);
  outcome.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  return outcome;
}

/// The checks that failed, by module.
std::map<std::string, Names> failed(const std::string& kind, const std::string& output) {
  std::map<std::string, Names> result;
  const std::string mark = "[  FAILED  ] " + kind + "/";
  std::istringstream lines(output);
  for (std::string line; std::getline(lines, line);) {
    if (line.rfind(mark, 0) != 0) continue;
    const std::string name = line.substr(mark.size(), line.find_first_of(" ,", mark.size()) - mark.size());
    result[name.substr(0, name.find('.'))].insert(name.substr(name.find('.') + 1));
  }
  return result;
}

/// Each module fails the checks named, and others only where the same fault shows in them.
void expect_found(const std::string& kind, const std::map<std::string, Names>& expected) {
  const Outcome outcome = run(kind + "/*-*.Time:*/crashes.*:*/needs_previous.*:" + kind + "/needs_depth." +
                              (kind == "segmenter" ? "*" : "None") + ":*/needs_descriptors.*");
  EXPECT_EQ(outcome.exit_code, 1);
  const auto found = failed(kind, outcome.output);
  EXPECT_EQ(found.count("sound"), 0U) << "a module without a fault fails\n" << outcome.output;
  for (const auto& [module, checks] : expected) {
    const auto of_module = found.find(module);
    if (of_module == found.end()) {
      ADD_FAILURE() << kind << "/" << module << " passes";
      continue;
    }
    EXPECT_EQ(testing::PrintToString(of_module->second), testing::PrintToString(checks)) << kind << "/" << module;
  }
  for (const auto& [module, checks] : found)
    EXPECT_EQ(expected.count(module), 1U)
        << kind << "/" << module << " is not expected to fail " << testing::PrintToString(checks);
}

TEST(BadModules, ExtractorsAreFound) {
  expect_found("features",
               {{"appends", {"InstancesDoNotMeet", "ReplacesOut"}},
                {"blind",
                 {"AnglesLieWithinTheCircle", "FillsEveryArray", "FindsFeatures", "PositionsLieInsideTheImage",
                  "ResponsesAreFinite"}},
                {"counts_calls",
                 {"BudgetComesAndGoes", "InstancesDoNotMeet", "MayChangeThreads", "ReplacesOut",
                  "SameImageSameFeatures", "TakesImagesWithGaps"}},
                {"degrees", {"AnglesLieWithinTheCircle"}},
                {"grows", {"PyramidIsWholeAndStays"}},
                {"high_octave", {"HonoursIgnore", "OctavesLieWithinThePyramid"}},
                {"ignores_gaps", {"TakesImagesWithGaps"}},
                {"ignores_ignore", {"HonoursIgnore", "TakesImagesOfAnySize", "TakesNothingWhereAllIsIgnored"}},
                {"no_number",
                 {"BudgetComesAndGoes", "InstancesDoNotMeet", "MayChangeThreads", "ReplacesOut", "ResponsesAreFinite",
                  "SameImageSameFeatures", "TakesImagesWithGaps"}},
                {"outside", {"HonoursIgnore", "PositionsLieInsideTheImage", "TakesImagesOfAnySize"}},
                {"refuses_tiny", {"FindsNothingInTinyImages", "TakesImagesOfAnySize"}},
                {"short_array", {"FillsEveryArray", "HonoursIgnore", "ReplacesOut", "TakesImagesOfAnySize"}},
                {"writes", {"WritesToNoImage"}}});
}

TEST(BadModules, SegmentersAreFound) {
  const Names unsound{"LivesWithoutDepthAndTruth", "ResultsAreSound", "SurvivesDepthThatIsNoNumber",
                      "SurvivesFramesOfAnySize"};
  expect_found(
      "segmenter",
      {{"counts_calls", {"InstancesDoNotMeet", "MayChangeThreads", "SameFramesSameResults", "TakesImagesWithGaps"}},
       {"half_size", unsound},
       {"lost_instance", unsound},
       {"movable_stranger", {"MovableAreClasses"}},
       {"new_class", {"ClassesStay"}},
       {"nothing", {"SegmentsFrames"}},
       {"one_buffer", {"MayChangeThreads", "ResultsAreKeptApart"}},
       {"one_thread", {"InstancesDoNotMeet", "MayChangeThreads"}},
       {"same_names", {"ClassesHaveNames"}},
       {"small_confidence", unsound},
       {"stranger", unsound},
       {"throws_texts", {"SurvivesFramesOfAnySize"}},
       {"wide", unsound},
       {"writes", {"WritesToNoFrame"}}});
}

TEST(BadModules, FiltersAreFound) {
  const Names unsound{
      "EvidenceIsSound",     "LivesWithEverythingMasked",    "LivesWithoutDepth",           "LivesWithoutFeatures",
      "LivesWithoutMatches", "LivesWithoutWhatMayBeMissing", "SurvivesDepthThatIsNoNumber", "SurvivesImagesOfAnySize"};
  expect_found("filters",
               {{"cells_without_end", unsound},
                {"changes_its_needs", {"NeedsStay"}},
                {"counts_calls", {"InstancesDoNotMeet", "MayChangeThreads", "SameContextsSameEvidence"}},
                {"hides_its_needs", {"WorksWithoutDepthUnlessItNeedsIt"}},
                {"invents_points", unsound},
                {"names_itself", {"NeverTakesAway"}},
                {"needs_depth", {"LivesWithoutDepth"}},
                {"no_number",
                 {"EvidenceIsSound", "InstancesDoNotMeet", "LivesWithEverythingMasked", "LivesWithoutDepth",
                  "LivesWithoutFeatures", "LivesWithoutMatches", "LivesWithoutWhatMayBeMissing", "MayChangeThreads",
                  "SameContextsSameEvidence", "SurvivesDepthThatIsNoNumber", "SurvivesImagesOfAnySize"}},
                {"numbers_from_zero", unsound},
                {"starts_anew", {"NeverTakesAway"}},
                {"writes", {"ChangesNothingButEvidence"}}});
}

TEST(BadModules, OptimizersAreFound) {
  expect_found(
      "optimizer",
      {{"denies_factors", {"SolvesAnInertialBundle"}},
       {"ignores_factors",
        {"EstimatesAFreeScale", "KeepsFixedMotions", "LeavesFactorsThatCannotBeUsed", "SolvesAnInertialBundle"}},
       {"counts_calls",
        {"InstancesDoNotMeet", "LeavesAPoseThatCannotBeFound", "ManyThreadsAtOnce", "SameProblemSameBits"}},
       {"forgets_inliers", {"MarksInliersOfAPose", "SurvivesNumbersThatAreNone"}},
       {"ignores_weights", {"LeavesOutWhatHasNoWeight", "LeavesWhatIsNotOut"}},
       {"miscounts", {"FindsAPose", "MarksInliersOfAPose", "MarksOutliersOfABundle", "SolvesABundle"}},
       {"moves_fixed",
        {"KeepsFixedPoses", "LeavesABundleThatCannotBeSolved", "LeavesFactorsThatCannotBeUsed", "StopsABundle"}},
       {"moves_unusable", {"LeavesAPoseThatCannotBeFound"}},
       {"never_stops", {"StopsABundle"}},
       {"no_covariance", {"CovarianceIsOne"}},
       {"no_number",
        {"FindsAPose", "InstancesDoNotMeet", "LeavesAPoseThatCannotBeFound", "LeavesOutWhatHasNoWeight",
         "ManyThreadsAtOnce", "MarksInliersOfAPose", "SameProblemSameBits", "SurvivesNumbersThatAreNone"}},
       {"rounds_rotations", {"FindsAPose", "LeavesAPoseThatCannotBeFound"}},
       {"stays_away", {"LeavesAGraphThatCannotBeSolved", "SolvesAGraph"}},
       {"tilts", {"KeepsTheVertical"}}});
}

TEST(BadModules, LoopDetectorsAreFound) {
  expect_found(
      "loop_detector",
      {{"blind", {"RecognisesAPlace"}},
       {"counts_calls", {"AskingChangesNothing", "InstancesDoNotMeet", "MayChangeThreads", "SameCallsSameMatches"}},
       {"generous", {"GivesAtMostWhatWasAsked", "MatchesAreSound"}},
       {"image_of_a_mood", {"AskingChangesNothing", "DescribesImagesAlike", "DoesNotSeeWhatMoves"}},
       {"image_of_numbers", {"DescribesImagesAlike", "RecognisesAPlace"}},
       {"image_with_people", {"DoesNotSeeWhatMoves"}},
       {"learns_by_asking", {"AskingChangesNothing"}},
       {"never_forgets", {"ForgetsWhatIsRemoved", "LivesWithAnyNumberOfDescriptors"}},
       {"no_number",
        {"AskingChangesNothing", "ForgetsWhatIsRemoved", "IgnoresUnknownRemovals", "InstancesDoNotMeet",
         "LivesWithAnyNumberOfDescriptors", "MatchesAreSound", "MayChangeThreads", "SameCallsSameMatches"}},
       {"strict", {"ForgetsWhatIsRemoved", "IgnoresUnknownRemovals"}},
       {"twice",
        {"ForgetsWhatIsRemoved", "IgnoresUnknownRemovals", "LivesWithAnyNumberOfDescriptors", "MatchesAreSound"}},
       {"worst_first", {"MatchesAreSound"}}});
}

TEST(BadModules, MessagesNameTheSentence) {
  EXPECT_THAT(run("segmenter/stranger.ResultsAreSound").output,
              AllOf(HasSubstr("label 7 at column 0, row 0 of 2 classes"),
                    HasSubstr("segmenter/stranger is held to holdfast/interfaces/segmenter.hpp: \"8UC1 of the frame's "
                              "size: index into Segmenter::classes(); 255 = unknown\"")));
}

TEST(BadModules, CrashesNameTheSentenceToo) {
  for (const std::string test :
       {"features/crashes.FindsNothingInTinyImages", "segmenter/needs_depth.LivesWithoutDepthAndTruth",
        "filters/needs_previous.LivesWithoutWhatMayBeMissing",
        "loop_detector/needs_descriptors.LivesWithAnyNumberOfDescriptors"}) {
    const Outcome outcome = run(test);
    EXPECT_NE(outcome.exit_code, 0) << test;
    EXPECT_THAT(outcome.output, AllOf(HasSubstr("The module crashed in " + test), HasSubstr("is held to holdfast/")));
  }
}

}  // namespace
}  // namespace holdfast::conformance
