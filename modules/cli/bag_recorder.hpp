// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "holdfast/config/configuration.hpp"
#include "holdfast/core/worker.hpp"
#include "holdfast/interfaces/frame_source.hpp"
#include "holdfast/mcap/mcap_writer.hpp"
#include "holdfast/mcap/sensor_messages.hpp"

namespace holdfast {

/// Records the frames of a source in an MCAP file of ROS 2: raw images of a camera, with depth if there is some, or of
/// a stereo pair, camera_info and inertial measurements, and beside it the configuration that reads them (FILE.yaml)
/// and the truth (FILE.truth.txt). Images and depth are recorded without loss: depth as 16UC1 if it is in whole
/// millimetres, else as 32FC1. Time stamps have nanoseconds. If the first ones are negative, which a message cannot
/// hold, all stamps and the truth are shifted by whole seconds.
///
/// A thread compresses and writes; record() waits for it when four frames wait. What was recorded is readable if the
/// program is killed.
class BagRecorder {
 public:
  /// Throws InputError for a file that is there, unless `overwrite`, and in any case for one that the recording reads.
  BagRecorder(const Configuration& configuration, const Registry& registry, const SourceDescription& source,
              std::filesystem::path file, bool overwrite);

  /// Throws InputError if an earlier frame could not be written, and Error for a time stamp that a message cannot hold.
  void record(const SensorFrame& frame);
  /// Completes the file and writes those beside it; these also if the file could not be written.
  void finish(const Trajectory& truth);

  /// The frames that were written.
  std::uint64_t frame_count() const { return frames_; }
  /// The shift of time stamps; see Recorder.
  std::string losses() const;
  const std::filesystem::path& target() const { return file_; }
  std::filesystem::path configuration_file() const;

 private:
  std::filesystem::path truth_file() const;
  void add_channels(const SourceDescription& source);
  void begin(const SensorFrame& frame);
  void write(const SensorFrame& frame);
  void write_right(const mcap::MessageHeader& header, const cv::Mat& image);
  void write_depth(const SensorFrame& frame);
  void write_imu(const SensorFrame& frame);
  void write_files_beside(const Trajectory& truth);

  std::filesystem::path file_;
  Configuration configuration_;
  std::optional<mcap::McapWriter> bag_;
  std::uint16_t colour_ = 0, depth_ = 0, camera_info_ = 0, imu_ = 0, right_ = 0, right_info_ = 0;  // channels; 0 = none
  std::atomic<std::uint64_t> frames_ = 0;
  bool has_begun_ = false;
  double shift_ = 0.0;              // of all stamps, whole [s]
  double largest_delay_ = 0.0;      // of depth [s]
  double last_imu_stamp_ = -1e300;  // that was written, without the shift [s]
  std::optional<Worker<SensorFrame>> writer_;
};

}  // namespace holdfast
