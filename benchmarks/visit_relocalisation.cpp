// SPDX-License-Identifier: BSD-3-Clause
// Relocalisation on a second visit to a room that changed, by descriptors alone and with classes:
//
//     visit_relocalisation SEGMENTER WEIGHTS STRIDE FIRST SECOND [FIRST SECOND]...
//
// SEGMENTER, WEIGHTS, FIRST, SECOND: as place_changes. A run over FIRST makes the map. Every STRIDE frames of SECOND
// the camera is switched on anew: it sees six frames and knows nothing but the map. It is located when one of them has
// a pose; right within 0.15 m and 5 degrees of the truth, wrong otherwise.
#include <cmath>
#include <cstdio>
#include <exception>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "class_weights.hpp"
#include "holdfast/config/configuration.hpp"
#include "holdfast/geometry/so3.hpp"
#include "holdfast/pipeline/pipeline_builder.hpp"
#include "holdfast/plugin/builtin.hpp"
#include "holdfast/run/configured_pipeline.hpp"

namespace holdfast {
namespace {

constexpr int frames_per_start = 6;

struct Counts {
  int starts = 0, right = 0, wrong = 0;

  void print(const char* name) const {
    std::printf("  %-34s %d starts, located right %d (%.1f %%), wrong %d\n", name, starts, right,
                starts > 0 ? 100.0 * right / starts : 0.0, wrong);
    std::fflush(stdout);
  }
};

Configuration configuration_of(const std::string& source, const std::string& segmenter, Registry& registry) {
  const std::string text = "source: " + source + "\nsegmenter: " + segmenter +
                           "\ncamera: tum_fr1\nfeatures: orb\noptimizer: schur\nloop_detector: { flann: {} }\n" +
                           "filters: [semantic_mask, multi_view_depth]\n";
  return resolve_configuration(parse_yaml(text, "visit", "."), "visit", registry, pipeline_sections());
}

/// The map of a run, with the motion from the world of the truth to that of the map.
struct Mapped {
  Map map;
  Eigen::Isometry3d T_map_truth = Eigen::Isometry3d::Identity();
};

Mapped map_of(const Configuration& configuration, const Registry& registry) {
  BuiltPipeline built = build_pipeline(configuration, registry);
  Mapped result;
  bool has_pose = false;
  while (const auto frame = built.source->next()) {
    const FrameResult found = built.pipeline.feed(*frame);
    if (!has_pose && found.status == TrackingStatus::tracked) {
      result.T_map_truth = found.T_world_camera * frame->truth->T_world_camera->inverse();
      has_pose = true;
    }
  }
  built.pipeline.finish();
  result.map = built.pipeline.take_map();
  return result;
}

class Starts {
 public:
  Starts(const Configuration& configuration, const Registry& registry, const SourceDescription& source,
         const Mapped& mapped, const ClassWeights& weights)
      : configuration_(configuration), registry_(registry), source_(source), mapped_(mapped), weights_(weights) {}

  void begin() {
    PipelineBuilder builder(registry_);
    builder.source(source_)
        .camera("tum_fr1")
        .features("orb")
        .segmenter({configuration_.segmenter.name, configuration_.segmenter.values})
        .optimizer("schur")
        .loop_detector({"flann", {{"class_weights", weights_}}})
        .filter("semantic_mask")
        .filter("multi_view_depth")
        .localise_in(mapped_.map);
    pipeline_.emplace(builder.build());
    is_located_ = false;
    ++counts_.starts;
  }
  void feed(const SensorFrame& frame) {
    if (is_located_) return;
    const FrameResult found = pipeline_->feed(frame);
    if (found.status != TrackingStatus::tracked) return;
    is_located_ = true;
    const Eigen::Isometry3d error = found.T_world_camera.inverse() * mapped_.T_map_truth * *frame.truth->T_world_camera;
    const double degrees = geometry::log_so3(Eigen::Matrix3d(error.linear())).norm() * 180.0 / std::numbers::pi;
    ++(error.translation().norm() < 0.15 && degrees < 5.0 ? counts_.right : counts_.wrong);
  }
  void end() {
    if (pipeline_) pipeline_->finish();
    pipeline_.reset();
  }
  const Counts& counts() const { return counts_; }

 private:
  const Configuration& configuration_;
  const Registry& registry_;
  SourceDescription source_;
  const Mapped& mapped_;
  ClassWeights weights_;
  std::optional<Pipeline> pipeline_;
  bool is_located_ = false;
  Counts counts_;
};

void add(const Counts& counts, Counts& all) {
  all.starts += counts.starts;
  all.right += counts.right;
  all.wrong += counts.wrong;
}

int run(int count, char** arguments) {
  if (count < 6 || count % 2 != 0) {
    std::fprintf(stderr, "usage: visit_relocalisation SEGMENTER WEIGHTS STRIDE FIRST SECOND [FIRST SECOND]...\n");
    return 2;
  }
  Registry registry;
  register_builtin_plugins(registry);
  const std::vector<std::string> names = weight_sets(arguments[2]);
  const int stride = std::max(frames_per_start, std::stoi(arguments[3]));
  std::vector<Counts> all(names.size());
  for (int i = 4; i + 1 < count; i += 2) {
    const Configuration first = configuration_of(arguments[i], arguments[1], registry);
    const Configuration second = configuration_of(arguments[i + 1], arguments[1], registry);
    const Mapped mapped = map_of(first, registry);
    const std::unique_ptr<FrameSource> source = build_source(second, registry);
    std::vector<std::unique_ptr<Starts>> starts;
    for (const std::string& name : names)
      starts.push_back(std::make_unique<Starts>(second, registry, source->describe(), mapped, class_weights_of(name)));
    std::printf("%s\n  in the map of %s: %zu keyframes, %zu points\n", arguments[i + 1], arguments[i],
                mapped.map.keyframes().size(), mapped.map.points().size());
    while (const auto frame = source->next()) {
      const auto phase = static_cast<int>(frame->index % static_cast<std::uint64_t>(stride));
      for (const auto& each : starts) {
        if (phase == 0) each->begin();
        if (phase < frames_per_start) each->feed(*frame);
        if (phase == frames_per_start - 1) each->end();
      }
    }
    for (std::size_t k = 0; k < names.size(); ++k) {
      starts[k]->end();
      starts[k]->counts().print(names[k].c_str());
      add(starts[k]->counts(), all[k]);
    }
  }
  std::printf("all\n");
  for (std::size_t k = 0; k < names.size(); ++k) all[k].print(names[k].c_str());
  return 0;
}

}  // namespace
}  // namespace holdfast

int main(int count, char** arguments) {
  try {
    return holdfast::run(count, arguments);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "visit_relocalisation: %s\n", error.what());
    return 1;
  }
}
