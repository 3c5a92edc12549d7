// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "config/fake_registry.hpp"

namespace holdfast {
namespace {

using test::EverySettings;
using test::load;
using test::rest;
using ::testing::ElementsAre;

EverySettings settings(const Configuration& configuration) {
  return ParameterTable<EverySettings>().settings(configuration.features.values);
}
EverySettings orb(const std::string& parameters) {
  return settings(load(rest + "features: { orb: " + parameters + " }\n"));
}

TEST(ConfigurationValues, Defaults) {
  const Configuration configuration = load(rest + "features: orb\n");
  EXPECT_EQ(configuration.source.name, "tum");
  EXPECT_EQ(configuration.features.name, "orb");
  EXPECT_EQ(configuration.optimizer.name, "ceres");
  EXPECT_EQ(configuration.segmenter.name, "none");
  EXPECT_EQ(configuration.loop_detector.name, "none");
  EXPECT_TRUE(configuration.filters.empty());
  EXPECT_TRUE(configuration.observers.empty());
  EXPECT_FALSE(configuration.camera.has_value());
  EXPECT_EQ(configuration.run.mode, "sequential");
  EXPECT_EQ(configuration.run.seed, 1U);
  EXPECT_EQ(std::get<double>(configuration.sections.at("tracking").at("threshold")), 5.99);
  EXPECT_EQ(configuration.features.values.size(), 11U);
  EXPECT_EQ(settings(configuration).count, 1000);
}

TEST(ConfigurationValues, EveryType) {
  const EverySettings s =
      orb("{ flag: false, count: +60, big: 18000000000, scale: 2, ratio: 0.3, text: 12, colour: green, file: /x/../y, "
          "words: [1, 'a b', ''], numbers: [1, 2.5e-3], pairs: { b: 1, a: '2' } }");
  EXPECT_FALSE(s.flag);
  EXPECT_EQ(s.count, 60);
  EXPECT_EQ(s.big, 18000000000U);
  EXPECT_EQ(s.scale, 2.0);
  EXPECT_EQ(s.ratio, 0.3F);
  EXPECT_EQ(s.text, "12");
  EXPECT_EQ(s.colour, "green");
  EXPECT_EQ(s.file, "/y");
  EXPECT_THAT(s.words, ElementsAre("1", "a b", ""));
  EXPECT_THAT(s.numbers, ElementsAre(1.0, 2.5e-3));
  EXPECT_EQ(s.pairs, (TextMap{{"b", "1"}, {"a", "2"}}));
}

TEST(ConfigurationValues, ShorthandsAndChains) {
  const Configuration configuration = load(rest + R"(features: orb
filters:
  - semantic_mask
  - reprojection_error: { threshold: 3 }
  - reprojection_error
  - semantic_mask: {}
observers: [dump]
)");
  std::vector<std::string> names;
  for (const ModuleChoice& filter : configuration.filters) names.push_back(filter.name);
  EXPECT_THAT(names, ElementsAre("semantic_mask", "reprojection_error", "reprojection_error", "semantic_mask"));
  EXPECT_EQ(std::get<double>(configuration.filters[1].values.at("threshold")), 3.0);
  EXPECT_EQ(std::get<double>(configuration.filters[2].values.at("threshold")), 5.99);
  EXPECT_EQ(configuration.filters[1].location.line, 6);
  EXPECT_EQ(configuration.filters[1].location.column, 5);
  EXPECT_EQ(configuration.observers.at(0).name, "dump");
  EXPECT_TRUE(load(rest + "features: orb\nfilters:\n").filters.empty());
  EXPECT_TRUE(load(rest + "features: orb\nfilters: []\n").filters.empty());
}

TEST(ConfigurationValues, AliasesStandForWhatTheyName) {
  const Configuration configuration = load(rest + R"(features: orb
filters:
  - reprojection_error: &strict { threshold: 2 }
  - reprojection_error: *strict
tracking: *strict
)");
  EXPECT_EQ(std::get<double>(configuration.filters.at(1).values.at("threshold")), 2.0);
  EXPECT_EQ(std::get<double>(configuration.sections.at("tracking").at("threshold")), 2.0);
}

TEST(ConfigurationValues, Cameras) {
  const Configuration named = load(rest + "features: orb\ncamera: tum_fr3\n");
  EXPECT_EQ(named.camera, find_camera("tum_fr3"));
  const Configuration numbers = load(
      rest + "features: orb\ncamera: { width: 320, height: 240, fx: 260, fy: 261.5, cx: 160, cy: 120, k2: -0.5 }\n");
  ASSERT_TRUE(numbers.camera.has_value());
  EXPECT_EQ(numbers.camera->name, "");
  EXPECT_EQ(numbers.camera->width, 320);
  EXPECT_EQ(numbers.camera->height, 240);
  EXPECT_EQ(numbers.camera->fx, 260.0);
  EXPECT_EQ(numbers.camera->fy, 261.5);
  EXPECT_EQ(numbers.camera->cx, 160.0);
  EXPECT_EQ(numbers.camera->cy, 120.0);
  EXPECT_EQ(numbers.camera->distortion.k1, 0.0);
  EXPECT_EQ(numbers.camera->distortion.k2, -0.5);
  EXPECT_EQ(numbers.camera->baseline, 0.08);
}

TEST(ConfigurationValues, RelativePathsStartWhereTheFileStands) {
  const test::ScratchFolder folder;
  std::filesystem::create_directory(folder.path() / "sub");
  Registry registry = test::fake_registry();
  const auto file = folder.write("sub/c.yaml", "source: { tum: { path: ../data } }\noptimizer: ceres\nfeatures: orb\n");
  const auto path_of = [&](const std::vector<std::string>& overrides) {
    const Configuration configuration = load_configuration(file, overrides, registry, test::fake_sections());
    return std::get<std::string>(configuration.source.values.at("path"));
  };
  EXPECT_EQ(path_of({}), (folder.path() / "data").string());
  EXPECT_EQ(path_of({"source.tum.path=../data"}), (std::filesystem::current_path() / "../data").lexically_normal());
  EXPECT_EQ(path_of({"source.tum.path=/data"}), "/data");
  // An empty path stays empty: no file is given.
  EXPECT_EQ(orb("{ file: '' }").file, "");
}

/// What a configuration says, apart from where it was read.
void expect_same(const Configuration& a, const Configuration& b) {
  for (const auto choice : {&Configuration::source, &Configuration::features, &Configuration::segmenter,
                            &Configuration::optimizer, &Configuration::loop_detector}) {
    EXPECT_EQ((a.*choice).name, (b.*choice).name);
    EXPECT_EQ((a.*choice).values, (b.*choice).values);
  }
  for (const auto chain : {&Configuration::filters, &Configuration::observers}) {
    ASSERT_EQ((a.*chain).size(), (b.*chain).size());
    for (std::size_t i = 0; i < (a.*chain).size(); ++i) {
      EXPECT_EQ((a.*chain)[i].name, (b.*chain)[i].name);
      EXPECT_EQ((a.*chain)[i].values, (b.*chain)[i].values);
    }
  }
  EXPECT_EQ(a.sections, b.sections);
  EXPECT_EQ(a.run.mode, b.run.mode);
  EXPECT_EQ(a.run.seed, b.run.seed);
  EXPECT_EQ(a.plugins, b.plugins);
  ASSERT_EQ(a.camera.has_value(), b.camera.has_value());
  if (!a.camera) return;
  Camera unnamed = *a.camera;  // the resolved configuration gives numbers
  unnamed.name = b.camera->name;
  EXPECT_EQ(unnamed, *b.camera);
}

TEST(ResolvedConfiguration, LoadsAsWhatItWas) {
  const std::string chains =
      "filters: [ semantic_mask, reprojection_error: { threshold: 1e-7 } ]\nobservers: [ dump ]\n";
  const Configuration configuration =
      load(rest + chains +
           "features: { orb: { ratio: 0.7, scale: 1.2, big: 9223372036854775807, numbers: [0.1, 1e300, 3] } }\n" +
           "camera: tum_fr1\nrun: { seed: 42 }\ntracking: { threshold: 0.30000000000000004 }\n");
  const std::string yaml = to_yaml(configuration);
  const Configuration again = load(yaml);
  expect_same(configuration, again);
  EXPECT_EQ(settings(again).ratio, 0.7F);
  EXPECT_EQ(std::get<std::int64_t>(again.features.values.at("big")), std::numeric_limits<std::int64_t>::max());
  EXPECT_THAT(yaml, ::testing::HasSubstr("ratio: 0.7\n"));
  EXPECT_THAT(yaml, ::testing::HasSubstr("count: 1000\n"));
}

TEST(ResolvedConfiguration, FindsPluginsFromAnywhere) {
  // A plugin beside the configuration, named without a folder: elsewhere it would not be found under that name.
  const test::ScratchFolder folder;
  const auto file = folder.write("c.yaml", rest + "features: orb\nplugins: [ libtest_good_plugin.so ]\n");
  std::filesystem::copy_file(std::filesystem::path(HOLDFAST_TEST_PLUGINS) / "libtest_good_plugin.so",
                             folder.path() / "libtest_good_plugin.so");
  Registry registry = test::fake_registry();
  const Configuration configuration = load_configuration(file, {}, registry, test::fake_sections());
  EXPECT_THAT(configuration.plugins, ElementsAre((folder.path() / "libtest_good_plugin.so").string()));
  EXPECT_NE(registry.find("number", "given"), nullptr);
  EXPECT_EQ(load(to_yaml(configuration)).plugins, configuration.plugins);
}

TEST(ResolvedConfiguration, KeepsOddTexts) {
  const std::vector<std::string> odd = {
      "",      " ",    "true",        "12",           "1.5",      "null",   "~",      "a: b",   "- a",
      "#no",   "a #b", "'",           "\"",           "\\",       "a\nb",   "a\tb",   "\x01",   "\x7f",
      "{a}",   "[a]",  "a,b",         "*a",           "&a",       "!a",     "%a",     "@a",     "`a",
      "|",     ">",    "caf\xc3\xa9", "yes",          ".nan",     "0x10",   "end ",   " start", "?",
      "? a",   ":",    "a:",          "---",          "...",      "<<",     "=",      "1e3",    "\r\n",
      "a\\nb", "+1",   "C:\\x",       "\xe2\x80\xa8", "\xc2\x85", "a'b\"c", "\x1b[0m"};
  Configuration configuration = load(rest + "features: orb\n");
  for (const std::string& text : odd) {
    configuration.features.values["text"] = text;
    configuration.features.values["words"] = std::vector<std::string>{text, text};
    configuration.features.values["pairs"] = TextMap{{text, text}};
    if (!text.empty()) configuration.features.values["file"] = "/folder/" + text + "/x";
    const Configuration again = load(to_yaml(configuration));
    EXPECT_EQ(again.features.values.at("text"), configuration.features.values.at("text")) << text;
    EXPECT_EQ(again.features.values.at("words"), configuration.features.values.at("words")) << text;
    EXPECT_EQ(again.features.values.at("pairs"), configuration.features.values.at("pairs")) << text;
    EXPECT_EQ(again.features.values.at("file"), configuration.features.values.at("file")) << text;
  }
  configuration.features.values["words"] = std::vector<std::string>{};
  configuration.features.values["numbers"] = std::vector<double>{};
  configuration.features.values["pairs"] = TextMap{};
  expect_same(configuration, load(to_yaml(configuration)));
}

}  // namespace
}  // namespace holdfast
