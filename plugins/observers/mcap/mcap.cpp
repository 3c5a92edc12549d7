// SPDX-License-Identifier: BSD-3-Clause
#include <filesystem>
#include <mutex>
#include <optional>

#include "holdfast/interfaces/observer.hpp"
#include "holdfast/mcap/mcap_writer.hpp"
#include "holdfast/mcap/run_messages.hpp"
#include "holdfast/plugin/plugin.hpp"
#include "holdfast/settings/mcap.hpp"

namespace holdfast {

void McapSettings::describe(ParameterTable<McapSettings>& table) {
  using S = McapSettings;
  table
      .add("image_every", &S::image_every,
           "an image and its moving cells are written for every frame whose index is a multiple of this number; 0 = "
           "no images")
      .range(0, 100000);
  table.add("quality", &S::quality, "JPEG quality of the images").range(1, 100);
  table
      .add("map_interval", &S::map_interval,
           "minimum time between two states of the map (keyframes and points); the last one is always written")
      .range(0, 1e6)
      .unit("s");
}

namespace {

/// Writes what a run finds to run.mcap. Needs an output folder, and does nothing without one. The tracking and the
/// mapping thread share the file.
class Mcap final : public Observer {
 public:
  Mcap(const McapSettings& settings, const CreationContext& context)
      : settings_(settings), folder_(context.output_directory), camera_(context.camera) {}

  void on_frame(const SensorFrame& sensor_frame, const Frame& frame, const FrameResult& result) override {
    if (folder_.empty()) return;
    const std::lock_guard lock(mutex_);
    if (!messages_) open();
    messages_->add_frame(sensor_frame, frame, result);
  }

  void on_keyframe(KeyFrameId, const ObservedMap& map) override {
    {
      const std::lock_guard lock(mutex_);
      if (!messages_ || messages_->time() < map_time_ + settings_.map_interval) return;
      map_time_ = messages_->time();
    }
    const MapSnapshot& snapshot = map.snapshot();
    const std::lock_guard lock(mutex_);
    messages_->add_map(snapshot, messages_->time());
  }

  void on_finish(const Map& map) override {
    if (!messages_) return;
    messages_->add_map(make_snapshot(map), messages_->time());
    messages_.reset();
    writer_->close();
    writer_.reset();
  }

 private:
  /// With the first frame: until then the folder may be cleared of earlier results.
  void open() {
    writer_.emplace(folder_ / "run.mcap");
    messages_.emplace(*writer_, mcap::RunMessages::Options{settings_.image_every, settings_.quality}, camera_);
  }

  McapSettings settings_;
  std::filesystem::path folder_;
  Camera camera_;
  std::mutex mutex_;
  std::optional<mcap::McapWriter> writer_;
  std::optional<mcap::RunMessages> messages_;
  double map_time_ = -1e300;  // of the last map [s]
};

}  // namespace

HOLDFAST_PLUGIN(mcap, registry) {
  registry.add<Observer, Mcap, McapSettings>(
      {.name = McapSettings::module,
       .summary = "Writes poses, map, moving objects, images and the state of every frame to run.mcap, for Foxglove."});
}

}  // namespace holdfast
