// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace holdfast {

/// A table of texts. The first column is set flush left, the others flush right, as numbers want it.
struct ReportTable {
  std::string caption;
  std::vector<std::string> header;
  std::vector<std::vector<std::string>> rows;  ///< each as long as the header
  /// One share (0 to 1) per row, drawn as a bar in a column of its own at the end; no such column when empty.
  std::vector<double> bars;
};

/// A picture, given as the SVG text that to_svg() makes.
struct ReportFigure {
  std::string svg;
  std::string caption;
};

/// A heading and what stands beneath it, in this order; empty parts take no room.
struct ReportSection {
  std::string heading;
  std::string text;                                         ///< a paragraph
  std::vector<std::pair<std::string, std::string>> values;  ///< name and value
  std::vector<ReportTable> tables;
  std::vector<ReportFigure> figures;
  std::string preformatted;  ///< kept as it is, in a fixed-width font; for a configuration
};

/// A number worth large type at the top of the page: {"ATE RMSE", "9.6 mm"}.
struct ReportHighlight {
  std::string name;
  std::string value;
};

/// The content of a report page, from top to bottom.
struct Report {
  std::string title;
  std::string subtitle;
  std::vector<ReportHighlight> highlights;
  std::vector<ReportSection> sections;
};

/// One HTML page that needs nothing but itself: styles and pictures are inline, there are no scripts. Dark on light,
/// also in print. All texts are escaped, the SVG of figures is not. Same report, same bytes. Throws CheckError when a
/// row is not as long as its header, or the bars are not as many as the rows.
std::string to_html(const Report& report);

}  // namespace holdfast
