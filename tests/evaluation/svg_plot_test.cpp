// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/evaluation/svg_plot.hpp"

#include <gmock/gmock.h>

#include <limits>
#include <sstream>

#include "holdfast/core/error.hpp"

namespace holdfast {
namespace {

using ::testing::DoubleNear;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::size_t occurrences(const std::string& text, const std::string& word) {
  std::size_t count = 0;
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++count;
  return count;
}

/// The description of the first path.
std::string path_of(const std::string& svg) {
  const std::string head = "<path d=\"";
  const std::size_t begin = svg.find(head);
  if (begin == std::string::npos) return {};
  return svg.substr(begin + head.size(), svg.find('"', begin + head.size()) - begin - head.size());
}

TEST(RoundTicks, AreMultiplesOfOneTwoFive) {
  EXPECT_THAT(round_ticks(0.0, 1.0, 5).values,
              ElementsAre(0.0, DoubleNear(0.2, 1e-12), DoubleNear(0.4, 1e-12), DoubleNear(0.6, 1e-12),
                          DoubleNear(0.8, 1e-12), DoubleNear(1.0, 1e-12)));
  EXPECT_EQ(round_ticks(0.0, 1.0, 5).decimals, 1);
  EXPECT_THAT(round_ticks(-3.0, 42.0, 5).values, ElementsAre(0.0, 10.0, 20.0, 30.0, 40.0));
  EXPECT_EQ(round_ticks(-3.0, 42.0, 5).decimals, 0);
  EXPECT_DOUBLE_EQ(round_ticks(0.0, 0.0123, 4).step, 0.005);
  EXPECT_EQ(round_ticks(0.0, 0.0123, 4).decimals, 3);
  EXPECT_DOUBLE_EQ(round_ticks(0.0, 3.6, 5).step, 1.0);
  EXPECT_EQ(round_ticks(0.0, 3.6, 5).decimals, 0);
}

TEST(SvgPlot, LiftsThePenAtWhatIsNotFinite) {
  Plot plot;
  PlotLine line;
  line.x = {0, 1, 2, 3, 4};
  line.y = {0, 1, std::numeric_limits<double>::quiet_NaN(), 1, 0};
  plot.lines = {line};
  const std::string path = path_of(to_svg(plot));
  EXPECT_EQ(occurrences(path, "M"), 2u) << path;
  EXPECT_EQ(occurrences(path, "L"), 2u) << path;
}

TEST(SvgPlot, KeepsOneScaleWhereAsked) {
  Plot plot;
  plot.equal_scale = true;
  PlotLine line;
  line.x = {0, 10, 10};
  line.y = {0, 0, 1};
  plot.lines = {line};
  std::istringstream path(path_of(to_svg(plot)));
  char letter = ' ';
  double x[3] = {}, y[3] = {};
  for (int i = 0; i < 3; ++i) path >> letter >> x[i] >> y[i];
  ASSERT_FALSE(path.fail());
  const double along_x = x[1] - x[0], along_y = y[1] - y[2];
  EXPECT_NEAR(along_x, 10.0 * along_y, 1.5);
  EXPECT_GT(along_y, 10.0) << "up is up";
}

TEST(SvgPlot, EscapesTextsAndDrawsWhatWasGiven) {
  Plot plot;
  plot.title = "a < b & \"c\"";
  plot.band_label = "no pose";
  plot.bands = {{1.0, 2.0}};
  plot.levels = {{"RMSE", plot_colour::vermilion, 0.5}};
  plot.points = {{"start", plot_colour::green, 0.0, 0.0}};
  const std::string svg = to_svg(plot);
  EXPECT_THAT(svg, HasSubstr("a &lt; b &amp; &quot;c&quot;"));
  for (const char* label : {">no pose<", ">RMSE<", ">start<"}) EXPECT_THAT(svg, HasSubstr(label));
  EXPECT_EQ(occurrences(svg, "nan"), 0u);
}

TEST(SvgPlot, DrawsNothingAndASinglePoint) {
  EXPECT_THAT(to_svg(Plot{}), HasSubstr("</svg>"));
  Plot plot;
  PlotLine line;
  line.x = {1305031102.0};
  line.y = {0.0};
  plot.lines = {line};
  plot.y_from_zero = true;
  const std::string svg = to_svg(plot);
  EXPECT_EQ(occurrences(svg, "nan"), 0u);
  EXPECT_EQ(occurrences(svg, "inf"), 0u);
  EXPECT_EQ(occurrences(svg, "<path"), 1u);
}

TEST(SvgPlot, RefusesALineOfUnequalLists) {
  Plot plot;
  PlotLine line;
  line.x = {1.0, 2.0};
  line.y = {1.0};
  plot.lines = {line};
  EXPECT_THROW(to_svg(plot), CheckError);
}

}  // namespace
}  // namespace holdfast
