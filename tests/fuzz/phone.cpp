// SPDX-License-Identifier: BSD-3-Clause
// What apps of phones write beside images: metadata.json of Record3D, transforms.json, or the tables of Stray Scanner
// with a zero byte between odometry.csv and camera_matrix.csv, as the first byte says; the rest is the file.
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "fuzz.hpp"
#include "holdfast/image_files/phone_recording.hpp"

using namespace holdfast;

namespace {

constexpr std::array<const char*, 3> layouts = {"record3d", "transforms", "stray_scanner"};

/// The folder of a layout, with three images of no content, which are not read.
void make_folder(const std::string& layout) {
  for (const char* part : {"rgb", "depth", "confidence", "images"})
    std::filesystem::create_directories(fuzz::folder().path() / layout / part);
  for (int i = 0; i < 3; ++i) {
    const std::string number = std::to_string(i);
    for (const std::string& file : {"rgb/" + number + ".jpg", "depth/" + number + ".exr", "depth/" + number + ".png",
                                    "images/" + number + ".png", "confidence/" + number + ".png"})
      fuzz::folder().write(layout + "/" + file, {});
  }
  fuzz::folder().write(layout + "/rgb.mp4", {});
}

void check(const CalibratedRecording& recording) {
  fuzz::require(!recording.files.empty(), "an accepted recording has frames");
  fuzz::require(recording.camera.trouble().empty(), "an accepted camera has no trouble");
  for (std::size_t i = 0; i < recording.files.size(); ++i) {
    const ImageFiles& files = recording.files[i];
    fuzz::require(std::isfinite(files.timestamp), "stamps are finite");
    fuzz::require(i == 0 || recording.files[i - 1].timestamp < files.timestamp, "stamps increase strictly");
    fuzz::require(!files.colour.empty(), "a frame has an image");
    fuzz::require(recording.depth || files.depth.empty(), "depth images have a unit");
  }
  for (std::size_t i = 0; i < recording.truth.size(); ++i) {
    const Eigen::Isometry3d& pose = recording.truth[i].T_world_camera;
    const double error = (pose.linear() * pose.linear().transpose() - Eigen::Matrix3d::Identity()).norm();
    fuzz::require(error < 1e-9 && pose.translation().allFinite(), "an accepted pose is rigid and finite");
    fuzz::require(i == 0 || recording.truth[i - 1].timestamp < recording.truth[i].timestamp, "poses are in order");
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const bool is_made = [] { return std::for_each(layouts.begin(), layouts.end(), make_folder), true; }();
  if (size == 0 || !is_made) return 0;
  const std::string layout = layouts[data[0] % layouts.size()];
  const fuzz::Bytes bytes = {data + 1, size - 1};
  if (layout == "stray_scanner") {
    const auto end = static_cast<std::size_t>(std::find(bytes.begin(), bytes.end(), 0) - bytes.begin());
    fuzz::folder().write(layout + "/odometry.csv", bytes.first(end));
    fuzz::folder().write(layout + "/camera_matrix.csv", bytes.subspan(std::min(end + 1, bytes.size())));
  } else {
    fuzz::folder().write(layout + (layout == "transforms" ? "/transforms.json" : "/metadata.json"), bytes);
  }
  const int width = (data[0] / 3) % 2 == 0 ? 0 : 64;  // as recorded, or scaled down
  fuzz::accepts([&] {
    const std::filesystem::path folder = fuzz::folder().path() / layout;
    CalibratedRecording recording = read_phone_recording({.path = folder, .width = width, .frame_rate = 30.0});
    if (recording.colour_is_video) resize_frames(recording, {1920, 1440}, width, folder.string());
    check(recording);
  });
  return 0;
}
