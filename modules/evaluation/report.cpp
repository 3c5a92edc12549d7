// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/evaluation/report.hpp"

#include <algorithm>

#include "holdfast/core/error.hpp"
#include "holdfast/evaluation/number_text.hpp"

namespace holdfast {

namespace {

constexpr const char* style = R"(
:root { color-scheme: light; }
* { box-sizing: border-box; }
body { margin: 0; background: #f4f4f1; color: #222; font: 15px/1.5 Helvetica, Arial, "DejaVu Sans", sans-serif; }
main { max-width: 880px; margin: 0 auto; padding: 32px 24px 48px; }
h1 { font-size: 26px; line-height: 1.2; margin: 0 0 4px; overflow-wrap: anywhere; }
h2 { font-size: 18px; margin: 0 0 12px; }
p { margin: 0 0 12px; }
.subtitle { color: #666; margin-bottom: 20px; overflow-wrap: anywhere; }
.highlights { display: flex; flex-wrap: wrap; gap: 12px; margin: 0 0 20px; }
.highlight { flex: 1 1 130px; background: #fff; border: 1px solid #dcdcd6; border-radius: 6px; padding: 10px 14px; }
.highlight b { display: block; font-size: 22px; line-height: 1.3; color: #0072b2; white-space: nowrap; }
.highlight.alarming b { color: #c1121f; }
.highlight span { color: #666; font-size: 13px; }
section { background: #fff; border: 1px solid #dcdcd6; border-radius: 6px; padding: 20px 24px; margin-bottom: 20px; }
table { border-collapse: collapse; width: 100%; margin: 0 0 16px; font-variant-numeric: tabular-nums; }
caption { text-align: left; color: #666; padding-bottom: 6px; }
th, td { padding: 4px 10px; text-align: right; border-bottom: 1px solid #e8e8e3; }
thead th { border-bottom: 2px solid #bbb; font-weight: 600; }
th:first-child, td:first-child { text-align: left; padding-left: 0; }
table:not(.values) td:not(:first-child) { white-space: nowrap; }
table.values th { width: 32%; font-weight: normal; color: #666; vertical-align: top; }
table.values td { text-align: left; overflow-wrap: anywhere; }
td.bar { width: 22%; padding-right: 0; }
td.bar i { display: block; height: 11px; background: #56b4e9; print-color-adjust: exact; -webkit-print-color-adjust: exact; }
figure { margin: 0 0 16px; }
figure svg { display: block; max-width: 100%; height: auto; }
figcaption { color: #666; font-size: 13px; padding-top: 4px; }
pre { margin: 0; padding: 12px; background: #f7f7f4; overflow-x: auto; font: 13px/1.45 "DejaVu Sans Mono", monospace; }
section > :last-child { margin-bottom: 0; }
@media print {
  body { background: #fff; font-size: 11pt; }
  main { max-width: none; padding: 0; }
  section { border: 0; padding: 0; }
  pre { white-space: pre-wrap; }
  figure, table, .highlights { break-inside: avoid; }
  h2 { break-after: avoid; }
}
)";

std::string element(const std::string& tag, const std::string& text) {
  return "<" + tag + ">" + escape_markup(text) + "</" + tag.substr(0, tag.find(' ')) + ">";
}

std::string to_html(const ReportTable& table) {
  HOLDFAST_CHECK(table.bars.empty() || table.bars.size() == table.rows.size(),
                 "table '" << table.caption << "' bars " << table.bars.size() << " rows " << table.rows.size());
  std::string html = "<table>\n";
  if (!table.caption.empty()) html += element("caption", table.caption) + '\n';
  html += "<thead><tr>";
  for (const std::string& name : table.header) html += element("th scope=\"col\"", name);
  if (!table.bars.empty()) html += "<th></th>";
  html += "</tr></thead>\n<tbody>\n";
  for (std::size_t row = 0; row < table.rows.size(); ++row) {
    const std::vector<std::string>& cells = table.rows[row];
    HOLDFAST_CHECK(cells.size() == table.header.size(), "table '" << table.caption << "' row " << row << " cells "
                                                                  << cells.size() << " header " << table.header.size());
    html += "<tr>";
    for (const std::string& cell : cells) html += element("td", cell);
    if (!table.bars.empty()) {
      const double percent = 100.0 * std::clamp(table.bars[row], 0.0, 1.0);
      html += "<td class=\"bar\"><i style=\"width:" + fixed_text(percent, 1) + "%\"></i></td>";
    }
    html += "</tr>\n";
  }
  return html + "</tbody>\n</table>\n";
}

std::string to_html(const ReportSection& section) {
  std::string html = "<section>\n";
  if (!section.heading.empty()) html += element("h2", section.heading) + '\n';
  if (!section.text.empty()) html += element("p", section.text) + '\n';
  if (!section.values.empty()) {
    html += "<table class=\"values\">\n<tbody>\n";
    for (const auto& [name, value] : section.values)
      html += "<tr>" + element("th scope=\"row\"", name) + element("td", value) + "</tr>\n";
    html += "</tbody>\n</table>\n";
  }
  for (const ReportTable& table : section.tables) html += to_html(table);
  for (const ReportFigure& figure : section.figures) {
    html += "<figure>\n" + figure.svg;
    if (!figure.caption.empty()) html += element("figcaption", figure.caption) + '\n';
    html += "</figure>\n";
  }
  if (!section.preformatted.empty()) html += element("pre", section.preformatted) + '\n';
  return html + "</section>\n";
}

}  // namespace

std::string to_html(const Report& report) {
  std::string html = "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n";
  html += "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n";
  html += element("title", report.title) + "\n<style>" + style + "</style>\n</head>\n<body>\n<main>\n";
  html += element("h1", report.title) + '\n';
  if (!report.subtitle.empty()) html += element("p class=\"subtitle\"", report.subtitle) + '\n';
  if (!report.highlights.empty()) {
    html += "<div class=\"highlights\">\n";
    for (const ReportHighlight& highlight : report.highlights)
      html +=
          std::string(highlight.is_alarming ? "<div class=\"highlight alarming\">" : "<div class=\"highlight\">") +
          element("b", highlight.value) + element("span", highlight.name) + "</div>\n";
    html += "</div>\n";
  }
  for (const ReportSection& section : report.sections) html += to_html(section);
  return html + "</main>\n</body>\n</html>\n";
}

}  // namespace holdfast
