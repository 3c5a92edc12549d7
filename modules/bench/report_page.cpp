// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/bench/report_page.hpp"

#include <span>
#include <string_view>

#include "holdfast/core/embedded_file.hpp"
#include "holdfast/core/error.hpp"
#include "holdfast/evaluation/number_text.hpp"

namespace holdfast {

std::span<const EmbeddedFile> embedded_report_page();

namespace {

std::string_view part(std::string_view name) {
  for (const EmbeddedFile& file : embedded_report_page())
    if (file.name == name) return file.content;
  HOLDFAST_CHECK(false, "no part '" << name << "' of the report page");
}

std::string replaced(std::string_view text, std::string_view what, std::string_view by) {
  std::string result;
  for (std::size_t at; (at = text.find(what)) != std::string_view::npos; text.remove_prefix(at + what.size()))
    result.append(text.substr(0, at)).append(by);
  return result.append(text);
}

/// JSON that no name can break out of a script element with.
std::string json_in_script(const std::string& json) { return replaced(json, "<", "\\u003c"); }

/// What a line {{KEY}} of the template stands for.
std::string filling(std::string_view key, const std::string& title, const std::string& results,
                    const std::string& tracks) {
  if (key == "title") return escape_markup(title);
  if (key == "results") return json_in_script(results);
  if (key == "tracks") return json_in_script(tracks);
  return std::string(part(key));
}

}  // namespace

std::string report_page(const std::string& title, const std::string& results, const std::string& tracks) {
  std::string page;
  std::string_view rest = part("page.html");
  for (std::size_t at; (at = rest.find("{{")) != std::string_view::npos;) {
    const std::size_t end = rest.find("}}", at);
    page.append(rest.substr(0, at)).append(filling(rest.substr(at + 2, end - at - 2), title, results, tracks));
    rest.remove_prefix(end + 2);
  }
  return page.append(rest);
}

}  // namespace holdfast
