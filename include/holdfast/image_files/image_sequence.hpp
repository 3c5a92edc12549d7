// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "holdfast/core/error.hpp"
#include "holdfast/core/sensor_frame.hpp"
#include "holdfast/core/warning.hpp"
#include "holdfast/image_files/image_decoder.hpp"
#include "holdfast/image_files/recorded_imu.hpp"
#include "holdfast/image_files/stereo_rectification.hpp"
#include "holdfast/interfaces/frame_source.hpp"

namespace holdfast {

/// The files of one frame of a recording.
struct ImageFiles {
  double timestamp = 0.0;    ///< of the colour image [s]
  double depth_delay = 0.0;  ///< from the colour to the depth image [s]; see SensorFrame
  std::filesystem::path colour;
  std::filesystem::path depth;      ///< empty for a recording without depth
  SourceLocation colour_listed_at;  ///< the line of the list with the image; no file without a list
  SourceLocation depth_listed_at;
  std::filesystem::path right = {};  ///< right image of a stereo pair; empty without one
  SourceLocation right_listed_at = {};
  std::filesystem::path confidence = {};  ///< of the depth image, with its size: 8 bits; empty without one
  std::size_t video_index = 0;            ///< of the colour image, where `colour` is a video
};

/// Readers for images that are neither PNG nor JPEG files, such as those of a video; empty = ImageDecoder. They throw
/// InputError for an image that cannot be used.
struct ImageReaders {
  std::function<cv::Mat(const ImageFiles&)> colour;  ///< 8UC3, blue green red
  std::function<cv::Mat(const ImageFiles&)> depth;   ///< 32FC1 [m], 0 = no value
};

/// Options for reading the images of a sequence.
struct ImageSequenceOptions {
  DepthEncoding depth;  ///< of the depth images
  int width = 0;        ///< of every image in the files [px]
  int height = 0;
  bool skip_bad_frames = false;  ///< skip and count bad frames instead of throwing InputError
  /// Grey images, which are widened to three equal channels, may have 16 bits, of which the upper 8 are used.
  bool grey_may_have_16_bits = false;
  /// Depth images of another size than the colour images are scaled to it: each pixel of the result has the value of
  /// the depth pixel that covers its centre. For cameras whose images show the same view.
  bool scales_depth = false;
  bool stamps_are_read = true;  ///< from a list; otherwise they follow from a frame rate, and are seconds
  /// Rectification of stereo pairs, whose images have the sizes of its cameras; nullptr = already rectified.
  std::shared_ptr<const StereoRectification> rectification = nullptr;
  /// The key that sets DepthEncoding::no_value, such as "source.tum.invalid_depth", for ImageSequence::warnings().
  std::string invalid_depth_key = {};
  cv::Size frame_size = {};    ///< to which colour images are scaled down; empty = as in the files
  ImageReaders readers = {};   ///< see there
  int minimum_confidence = 0;  ///< depth of lower confidence has no value; see ImageFiles::confidence
};

/// Decodes the frames of a recording one by one; the common part of all sources that read image files. Used by one
/// thread.
class ImageSequence {
 public:
  /// The time stamps must increase strictly.
  ImageSequence(std::vector<ImageFiles> files, const ImageSequenceOptions& options);

  /// Returns the next valid frame, or nothing at the end. Throws InputError with the image and its line in the list for
  /// a bad frame, unless bad frames are skipped; in this case it throws at the end if no frame was valid.
  std::optional<SensorFrame> next();
  /// See FrameSource::pass_over().
  std::vector<double> pass_over(double timestamp);

  std::uint64_t size() const { return files_.size(); }
  /// Of all frames [s].
  std::vector<double> timestamps() const;
  const std::vector<SkippedFrame>& skipped() const { return skipped_; }
  /// Warnings about time stamps that are not seconds (core/stamp_unit.hpp), and about a depth value that seems to
  /// denote missing measurements (find_no_value()). The first call reads some images, unless
  /// ImageSequenceOptions::invalid_depth_key is empty.
  Warnings warnings() const;

 private:
  SensorFrame decode(const ImageFiles& files);
  cv::Mat decode_colour(const ImageFiles& files, const cv::Size& expected);
  cv::Mat decode_depth(const ImageFiles& files, const cv::Size& colour_size);
  /// Throws InputError, and sets is_of_other_size_, for another size than that of the camera.
  ImageDecoder::SizeCheck size_check(const std::filesystem::path& file, const cv::Size& camera);
  void remove_unsure_depth(const ImageFiles& files, cv::Mat& depth);
  std::optional<Diagnostic> suspected_stamp_unit() const;
  std::optional<Diagnostic> suspected_no_value() const;

  std::vector<ImageFiles> files_;
  ImageSequenceOptions options_;
  std::size_t position_ = 0;
  ImageDecoder decoder_;
  std::vector<SkippedFrame> skipped_;
  bool is_of_other_size_ = false;             ///< the image read last
  mutable std::optional<Warnings> warnings_;  ///< once they were asked for
};

/// A source whose frames are those of an ImageSequence. Derived classes complete the description, in which the number
/// of frames is set, and the truth.
class ImageSequenceSource : public FrameSource {
 public:
  SourceDescription describe() const override { return description_; }
  std::optional<SensorFrame> next() override {
    std::optional<SensorFrame> frame = sequence_.next();
    if (frame) imu_.add_to(*frame);
    return frame;
  }
  std::vector<double> pass_over(double timestamp) override { return sequence_.pass_over(timestamp); }
  Trajectory truth() const override { return truth_; }
  std::vector<SkippedFrame> skipped() const override { return sequence_.skipped(); }
  Warnings warnings() const override {
    Warnings warnings = sequence_.warnings();
    add_warnings(warnings, imu_.warnings());
    return warnings;
  }

 protected:
  ImageSequenceSource(std::vector<ImageFiles> files, const ImageSequenceOptions& options)
      : sequence_(std::move(files), options) {
    description_.can_read_ahead = true;
    description_.frame_count = sequence_.size();
    description_.frame_timestamps = sequence_.timestamps();
  }

  /// Adds the inertial measurements of a file to the frames; an empty path adds none. See RecordedImu.
  void read_imu(const std::filesystem::path& file, const std::optional<ImuCalibration>& calibration) {
    imu_ = RecordedImu(file, calibration, description_.frame_timestamps);
    imu_.describe(description_);
  }

  SourceDescription description_;
  Trajectory truth_;

 private:
  ImageSequence sequence_;
  RecordedImu imu_;
};

/// Depth [m] that probably denotes missing measurements in the given depth images (32FC1): the maximum of each image if
/// it is equal in at least three images, covers at least 1 % of the pixels, and exceeds all other values by a quarter.
/// Empty if there is none.
std::optional<float> find_no_value(const std::vector<cv::Mat>& depths);

/// Throws InputError unless `folder` is a folder: "is missing; expected EXPECTED; set `SETTING`".
void require_recording_folder(const std::filesystem::path& folder, const std::string& expected,
                              const std::string& setting);

/// Sets the time stamps of all frames: those of a file with one stamp per line, or, without a file, i / frame_rate
/// [1/s]. Throws InputError for a file that does not have one stamp for each frame.
void set_stamps(std::vector<ImageFiles>& files, const std::filesystem::path& stamps, double frame_rate);

/// Keeps `count` elements (0 = all remaining) from index `start`. Throws InputError at `place` if `start` is beyond the
/// last element; `what` names the elements in the message.
template <class Element>
void select_range(std::vector<Element>& elements, std::int64_t start, std::int64_t count,
                  const std::filesystem::path& place, const char* what) {
  const auto size = static_cast<std::int64_t>(elements.size());
  if (start >= size)
    throw InputError({place.string()}, "has " + std::to_string(size) + ' ' + what + ", but `start` is " +
                                           std::to_string(start) + "; expected 0 to " + std::to_string(size - 1));
  elements.erase(elements.begin(), elements.begin() + start);
  if (count > 0 && count < size - start) elements.resize(static_cast<std::size_t>(count));
}

}  // namespace holdfast
