// SPDX-License-Identifier: BSD-3-Clause
// robot_loop SECONDS: a robot without a screen. Frames come at the pace of a camera, the pose of each is read at once,
// background work has threads of its own, and SIGINT or SIGTERM ends the run cleanly.
#include <atomic>
#include <csignal>
#include <iostream>
#include <string>

#include "holdfast/holdfast.hpp"
#include "holdfast/run/frame_feeder.hpp"
#include "holdfast/settings/all.hpp"
#include "simulated_frames.hpp"

namespace {
std::atomic<bool> stop = false;
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler may touch nothing else");
}  // namespace

int main(int argument_count, char** arguments) try {
  if (argument_count != 2) throw holdfast::Error("usage: robot_loop SECONDS");
  std::signal(SIGINT, [](int) { stop = true; });
  std::signal(SIGTERM, [](int) { stop = true; });

  // Frames arrive at their time stamps, and one that finds tracking busy is dropped, as on a robot.
  const holdfast::RunSettings run{.mode = holdfast::RunMode::threaded,
                                  .pace = holdfast::Pace::timestamps,
                                  .late_frames = holdfast::LateFrames::drop};
  const auto source = simulated_frames(std::stod(arguments[1]));
  holdfast::Pipeline pipeline = holdfast::PipelineBuilder()
                                    .source(source->describe())
                                    .features(holdfast::OrbSettings{})
                                    .optimizer(holdfast::CeresSettings{})
                                    .loop_detector(holdfast::FlannSettings{})
                                    .run(run)
                                    .build();
  holdfast::FrameFeeder camera(*source, run);  // reads the camera in its own thread
  int tracked = 0;
  while (!stop) {
    const auto fed = camera.next();
    if (!fed) break;
    const holdfast::FrameResult result = pipeline.feed(fed->frame);
    if (!result.T_world_camera) continue;  // lost: a robot would slow down here; tracking recovers by itself
    const Eigen::Vector3d place = result.T_world_camera->translation();
    if (tracked++ % 30 == 0)  // the map may be looked at while the threads work on it
      std::cout << "at " << place.transpose() << ", " << pipeline.map_snapshot().points.size() << " points known"
                << std::endl;
  }
  camera.stop();
  pipeline.interrupt();  // long adjustments need not end; what is queued is still done
  pipeline.finish();
  std::cout << (stop ? "stopped by a signal" : "the end of the frames") << ", " << tracked << " poses\n";
  return tracked > 0 ? 0 : 1;
} catch (const holdfast::Error& error) {
  std::cerr << error.what() << '\n';
  return 1;
}
