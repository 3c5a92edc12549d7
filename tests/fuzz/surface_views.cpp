// SPDX-License-Identifier: BSD-3-Clause
// The list of the views that a run keeps beside its map. Their images are of 4x3 pixels: frame 0 of a keyframe at 1 s
// with the sequence number 0, and frame 1 that only carves.
#include <opencv2/imgcodecs.hpp>

#include "fuzz.hpp"
#include "holdfast/surface/surface_field.hpp"
#include "holdfast/surface/surface_views.hpp"

using namespace holdfast;

namespace {

Map make_map() {
  Map map;
  Frame frame;
  frame.timestamp = 1.0;
  frame.T_camera_world = Eigen::Isometry3d::Identity();
  map.add_keyframe(frame);
  return map;
}

void write_images() {
  const std::filesystem::path folder = fuzz::folder().path();
  for (const char* kind : {"colour", "depth"}) std::filesystem::create_directories(folder / kind);
  cv::imwrite((folder / "colour/000000.png").string(), cv::Mat(3, 4, CV_8UC3, cv::Scalar(1, 2, 3)));
  for (const char* name : {"depth/000000.png", "depth/000001.png"})
    cv::imwrite((folder / name).string(), cv::Mat(3, 4, CV_16UC1, cv::Scalar(2000)));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const Map map = make_map();
  static const bool has_images = (write_images(), true);
  fuzz::require(has_images, "the images are there");
  fuzz::folder().write("views.json", {data, size});
  SurfaceViews views;
  if (!fuzz::accepts([&] { views = read_views(fuzz::folder().path(), map); })) return 0;
  fuzz::require(!views.views.empty(), "there is a view");
  for (std::size_t i = 0; i < views.views.size(); ++i) {
    const KeptView& view = views.views[i];
    const Camera& camera = view.only_carves() ? *view.coarse_camera : views.camera;
    fuzz::require(view.depth.cols == camera.width && view.depth.rows == camera.height, "images fit their camera");
    fuzz::require(i == 0 || views.views[i - 1].frame_index < view.frame_index, "frames increase");
  }
  if (SurfaceField::is_available()) fuse(views, map);
  return 0;
}
