// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace holdfast {

/// Colours that are distinguishable with colour blindness (Okabe and Ito 2008), and greys.
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

/// A polyline. A value that is not finite interrupts the line.
struct PlotLine {
  std::string label;  ///< for the legend; empty = no entry
  std::string colour = plot_colour::blue;
  std::vector<double> x;
  std::vector<double> y;  ///< as many as x
  double width = 1.6;     ///< [px]
  bool dashed = false;
  double opacity = 1.0;  ///< 0 to 1
};

/// A dashed horizontal line across the whole plot.
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

/// A plot with two axes; to_svg() converts it to SVG. The drawing order is bands, lines, levels, points.
struct Plot {
  std::string title;
  std::string x_label;  ///< with unit: "time [s]"
  std::string y_label;
  bool equal_scale = false;  ///< both axes have the same scale
  bool y_from_zero = false;  ///< the y axis begins at 0; for non-negative values
  int width = 760;           ///< [px]
  int height = 460;          ///< [px]
  std::vector<PlotBand> bands;
  std::string band_label;  ///< for the legend, if there are bands
  std::vector<PlotLine> lines;
  std::vector<PlotLevel> levels;
  std::vector<PlotPoint> points;
};

/// Converts a plot to a self-contained SVG image without ids, scripts or external fonts, for a file or inline in HTML.
/// Points of a line within half a pixel of the last drawn point are skipped. The same plot gives the same bytes.
std::string to_svg(const Plot& plot);

/// Positions of axis ticks: about `count` multiples of 1, 2 or 5 times a power of ten in [begin, end].
struct Ticks {
  double step = 1.0;
  int decimals = 0;  ///< sufficient to distinguish the ticks
  std::vector<double> values;
};
Ticks round_ticks(double begin, double end, int count);

}  // namespace holdfast
