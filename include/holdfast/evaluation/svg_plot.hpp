// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace holdfast {

/// Colours that people with colour-blindness tell apart (Okabe and Ito 2008), and greys.
namespace plot_colour {
inline constexpr const char* black = "#222222";
inline constexpr const char* blue = "#0072b2";
inline constexpr const char* vermilion = "#d55e00";
inline constexpr const char* green = "#009e73";
inline constexpr const char* orange = "#e69f00";
inline constexpr const char* purple = "#cc79a7";
inline constexpr const char* sky = "#56b4e9";
inline constexpr const char* grey = "#9a9a9a";
}  // namespace plot_colour

/// A line through points. A value that is not finite lifts the pen.
struct PlotLine {
  std::string label;  ///< in the legend; none when empty
  std::string colour = plot_colour::blue;
  std::vector<double> x;
  std::vector<double> y;  ///< as many as x
  double width = 1.6;     ///< [px]
  bool dashed = false;
  double opacity = 1.0;  ///< 0 to 1
};

/// A dashed line across the whole plot at one height.
struct PlotLevel {
  std::string label;
  std::string colour = plot_colour::vermilion;
  double y = 0.0;
};

/// A small circle.
struct PlotPoint {
  std::string label;
  std::string colour = plot_colour::green;
  double x = 0.0;
  double y = 0.0;
};

/// A shaded range of x.
struct PlotBand {
  double begin = 0.0;
  double end = 0.0;
};

/// A plot with two axes, made into SVG by to_svg(). Later parts are drawn over earlier ones: bands, lines, levels,
/// points.
struct Plot {
  std::string title;
  std::string x_label;  ///< with unit: "time [s]"
  std::string y_label;
  bool equal_scale = false;  ///< one unit of x is as long as one of y
  bool y_from_zero = false;  ///< the y axis begins at 0; for values that are never negative
  int width = 760;           ///< [px]
  int height = 460;          ///< [px]
  std::vector<PlotBand> bands;
  std::string band_label;  ///< in the legend, when there are bands
  std::vector<PlotLine> lines;
  std::vector<PlotLevel> levels;
  std::vector<PlotPoint> points;
};

/// A self-contained SVG image without ids, scripts or outside fonts, fit for a file and for inlining into HTML. Points
/// of a line nearer than half a pixel to the last drawn one are left out. Same plot, same bytes.
std::string to_svg(const Plot& plot);

/// Positions of axis ticks: about `count` multiples of 1, 2 or 5 times a power of ten within [begin, end].
struct Ticks {
  double step = 1.0;
  int decimals = 0;  ///< enough to tell the ticks apart
  std::vector<double> values;
};
Ticks round_ticks(double begin, double end, int count);

}  // namespace holdfast
