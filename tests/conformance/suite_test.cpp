// SPDX-License-Identifier: BSD-3-Clause
// What add_tests() says of a plugin, modules or parameters that cannot be tested. What it adds is seen by
// bad_modules_test.cpp: tests can only be added before they run.
#include "holdfast/conformance/suite.hpp"

#include <gmock/gmock.h>

#include "holdfast/core/error.hpp"
#include "holdfast/interfaces/observer.hpp"
#include "holdfast/interfaces/segmenter.hpp"

namespace holdfast::conformance {
namespace {

using testing::AllOf;
using testing::HasSubstr;

struct Settings {
  int dilate = 3;
  static void describe(ParameterTable<Settings>& table) {
    table.add("dilate", &Settings::dilate, "growth").range(0, 9);
  }
};

void register_one(Registry& registry) {
  registry.add<Segmenter, Settings>({.name = "mine", .summary = "One."}, [](const Settings&, const CreationContext&) {
    return std::make_unique<NullSegmenter>();
  });
}

void register_nothing(Registry&) {}

std::string refusal(const Subject& subject) {
  try {
    add_tests(subject);
  } catch (const Error& error) {
    return error.what();
  }
  return "added";
}

TEST(AddTests, NamesThePlaceOfEveryMistakeInTheParameters) {
  Subject subject{.register_modules = register_one};
  subject.parameters = "segmenter:\n  mine: { dilat: 3, dilate: 40 }\n  yours: {}\nsegmenters: {}\n";
  EXPECT_THAT(refusal(subject),
              AllOf(HasSubstr("PARAMETERS:2"), HasSubstr("did you mean 'dilate'"), HasSubstr("40 is above 9"),
                    HasSubstr("PARAMETERS:3"), HasSubstr("no segmenter module 'yours'"), HasSubstr("PARAMETERS:4"),
                    HasSubstr("did you mean 'segmenter'")));
  subject.parameters = "segmenter: mine";
  EXPECT_THAT(refusal(subject), HasSubstr("expected modules with their parameters"));
}

TEST(AddTests, NamesTheModulesThereAre) {
  EXPECT_THAT(refusal({.register_modules = register_one, .modules = {"mnie"}}), HasSubstr("no module 'mnie'"));
  EXPECT_THAT(refusal({.register_modules = register_one, .except = {"segmenter/yours"}}),
              HasSubstr("no module 'segmenter/yours'"));
}

TEST(AddTests, RefusesAPluginWithoutAnythingToTest) {
  EXPECT_THAT(refusal({.register_modules = register_nothing}),
              AllOf(HasSubstr("no module that can be tested"), HasSubstr("segmenter")));
  EXPECT_THAT(refusal({.plugin = "/nowhere/libabsent.so"}), HasSubstr("there is no such file"));
}

}  // namespace
}  // namespace holdfast::conformance
