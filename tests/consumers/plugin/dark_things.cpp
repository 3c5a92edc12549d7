// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/interfaces/segmenter.hpp"
#include "holdfast/plugin/plugin.hpp"

#include <opencv2/core/mat.hpp>

namespace {

struct DarkThingsSettings {
  int brightness = 60;

  static void describe(holdfast::ParameterTable<DarkThingsSettings>& table) {
    table.add("brightness", &DarkThingsSettings::brightness, "of the green channel, below which a pixel is dark")
        .range(1, 255);
  }
};

/// Finds whatever is dark.
class DarkThings final : public holdfast::Segmenter {
 public:
  DarkThings(const DarkThingsSettings& settings, const holdfast::CreationContext&) : settings_(settings) {}

  const std::vector<std::string>& classes() const override { return classes_; }
  holdfast::Segmentation segment(const holdfast::SensorFrame& frame) override {
    holdfast::Segmentation result{cv::Mat(frame.colour.size(), CV_8UC1), {}};
    for (int y = 0; y < frame.colour.rows; ++y)
      for (int x = 0; x < frame.colour.cols; ++x)
        result.labels.at<unsigned char>(y, x) = frame.colour.at<cv::Vec3b>(y, x)[1] < settings_.brightness ? 1 : 0;
    return result;
  }

 private:
  DarkThingsSettings settings_;
  std::vector<std::string> classes_{"bright", "dark"};
};

}  // namespace

HOLDFAST_PLUGIN(dark_things, registry) {
  registry.add<holdfast::Segmenter, DarkThings, DarkThingsSettings>(
      {.name = "dark_things", .summary = "Finds whatever is dark."});
}
