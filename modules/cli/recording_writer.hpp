// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <vector>

#include "holdfast/core/atomic_file.hpp"
#include "holdfast/core/sensor_frame.hpp"
#include "holdfast/core/trajectory.hpp"
#include "holdfast/core/worker.hpp"

namespace holdfast {

/// Encodes by the file's extension, writes in one step. Throws InputError.
void write_image_atomically(const std::filesystem::path& file, const cv::Mat& image,
                            const std::vector<int>& parameters = {}, Durability durability = Durability::later);

/// Writes a recording in the layout of the TUM RGB-D benchmark: rgb/, depth/ (16 bit, 0 = no value), their lists
/// rgb.txt and depth.txt, associations.txt and groundtruth.txt; beside them shutter.txt, with the word "global", where
/// all rows of an image were exposed at once, and imu.csv with inertial measurements, where frames have some. Colour as
/// PNG and time stamps are written without loss, and so is depth of sensors that measure whole numbers of 16 bits:
/// their units to the metre are those that the writer is told, or those that it finds by the first image with depth.
/// Other depth is rounded to a fifth of a millimetre, the unit of the benchmark, and what lies beyond 13.1 m has no
/// value then.
///
/// Two threads encode, so that a camera of 30 frames per second loses none; add() waits for them when four frames wait.
/// Every image is written in one step, lists last, when all images have reached the disk, so that no list names a
/// missing image. Used by one thread.
class RecordingWriter {
 public:
  static constexpr double depth_units_per_metre = 5000.0;  // of the TUM benchmark

  /// How time stamps are written, in lists and as names of images.
  enum class Stamps {
    exact,         ///< all digits that a number needs, at least six after the point
    microseconds,  ///< six digits after the point
  };
  struct Options {
    std::string colour_format = "png";  ///< "png" or "jpg"
    Stamps stamps = Stamps::exact;
    /// Units to the metre that are tried on the first image with depth, in this order; depth_units_per_metre where none
    /// is exact.
    std::vector<double> depth_factors = {depth_units_per_metre};
    bool has_global_shutter = false;  ///< see SourceDescription
  };

  /// Makes the folders.
  RecordingWriter(std::filesystem::path folder, Options options);

  /// What a reader will find of a frame: its depth and its depth_delay as they are recorded. The images are shared with
  /// `frame` where nothing changes.
  SensorFrame as_recorded(const SensorFrame& frame);

  /// Adds a frame with colour and depth; frames come in order. Throws InputError for a file that cannot be written,
  /// maybe that of an earlier frame.
  void add(const SensorFrame& frame);
  /// The name of the images of a time stamp, without extension.
  std::string stamp_name(double timestamp) const;
  /// Waits for the images and writes the lists; an empty truth makes no file. Throws as add() does.
  void finish(const Trajectory& truth);

  std::uint64_t frame_count() const { return frames_; }
  /// Units to the metre of the depth images.
  double depth_factor() const { return depth_factor_.value_or(depth_units_per_metre); }
  /// Number of frames whose depth as_recorded() had to round.
  std::uint64_t rounded_frames() const { return rounded_frames_; }

  /// What it writes, lists first.
  static const std::vector<std::string>& entries();

 private:
  /// An image that waits for its encoding.
  struct Job {
    std::filesystem::path colour_file, depth_file;
    cv::Mat colour, depth;
    double depth_factor = 0.0;
  };
  void choose_depth_factor(const cv::Mat& depth);
  void encode(const Job& job) const;

  std::filesystem::path folder_;
  Options options_;
  std::string colour_list_, depth_list_, associations_;
  std::string imu_lines_;        // empty without inertial measurements
  double last_imu_stamp_ = 0.0;  // of imu_lines_
  std::uint64_t frames_ = 0, rounded_frames_ = 0;
  std::optional<double> depth_factor_;  // once there was depth
  bool has_failed_ = false;             // an image is missing
  std::vector<std::unique_ptr<Worker<Job>>> encoders_;
};

}  // namespace holdfast
