// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/plugin/plugin.hpp"
#include "plugin/number.hpp"

namespace {

struct Settings {
  double number = 1.5;
  static void describe(holdfast::ParameterTable<Settings>& table) {
    table.add("number", &Settings::number, "what it gives").range(0, 10);
  }
};

class Given final : public holdfast::test::Number {
 public:
  Given(const Settings& settings, const holdfast::CreationContext& context)
      : number_(settings.number + static_cast<double>(context.seed)) {}
  double number() const override { return number_; }

 private:
  double number_;
};

}  // namespace

HOLDFAST_PLUGIN(good, registry) {
  registry.add<holdfast::test::Number, Given, Settings>({.name = "given", .summary = "Gives a number."});
}
