// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/interfaces/dynamic_filter.hpp"
#include "holdfast/plugin/plugin.hpp"

namespace {

struct NearnessSettings {
  double distance = 0.5;
  double log_odds = -2.0;

  static void describe(holdfast::ParameterTable<NearnessSettings>& table) {
    table.add("distance", &NearnessSettings::distance, "features nearer than this are suspect").range(0, 10).unit("m");
    table.add("log_odds", &NearnessSettings::log_odds, "evidence added to a suspect feature").range(-10, 0);
  }
};

class Nearness final : public holdfast::DynamicFilter {
 public:
  Nearness(const NearnessSettings& settings, const holdfast::CreationContext&) : settings_(settings) {}

  holdfast::Needs needs() const override { return {.depth = true}; }

  void apply(const holdfast::FilterContext& context, holdfast::StaticEvidence& evidence) override {
    for (std::size_t i = 0; i < context.frame.size(); ++i)
      if (context.frame.has_depth(i) && context.frame.depth[i] < settings_.distance)
        evidence.add(i, static_cast<float>(settings_.log_odds), holdfast::StaticEvidence::Kind::prior);
  }

 private:
  NearnessSettings settings_;
};

}  // namespace

HOLDFAST_PLUGIN(nearness, registry) {
  registry.add<holdfast::DynamicFilter, Nearness, NearnessSettings>(
      {.name = "nearness", .summary = "Distrusts features very near to the camera."});
}
