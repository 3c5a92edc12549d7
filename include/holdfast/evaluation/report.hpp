// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace holdfast {

/// A table of texts. The first column is left-aligned, the others are right-aligned for numbers.
struct ReportTable {
  std::string caption;
  std::vector<std::string> header;
  std::vector<std::vector<std::string>> rows;  ///< each as long as the header
  /// One fraction (0 to 1) per row, drawn as a bar in an additional last column; empty for no such column.
  std::vector<double> bars;
};

/// A figure as SVG text from to_svg().
struct ReportFigure {
  std::string svg;
  std::string caption;
};

/// Pictures that the page plays one after the other, with a button and a slider. The page refers to them, so that it
/// stays small; without JavaScript it shows the first one.
struct ReportClip {
  std::vector<std::string>
      pictures;                    ///< addresses relative to the page, without line breaks: "overlay/frame_000000.jpg"
  std::vector<std::string> names;  ///< one for each picture, without line breaks: "frame 0"
  double interval = 0.1;           ///< time from one picture to the next [s]
  std::string caption;
};

/// A heading and its content, in this order; empty parts are omitted.
struct ReportSection {
  std::string heading;
  std::string text;                                         ///< a paragraph
  std::vector<std::pair<std::string, std::string>> values;  ///< name and value
  std::vector<ReportTable> tables;
  std::vector<ReportFigure> figures;
  std::vector<ReportClip> clips;
  std::string preformatted;  ///< in a fixed-width font; for a configuration
};

/// A key figure in large type at the top of the page: {"ATE RMSE", "9.6 mm"}.
struct ReportHighlight {
  std::string name;
  std::string value;
  bool is_alarming = false;  ///< drawn in red
};

/// The content of a report page, from top to bottom.
struct Report {
  std::string title;
  std::string subtitle;
  std::vector<ReportHighlight> highlights;
  std::vector<ReportSection> sections;
};

/// Formats a report as a self-contained HTML page: styles, figures and a switch between dark and light are inline.
/// Texts are escaped, the SVG of figures is not. The same report gives the same bytes. Throws CheckError if a row and
/// its header differ in length, if the numbers of bars and rows differ, or if a clip has no picture, not one name for
/// each, or an interval that is not positive.
std::string to_html(const Report& report);

}  // namespace holdfast
