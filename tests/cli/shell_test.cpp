// SPDX-License-Identifier: BSD-3-Clause
// Completion in shells and the manual, as the program prints them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cli/program.hpp"

namespace holdfast {
namespace {

using test::Outcome;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

class ShellTest : public ::testing::Test {
 protected:
  bool has(const std::string& command) const {
    return std::system(("command -v " + command + " > /dev/null 2>&1").c_str()) == 0;
  }
  std::string output_of(const std::string& command) const {
    const std::string line = "cd '" + program_.path("").string() + "' && { " + command + "; } > answer 2>&1";
    EXPECT_EQ(std::system(line.c_str()), 0) << command << "\n" << program_.text("answer");
    return program_.text("answer");
  }

  test::Program program_;
};

TEST_F(ShellTest, BashCompletesCommandsOptionsValuesAndFiles) {
  if (!has("bash")) GTEST_SKIP() << "no bash";
  program_.write("room.yaml", "");
  program_.write("completion.bash", program_.run({"completion", "bash"}).output);
  // The words of a command line, of which the last one is completed.
  const auto completed = [&](const std::string& words) {
    program_.write("ask.bash",
                   "source completion.bash\nCOMP_WORDS=(" + words +
                       ")\nCOMP_CWORD=$((${#COMP_WORDS[@]} - 1))\n_holdfast\nprintf '<%s>' \"${COMPREPLY[@]}\"\n");
    return output_of("bash ask.bash");
  };
  EXPECT_EQ(completed("holdfast ru"), "<run>");
  EXPECT_EQ(completed("holdfast map ''"), "<info><export>");
  EXPECT_EQ(completed("holdfast run --ov"), "<--overwrite>");
  EXPECT_EQ(completed("holdfast map export --po"), "<--points>");
  EXPECT_EQ(completed("holdfast evaluate --alignment si"), "<sim3>");
  EXPECT_EQ(completed("holdfast run roo"), "<room.yaml>");
  EXPECT_EQ(completed("holdfast --ver"), "<--version>");
}

/// Bash passes "run.mode=thr" as three words, unless "=" is no separator.
TEST_F(ShellTest, BashCompletesSettingsModulesAndInstalledConfigurations) {
  if (!has("bash")) GTEST_SKIP() << "no bash";
  program_.write("completion.bash", program_.run({"completion", "bash"}).output);
  std::filesystem::create_directories(program_.path("demo_folder"));
  const auto completed = [&](const std::string& words) {
    program_.write("ask.bash", "source completion.bash\nCOMP_WORDS=('" HOLDFAST_PROGRAM "' " + words +
                                   ")\nCOMP_CWORD=$((${#COMP_WORDS[@]} - 1))\n_holdfast\nprintf '<%s>' "
                                   "\"${COMPREPLY[@]}\"\n");
    return output_of("bash ask.bash");
  };
  EXPECT_EQ(completed("modules multi_v"), "<multi_view_depth>");
  EXPECT_EQ(completed("run --set featu"), "<features.><features=>");
  EXPECT_EQ(completed("run --set features.or"), "<features.orb.>");
  EXPECT_EQ(completed("run --set features.orb.cou"), "<features.orb.count=>");
  EXPECT_EQ(completed("run a.yaml --set run.mode ="), "<sequential><threaded>");
  EXPECT_EQ(completed("run a.yaml --set segmenter = une"), "<unet>");
  EXPECT_EQ(completed("run a.yaml --set segmenter=une"), "<segmenter=unet>");
  EXPECT_EQ(completed("check --set dense_map.enabled = ''"), "<false><true>");
  EXPECT_EQ(completed("run dem"), "<demo><demo_folder>");
  EXPECT_EQ(completed("simulate crow"), "<crowd>");
}

/// As the shells ask for them; the scripts are checked by their own shells where these are installed.
TEST_F(ShellTest, WordsAreThoseOfTheProgram) {
  const Outcome settings = program_.run({"completion", "--words", "settings"});
  EXPECT_EQ(settings.exit_code, 0);
  EXPECT_THAT(settings.output, AllOf(HasSubstr("\ncamera=tum_fr1\n"), HasSubstr("\nfeatures.orb.count=\n"),
                                     HasSubstr("\nsegmenter=unet\n"), HasSubstr("\ntracking.minimum_inliers=\n"),
                                     HasSubstr("\nrun.late_frames=drop\n")));
  EXPECT_THAT(program_.run({"completion", "--words", "configurations"}).output, HasSubstr("\nfull\n"));
  EXPECT_EQ(program_.run({"completion"}).exit_code, 2);
  if (has("fish")) {
    program_.write("holdfast.fish", program_.run({"completion", "fish"}).output);
    EXPECT_THAT(
        output_of("fish --no-config -c \"source holdfast.fish; complete -C '" HOLDFAST_PROGRAM " run --set run.mo'\""),
        HasSubstr("run.mode=sequential"));
  }
}

TEST_F(ShellTest, ScriptsNameEveryCommandAndOption) {
  for (const std::string shell : {"bash", "zsh", "fish"}) {
    const Outcome outcome = program_.run({"completion", shell});
    EXPECT_EQ(outcome.exit_code, 0);
    EXPECT_THAT(outcome.output,
                AllOf(HasSubstr("overwrite"), HasSubstr("background"), HasSubstr("associate"), HasSubstr("alignment")))
        << shell;
    program_.write("script." + shell, outcome.output);
    if (has(shell)) output_of(shell + (shell == "fish" ? " --no-execute" : " -n") + (" script." + shell));
  }
  EXPECT_EQ(program_.run({"completion", "tcsh"}).exit_code, 2);
}

TEST_F(ShellTest, TheManualHasEveryCommand) {
  const Outcome outcome = program_.run({"manual"});
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_THAT(outcome.output, AllOf(HasSubstr(".TH HOLDFAST 1"), HasSubstr(".SH SYNOPSIS"),
                                    HasSubstr(".SS holdfast run"), HasSubstr(".SS holdfast map export"),
                                    HasSubstr("\\fB\\-o\\fR, \\fB\\-\\-output"), HasSubstr("run.minimum_coverage")));
  program_.write("holdfast.1", outcome.output);
  if (has("groff")) {
    EXPECT_EQ(output_of("groff -man -Tascii -ww -z holdfast.1"), "");
  }
}

}  // namespace
}  // namespace holdfast
