// SPDX-License-Identifier: BSD-3-Clause
#include <cctype>

#include "holdfast/bench/paper_tables.hpp"
#include "holdfast/bench/tables.hpp"

namespace holdfast {

std::string latex_text(const std::string& text) {
  std::string result;
  for (const char c : text) {
    switch (c) {
      case '\\':
        result += "\\textbackslash{}";
        break;
      case '~':
        result += "\\textasciitilde{}";
        break;
      case '^':
        result += "\\textasciicircum{}";
        break;
      case '&':
      case '%':
      case '$':
      case '#':
      case '_':
      case '{':
      case '}':
        (result += '\\') += c;
        break;
      default:
        result += static_cast<unsigned char>(c) < 0x20 || c == 0x7f ? ' ' : c;
    }
  }
  return result;
}

namespace {

std::string latex_cell(const PaperTable::Cell& cell) {
  std::string text = cell.text == "-" ? "--" : latex_text(cell.text);
  const bool is_negative = text.size() > 1 && text[0] == '-' && std::isdigit(static_cast<unsigned char>(text[1])) != 0;
  if (is_negative) text.replace(0, 1, "$-$");  // outside mathematics it would be a hyphen
  return (cell.is_best ? "\\textbf{" + text + "}" : text) + (cell.is_short ? "*" : "");
}

}  // namespace

std::string to_latex(const PaperTable& table) {
  std::string text = "% \\usepackage{booktabs}\n\\begin{table}\n\\centering\n\\caption{" + latex_text(table.caption) +
                     "}\n\\label{tab:" + table.name + "}\n\\begin{tabular}{" + std::string(table.text_columns, 'l') +
                     std::string(table.header.size() - table.text_columns, 'r') + "}\n\\toprule\n";
  for (std::size_t i = 0; i < table.header.size(); ++i) text += (i == 0 ? "" : " & ") + latex_text(table.header[i]);
  text += " \\\\\n\\midrule\n";
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    if (table.rows[i].begins_group && i > 0) text += "\\midrule\n";
    for (std::size_t c = 0; c < table.rows[i].cells.size(); ++c)
      text += (c == 0 ? "" : " & ") + latex_cell(table.rows[i].cells[c]);
    text += " \\\\\n";
  }
  text += "\\bottomrule\n\\end{tabular}\n";
  for (std::size_t i = 0; i < table.notes.size(); ++i)
    text += (i == 0 ? "\n\\smallskip\n" : "\\\\\n") + ("\\footnotesize " + latex_text(table.notes[i]));
  return text + (table.notes.empty() ? "" : "\n") + "\\end{table}\n";
}

std::string to_markdown(const PaperTable& table) {
  ReportTable plain{"", table.header, {}, {}};
  for (const PaperTable::Row& row : table.rows) {
    std::vector<std::string> cells;
    for (const PaperTable::Cell& cell : row.cells)
      cells.push_back((cell.is_best ? "**" + cell.text + "**" : cell.text) + (cell.is_short ? "\\*" : ""));
    plain.rows.push_back(std::move(cells));
  }
  std::string text = "**" + markdown_text(table.caption) + "**\n\n" + to_markdown(plain);
  for (const std::string& note : table.notes)
    text += "\n" + std::string(note.starts_with("*") ? "\\" : "") + markdown_text(note) + "\n";
  return text;
}

}  // namespace holdfast
