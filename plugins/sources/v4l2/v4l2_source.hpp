// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <memory>
#include <opencv2/core/types.hpp>
#include <optional>
#include <string>
#include <vector>

#include "holdfast/interfaces/frame_source.hpp"
#include "holdfast/plugin/parameter_table.hpp"
#include "lost_frames.hpp"
#include "video_input.hpp"

namespace holdfast::v4l2_plugin {

struct V4l2Settings {
  std::string device = "/dev/video0";
  std::filesystem::path file;
  double frame_rate = 0.0;
  double exposure = 0.0;

  static void describe(ParameterTable<V4l2Settings>& table);
};

/// One colour camera, or a video file. Time stamps: of a file those of its frames, or numbers / frame_rate; of a camera
/// those of its driver, or of this computer's monotonic clock when a frame comes, for a driver without. Frames that a
/// camera gave and nobody fetched are counted as skipped. A camera that gives no more frames, because it was unplugged
/// or has been silent for 10 s, is an InputError, after which a run writes what it has.
class V4l2Source final : public FrameSource {
 public:
  V4l2Source(const V4l2Settings& settings, const CreationContext& context);
  /// With a camera or file (`is_live`: a camera) of one's own, for tests. Frames must have that size.
  V4l2Source(const V4l2Settings& settings, cv::Size size, std::unique_ptr<VideoInput> input, bool is_live);

  SourceDescription describe() const override;
  std::optional<SensorFrame> next() override;
  std::vector<SkippedFrame> skipped() const override { return skipped_; }

 private:
  bool grab();
  double stamp_of_frame();
  void count_lost_frames(double stamp);
  std::string place() const;

  V4l2Settings settings_;
  cv::Size size_;
  std::unique_ptr<VideoInput> input_;
  bool is_live_ = false;
  bool has_driver_clock_ = true;
  bool has_ended_ = false;
  std::uint64_t index_ = 0, given_ = 0;
  std::optional<double> last_stamp_;
  LostFrames lost_;
  std::vector<SkippedFrame> skipped_;
};

}  // namespace holdfast::v4l2_plugin
