// SPDX-License-Identifier: BSD-3-Clause
#include <opencv2/core.hpp>

#include "holdfast/interfaces/dynamic_filter.hpp"
#include "holdfast/plugin/plugin.hpp"

struct DepthEdgeSettings {
  double step = 0.3;
  static void describe(holdfast::ParameterTable<DepthEdgeSettings>& table) {
    table.add("step", &DepthEdgeSettings::step, "depth difference to a nearer surface").range(0.01, 5).unit("m");
  }
};

struct DepthEdge final : holdfast::DynamicFilter {
  DepthEdge(const DepthEdgeSettings& settings, const holdfast::CreationContext&) : step(settings.step) {}
  holdfast::Needs needs() const override { return {.depth = true}; }

  void apply(const holdfast::FilterContext& context, holdfast::StaticEvidence& evidence) override {
    const cv::Mat& depth = context.sensor_frame.depth;
    const holdfast::Frame& frame = context.frame;
    for (std::size_t i = 0; i < frame.size(); ++i) {
      const cv::Point pixel(cv::Point2f(frame.features.x[i], frame.features.y[i]));  // of the raw image
      const cv::Rect around(pixel - cv::Point(6, 6), cv::Size(13, 13));
      const cv::Mat window = depth(around & cv::Rect(cv::Point(), depth.size()));
      double nearest = 0;
      cv::minMaxLoc(window, &nearest, nullptr, nullptr, nullptr, window > 0);
      // A feature without depth has depth 0, which is never behind another surface.
      if (frame.depth[i] - nearest > step) evidence.add(i, -1.5F, holdfast::StaticEvidence::Kind::prior);
    }
  }
  double step;
};

HOLDFAST_PLUGIN(depth_edge, registry) {
  registry.add<holdfast::DynamicFilter, DepthEdge, DepthEdgeSettings>(
      {.name = "depth_edge", .summary = "Prior against features behind an edge of the depth image."});
}
