// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <map>
#include <string>

#include "holdfast/core/counted.hpp"
#include "holdfast/core/error.hpp"
#include "holdfast/image_files/frame_poses.hpp"
#include "holdfast/image_files/numbered_files.hpp"
#include "phone_layouts.hpp"
#include "yaml_numbers.hpp"

namespace holdfast {

namespace {

namespace fs = std::filesystem;

/// A value of metadata.json that must be there.
YAML::Node required(const fs::path& file, const YAML::Node& root, const char* key) {
  if (const YAML::Node value = root[key]) return value;
  throw InputError({file.string()}, std::string("lacks \"") + key +
                                        "\"; expected the metadata of Record3D: w, h, K, poses and, if they were "
                                        "recorded, fps, frameTimestamps and perFrameIntrinsicCoeffs");
}

/// The intrinsics of perFrameIntrinsicCoeffs or, in older recordings, of K, whose numbers follow column by column.
std::vector<FrameIntrinsics> read_intrinsics(const fs::path& file, const YAML::Node& root) {
  std::vector<FrameIntrinsics> intrinsics;
  if (const YAML::Node frames = root["perFrameIntrinsicCoeffs"]; frames && frames.IsSequence())
    for (const YAML::Node& frame : frames) {
      const std::vector<double> n = yaml_numbers::numbers(file, frame, "perFrameIntrinsicCoeffs", {4});
      intrinsics.push_back({n[0], n[1], n[2], n[3]});
    }
  if (!intrinsics.empty()) return intrinsics;
  const YAML::Node node = required(file, root, "K");
  const std::vector<double> k = yaml_numbers::numbers(file, node, "K", {9});
  if (k[2] != 0.0 || k[5] != 0.0 || k[8] != 1.0)
    throw InputError(yaml_numbers::location(file, node.Mark()),
                     "is not the matrix of a camera column by column; expected K: [fx, 0, 0, 0, fy, 0, cx, cy, 1]");
  intrinsics.push_back({k[0], k[4], k[6], k[7]});
  return intrinsics;
}

/// One stamp for each image: those of frameTimestamps, or by the frame rate.
void set_frame_times(const fs::path& file, const YAML::Node& root, double frame_rate, std::vector<ImageFiles>& files) {
  const YAML::Node stamps = root["frameTimestamps"];
  if (!stamps || !stamps.IsSequence() || stamps.size() == 0) {
    if (const YAML::Node rate = root["fps"]) frame_rate = yaml_numbers::number(file, rate, "fps", true);
    set_stamps(files, {}, frame_rate);
    return;
  }
  if (stamps.size() != files.size())
    throw InputError(yaml_numbers::location(file, stamps.Mark()),
                     "has " + counted(stamps.size(), "time stamp") + ", but there are " +
                         counted(files.size(), "image") + " in rgb; expected one for each; export the recording again");
  for (std::size_t i = 0; i < files.size(); ++i) {
    files[i].timestamp = yaml_numbers::number(file, stamps[i], "frameTimestamps");
    if (i > 0 && !(files[i - 1].timestamp < files[i].timestamp))
      throw InputError(yaml_numbers::location(file, stamps[i].Mark()),
                       "is not later than the time stamp before; expected stamps that increase");
  }
}

}  // namespace

CalibratedRecording read_record3d(const fs::path& folder, const PhoneOptions& options) {
  const fs::path file = folder / "metadata.json";
  const YAML::Node root = yaml_numbers::load(file, "the metadata of Record3D");
  if (!root.IsMap()) throw InputError({file.string()}, "holds no keys; expected the metadata of Record3D");
  CalibratedRecording recording;
  recording.camera.name = "record3d";
  recording.camera.width = yaml_numbers::size(file, required(file, root, "w"), "w");
  recording.camera.height = yaml_numbers::size(file, required(file, root, "h"), "h");
  set_median_intrinsics(recording.camera, read_intrinsics(file, root));

  std::vector<NumberedFrame> numbered;
  for (const NumberedFile& image : find_numbered_files(folder / "rgb")) {
    numbered.push_back({0.0, numbered.size(), image.numbers});
    recording.files.emplace_back().colour = image.path;
  }
  std::error_code error;
  if (fs::is_directory(folder / "depth", error)) {
    recording.depth = DepthEncoding(1.0);  // of EXR files, which hold metres
    std::map<FileNumbers, fs::path> depth;
    for (const NumberedFile& image : find_numbered_files(folder / "depth", ".exr")) depth[image.numbers] = image.path;
    for (std::size_t i = 0; i < numbered.size(); ++i) {
      const auto found = depth.find(numbered[i].numbers);
      recording.files[i].depth = found != depth.end()
                                     ? found->second
                                     : folder / "depth" / (recording.files[i].colour.stem().string() + ".exr");
    }
  }
  set_frame_times(file, root, options.frame_rate, recording.files);
  for (std::size_t i = 0; i < numbered.size(); ++i) numbered[i].timestamp = recording.files[i].timestamp;
  required(file, root, "poses");
  recording.truth = read_frame_poses(file, numbered, numbered.size());
  return recording;
}

void set_median_intrinsics(Camera& camera, const std::vector<FrameIntrinsics>& frames) {
  const auto median = [&](double FrameIntrinsics::*member) {
    std::vector<double> values;
    for (const FrameIntrinsics& frame : frames) values.push_back(frame.*member);
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
  };
  camera.fx = median(&FrameIntrinsics::fx);
  camera.fy = median(&FrameIntrinsics::fy);
  camera.cx = median(&FrameIntrinsics::cx) - 0.5;
  camera.cy = median(&FrameIntrinsics::cy) - 0.5;
}

}  // namespace holdfast
