// SPDX-License-Identifier: BSD-3-Clause
#include <benchmark/benchmark.h>

#include <cmath>
#include <functional>
#include <opencv2/core.hpp>
#include <opencv2/core/utility.hpp>
#include <string>
#include <utility>

#include "holdfast/simulation/pictures.hpp"
#include "holdfast/simulation/room.hpp"
#include "holdfast/simulation/simulator.hpp"

namespace {

using namespace holdfast;
using namespace holdfast::simulation;

SimulationSettings settings_of(PathKind path) {
  SimulationSettings settings;
  settings.path = path;
  return settings;
}

/// Frames of a path, far apart, one after the other; the rate is shown as items_per_second.
void simulated_frames(benchmark::State& state, PathKind path, const char* camera, bool with_sensor) {
  cv::setNumThreads(1);
  Simulator simulator(settings_of(path), *find_camera(camera));
  std::uint64_t index = 0;
  for (auto _ : state) {
    if (with_sensor)
      benchmark::DoNotOptimize(simulator.frame(index).depth.data);
    else
      benchmark::DoNotOptimize(simulator.render(index).depth.data);
    index = (index + 37) % simulator.frame_count();
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations()));
}
BENCHMARK_CAPTURE(simulated_frames, xyz_640x480_distorted, PathKind::xyz, "tum_fr1", true)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(simulated_frames, xyz_640x480_distorted_without_sensor, PathKind::xyz, "tum_fr1", false)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(simulated_frames, xyz_640x480, PathKind::xyz, "tum_fr3", true)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(simulated_frames, halfsphere_640x480_distorted, PathKind::halfsphere, "tum_fr1", true)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(simulated_frames, rpy_640x480_distorted, PathKind::rpy, "tum_fr1", true)
    ->Unit(benchmark::kMillisecond);

// Stands in for a person: ten limbs of 256 triangles each, bent by two bones.
Object stand_in(World& world, int number) {
  const cv::Mat cloth = pictures::fabric({512, 512}, {60.0 + 50.0 * number, 120, 90}, Random(7));
  const TextureArea area = world.add_texture(cloth);
  Object person;
  person.name = "person " + std::to_string(number);
  person.class_name = "person";
  constexpr int rings = 9, facets = 16;
  for (int limb = 0; limb < 10; ++limb) {
    const float x = 0.12F * static_cast<float>(limb % 5 - 2), low = limb < 5 ? 0.0F : 0.85F;
    const auto first = static_cast<std::uint32_t>(person.mesh.vertices.size());
    for (int ring = 0; ring < rings; ++ring)
      for (int i = 0; i <= facets; ++i) {
        const float angle = 6.2831853F * static_cast<float>(i) / facets, up = static_cast<float>(ring) / (rings - 1);
        const Eigen::Vector3f out(std::cos(angle), std::sin(angle), 0.0F);
        person.mesh.vertices.push_back({Eigen::Vector3f(x, 0, low + 0.85F * up) + 0.12F * out, out,
                                        area.width * static_cast<float>(i) / facets, area.height * (1.0F - up), 1.0F});
        person.mesh.skin.push_back({{0, 1, 0, 0}, {1.0F - up, up, 0.0F, 0.0F}});
      }
    for (std::uint32_t ring = 0; ring + 1 < rings; ++ring)
      for (std::uint32_t i = 0; i < facets; ++i) {
        const std::uint32_t a = first + (ring + 1) * (facets + 1) + i, d = a - (facets + 1);
        const auto surface = static_cast<std::uint32_t>(limb);
        person.mesh.triangles.push_back({a, a + 1, d + 1, area.texture, surface});
        person.mesh.triangles.push_back({a, d + 1, d, area.texture, surface});
      }
  }
  person.mesh.surface_count = 10;
  person.mesh.rest.resize(bone_count, Eigen::Isometry3d::Identity());
  person.motion = [number](double time) {
    return Eigen::Isometry3d(Eigen::Translation3d(2.2 + 0.8 * number + 0.2 * std::sin(time), 3.4, 0.0) *
                             Eigen::AngleAxisd(time, Eigen::Vector3d::UnitZ()));
  };
  person.bones = [](double time) {
    BonePoses poses;
    poses.fill(Eigen::Isometry3d::Identity());
    poses[1] = Eigen::AngleAxisd(0.1 * std::sin(3.0 * time), Eigen::Vector3d::UnitX());
    return poses;
  };
  return person;
}

/// Three stand-ins for people, close before the camera of a path, with all sensor effects.
void three_people(benchmark::State& state, double exposure) {
  cv::setNumThreads(1);
  World world = make_room(1);
  for (int number = 0; number < 3; ++number) {
    Object person = stand_in(world, number);
    world.objects.push_back(std::move(person));
  }
  const Camera camera = *find_camera("tum_fr3");
  Renderer renderer(world, camera);
  const CameraPath path(PathKind::xyz, 1);
  const std::function<Eigen::Isometry3d(double)> pose = [&](double time) { return path.pose(time); };
  double time = 0.0, covered = 0.0;
  for (auto _ : state) {
    RenderedFrame frame = renderer.render(pose, time, exposure);
    sense_colour(frame.colour, {}, 1, time);
    benchmark::DoNotOptimize(sense_depth(frame.depth, frame.cosine, camera, {}, 1, time).data);
    covered += cv::countNonZero(frame.object_ids > world.objects.size() - 3) / double(frame.object_ids.total());
    time = time > 18.0 ? 0.0 : time + 37.0 / 30.0;
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations()));
  state.counters["people_share"] = covered / static_cast<double>(state.iterations());
}
BENCHMARK_CAPTURE(three_people, 640x480, 0.0)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(three_people, 640x480_blurred_10_ms, 0.01)->Unit(benchmark::kMillisecond);

void build_room(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(make_room(RoomKind::office, 1).world.objects.size());
}
BENCHMARK(build_room)->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
