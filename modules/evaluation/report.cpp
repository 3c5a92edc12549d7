// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/evaluation/report.hpp"

#include <algorithm>
#include <span>

#include "holdfast/core/embedded_file.hpp"
#include "holdfast/core/error.hpp"
#include "holdfast/evaluation/number_text.hpp"

namespace holdfast {

std::span<const EmbeddedFile> embedded_report_style();
std::span<const EmbeddedFile> embedded_report_script();
std::span<const EmbeddedFile> embedded_report_clip_script();

namespace {

std::string joined(std::span<const EmbeddedFile> files) {
  std::string text;
  for (const EmbeddedFile& file : files) text += file.content;
  return text;
}

std::string element(const std::string& tag, const std::string& text) {
  return "<" + tag + ">" + escape_markup(text) + "</" + tag.substr(0, tag.find(' ')) + ">";
}

std::string to_html(const ReportTable& table) {
  HOLDFAST_CHECK(table.bars.empty() || table.bars.size() == table.rows.size(),
                 "table '" << table.caption << "' bars " << table.bars.size() << " rows " << table.rows.size());
  std::string html = "<div class=\"scroll\"><table>\n";
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
  return html + "</tbody>\n</table></div>\n";
}

std::string lines_of(const std::vector<std::string>& texts) {
  std::string lines;
  for (const std::string& text : texts) lines += (lines.empty() ? "" : "\n") + text;
  return lines;
}

/// The first picture and a player, which is hidden until its script runs.
std::string to_html(const ReportClip& clip) {
  HOLDFAST_CHECK(!clip.pictures.empty() && clip.names.size() == clip.pictures.size() && clip.interval > 0.0,
                 "clip '" << clip.caption << "' pictures " << clip.pictures.size() << " names " << clip.names.size()
                          << " interval " << clip.interval);
  std::string html = "<figure class=\"clip\" data-interval=\"" + shortest_text(clip.interval) + "\" data-pictures=\"" +
                     escape_markup(lines_of(clip.pictures)) + "\" data-names=\"" + escape_markup(lines_of(clip.names)) +
                     "\">\n<img src=\"" + escape_markup(clip.pictures.front()) + "\" alt=\"" +
                     escape_markup(clip.names.front()) + "\">\n";
  html += "<div class=\"player\" hidden><button type=\"button\">Play</button><input type=\"range\" min=\"0\" max=\"" +
          std::to_string(clip.pictures.size() - 1) + "\" value=\"0\" aria-label=\"Picture\"><output></output></div>\n";
  if (!clip.caption.empty()) html += element("figcaption", clip.caption) + '\n';
  return html + "</figure>\n";
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
  for (const ReportClip& clip : section.clips) html += to_html(clip);
  if (!section.preformatted.empty()) html += element("pre", section.preformatted) + '\n';
  return html + "</section>\n";
}

}  // namespace

std::string to_html(const Report& report) {
  std::string html = "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n";
  html += "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n";
  html += element("title", report.title) + "\n<style>" + joined(embedded_report_style()) + "</style>\n<script>\n" +
          joined(embedded_report_script()) + "</script>\n</head>\n<body>\n<main>\n";
  html += "<header>" + element("h1", report.title) + "<span data-theme></span></header>\n";
  if (!report.subtitle.empty()) html += element("p class=\"subtitle\"", report.subtitle) + '\n';
  if (!report.highlights.empty()) {
    html += "<div class=\"highlights\">\n";
    for (const ReportHighlight& highlight : report.highlights)
      html += std::string(highlight.is_alarming ? "<div class=\"highlight alarming\">" : "<div class=\"highlight\">") +
              element("b", highlight.value) + element("span", highlight.name) + "</div>\n";
    html += "</div>\n";
  }
  for (const ReportSection& section : report.sections) html += to_html(section);
  if (std::any_of(report.sections.begin(), report.sections.end(), [](const auto& s) { return !s.clips.empty(); }))
    html += "<script>\n" + joined(embedded_report_clip_script()) + "</script>\n";
  return html + "</main>\n</body>\n</html>\n";
}

}  // namespace holdfast
