// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include "bench/listed_recording.hpp"
#include "cli/program.hpp"
#include "support/browser.hpp"

namespace holdfast {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

/// The report of a real bench: stand-ins for programs of others, good and bad, on a recording of which only the lists
/// are there.
class ReportPageBrowserTest : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto program = test::find_browser();
    if (!program) GTEST_SKIP() << "no chromium, chromium-browser or google-chrome in PATH to look at the page with";
    run_bench();
    browser_.emplace(*program, program_.path("profile"));
  }

  void run_bench() {
    test::write_listed_recording(program_, "recording");
    std::string matrix = "title: '" + title_ + "'\nabout: '<b>bold</b>'\nbaseline: good\nsystems:\n";
    for (const std::string mood : {"good", "half", "crash", "nan", "fail"})
      matrix += "  " + mood +
                ":\n    command: [sh, " HOLDFAST_SOURCE_DIR
                "/examples/external/stand_in.sh, '{associations}', '{settings}', '{sequence}', poses.txt]\n"
                "    environment: { STAND_IN: " +
                mood + " }\n    trajectory: '{output}/poses.txt'\n";
    matrix += "sequences: { little: { source: { tum: { path: recording, frames: 50 } }, camera: tum_fr3 } }\n";
    program_.write("matrix.yaml", matrix);
    const test::Outcome outcome = program_.run({"bench", "matrix.yaml", "--output", "out"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.errors;
  }

  std::string address(const std::string& fragment = "") const {
    return "file://" + program_.path("out/report.html").string() + fragment;
  }
  std::string text(const std::string& expression) { return browser_->evaluate(expression).get<std::string>(); }
  /// The first column of a table, from top to bottom.
  std::string order(const std::string& table) {
    return text("[...document.querySelectorAll('#" + table + " tbody th')].map((e) => e.textContent).join(' ')");
  }
  static std::string column(const std::string& table, const std::string& title) {
    return "[...document.querySelectorAll('#" + table + " thead th')].find((e) => e.textContent.startsWith('" + title +
           "'))";
  }

  test::Program program_;
  std::string title_ = "</script><script>document.title = 1</script> & others";
  std::optional<test::Browser> browser_;
};

TEST_F(ReportPageBrowserTest, SortsChoosesAndShowsFailures) {
  browser_->open_page(address());
  EXPECT_EQ(text("document.title"), title_);
  EXPECT_EQ(text("document.querySelector('h1').textContent"), title_);
  EXPECT_EQ(text("document.getElementById('about').textContent"), "<b>bold</b>");

  // A column is sorted by the mouse, the other way round by a second click, and by the keyboard.
  EXPECT_EQ(order("run-table"), "good half crash nan fail");
  const std::string coverage = column("run-table", "coverage");
  EXPECT_EQ(text(coverage + ".getAttribute('aria-sort')"), "none");
  browser_->click(coverage + ".firstChild");
  EXPECT_EQ(text(coverage + ".getAttribute('aria-sort')"), "ascending");
  EXPECT_EQ(order("run-table"), "fail half crash nan good");
  browser_->click(coverage + ".firstChild");
  EXPECT_EQ(text(coverage + ".getAttribute('aria-sort')"), "descending");
  EXPECT_EQ(order("run-table"), "good half crash nan fail");
  browser_->evaluate(column("run-table", "variant") + ".firstChild.focus()");
  browser_->press_enter();
  EXPECT_EQ(order("run-table"), "crash fail good half nan");
  EXPECT_EQ(text(coverage + ".getAttribute('aria-sort')"), "none");

  // What failed is shown as such, and stands for no figure.
  const std::string errors = text("document.querySelector('#error-table tbody').textContent");
  EXPECT_THAT(errors, AllOf(HasSubstr("crashed (signal 11)"), HasSubstr("failed (exit code 3)"), HasSubstr("50.0 %")));
  EXPECT_THAT(text("document.getElementById('run-table').textContent"),
              AllOf(HasSubstr("25 poses not finite"), HasSubstr("short")));
  EXPECT_THAT(text("document.getElementById('state').textContent"), HasSubstr("4 runs with trouble"));

  // Every run leads to what it was asked for.
  EXPECT_EQ(text("[...document.querySelectorAll('#run-table a')].find((e) => e.textContent === 'configuration')"
                 ".getAttribute('href')"),
            "runs/crash/little/repeat1/request.json");
  EXPECT_TRUE(std::filesystem::exists(program_.path("out/runs/crash/little/repeat1/request.json")));
  EXPECT_THAT(browser_->complaints(), IsEmpty());
}

TEST_F(ReportPageBrowserTest, LinksToNoHiddenSectionAndCutsNothing) {
  browser_->open_page(address());
  EXPECT_EQ(text("[...document.querySelectorAll('nav a')].filter((a) => a.checkVisibility()).map((a) => "
                 "a.getAttribute('href')).join(' ')"),
            "#comparisons #errors #improvements #trajectories #cost #runs");
  // A badge shows all its text, and the page is as wide as the window.
  EXPECT_EQ(
      browser_->evaluate("[...document.querySelectorAll('.mark')].filter((e) => e.scrollWidth > e.clientWidth + 1 "
                         "|| getComputedStyle(e).textOverflow === 'ellipsis').length"),
      0);
  EXPECT_TRUE(browser_->evaluate("document.documentElement.scrollWidth <= innerWidth").get<bool>());
  EXPECT_THAT(browser_->complaints(), IsEmpty());
}

TEST_F(ReportPageBrowserTest, WhatIsCopiedEndsWithItsCitation) {
  browser_->open_page(address());
  const std::string citation = text("document.getElementById('citation').textContent");
  EXPECT_THAT(citation, AllOf(HasSubstr("(matrix.yaml); "), HasSubstr("1 sequence"), HasSubstr("SE(3) alignment")));
  const std::string copied = text(
      "(() => { const range = document.createRange();"
      " range.selectNodeContents(document.querySelector('#run-table tbody tr'));"
      " getSelection().removeAllRanges(); getSelection().addRange(range); const data = new DataTransfer();"
      " document.dispatchEvent(new ClipboardEvent('copy', {clipboardData: data, cancelable: true}));"
      " return data.getData('text/plain'); })()");
  EXPECT_THAT(copied, AllOf(HasSubstr("good"), ::testing::EndsWith("\n" + citation + "\n")));

  browser_->evaluate("void addEventListener('copy', () => { window.taken = document.activeElement.value; }, true)");
  browser_->evaluate("void getSelection().removeAllRanges()");
  browser_->click("document.querySelector('#run-table caption button')");
  const std::string table = text("window.taken");
  EXPECT_THAT(table, AllOf(HasSubstr("variant\tsequence\t"), HasSubstr("\ngood\tlittle\t"),
                           ::testing::EndsWith("\n" + citation + "\n")));
}

TEST_F(ReportPageBrowserTest, DrawsTheChosenRuns) {
  browser_->open_page(address());
  const std::string canvas = "document.getElementById('trajectory-canvas')";
  const std::string drawn = canvas + ".getAttribute('aria-label')";
  EXPECT_EQ(text(drawn), "Trajectories on little: truth, good (run 1), half (run 1), crash (run 1), nan (run 1)");
  EXPECT_THAT(text("document.getElementById('chosen-runs').textContent"), HasSubstr("failfailed (exit code 3)"));
  const std::string picture = canvas + ".toDataURL()";
  const std::string before = text(picture);

  browser_->click("document.querySelector('#chosen-runs input[value^=half]')");
  EXPECT_EQ(text(drawn), "Trajectories on little: truth, good (run 1), crash (run 1), nan (run 1)");
  EXPECT_NE(text(picture), before) << "the picture follows the choice";
  EXPECT_EQ(browser_->evaluate("document.querySelectorAll('#error-plot canvas').length"), 1);

  const std::string whole = text(picture);
  browser_->click("document.getElementById('zoom-in')");
  EXPECT_NE(text(picture), whole);
  browser_->click("document.getElementById('zoom-fit')");
  EXPECT_EQ(text(picture), whole);
  browser_->click("document.querySelector('#plane input[value=yz]')");
  EXPECT_NE(text(picture), whole);

  // The address holds the choice.
  const std::string fragment = text("location.hash");
  browser_->open_page(address(fragment));
  EXPECT_EQ(text(drawn), "Trajectories on little: truth, good (run 1), crash (run 1), nan (run 1)");
  EXPECT_EQ(text("document.querySelector('#plane input:checked').value"), "yz");

  browser_->click("[...document.querySelectorAll('#run-table button.plain')][1]");
  EXPECT_EQ(text(drawn), "Trajectories on little: truth, half (run 1)");
  EXPECT_THAT(browser_->complaints(), IsEmpty());
}

}  // namespace
}  // namespace holdfast
