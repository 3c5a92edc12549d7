// SPDX-License-Identifier: BSD-3-Clause
// Time to fuse the views of a simulated room into a surface of 2 cm voxels, as ratios to cv::ORB(1000) on the same
// images, in the same process and on one thread.
#include <benchmark/benchmark.h>

#include <memory>
#include <numeric>
#include <opencv2/core/utility.hpp>
#include <string>
#include <vector>

#include "holdfast/core/coarse_view.hpp"
#include "holdfast/evaluation/statistics.hpp"
#include "holdfast/simulation/scene_file.hpp"
#include "holdfast/simulation/simulator.hpp"
#include "holdfast/surface/carving_views.hpp"
#include "holdfast/surface/surface_field.hpp"
#include "orb_yardstick.hpp"
#include "processor_time.hpp"

namespace holdfast {
namespace {

/// The views of a scene at their true poses, in the order of time, and the time of cv::ORB on their images.
struct Views {
  Camera camera;
  std::vector<KeptView> views;
  std::vector<double> orb_times;  // [s]
};

/// Of the first ten seconds: a keyframe every `keyframe_interval`, and a coarse view every 0.2 s between them [s].
Views make_views(const std::string& scene_file, double keyframe_interval) {
  simulation::Scene scene = simulation::read_scene(HOLDFAST_SOURCE_DIR "/" + scene_file);
  scene.seed = 1;
  scene.duration = 10.0;
  simulation::Simulator simulator(scene, find_camera("tum_fr3").value());
  const ViewSampler sampler(simulator.camera(), DenseMapSettings());
  const CoarseSampler coarse_sampler(simulator.camera());
  Views result{sampler.camera(), {}, {}};
  OrbYardstick orb;
  double last_keyframe = -1e9, last = -1e9;
  for (std::uint64_t i = 0; i < simulator.frame_count(); ++i) {
    const double stamp = simulator.timestamp(i);
    const bool is_keyframe = stamp - last_keyframe >= keyframe_interval;
    if (!is_keyframe && stamp - last < SurfaceSettings().carving_interval) continue;
    last = stamp;
    if (is_keyframe) last_keyframe = stamp;
    const SensorFrame sensor_frame = simulator.frame(i);
    Frame frame;
    frame.index = i, frame.timestamp = stamp;
    frame.camera = std::make_shared<const Camera>(simulator.camera());
    coarse_sampler.sample_depth(sensor_frame.depth, frame.coarse);
    if (is_keyframe) {
      time(result.orb_times, [&] { orb.seconds(sensor_frame.colour); });
      result.views.push_back(sampler.sample({}, sensor_frame, {}, {}, {}));
    } else {
      CarvingViews carving(0.0, 1);
      carving.add(frame, {}, Eigen::Isometry3d::Identity());
      result.views.push_back(carving.views().front());
    }
    result.views.back().T_view_keyframe = simulator.T_world_camera(i).inverse();
  }
  return result;
}

/// `to_cv_orb`: of a keyframe with the coarse views since the last one. `keyframe`, `coarse`: of one view of the kind.
/// `move`: of a keyframe that is taken out and put in 2 cm beside.
void fuse(benchmark::State& state, const char* scene_file, double keyframe_interval) {
  cv::setNumThreads(1);
  const Views input = make_views(scene_file, keyframe_interval);
  std::vector<double> keyframes, coarse, moves;
  for (auto _ : state) {
    SurfaceField field(input.camera, SurfaceSettings());
    std::vector<SurfaceField::Fusion> fusions;
    for (const KeptView& view : input.views)
      time(view.only_carves() ? coarse : keyframes, [&] {
        const auto number = static_cast<std::uint32_t>(fusions.size());
        fusions.push_back(field.put_in(view, view.T_view_keyframe.inverse(), number));
      });
    for (std::size_t i = 0; i < input.views.size(); ++i) {
      if (input.views[i].only_carves()) continue;
      Eigen::Isometry3d pose = fusions[i].T_world_camera;
      pose.translation().x() += 0.02;
      time(moves, [&] { field.move(input.views[i], fusions[i], pose); });
    }
  }
  const double orb = median(input.orb_times), keyframe_count = static_cast<double>(keyframes.size());
  const auto sum = [](const std::vector<double>& times) { return std::accumulate(times.begin(), times.end(), 0.0); };
  state.counters["to_cv_orb"] = (sum(keyframes) + sum(coarse)) / keyframe_count / orb;
  state.counters["keyframe"] = sum(keyframes) / keyframe_count / orb;
  state.counters["coarse"] = sum(coarse) / static_cast<double>(coarse.size()) / orb;
  state.counters["move"] = sum(moves) / keyframe_count / orb;
}
BENCHMARK_CAPTURE(fuse, room, "tests/cli/somebody_leaves.yaml", 0.9)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(fuse, hall, "examples/scenes/loop.yaml", 0.22)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace holdfast

BENCHMARK_MAIN();
