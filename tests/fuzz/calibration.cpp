// SPDX-License-Identifier: BSD-3-Clause
// Files with the calibration of cameras, and the lists of images beside them.
#include <cmath>

#include "fuzz.hpp"
#include "holdfast/image_files/camera_file.hpp"
#include "holdfast/image_files/euroc_files.hpp"
#include "holdfast/image_files/kitti_raw_files.hpp"
#include "holdfast/image_files/openloris_files.hpp"

using namespace holdfast;

namespace {

void check(const Camera& camera) {
  fuzz::require(camera.width > 0 && camera.height > 0, "an accepted camera has an area");
  fuzz::require(camera.fx > 0.0 && camera.fy > 0.0, "an accepted camera has focal lengths");
  fuzz::require(camera.distortion.trouble().empty(), "the coefficients fit the lens");
  camera.is_usable({0.0, 0.0});
  camera.undistort({0.0, 0.0});
}

void check(const Eigen::Isometry3d& pose) {
  const double error = (pose.linear() * pose.linear().transpose() - Eigen::Matrix3d::Identity()).norm();
  fuzz::require(error < 1e-9 && pose.translation().allFinite(), "an accepted pose is rigid and finite");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto file = fuzz::folder().write("camera.yaml", {data, size});
  fuzz::accepts([&] {
    const CameraFile read = read_camera_file(file, Camera{}, "source.folder.intrinsics");
    check(read.camera);
    if (!read.pair) return;
    check(read.pair->right);
    check(read.pair->T_left_right);
  });
  fuzz::accepts([&] {
    const EurocCamera read = read_euroc_camera(file);
    check(read.camera);
    check(read.T_body_camera);
  });
  fuzz::accepts([&] { check(read_euroc_imu(file).T_body_camera); });
  fuzz::accepts([&] {
    const EurocCamera read = read_kalibr_camera(file, "cam0");
    check(read.camera);
    check(read.T_body_camera);
  });
  fuzz::accepts([&] { read_kalibr_imu(file); });
  fuzz::accepts([&] { check(read_kitti_transform(file)); });
  fuzz::accepts([&] {
    const KittiRawCalibration read = read_kitti_raw_calibration(file);
    fuzz::require(read.projections.size() == 4 && read.sizes.size() == 4, "all cameras are there");
  });
  fuzz::accepts([&] {
    const KittiOxts packet = read_kitti_oxts(file);
    check(KittiMercator(packet).pose(packet));
  });
  fuzz::accepts([&] {
    const std::vector<double> stamps = read_kitti_stamps(file);
    for (std::size_t i = 1; i < stamps.size(); ++i)
      fuzz::require(stamps[i - 1] < stamps[i], "stamps increase strictly");
  });
  fuzz::accepts([&] { check(read_openloris_camera(file, "d400_color_optical_frame")); });
  fuzz::accepts([&] { check(read_openloris_pose(file, "d400_color_optical_frame")); });
  fuzz::accepts([&] {
    const std::vector<ListedImage> images = read_euroc_image_list(file);
    fuzz::require(!images.empty(), "an accepted list is not empty");
    for (std::size_t i = 0; i < images.size(); ++i) {
      fuzz::require(!images[i].name.empty(), "images have names");
      fuzz::require(i == 0 || images[i - 1].timestamp < images[i].timestamp, "stamps increase strictly");
    }
  });
  return 0;
}
