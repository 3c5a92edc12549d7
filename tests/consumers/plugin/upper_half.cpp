// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/interfaces/dynamic_filter.hpp"
#include "holdfast/plugin/plugin.hpp"

namespace {

struct UpperHalfSettings {
  double log_odds = -2.0;

  static void describe(holdfast::ParameterTable<UpperHalfSettings>& table) {
    table.add("log_odds", &UpperHalfSettings::log_odds, "said about every feature in the upper half").range(-10, 10);
  }
};

/// Takes whatever is above the middle of the image for moving.
class UpperHalf final : public holdfast::DynamicFilter {
 public:
  UpperHalf(const UpperHalfSettings& settings, const holdfast::CreationContext& context)
      : log_odds_(static_cast<float>(settings.log_odds)), middle_(0.5F * static_cast<float>(context.camera.height)) {}

  holdfast::Needs needs() const override { return {}; }
  void apply(const holdfast::FilterContext& context, holdfast::StaticEvidence& evidence) override {
    for (std::size_t i = 0; i < context.frame.size(); ++i)
      if (context.frame.y[i] < middle_) evidence.add(i, log_odds_);
  }

 private:
  float log_odds_;
  float middle_;
};

}  // namespace

HOLDFAST_PLUGIN(upper_half, registry) {
  registry.add<holdfast::DynamicFilter, UpperHalf, UpperHalfSettings>(
      {.name = "upper_half", .summary = "Takes whatever is above the middle of the image for moving."});
}
