// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/evaluation/svg_plot.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "holdfast/core/error.hpp"
#include "holdfast/evaluation/number_text.hpp"

namespace holdfast {

namespace {

constexpr double character_width = 7.2;  // of the 12 px font, on average [px]
constexpr double legend_row_height = 20.0;
constexpr double swatch_width = 22.0;

struct Range {
  double begin = std::numeric_limits<double>::infinity();
  double end = -std::numeric_limits<double>::infinity();

  void include(double value) {
    if (!std::isfinite(value)) return;
    begin = std::min(begin, value);
    end = std::max(end, value);
  }
  double length() const { return end - begin; }
  double middle() const { return (begin + end) / 2.0; }
  /// Makes an empty or single-valued range one that can be drawn.
  void make_drawable() {
    if (!(begin <= end)) begin = end = 0.0;
    const double least = std::max(1e-9, 1e-9 * std::max(std::abs(begin), std::abs(end)));
    if (length() < least) widen_to(std::max(1.0, std::abs(begin)) * 1e-3);
  }
  void widen_to(double wanted) {
    const double centre = middle();
    begin = centre - wanted / 2.0;
    end = centre + wanted / 2.0;
  }
};

/// Positions of the axes, and conversion of values to pixels.
struct Frame {
  double left, top, right, bottom;  // [px]
  Range x, y;

  double pixel_x(double value) const { return left + (value - x.begin) / x.length() * (right - left); }
  double pixel_y(double value) const { return bottom - (value - y.begin) / y.length() * (bottom - top); }
};

std::string pixel(double value) { return fixed_text(value, 1); }

std::string line_element(double x1, double y1, double x2, double y2, const std::string& style) {
  return "<line x1=\"" + pixel(x1) + "\" y1=\"" + pixel(y1) + "\" x2=\"" + pixel(x2) + "\" y2=\"" + pixel(y2) + "\" " +
         style + "/>\n";
}

std::string text_element(double x, double y, const std::string& text, const std::string& style) {
  return "<text x=\"" + pixel(x) + "\" y=\"" + pixel(y) + "\" " + style + ">" + escape_markup(text) + "</text>\n";
}

std::string circle_element(double x, double y, const std::string& colour) {
  return "<circle cx=\"" + pixel(x) + "\" cy=\"" + pixel(y) + "\" r=\"4.5\" fill=\"" + colour +
         "\" stroke=\"#ffffff\" stroke-width=\"1.2\"/>\n";
}

std::string stroke(const std::string& colour, double width, bool dashed) {
  return "stroke=\"" + colour + "\" stroke-width=\"" + pixel(width) + "\"" +
         (dashed ? " stroke-dasharray=\"7 4\"" : "");
}

std::string path_element(const PlotLine& line, const Frame& frame) {
  std::string path;
  bool pen_down = false;
  double last_x = 0.0, last_y = 0.0;
  for (std::size_t i = 0; i < line.x.size(); ++i) {
    if (!std::isfinite(line.x[i]) || !std::isfinite(line.y[i])) {
      pen_down = false;
      continue;
    }
    const double x = frame.pixel_x(line.x[i]), y = frame.pixel_y(line.y[i]);
    const bool ends_here = i + 1 == line.x.size() || !std::isfinite(line.x[i + 1]) || !std::isfinite(line.y[i + 1]);
    if (pen_down && !ends_here && std::hypot(x - last_x, y - last_y) < 0.5) continue;
    // A lone point becomes a line of no length, which the round cap turns into a dot.
    path += pen_down ? 'L' : 'M';
    path += pixel(x) + ' ' + pixel(y);
    if (!pen_down && ends_here) path += "h0";
    pen_down = true;
    last_x = x;
    last_y = y;
  }
  if (path.empty()) return {};
  return "<path d=\"" + path + "\" fill=\"none\" stroke-linejoin=\"round\" stroke-linecap=\"round\" " +
         stroke(line.colour, line.width, line.dashed) +
         (line.opacity < 1.0 ? " stroke-opacity=\"" + fixed_text(line.opacity, 2) + "\"" : "") + "/>\n";
}

/// One sign and its word.
struct LegendEntry {
  enum class Sign { line, dashes, circle, band } sign;
  std::string colour;
  double width;
  std::string label;

  double pixels() const { return swatch_width + 8.0 + character_width * static_cast<double>(label.size()) + 20.0; }
};

std::vector<LegendEntry> legend_of(const Plot& plot) {
  using Sign = LegendEntry::Sign;
  std::vector<LegendEntry> entries;
  for (const PlotLine& line : plot.lines)
    if (!line.label.empty())
      entries.push_back({line.dashed ? Sign::dashes : Sign::line, line.colour, std::max(line.width, 1.4), line.label});
  for (const PlotLevel& level : plot.levels)
    if (!level.label.empty()) entries.push_back({Sign::dashes, level.colour, 1.4, level.label});
  for (const PlotPoint& point : plot.points)
    if (!point.label.empty()) entries.push_back({Sign::circle, point.colour, 0.0, point.label});
  if (!plot.bands.empty() && !plot.band_label.empty()) entries.push_back({Sign::band, "", 0.0, plot.band_label});
  return entries;
}

constexpr const char* band_style = "fill=\"#f9d3c9\"";

/// The legend in rows that begin at (left, top); `rows` receives their number.
std::string draw_legend(const std::vector<LegendEntry>& entries, double left, double right, double top, int& rows) {
  std::string svg;
  double x = left;
  rows = entries.empty() ? 0 : 1;
  for (const LegendEntry& entry : entries) {
    if (x > left && x + entry.pixels() > right + 20.0) {
      x = left;
      ++rows;
    }
    const double y = top + (rows - 0.5) * legend_row_height;
    using Sign = LegendEntry::Sign;
    switch (entry.sign) {
      case Sign::line:
      case Sign::dashes:
        svg += line_element(x, y, x + swatch_width, y, stroke(entry.colour, entry.width, entry.sign == Sign::dashes));
        break;
      case Sign::circle:
        svg += circle_element(x + swatch_width / 2.0, y, entry.colour);
        break;
      case Sign::band:
        svg += "<rect x=\"" + pixel(x) + "\" y=\"" + pixel(y - 6.0) + "\" width=\"" + pixel(swatch_width) +
               "\" height=\"12\" " + band_style + "/>\n";
        break;
    }
    svg += text_element(x + swatch_width + 8.0, y + 4.0, entry.label, "fill=\"#333333\"");
    x += entry.pixels();
  }
  return svg;
}

void fit_ranges(const Plot& plot, Frame& frame) {
  for (const PlotLine& line : plot.lines) {
    for (std::size_t i = 0; i < line.x.size(); ++i) {
      if (!std::isfinite(line.x[i]) || !std::isfinite(line.y[i])) continue;
      frame.x.include(line.x[i]);
      frame.y.include(line.y[i]);
    }
  }
  for (const PlotPoint& point : plot.points) {
    frame.x.include(point.x);
    frame.y.include(point.y);
  }
  for (const PlotLevel& level : plot.levels) frame.y.include(level.y);
  for (const PlotBand& band : plot.bands) {
    frame.x.include(band.begin);
    frame.x.include(band.end);
  }
  if (plot.y_from_zero) frame.y.include(0.0);
  frame.x.make_drawable();
  frame.y.make_drawable();
  const double width = frame.right - frame.left, height = frame.bottom - frame.top;
  if (plot.equal_scale) {
    const double unit = std::max(frame.x.length() / width, frame.y.length() / height) * 1.08;
    frame.x.widen_to(unit * width);
    frame.y.widen_to(unit * height);
  } else {
    const double margin = 0.06 * frame.y.length();
    frame.y.end += margin;
    if (!plot.y_from_zero) frame.y.begin -= margin;
  }
}

std::string draw_axes(const Plot& plot, const Frame& frame) {
  std::string svg;
  const std::string grid = stroke("#e3e3e3", 1.0, false);
  const double height = frame.bottom - frame.top;
  const Ticks x_ticks = round_ticks(frame.x.begin, frame.x.end, plot.width / 95);
  const Ticks y_ticks = round_ticks(frame.y.begin, frame.y.end, std::max(4, static_cast<int>(height / 50.0)));
  for (const double value : x_ticks.values) {
    const double x = frame.pixel_x(value);
    svg += line_element(x, frame.top, x, frame.bottom, grid);
    svg += text_element(x, frame.bottom + 18.0, fixed_text(value, x_ticks.decimals),
                        "text-anchor=\"middle\" fill=\"#444444\"");
  }
  for (const double value : y_ticks.values) {
    const double y = frame.pixel_y(value);
    svg += line_element(frame.left, y, frame.right, y, grid);
    svg += text_element(frame.left - 8.0, y + 4.0, fixed_text(value, y_ticks.decimals),
                        "text-anchor=\"end\" fill=\"#444444\"");
  }
  svg += text_element((frame.left + frame.right) / 2.0, frame.bottom + 40.0, plot.x_label,
                      "text-anchor=\"middle\" font-size=\"13\" fill=\"#222222\"");
  const double y_middle = (frame.top + frame.bottom) / 2.0;
  svg += text_element(
      18.0, y_middle, plot.y_label,
      "text-anchor=\"middle\" font-size=\"13\" fill=\"#222222\" transform=\"rotate(-90 18 " + pixel(y_middle) + ")\"");
  return svg;
}

}  // namespace

Ticks round_ticks(double begin, double end, int count) {
  HOLDFAST_CHECK(end > begin && count > 0, "begin " << begin << " end " << end << " count " << count);
  const double wanted = (end - begin) / count;
  const int exponent = static_cast<int>(std::floor(std::log10(wanted)));
  const double power = std::pow(10.0, exponent);
  const double leading = wanted / power;
  Ticks ticks;
  // The next larger round step, so that labels are never closer than requested.
  const double rounded = leading <= 1.0 ? 1.0 : leading <= 2.0 ? 2.0 : leading <= 5.0 ? 5.0 : 10.0;
  ticks.step = rounded * power;
  ticks.decimals = std::max(0, rounded == 10.0 ? -exponent - 1 : -exponent);
  const double first = std::ceil(begin / ticks.step - 1e-9), last = std::floor(end / ticks.step + 1e-9);
  for (double k = first; k <= last; k += 1.0) ticks.values.push_back(k * ticks.step);
  return ticks;
}

std::string to_svg(const Plot& plot) {
  for (const PlotLine& line : plot.lines)
    HOLDFAST_CHECK(line.x.size() == line.y.size(),
                   "line '" << line.label << "' x " << line.x.size() << " y " << line.y.size());
  Frame frame{72.0, 34.0, plot.width - 20.0, plot.height - 52.0, {}, {}};
  int legend_rows = 0;
  const std::string legend = draw_legend(legend_of(plot), frame.left, frame.right, frame.top, legend_rows);
  frame.top += legend_rows * legend_row_height + 8.0;
  fit_ranges(plot, frame);

  const std::string size = std::to_string(plot.width) + "\" height=\"" + std::to_string(plot.height);
  std::string svg = "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" + size + "\" viewBox=\"0 0 " +
                    std::to_string(plot.width) + ' ' + std::to_string(plot.height) +
                    "\" role=\"img\" font-family=\"Helvetica, Arial, 'DejaVu Sans', sans-serif\" font-size=\"12\">\n";
  svg += "<title>" + escape_markup(plot.title) + "</title>\n";
  svg += "<rect width=\"" + size + "\" fill=\"#ffffff\"/>\n";
  svg += text_element(frame.left, 23.0, plot.title, "font-size=\"15\" font-weight=\"bold\" fill=\"#222222\"");
  svg += legend;
  for (const PlotBand& band : plot.bands) {
    const double begin = frame.pixel_x(band.begin);
    const double width = std::max(1.0, frame.pixel_x(band.end) - begin);
    svg += "<rect x=\"" + pixel(begin) + "\" y=\"" + pixel(frame.top) + "\" width=\"" + pixel(width) + "\" height=\"" +
           pixel(frame.bottom - frame.top) + "\" " + band_style + "/>\n";
  }
  svg += draw_axes(plot, frame);
  for (const PlotLine& line : plot.lines) svg += path_element(line, frame);
  for (const PlotLevel& level : plot.levels) {
    const double y = frame.pixel_y(level.y);
    svg += line_element(frame.left, y, frame.right, y, stroke(level.colour, 1.4, true));
  }
  for (const PlotPoint& point : plot.points)
    svg += circle_element(frame.pixel_x(point.x), frame.pixel_y(point.y), point.colour);
  svg += "<rect x=\"" + pixel(frame.left) + "\" y=\"" + pixel(frame.top) + "\" width=\"" +
         pixel(frame.right - frame.left) + "\" height=\"" + pixel(frame.bottom - frame.top) +
         "\" fill=\"none\" stroke=\"#888888\"/>\n";
  return svg + "</svg>\n";
}

}  // namespace holdfast
