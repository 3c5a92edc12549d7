// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/interfaces/segmenter.hpp"
#include "holdfast/plugin/plugin.hpp"

struct InFrontSettings {
  double distance = 1.8;
  static void describe(holdfast::ParameterTable<InFrontSettings>& table) {
    table.add("distance", &InFrontSettings::distance, "nearer pixels are labelled as person").range(0.1, 10).unit("m");
  }
};

struct InFront final : holdfast::Segmenter {
  InFront(const InFrontSettings& settings, const holdfast::CreationContext&) : distance(settings.distance) {}

  const std::vector<std::string>& classes() const override { return names; }

  holdfast::Segmentation segment(const holdfast::SensorFrame& frame) override {
    holdfast::Segmentation result;
    if (frame.depth.empty()) return result;                             // no segmentation for this frame
    const cv::Mat near = (frame.depth > 0) & (frame.depth < distance);  // 255 for near pixels, else 0
    result.labels = near / 255;                                         // 8UC1, index into classes()
    return result;
  }

  double distance;
  std::vector<std::string> names{"background", "person"};
};

HOLDFAST_PLUGIN(in_front, registry) {
  registry.add<holdfast::Segmenter, InFront, InFrontSettings>(
      {.name = "in_front", .summary = "Labels near pixels as person."});
}
