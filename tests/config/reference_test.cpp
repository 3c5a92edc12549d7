// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/config/reference.hpp"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "fixture.hpp"

namespace holdfast {
namespace {

using testing::HasSubstr;

std::string reference_of(const std::string& name, ReferenceFormat format) {
  return reference(test::test_registry(), test::test_sections(), name, format);
}

TEST(Reference, TextListsEverything) {
  const std::string text = reference_of("", ReferenceFormat::text);
  for (const std::string name : {"tum", "opencv_orb", "semantic_mask", "ceres", "camera", "tracking", "run"})
    EXPECT_THAT(text, HasSubstr("\n  " + name + " ")) << name;
}

TEST(Reference, MarksWhatIsNotInThisBuild) {
  Registry registry = test::test_registry();
  registry.add_left_out("features", "sift", "HOLDFAST_PLUGIN_SIFT");
  registry.add_left_out("observers", "overlay", "HOLDFAST_PLUGIN_OVERLAY");  // the only one of its kind here
  registry.add_unusable("features", "orb", "its library is not there");
  const auto text_of = [&](const std::string& name, ReferenceFormat format = ReferenceFormat::text) {
    return reference(registry, test::test_sections(), name, format);
  };
  EXPECT_THAT(text_of(""), testing::AllOf(HasSubstr("  orb                 [not in this build] Summary of orb."),
                                          HasSubstr("  sift                [not in this build] "),
                                          HasSubstr("\nobservers:\n  overlay             [not in this build] "),
                                          HasSubstr("  opencv_orb          Summary of opencv_orb.")));
  EXPECT_THAT(text_of("orb"), HasSubstr("Not in this build: its library is not there\n"));
  EXPECT_THAT(text_of("sift"), HasSubstr("configure Holdfast with -DHOLDFAST_PLUGIN_SIFT=ON\n"));
  const auto json = nlohmann::json::parse(text_of("features", ReferenceFormat::json));
  for (const auto& entry : json) EXPECT_EQ(entry.at("in_this_build"), entry.at("name") == "opencv_orb") << entry;
}

TEST(Reference, TextOfOneModuleShowsItsTable) {
  const std::string text = reference_of("orb", ReferenceFormat::text);
  EXPECT_THAT(text, HasSubstr("Summary of orb."));
  EXPECT_THAT(text, HasSubstr("Paper: A paper"));
  EXPECT_THAT(text, HasSubstr("count   integer, default 1000, from 50 to 20000"));
  EXPECT_THAT(text, HasSubstr("tree | grid"));
  EXPECT_THAT(text, testing::Not(HasSubstr("opencv_orb")));
}

TEST(Reference, MarkdownHasOneRowPerParameter) {
  const std::string text = reference_of("", ReferenceFormat::markdown);
  EXPECT_THAT(text, HasSubstr("| `count` | integer | 1000 | from 50 to 20000 |  | features to keep |\n"));
  EXPECT_THAT(text, HasSubstr("| `spread` | text | tree | tree \\| grid |  | how |\n"));
  EXPECT_THAT(text, HasSubstr("| `window` | real | 15.0 | from 1 to 200 | px | search radius |\n"));
  EXPECT_THAT(text, HasSubstr("| `path` | path | required |"));
}

TEST(Reference, MarkdownOfEverythingIsAPageWithContents) {
  const std::string page = reference_of("", ReferenceFormat::markdown),
                    part = reference_of("orb", ReferenceFormat::markdown);
  EXPECT_EQ(page.rfind("# Configuration reference\n", 0), 0U);
  EXPECT_THAT(page,
              testing::AllOf(HasSubstr("\n| [`features`](#features) | [`opencv_orb`](#opencv_orb), [`orb`](#orb)"),
                             HasSubstr("| [Plain sections](#plain-sections) | [`camera`](#camera), ")));
  EXPECT_EQ(part.rfind("## `features`\n", 0), 0U);
}

TEST(Reference, ContentsTellModulesOfOneNameApart) {
  EXPECT_THAT(reference_of("", ReferenceFormat::markdown),
              testing::AllOf(HasSubstr("(#loop_detector) | [`none`](#none) |"),
                             HasSubstr("(#segmenter) | [`none`](#none-1) |")));
}

TEST(Reference, WritesRangesOfLargeNumbersInFull) {
  Parameter parameter;
  EXPECT_EQ(parameter.range(1, 1e5).range_text(), "from 1 to 100000");
  EXPECT_EQ(parameter.range(1e-12, 0.5).range_text(), "from 1e-12 to 0.5");
}

TEST(Reference, JsonHoldsTheTable) {
  const auto all = nlohmann::json::parse(reference_of("orb", ReferenceFormat::json));
  ASSERT_EQ(all.size(), 1U);
  EXPECT_EQ(all[0]["kind"], "features");
  const auto& count = all[0]["parameters"][0];
  EXPECT_EQ(count["name"], "count");
  EXPECT_EQ(count["default"], 1000);
  EXPECT_EQ(count["minimum"], 50);
}

TEST(Reference, JsonReplacesBytesThatAreNotUtf8) {
  Registry registry;
  registry.add<Segmenter, NoSettings>({.name = "strange", .summary = "A caf\xe9.", .paper = ""},
                                      [](const NoSettings&, const CreationContext&) { return nullptr; });
  const auto all = nlohmann::json::parse(reference(registry, {}, "strange", ReferenceFormat::json));
  EXPECT_EQ(all[0]["summary"], "A caf\xef\xbf\xbd.");
}

TEST(Reference, ListsTheSectionsOfSceneFilesUnderTheirOwnHeading) {
  std::vector<SectionDescription> sections = test::test_sections();
  for (const char* name : {"scene", "scene.people.do.walk"})
    sections.push_back(
        {name, std::string("About ") + name + ".", ParameterTable<test::TrackingSettings>().parameters(), "scene"});
  const Registry registry = test::test_registry();
  const auto of = [&](const char* name, ReferenceFormat format) { return reference(registry, sections, name, format); };

  EXPECT_THAT(of("", ReferenceFormat::text),
              testing::AllOf(HasSubstr("\nscene:\n  scene "), HasSubstr("\n  scene.people.do.walk ")));
  EXPECT_THAT(of("scene", ReferenceFormat::text),
              testing::AllOf(HasSubstr("About scene."), HasSubstr("About scene.people.do.walk."), HasSubstr("window"),
                             testing::Not(HasSubstr("Licence")), testing::Not(HasSubstr("How frames are followed"))));
  EXPECT_THAT(of("scene.people.do.walk", ReferenceFormat::text),
              testing::AllOf(HasSubstr("scene.people.do.walk"), testing::Not(HasSubstr("About scene.\n"))));
  const std::string markdown = of("", ReferenceFormat::markdown);
  EXPECT_THAT(markdown, testing::AllOf(HasSubstr("\n## Scene files\n"), HasSubstr("\n### `scene`\n\nAbout scene.\n"),
                                       HasSubstr("\n### `scene.people.do.walk`\n")));
  EXPECT_LT(markdown.find("### `tracking`"), markdown.find("## Scene files"));
}

TEST(Reference, SuggestsAName) {
  try {
    reference_of("opencv_obr", ReferenceFormat::text);
    FAIL() << "an unknown name was accepted";
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(), "there is no module or section 'opencv_obr'; did you mean 'opencv_orb'?");
  }
}

}  // namespace
}  // namespace holdfast
