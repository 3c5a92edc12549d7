// SPDX-License-Identifier: BSD-3-Clause
// What the suite quotes stands in the headers, and what it checks stands in its page.
#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <set>
#include <sstream>

#include "holdfast/conformance/suite.hpp"

namespace holdfast::conformance {
namespace {

std::string read(const std::string& file) {
  std::ostringstream text;
  text << std::ifstream(std::string(HOLDFAST_SOURCE_DIR) + "/" + file).rdbuf();
  return text.str();
}

/// The text without marks of comments, every gap being one space.
std::string flat(const std::string& text) {
  std::istringstream words(text);
  std::string result;
  for (std::string word; words >> word;)
    if (word != "///" && word != "///<" && word != "//") result += word + " ";
  return result;
}

TEST(Catalogue, EveryPromiseStandsInItsHeader) {
  std::map<std::string, std::string> headers;
  for (const CheckDescription& check : catalogue()) {
    std::string& text = headers[check.promise.header];
    if (text.empty()) text = flat(read(std::string("include/") + check.promise.header));
    EXPECT_NE(text.find(flat(check.promise.sentence)), std::string::npos)
        << check.kind << "." << check.name << " holds modules to what " << check.promise.header
        << " does not say: " << check.promise.sentence;
  }
}

TEST(Catalogue, EveryCheckHasItsLineInThePage) {
  const std::string page = read("docs/conformance.md");
  for (const CheckDescription& check : catalogue())
    EXPECT_NE(page.find("| `" + check.name + "` |"), std::string::npos) << check.kind << "." << check.name;
}

TEST(Catalogue, ChecksOfAKindDifferInName) {
  std::set<std::pair<std::string, std::string>> names;
  for (const CheckDescription& check : catalogue())
    EXPECT_TRUE(names.insert({check.kind, check.name}).second) << check.kind << "." << check.name;
  EXPECT_GT(names.size(), 60U);
}

}  // namespace
}  // namespace holdfast::conformance
