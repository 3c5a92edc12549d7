// SPDX-License-Identifier: BSD-3-Clause
// Trajectories in TUM format.
#include "holdfast/core/trajectory.hpp"
#include "fuzz.hpp"

using namespace holdfast;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto file = fuzz::folder().write("trajectory.txt", {data, size});
  TrajectoryFile read;
  if (!fuzz::accepts([&] { read = read_trajectory_file(file); })) return 0;
  for (std::size_t i = 0; i < read.poses.size(); ++i) {
    fuzz::require(read.poses[i].T_world_camera.matrix().allFinite(), "poses are finite");
    fuzz::require(i == 0 || read.poses[i - 1].timestamp < read.poses[i].timestamp, "stamps increase strictly");
  }
  read.omissions();
  trajectory_text(read.poses);
  return 0;
}
