// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "holdfast/core/module.hpp"
#include "holdfast/core/sensor_frame.hpp"
#include "holdfast/core/trajectory.hpp"

namespace holdfast {

/// A frame that could not be used and was skipped, as configured by `on_bad_frame: skip`.
struct SkippedFrame {
  std::uint64_t index = 0;
  double timestamp = 0.0;
  std::string reason;  ///< the error message, which names the file
};

/// Properties of a source that are known before its first frame.
struct SourceDescription {
  std::string name;  ///< name of the sequence, for titles
  bool has_depth = false;
  bool has_right = false;  ///< frames have a right image; see SensorFrame::right
  /// Global shutter: all rows of an image are exposed at once, for any Camera::readout.
  bool has_global_shutter = false;
  /// Frames do not depend on what happens between two calls of next(), as those of a recording, so that a sequential
  /// run may read ahead in another thread. False for a source that other code influences during a run.
  bool can_read_ahead = false;
  std::string truth_frame = "raw";           ///< of FrameSource::truth(): "raw" as recorded, or "transformed"
  std::vector<std::string> class_names;      ///< class names of FrameTruth::class_labels, by index
  std::optional<std::uint64_t> frame_count;  ///< empty if the source is endless
  /// Time stamps of all frames in their order [s], if they are known before the first frame; otherwise empty.
  std::vector<double> frame_timestamps;
  std::optional<Camera> camera;  ///< calibration known to the source; another one in the configuration is an error
  bool has_imu = false;          ///< frames have inertial measurements; see SensorFrame::imu
  /// Calibration of the IMU: CreationContext::imu or, without it, that known to the source. T_body_camera is that of
  /// the camera of the frames, which is rectified where the source rectifies.
  std::optional<ImuCalibration> imu;
};

/// Provides the frames of a recording, a simulation or a live camera. Time stamps increase strictly from frame to
/// frame. Used by one thread, but for interrupt().
class FrameSource : public Module {
 public:
  static constexpr const char* kind = "source";

  virtual SourceDescription describe() const = 0;
  /// Returns the next frame, or nothing at the end. Throws InputError that names the file for a frame that cannot be
  /// used, unless the source is configured to skip and count such frames.
  virtual std::optional<SensorFrame> next() = 0;
  /// Skips frames without reading them, so that next() returns the last frame whose time stamp is at most `timestamp`
  /// [s]. Returns the time stamps of the skipped frames. Called in paced runs whose reader is late (`late_frames:
  /// drop`). A source without known stamps, such as a camera, skips none.
  virtual std::vector<double> pass_over([[maybe_unused]] double timestamp) { return {}; }
  /// Ground-truth poses, sorted by time stamp; the stamps may differ from those of the frames. Empty if unknown.
  virtual Trajectory truth() const { return {}; }
  /// Frames skipped so far.
  virtual std::vector<SkippedFrame> skipped() const { return {}; }

  /// Ends the source early: a next() that waits for a camera returns nothing within 0.1 s, and so does every later one.
  /// A source that does not wait need not obey; one that wraps another hands it on. Any thread may call it.
  virtual void interrupt() { interrupted_ = true; }

 protected:
  bool is_interrupted() const { return interrupted_; }

 private:
  std::atomic<bool> interrupted_ = false;
};

}  // namespace holdfast
