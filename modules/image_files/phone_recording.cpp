// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/image_files/phone_recording.hpp"

#include <cmath>

#include "holdfast/core/error.hpp"
#include "phone_layouts.hpp"

namespace holdfast {

namespace {

namespace fs = std::filesystem;

bool has(const fs::path& folder, const char* name) {
  std::error_code error;
  return fs::exists(folder / name, error);
}

[[noreturn]] void refuse_r3d(const fs::path& place) {
  throw InputError({place.string()},
                   "is a recording of Record3D in its own format, whose depth is compressed by LZFSE, for which there "
                   "is no library; expected a folder; export it from the app as 'EXR + RGB sequence'");
}

}  // namespace

PhoneFolder find_phone_folder(const fs::path& folder) {
  if (folder.extension() == ".r3d" || (has(folder, "metadata") && has(folder, "rgbd"))) refuse_r3d(folder);
  require_recording_folder(folder, "a folder that an app of a phone exported", "source.phone.path");
  for (const fs::path& place : {folder, folder / "EXR_RGBD"})
    if (has(place, "metadata.json") && has(place, "rgb")) return {PhoneLayout::record3d, place};
  if (has(folder, "transforms.json")) return {PhoneLayout::transforms, folder};
  if (has(folder, "odometry.csv") && has(folder, "camera_matrix.csv")) return {PhoneLayout::stray_scanner, folder};
  throw InputError({folder.string()},
                   "is not a recording of a phone that is known; expected metadata.json and rgb/ (Record3D), "
                   "transforms.json (NeRFCapture, Nerfstudio), or odometry.csv and camera_matrix.csv (Stray Scanner); "
                   "is it a folder inside this one?");
}

bool is_phone_folder(const fs::path& folder) {
  try {
    find_phone_folder(folder);
    return true;
  } catch (const InputError&) {
    return false;
  }
}

CalibratedRecording read_phone_recording(const PhoneOptions& options) {
  const PhoneFolder found = find_phone_folder(options.path);
  CalibratedRecording recording;
  switch (found.layout) {
    case PhoneLayout::record3d:
      recording = read_record3d(found.folder, options);
      break;
    case PhoneLayout::transforms:
      recording = read_transforms(found.folder, options);
      break;
    case PhoneLayout::stray_scanner:
      recording = read_stray_scanner(found.folder, options);
      break;
  }
  recording.has_global_shutter = false;
  recording.scales_depth = true;
  recording.minimum_confidence = options.minimum_confidence;
  measure_frame_rate(recording);
  if (!recording.colour_is_video)
    resize_frames(recording, {recording.camera.width, recording.camera.height}, options.width, options.path.string());
  select_range(recording.files, options.range.start, options.range.frames, options.path, "frames");
  return recording;
}

void resize_frames(CalibratedRecording& recording, const cv::Size& size, int width, const std::string& place) {
  Camera& camera = recording.camera;
  camera.width = size.width;
  camera.height = size.height;
  recording.left_size = recording.right_size = size;
  if (const std::string trouble = camera.trouble(); !trouble.empty()) throw InputError({place}, trouble);
  if (width == 0 || width == size.width) return;
  if (width > size.width)
    throw InputError({place}, "has images of " + std::to_string(size.width) + " pixels in width, but `width` is " +
                                  std::to_string(width) + "; expected a width that is not larger");
  // A pixel centre lies at an integer, so that the left border of the image is at -0.5.
  camera.width = width;
  camera.height = static_cast<int>(std::lround(static_cast<double>(size.height) * width / size.width));
  const double x_scale = static_cast<double>(camera.width) / size.width;
  const double y_scale = static_cast<double>(camera.height) / size.height;
  camera.fx *= x_scale;
  camera.fy *= y_scale;
  camera.cx = (camera.cx + 0.5) * x_scale - 0.5;
  camera.cy = (camera.cy + 0.5) * y_scale - 0.5;
}

}  // namespace holdfast
