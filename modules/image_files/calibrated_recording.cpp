// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/image_files/calibrated_recording.hpp"

#include <utility>

#include "holdfast/core/error.hpp"
#include "holdfast/core/folder_name.hpp"

namespace holdfast {

namespace {

ImageSequenceOptions options_of(const CalibratedRecording& recording, bool skip_bad_frames) {
  ImageSequenceOptions options;
  options.width = recording.left_size.width;
  options.height = recording.left_size.height;
  options.skip_bad_frames = skip_bad_frames;
  options.grey_may_have_16_bits = !recording.depth;  // depth images have this form too
  if (recording.depth) options.depth = *recording.depth;
  options.invalid_depth_key = recording.invalid_depth_key;
  options.rectification = recording.rectification;
  if (!recording.rectification) options.frame_size = {recording.camera.width, recording.camera.height};
  options.scales_depth = recording.scales_depth;
  options.minimum_confidence = recording.minimum_confidence;
  options.readers = recording.readers;
  return options;
}

}  // namespace

void rectify_pair(CalibratedRecording& recording, const Camera& right, const Eigen::Isometry3d& T_left_right,
                  const std::filesystem::path& file) {
  try {
    recording.rectification =
        std::make_shared<const StereoRectification>(StereoCameras{recording.camera, right, T_left_right});
  } catch (const Error& problem) {
    throw InputError({file.string()}, problem.what());
  }
  recording.has_right = true;
  recording.right_size = {right.width, right.height};
  recording.camera = recording.rectification->camera();
}

void measure_frame_rate(CalibratedRecording& recording) {
  const std::vector<ImageFiles>& files = recording.files;
  if (files.size() < 2) return;
  recording.camera.frame_rate =
      static_cast<double>(files.size() - 1) / (files.back().timestamp - files.front().timestamp);
}

CalibratedSource::CalibratedSource(CalibratedRecording recording, const std::filesystem::path& folder,
                                   bool skip_bad_frames)
    : ImageSequenceSource(std::move(recording.files), options_of(recording, skip_bad_frames)) {
  description_.name = folder_name(folder);
  description_.has_right = recording.has_right;
  description_.has_depth = recording.depth.has_value();
  description_.has_global_shutter = recording.has_global_shutter;
  description_.camera = recording.camera;
  description_.truth_frame = recording.truth_frame;
  truth_ = std::move(recording.truth);
  read_imu(recording.imu_file, recording.imu);
}

}  // namespace holdfast
