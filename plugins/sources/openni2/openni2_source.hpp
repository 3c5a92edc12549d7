// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "depth_camera.hpp"
#include "holdfast/interfaces/frame_source.hpp"
#include "holdfast/plugin/parameter_table.hpp"

namespace holdfast::openni2_plugin {

struct Openni2Settings {
  std::string device = {};
  std::string registration = "device";
  double max_time_difference = 0.02;

  static void describe(ParameterTable<Openni2Settings>& table);
};

/// A camera with colour and depth. A frame is a colour image with the depth image that was taken nearest to it, within
/// max_time_difference; time stamps are those of the camera. Colour images that nobody fetched in time, and those that
/// got no depth image, are counted as skipped frames. A camera that is unplugged is an InputError, after which a run
/// writes what it has.
class Openni2Source final : public FrameSource {
 public:
  Openni2Source(const Openni2Settings& settings, const CreationContext& context);
  /// With a camera of one's own, for tests.
  Openni2Source(const Openni2Settings& settings, std::unique_ptr<DepthCamera> camera);

  SourceDescription describe() const override;
  std::optional<SensorFrame> next() override;
  std::vector<SkippedFrame> skipped() const override { return skipped_; }

 private:
  void take(StreamImage image);
  void take_colour(StreamImage image);
  std::optional<SensorFrame> pair();
  void skip(std::uint64_t time, const char* reason);
  std::string place() const;

  Openni2Settings settings_;
  std::unique_ptr<DepthCamera> camera_;
  std::optional<StreamImage> colour_, depth_;  // that wait for each other
  std::uint64_t index_ = 0;
  std::optional<std::uint64_t> last_number_, last_time_;  // of colour
  bool has_given_ = false, has_ended_ = false;
  std::vector<SkippedFrame> skipped_;
};

}  // namespace holdfast::openni2_plugin
