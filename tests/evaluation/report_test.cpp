// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/evaluation/report.hpp"

#include <gmock/gmock.h>

#include "holdfast/core/error.hpp"

namespace holdfast {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

Report sample() {
  Report report;
  report.title = "Run <one> & only";
  report.highlights = {{"ATE RMSE", "9.6 mm"}};
  ReportSection section;
  section.heading = "Stages";
  section.values = {{"seed", "1"}};
  section.tables = {{"Time per frame", {"stage", "median"}, {{"track", "12.0"}, {"map", "3.0"}}, {0.8, 0.2}}};
  section.figures = {{"<svg><title>t</title></svg>\n", "A figure"}};
  section.preformatted = "source: { tum: {} }";
  report.sections = {section};
  return report;
}

TEST(Report, HoldsEverythingInOnePage) {
  const std::string html = to_html(sample());
  EXPECT_THAT(html, HasSubstr("<h1>Run &lt;one&gt; &amp; only</h1>"));
  EXPECT_THAT(html, HasSubstr("<b>9.6 mm</b><span>ATE RMSE</span>"));
  EXPECT_THAT(html, HasSubstr("<td>track</td><td>12.0</td><td class=\"bar\"><i style=\"width:80.0%\">"));
  EXPECT_THAT(html, HasSubstr("<svg><title>t</title></svg>"));
  EXPECT_THAT(html, HasSubstr("<figcaption>A figure</figcaption>"));
  EXPECT_THAT(html, HasSubstr("<pre>source: { tum: {} }</pre>"));
}

TEST(Report, NeedsNothingFromOutside) {
  const std::string html = to_html(sample());
  for (const char* outside : {"http:", "https:", "<link", "@import", "url("})
    EXPECT_THAT(html, Not(HasSubstr(outside)));
}

TEST(Report, DrawsAlarmingFiguresInRed) {
  Report report;
  report.highlights = {{"ATE RMSE", "9 mm"}, {"coverage", "12 %", true}};
  const std::string html = to_html(report);
  EXPECT_THAT(html, HasSubstr("<div class=\"highlight\"><b>9 mm</b>"));
  EXPECT_THAT(html, HasSubstr("<div class=\"highlight alarming\"><b>12 %</b>"));
}

TEST(Report, RefersToThePicturesOfAClip) {
  EXPECT_THAT(to_html(sample()), Not(HasSubstr("figure.clip"))) << "no script without a clip";
  Report report = sample();
  report.sections[0].clips = {
      {{"overlay/frame_000000.jpg", "overlay/frame_000002.jpg"}, {"frame 0", "a \"2\""}, 0.05, "Masks"}};
  const std::string html = to_html(report);
  EXPECT_THAT(html, HasSubstr("<img src=\"overlay/frame_000000.jpg\" alt=\"frame 0\">"));
  EXPECT_THAT(html, HasSubstr("data-pictures=\"overlay/frame_000000.jpg\noverlay/frame_000002.jpg\""));
  EXPECT_THAT(html, HasSubstr("data-names=\"frame 0\na &quot;2&quot;\""));
  EXPECT_THAT(html, HasSubstr("<div class=\"player\" hidden>")) << "nothing to press without JavaScript";
  EXPECT_THAT(html, HasSubstr("querySelectorAll('figure.clip')"));
  report.sections[0].clips[0].names.pop_back();
  EXPECT_THROW(to_html(report), CheckError);
  report.sections[0].clips = {ReportClip{}};
  EXPECT_THROW(to_html(report), CheckError) << "a clip without pictures";
}

TEST(Report, RefusesRaggedTables) {
  Report report = sample();
  report.sections[0].tables[0].rows[1].pop_back();
  EXPECT_THROW(to_html(report), CheckError);
  report = sample();
  report.sections[0].tables[0].bars.pop_back();
  EXPECT_THROW(to_html(report), CheckError);
}

}  // namespace
}  // namespace holdfast
