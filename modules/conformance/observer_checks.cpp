// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>

#include "check.hpp"
#include "filter_scene.hpp"
#include "holdfast/interfaces/observer.hpp"

namespace holdfast::conformance {

namespace {

const char* const header = "holdfast/interfaces/observer.hpp";

FrameResult result_of(const Moment& moment, TrackingStatus status) {
  FrameResult result;
  result.index = moment.frame.index;
  result.timestamp = moment.frame.timestamp;
  result.status = status;
  if (status == TrackingStatus::tracked) result.T_world_camera = moment.frame.T_world_camera();
  return result;
}

std::vector<KeyFrameId> keyframes_of(const Map& map) { return map.keyframes_by_age(); }

/// A whole run: frames, keyframes, a loop, the end.
void show_run(Observer& observer, FilterScene& scene, TrackingStatus status) {
  const ObservedMap observed([&] { return make_snapshot(scene.map()); });
  const std::vector<KeyFrameId> keyframes = keyframes_of(scene.map());
  observer.on_start({"background", "person"});
  for (const Moment& moment : scene.moments()) {
    observer.on_frame(moment.sensor, moment.frame, result_of(moment, status));
    observer.on_keyframe(keyframes.back(), observed);
    ObservedView view{.keyframe = keyframes.back(), .timestamp = moment.frame.timestamp};
    view.points = [](std::size_t max_count) { return std::vector<CloudPoint>(std::min<std::size_t>(max_count, 10)); };
    observer.on_static_view(view);
  }
  const SurfacePatch patch{{0, 0, 0}, std::vector<MeshVertex>(3), {{0, 1, 2}}};
  observer.on_surface({1, [&](std::uint64_t, int) { return std::vector<SurfacePatch>{patch}; }});
  observer.on_loop(keyframes.back(), keyframes.front(), observed);
  observer.on_finish(scene.map());
}

void lives_through_a_run(const Maker& maker) {
  FilterScene scene(standard_camera());
  show_run(*maker.make<Observer>(), scene, TrackingStatus::tracked);
}

void lives_through_a_loss(const Maker& maker) {
  FilterScene scene(standard_camera());
  show_run(*maker.make<Observer>(), scene, TrackingStatus::lost);
}

void lives_without_depth_features_and_truth(const Maker& maker) {
  FilterScene scene(standard_camera());
  for (Moment& moment : scene.moments()) {
    remove_features(moment.frame);
    remove_depth(moment);
    moment.sensor.truth = nullptr;
  }
  show_run(*maker.make<Observer>(), scene, TrackingStatus::tracked);
}

void lives_with_no_event(const Maker& maker) {
  FilterScene scene(standard_camera());
  maker.make<Observer>()->on_finish(scene.map());
  maker.make<Observer>()->on_finish(Map());
  static_cast<void>(maker.make<Observer>());  // a run that failed before its first frame
}

void writes_to_no_image(const Maker& maker) {
  FilterScene scene(standard_camera());
  std::vector<std::uint64_t> before, after;
  const auto digests = [&] {
    std::vector<std::uint64_t> all;
    for (const Moment& moment : scene.moments()) {
      all.push_back(digest(moment.sensor.colour));
      all.push_back(digest(moment.sensor.depth));
    }
    return all;
  };
  before = digests();
  show_run(*maker.make<Observer>(), scene, TrackingStatus::tracked);
  after = digests();
  EXPECT_EQ(before, after) << "an image was written to";
}

void instances_do_not_meet(const Maker& maker) {
  FilterScene first(standard_camera()), second(standard_camera());
  const auto one = maker.make<Observer>(), two = maker.make<Observer>();
  run_side_by_side([&] { show_run(*one, first, TrackingStatus::tracked); },
                   [&] { show_run(*two, second, TrackingStatus::tracked); });
}

void lives_through_interrupts(const Maker& maker) {
  FilterScene scene(standard_camera());
  const auto observer = maker.make<Observer>();
  static_assert(noexcept(observer->interrupt()), "it is called where nobody could catch an exception");
  run_side_by_side([&] { show_run(*observer, scene, TrackingStatus::tracked); },
                   [&] {
                     for (int i = 0; i < 100; ++i) observer->interrupt();
                   });
}

}  // namespace

std::vector<Check> observer_checks() {
  const Promise events{header, "Observes a run. Every method does nothing unless overridden."};
  const Promise interrupts{
      header,
      "When the run is interrupted (Pipeline::interrupt()), by any thread, also during another call, and more than "
      "once:"};
  const Promise images{"holdfast/core/sensor_frame.hpp",
                       "The images are shared, not copied, and must not be written to."};
  return {
      {"LivesThroughARun", events, lives_through_a_run},
      {"LivesThroughALoss", events, lives_through_a_loss},
      {"LivesWithoutDepthFeaturesAndTruth", events, lives_without_depth_features_and_truth},
      {"LivesWithNoEvent", events, lives_with_no_event},
      {"LivesThroughInterrupts", interrupts, lives_through_interrupts},
      {"WritesToNoImage", images, writes_to_no_image},
      {"InstancesDoNotMeet", events, instances_do_not_meet},
  };
}

}  // namespace holdfast::conformance
