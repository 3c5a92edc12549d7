// SPDX-License-Identifier: BSD-3-Clause
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "holdfast/interfaces/frame_source.hpp"
#include "holdfast/plugin/plugin.hpp"
#include "holdfast/simulation/imu_sensor.hpp"
#include "holdfast/simulation/scene_file.hpp"
#include "holdfast/simulation/simulator.hpp"

namespace holdfast {
namespace {

struct SimulatedSourceSettings {
  std::filesystem::path scene;
  std::string path = "as_scene";
  double duration = 0.0;
  std::int64_t seed = 0;
  double stereo_baseline = 0.0;
  std::vector<std::string> set;

  static std::vector<std::string> paths() {
    std::vector<std::string> names = simulation::path_names();
    names.insert(names.begin(), "as_scene");
    return names;
  }

  static void describe(ParameterTable<SimulatedSourceSettings>& table) {
    using S = SimulatedSourceSettings;
    table.add("scene", &S::scene, "scene file (YAML); empty = the empty office");
    table.add("path", &S::path, "camera path; as_scene = path of the scene").one_of(paths());
    table.add("duration", &S::duration, "duration of the sequence; 0 = duration of the scene")
        .range(0.0, 36000.0)
        .unit("s");
    table
        .add("seed", &S::seed,
             "seed of textures, small objects, people, path and noise; 0 = the seed of the scene, or else of the run")
        .at_least(0.0);
    table
        .add("stereo_baseline", &S::stereo_baseline,
             "a second camera so far to the right of the first takes the place of the depth sensor; 0 = none")
        .range(0.0, 10.0)
        .unit("m");
    table.add("set", &S::set, "values of the scene to override, each \"key.path=value\"");
  }
};

class SimulatedSource final : public FrameSource {
 public:
  SimulatedSource(const SimulatedSourceSettings& settings, const CreationContext& context)
      : simulator_(scene_of(settings, context), context.camera),
        stereo_baseline_(settings.stereo_baseline),
        imu_calibration_(context.imu) {
    if (context.imu) imu_.emplace(simulator_.path(), *context.imu, simulator_.scene().seed);
  }

  SourceDescription describe() const override {
    const simulation::Scene& scene = simulator_.scene();
    SourceDescription description;
    description.name = "simulated " + scene.name + ", " + scene.place_name() + ", path " +
                       simulation::to_string(scene.camera.path) + ", seed " + std::to_string(scene.seed);
    description.has_depth = !is_stereo();
    description.has_right = is_stereo();
    description.has_global_shutter = true;
    description.can_read_ahead = true;
    description.class_names = simulator_.class_names();
    description.frame_count = simulator_.frame_count();
    for (std::uint64_t i = 0; i < simulator_.frame_count(); ++i)
      description.frame_timestamps.push_back(simulator_.timestamp(i));
    description.camera = simulator_.camera();
    description.has_imu = imu_.has_value();
    description.imu = imu_calibration_;
    if (is_stereo()) description.camera->baseline = stereo_baseline_;
    return description;
  }

  std::optional<SensorFrame> next() override {
    if (next_ >= simulator_.frame_count()) return std::nullopt;
    const std::uint64_t index = next_++;
    SensorFrame frame = is_stereo() ? simulator_.stereo_frame(index, stereo_baseline_) : simulator_.frame(index);
    if (imu_) frame.imu = imu_->take(frame.timestamp);
    return frame;
  }

  std::vector<double> pass_over(double timestamp) override {
    std::vector<double> stamps;
    for (; next_ + 1 < simulator_.frame_count() && simulator_.timestamp(next_ + 1) <= timestamp; ++next_)
      stamps.push_back(simulator_.timestamp(next_));
    return stamps;
  }

  Trajectory truth() const override { return simulator_.truth(); }

 private:
  static simulation::Scene scene_of(const SimulatedSourceSettings& settings, const CreationContext& context) {
    std::vector<std::string> overrides;
    if (settings.path != "as_scene") overrides.push_back("camera.path=" + settings.path);
    overrides.insert(overrides.end(), settings.set.begin(), settings.set.end());
    simulation::Scene scene = simulation::read_scene(settings.scene, overrides);
    if (settings.duration > 0.0) scene.duration = settings.duration;
    if (settings.seed != 0) scene.seed = static_cast<std::uint64_t>(settings.seed);
    if (scene.seed == 0) scene.seed = context.seed;
    return scene;
  }

  bool is_stereo() const { return stereo_baseline_ > 0.0; }

  simulation::Simulator simulator_;
  double stereo_baseline_;
  std::optional<ImuCalibration> imu_calibration_;
  std::optional<simulation::ImuSensor> imu_;
  std::uint64_t next_ = 0;
};

}  // namespace
}  // namespace holdfast

HOLDFAST_PLUGIN(simulated, registry) {
  registry.add<holdfast::FrameSource, holdfast::SimulatedSource, holdfast::SimulatedSourceSettings>(
      {.name = "simulated",
       .summary = "A simulated scene with moving people and objects, rendered during the run, with exact ground truth.",
       .paper = "Depth noise after Nguyen, Izadi and Lovell 2012; paths after Sturm et al. 2012 and Zeng et al. 2023"});
}
