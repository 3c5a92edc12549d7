// SPDX-License-Identifier: BSD-3-Clause
#include <string>

#include "holdfast/interfaces/frame_source.hpp"
#include "holdfast/plugin/plugin.hpp"
#include "holdfast/simulation/simulator.hpp"

namespace holdfast {
namespace {

struct SimulatedSourceSettings {
  std::string room = "office";
  std::string path = "xyz";
  double duration = 20.0;
  double frame_rate = 30.0;
  std::int64_t seed = 0;
  double colour_noise = simulation::ColourSensorSettings{}.noise;
  double depth_noise = simulation::DepthSensorSettings{}.noise;
  bool depth_quantisation = simulation::DepthSensorSettings{}.quantisation;
  bool depth_holes = simulation::DepthSensorSettings{}.holes;
  double minimum_depth = simulation::DepthSensorSettings{}.minimum_depth;
  double maximum_depth = simulation::DepthSensorSettings{}.maximum_depth;

  static void describe(ParameterTable<SimulatedSourceSettings>& table) {
    using S = SimulatedSourceSettings;
    table.add("room", &S::room, "where: a furnished office, a large hall, or a corridor of look-alike desks")
        .one_of({"office", "hall", "corridor"});
    table.add("path", &S::path, "how the camera moves, after the TUM fr3 sequences")
        .one_of({"static", "xyz", "halfsphere", "rpy", "loop", "corridor", "table_edge", "rotation", "square"});
    table.add("duration", &S::duration, "length of the sequence").range(0.001, 36000.0).unit("s");
    table.add("frame_rate", &S::frame_rate, "frames per second").range(0.1, 1000.0).unit("1/s");
    table.add("seed", &S::seed, "of room, path and noise; 0 = the run's seed").at_least(0.0);
    table.add("colour_noise", &S::colour_noise, "standard deviation of each colour value; 0 = none")
        .range(0.0, 64.0)
        .unit("grey levels");
    table.add("depth_noise", &S::depth_noise, "factor on a Kinect's depth noise; 0 = none").range(0.0, 10.0);
    table.add("depth_quantisation", &S::depth_quantisation, "round disparity to eighths of a pixel, as a Kinect does");
    table.add("depth_holes", &S::depth_holes, "no depth in the projector's shadow, at ragged edges and on flat sights");
    table.add("minimum_depth", &S::minimum_depth, "no depth nearer").range(0.0, 100.0).unit("m");
    table.add("maximum_depth", &S::maximum_depth, "no depth farther").range(0.1, 100.0).unit("m");
  }
};

class SimulatedSource final : public FrameSource {
 public:
  SimulatedSource(const SimulatedSourceSettings& settings, const CreationContext& context)
      : simulator_(translate(settings, context), context.camera) {}

  SourceDescription describe() const override {
    SourceDescription description;
    description.name = std::string("simulated ") + simulation::to_string(simulator_.settings().room) + ", " +
                       simulation::to_string(simulator_.settings().path) + ", seed " +
                       std::to_string(simulator_.settings().seed);
    description.has_depth = true;
    description.has_object_masks = true;
    description.class_names = simulator_.class_names();
    description.frame_count = simulator_.frame_count();
    description.camera = simulator_.camera();
    return description;
  }

  std::optional<SensorFrame> next() override {
    if (next_ >= simulator_.frame_count()) return std::nullopt;
    return simulator_.frame(next_++);
  }

  Trajectory truth() const override { return simulator_.truth(); }

 private:
  static simulation::SimulationSettings translate(const SimulatedSourceSettings& settings,
                                                  const CreationContext& context) {
    simulation::SimulationSettings result;
    result.room = simulation::room_kind(settings.room);
    result.path = simulation::path_kind(settings.path);
    result.duration = settings.duration;
    result.frame_rate = settings.frame_rate;
    result.seed = settings.seed == 0 ? context.seed : static_cast<std::uint64_t>(settings.seed);
    result.colour_sensor.noise = settings.colour_noise;
    result.depth_sensor = {settings.depth_noise, settings.depth_quantisation, settings.depth_holes,
                           settings.minimum_depth, settings.maximum_depth};
    return result;
  }

  simulation::Simulator simulator_;
  std::uint64_t next_ = 0;
};

}  // namespace
}  // namespace holdfast

HOLDFAST_PLUGIN(simulated, registry) {
  registry.add<holdfast::FrameSource, holdfast::SimulatedSource, holdfast::SimulatedSourceSettings>(
      {.name = "simulated",
       .summary = "A furnished room seen by a Kinect-like camera, drawn on the fly with exact truth.",
       .paper = "Depth noise after Nguyen, Izadi and Lovell 2012; paths after Sturm et al. 2012"});
}
