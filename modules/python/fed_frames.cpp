// SPDX-License-Identifier: BSD-3-Clause
#include "fed_frames.hpp"

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "holdfast/config/configuration.hpp"
#include "holdfast/interfaces/frame_source.hpp"

namespace holdfast::python {

namespace {

struct FedFramesSettings {
  std::vector<std::string> class_names;
  bool stereo = false;

  static void describe(ParameterTable<FedFramesSettings>& table) {
    table.add("class_names", &FedFramesSettings::class_names,
              "class names of the frames' true class labels, by index, for the segmenter `truth`");
    table.add("stereo", &FedFramesSettings::stereo, "frames are rectified stereo pairs, without depth images");
  }
};

class FedFrames final : public FrameSource {
 public:
  FedFrames(const FedFramesSettings& settings, const CreationContext&) : settings_(settings) {}

  SourceDescription describe() const override {
    SourceDescription description;
    description.name = "frames fed from Python";
    description.has_depth = !settings_.stereo;
    description.has_right = settings_.stereo;
    description.has_imu = true;
    description.class_names = settings_.class_names;
    return description;
  }
  std::optional<SensorFrame> next() override { return std::nullopt; }

 private:
  FedFramesSettings settings_;
};

}  // namespace

void register_fed_frames(Registry& registry) {
  registry.add<FrameSource, FedFrames, FedFramesSettings>(
      {.name = fed_frames, .summary = "Frames that Python code feeds into a holdfast.Pipeline."});
}

void feed_from_caller(ConfigurationNode& root) {
  const ConfigurationNode* source = root.find("source");
  if (source != nullptr && source->find(fed_frames) != nullptr) return;
  ConfigurationNode name;
  name.kind = ConfigurationNode::Kind::scalar;
  name.location = source != nullptr ? source->location : root.location;
  name.folder = root.folder;
  name.text = fed_frames;
  set_value(root, "source", name, name.location, choice_sections());
}

}  // namespace holdfast::python
