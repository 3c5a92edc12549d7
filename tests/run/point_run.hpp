// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <utility>

#include "holdfast/core/error.hpp"
#include "holdfast/pipeline/pipeline_builder.hpp"
#include "holdfast/run/run.hpp"
#include "holdfast/settings/ceres.hpp"
#include "support/point_world.hpp"

extern "C" void holdfast_register_plugin_ceres(holdfast::Registry&);

namespace holdfast::test {

/// A source of 30 frames of a PointWorld with their true poses. It throws instead of giving frame `bad`.
class PointSource final : public FrameSource {
 public:
  static constexpr std::uint64_t frame_count = 30;
  explicit PointSource(PointWorld& world, std::uint64_t bad = frame_count) : world_(world), bad_(bad) {}
  SourceDescription describe() const override {
    SourceDescription description;
    description.name = "points";
    description.has_depth = true;
    description.frame_count = frame_count;
    description.camera = world_.camera();
    return description;
  }
  std::optional<SensorFrame> next() override {
    if (index_ == frame_count) return std::nullopt;
    if (index_ == bad_) throw InputError({"frame.png"}, "is broken");
    const std::uint64_t index = index_++;
    return world_.frame(index, time_of(index), path_pose(time_of(index)));
  }
  Trajectory truth() const override {
    Trajectory truth;
    for (std::uint64_t i = 0; i < frame_count; ++i) truth.push_back({time_of(i), path_pose(time_of(i))});
    return truth;
  }
  /// What is known before the first frame, and what the frames show.
  Warnings warnings() const override {
    Warnings warnings = {{{"points.txt", 3}, "holds few points"}};
    if (index_ > 0) warnings.push_back({{}, "all frames look alike"});
    return warnings;
  }

 private:
  static double time_of(std::uint64_t index) { return static_cast<double>(index) / 30.0; }

  PointWorld& world_;
  std::uint64_t bad_;
  std::uint64_t index_ = 0;
};

/// A pipeline over a PointSource, with exact features.
struct PointRun {
  explicit PointRun(std::uint64_t bad = PointSource::frame_count) {
    auto source = std::make_unique<PointSource>(world, bad);
    built = std::make_unique<BuiltPipeline>(BuiltPipeline{std::move(source), builder().build()});
    configuration.file = "points.yaml";
    configuration.run.seed = 7;
    configuration.loop_detector.name = "none";
  }

  PipelineBuilder builder() {
    Registry registry;
    holdfast_register_plugin_ceres(registry);
    PipelineBuilder begun(std::move(registry));
    begun.source(PointSource(world).describe())
        .features(std::make_unique<PointExtractor>(world, 0.3))
        .optimizer(CeresSettings{});
    return begun;
  }

  PointWorld world{find_camera("tum_fr1").value()};
  std::unique_ptr<BuiltPipeline> built;
  Configuration configuration;
};

}  // namespace holdfast::test
