// SPDX-License-Identifier: BSD-3-Clause
// Scenes. The world of a scene is not made: painting its textures takes too long for a million inputs.
#include "fuzz.hpp"
#include "holdfast/simulation/scene_file.hpp"

using namespace holdfast;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto file = fuzz::folder().write("scene.yaml", {data, size});
  fuzz::accepts([&] {
    const simulation::Scene scene = simulation::read_scene(file);
    fuzz::require(scene.duration > 0.0 && scene.frame_rate > 0.0, "an accepted scene has frames");
  });
  return 0;
}
