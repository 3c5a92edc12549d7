// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/interfaces/segmenter.hpp"
#include "holdfast/plugin/plugin.hpp"

namespace {

struct Settings {
  int dilate = 5;
  static void describe(holdfast::ParameterTable<Settings>& table) {
    table.add("dilate", &Settings::dilate, "growth of the mask").range(0, 50).unit("px");
  }
};

class Segmenter final : public holdfast::Segmenter {
 public:
  Segmenter(const Settings& settings, const holdfast::CreationContext&)
      : classes_(static_cast<std::size_t>(settings.dilate), "class") {}
  const std::vector<std::string>& classes() const override { return classes_; }
  holdfast::Segmentation segment(const holdfast::SensorFrame&) override { return {}; }

 private:
  std::vector<std::string> classes_;
};

}  // namespace

HOLDFAST_PLUGIN(good, registry) {
  registry.add<holdfast::Segmenter, Segmenter, Settings>({.name = "good", .summary = "For the test of the loader."});
}
