// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <unistd.h>

#include <fstream>

#include "holdfast/evaluation/report.hpp"
#include "support/browser.hpp"

namespace holdfast {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// A page with a clip of five pictures, which are 101, 102, ... pixels wide: the width tells which one is shown.
class ReportClipBrowserTest : public ::testing::Test {
 protected:
  static constexpr int count = 5;

  ReportClipBrowserTest() : folder_(fs::temp_directory_path() / ("report_clip_test." + std::to_string(getpid()))) {
    fs::create_directories(folder_ / "overlay");
    ReportClip clip;
    clip.interval = 0.05;
    clip.caption = "Masks";
    for (int i = 0; i < count; ++i) {
      const std::string name = "overlay/frame_" + std::to_string(i) + ".svg", size = std::to_string(101 + i);
      std::ofstream(folder_ / name) << "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" << size
                                    << "\" height=\"60\"><rect width=\"90\" height=\"60\" fill=\"teal\"/></svg>\n";
      clip.pictures.push_back(name);
      clip.names.push_back("frame " + std::to_string(10 * i));
    }
    Report report;
    report.title = "A run";
    report.sections.emplace_back();
    report.sections.back().clips = {clip};
    std::ofstream(folder_ / "report.html") << to_html(report);
  }
  ~ReportClipBrowserTest() override {
    browser_.reset();
    std::error_code error;
    fs::remove_all(folder_, error);
  }

  void SetUp() override {
    const auto program = test::find_browser();
    if (!program) GTEST_SKIP() << "no chromium, chromium-browser or google-chrome in PATH to look at the page with";
    browser_.emplace(*program, folder_ / "profile");
    browser_->open_page("file://" + (folder_ / "report.html").string());
  }

  std::string text(const std::string& expression) { return browser_->evaluate(expression).get<std::string>(); }
  std::string shown() { return text("document.querySelector('output').textContent"); }
  int width() { return browser_->evaluate("document.querySelector('figure.clip img').naturalWidth").get<int>(); }
  void move_slider_to(int index) {
    browser_->evaluate("(() => { const s = document.querySelector('input'); s.value = " + std::to_string(index) +
                       "; s.dispatchEvent(new Event('input')); })()");
  }
  /// Waits until the page says something, for a minute at most.
  bool comes(const std::string& expression) {
    for (int i = 0; i < 1200; ++i) {
      if (browser_->evaluate(expression) == true) return true;
      usleep(50'000);
    }
    return false;
  }

  fs::path folder_;
  std::optional<test::Browser> browser_;
};

TEST_F(ReportClipBrowserTest, PlaysToTheEndAndAgainFromTheBegin) {
  EXPECT_EQ(shown(), "frame 0, 1 of 5");
  EXPECT_EQ(width(), 101);
  const std::string button = "document.querySelector('.player button')";
  EXPECT_EQ(text(button + ".textContent"), "Play");
  for (int round = 0; round < 2; ++round) {
    browser_->evaluate("void (window.seen = [])");
    browser_->evaluate(
        "void new MutationObserver(() => seen.push(document.querySelector('img').alt))"
        ".observe(document.querySelector('img'), {attributes: true, attributeFilter: ['alt']})");
    browser_->click(button);
    ASSERT_TRUE(comes(button + ".textContent === 'Play' && document.querySelector('output').textContent === "
                               "'frame 40, 5 of 5'"))
        << shown();
    EXPECT_EQ(width(), 105);
    EXPECT_EQ(browser_->evaluate("seen.every((name, i) => i === 0 || name >= seen[i - 1])"), true) << "in order";
  }
  EXPECT_THAT(browser_->complaints(), IsEmpty());
}

TEST_F(ReportClipBrowserTest, TheSliderShowsAnyPicture) {
  move_slider_to(3);
  ASSERT_TRUE(comes("document.querySelector('output').textContent === 'frame 30, 4 of 5'")) << shown();
  EXPECT_EQ(width(), 104);
  EXPECT_EQ(text("document.querySelector('img').alt"), "frame 30");
  move_slider_to(1);
  ASSERT_TRUE(comes("document.querySelector('output').textContent === 'frame 10, 2 of 5'")) << shown();
  EXPECT_EQ(width(), 102);
}

TEST_F(ReportClipBrowserTest, AMissingPictureIsNamed) {
  fs::remove(folder_ / "overlay/frame_2.svg");
  move_slider_to(2);
  ASSERT_TRUE(comes("document.querySelector('output').textContent === 'overlay/frame_2.svg is missing'")) << shown();
  EXPECT_EQ(width(), 101) << "the picture before stays";
  move_slider_to(4);
  EXPECT_TRUE(comes("document.querySelector('output').textContent === 'frame 40, 5 of 5'")) << shown();
}

/// A shadow lies behind a plot, which must let it through, and is painted only where the page is narrower than the
/// plot.
TEST_F(ReportClipBrowserTest, AWidePlotSaysThatItScrolls) {
  Report report;
  report.title = "A run";
  report.sections.emplace_back();
  report.sections.back().figures.push_back(
      {"<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"640\" height=\"200\" viewBox=\"0 0 640 200\"><rect "
       "width=\"640\" "
       "height=\"200\" fill=\"#ffffff\"/></svg>",
       "A plot"});
  std::ofstream(folder_ / "plot.html") << to_html(report);
  const std::string figure = "document.querySelector('figure')";
  const auto style = [&](const std::string& element, const std::string& property) {
    return text("getComputedStyle(" + element + ")." + property);
  };
  browser_->open_page("file://" + (folder_ / "plot.html").string());
  browser_->show_at(400, 800, false);
  EXPECT_EQ(browser_->evaluate(figure + ".scrollWidth > " + figure + ".clientWidth"), true);
  EXPECT_THAT(style(figure, "backgroundImage"), HasSubstr("linear-gradient"));
  EXPECT_EQ(style("document.querySelector('figure svg')", "backgroundColor"), "rgba(0, 0, 0, 0)");
  EXPECT_EQ(style("document.querySelector('figure rect')", "fill"), "none");
  browser_->show_at(1280, 800, false);
  EXPECT_EQ(browser_->evaluate(figure + ".scrollWidth > " + figure + ".clientWidth"), false);
}

TEST_F(ReportClipBrowserTest, IsAPlainPictureWithoutItsScript) {
  std::string html;
  {
    std::ifstream stream(folder_ / "report.html");
    html.assign(std::istreambuf_iterator<char>(stream), {});
  }
  const std::size_t script = html.rfind("<script>");
  ASSERT_NE(script, std::string::npos);
  html.erase(script, html.rfind("</script>") - script);
  std::ofstream(folder_ / "plain.html") << html;
  browser_->open_page("file://" + (folder_ / "plain.html").string());
  EXPECT_EQ(width(), 101);
  EXPECT_FALSE(browser_->evaluate("document.querySelector('.player').checkVisibility()").get<bool>());
  EXPECT_TRUE(browser_->evaluate("document.querySelector('figure.clip img').checkVisibility()").get<bool>());
}

}  // namespace
}  // namespace holdfast
