// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <span>
#include <string>
#include <string_view>

#include "holdfast/core/check.hpp"
#include "holdfast/core/embedded_file.hpp"

namespace holdfast {

/// The content of the embedded file of that name. Throws CheckError if there is none.
inline std::string_view embedded_part(std::span<const EmbeddedFile> files, std::string_view name) {
  for (const EmbeddedFile& file : files)
    if (file.name == name) return file.content;
  HOLDFAST_CHECK(false, "no part '" << name << "' of the page");
  return {};
}

/// Expands the file `name`: each {{KEY}} is replaced by the text of that key, or else by the embedded file of that
/// name. Replacements are not expanded again.
inline std::string embedded_page(std::span<const EmbeddedFile> files, std::string_view name,
                                 const std::map<std::string, std::string, std::less<>>& texts = {}) {
  std::string page;
  std::string_view rest = embedded_part(files, name);
  for (std::size_t at; (at = rest.find("{{")) != std::string_view::npos;) {
    const std::size_t end = rest.find("}}", at);
    const std::string_view key = rest.substr(at + 2, end - at - 2);
    const auto text = texts.find(key);
    page.append(rest.substr(0, at)).append(text != texts.end() ? text->second : embedded_part(files, key));
    rest.remove_prefix(end + 2);
  }
  return page.append(rest);
}

}  // namespace holdfast
