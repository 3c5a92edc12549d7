// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/bench/report_page.hpp"

#include <span>
#include <string>
#include <string_view>

#include "holdfast/core/embedded_page.hpp"
#include "holdfast/evaluation/number_text.hpp"

namespace holdfast {

std::span<const EmbeddedFile> embedded_report_page();

namespace {

std::string replaced(std::string_view text, std::string_view what, std::string_view by) {
  std::string result;
  for (std::size_t at; (at = text.find(what)) != std::string_view::npos; text.remove_prefix(at + what.size()))
    result.append(text.substr(0, at)).append(by);
  return result.append(text);
}

/// JSON that no name can break out of a script element with.
std::string json_in_script(const std::string& json) { return replaced(json, "<", "\\u003c"); }

}  // namespace

std::string report_page(const std::string& title, const std::string& results, const std::string& tracks) {
  return embedded_page(
      embedded_report_page(), "page.html",
      {{"title", escape_markup(title)}, {"results", json_in_script(results)}, {"tracks", json_in_script(tracks)}});
}

}  // namespace holdfast
