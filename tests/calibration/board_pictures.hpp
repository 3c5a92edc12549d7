// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <cstdio>
#include <opencv2/imgproc.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "holdfast/calibration/board_detector.hpp"
#include "holdfast/core/camera.hpp"
#include "holdfast/core/random.hpp"
#include "holdfast/geometry/so3.hpp"

namespace holdfast::test {

constexpr double degree = 3.14159265358979323846 / 180.0;

/// A pose of a board whose middle is at `middle` in the camera frame [m], tilted around the vertical and the horizontal
/// axis [rad].
inline Eigen::Isometry3d board_pose(const CalibrationBoard& board, const Eigen::Vector3d& middle, double vertical,
                                    double horizontal) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = geometry::exp_so3(Eigen::Vector3d(0, vertical, 0)).toRotationMatrix() *
                  geometry::exp_so3(Eigen::Vector3d(horizontal, 0, 0)).toRotationMatrix();
  const Eigen::Vector3d centre(0.5 * (board.columns - 1) * board.square, 0.5 * (board.rows - 1) * board.square, 0.0);
  pose.translation() = middle - pose.linear() * centre;
  return pose;
}

/// Poses from all sides, in all parts of the image.
inline std::vector<Eigen::Isometry3d> board_poses(const CalibrationBoard& board, const Camera& camera, double distance,
                                                  double largest_tilt = 35.0 * degree, double spread = 0.22) {
  std::vector<Eigen::Isometry3d> poses;
  for (int row = -1; row <= 1; ++row) {
    for (int column = -1; column <= 1; ++column) {
      for (const int turned : {0, 1}) {
        const double x = spread * column * camera.width / camera.fx, y = spread * row * camera.height / camera.fy;
        const double near = turned == 1 ? 1.0 : 1.25;
        const double sign = (row + column) % 2 == 0 ? 1.0 : -1.0;
        poses.push_back(board_pose(board, Eigen::Vector3d(x, y, 1.0) * distance * near,
                                   turned == 1 ? sign * largest_tilt : 0.1 * column * largest_tilt,
                                   turned == 1 ? 0.2 * row * largest_tilt : -sign * largest_tilt));
      }
    }
  }
  return poses;
}

/// Exact corners of a board, without a picture; those outside of it are left out.
inline BoardView exact_view(const CalibrationBoard& board, const Camera& camera, const Eigen::Isometry3d& pose,
                            double noise = 0.0, Random* random = nullptr) {
  BoardView view;
  for (int i = 0; i < board.corner_count(); ++i) {
    Eigen::Vector2d pixel = camera.distort(camera.project(pose * board.corner(i)));
    if (pixel.x() < 0 || pixel.y() < 0 || pixel.x() > camera.width - 1 || pixel.y() > camera.height - 1) continue;
    if (random != nullptr) pixel += noise * Eigen::Vector2d{random->normal(), random->normal()};
    view.corners.push_back(i);
    view.pixels.push_back(pixel);
  }
  return view;
}

/// Draws what --print-board writes: the black rectangles of its SVG, at so many pixels per millimetre.
inline cv::Mat rasterised(const std::string& svg, double pixels_per_mm) {
  double width = 0, height = 0;
  std::sscanf(svg.c_str() + svg.find("viewBox"), "viewBox=\"0 0 %lf %lf\"", &width, &height);
  cv::Mat image(static_cast<int>(std::lround(height * pixels_per_mm)),
                static_cast<int>(std::lround(width * pixels_per_mm)), CV_8UC1, cv::Scalar(255));
  const std::size_t begin = svg.find(" d=\"") + 4;
  std::istringstream path(svg.substr(begin, svg.find('"', begin) - begin));
  double x, y, w, h, back;
  char command;
  while (path >> command >> x >> y >> command >> w >> command >> h >> command >> back >> command) {
    const auto pixel = [&](double mm) { return static_cast<int>(std::lround(mm * pixels_per_mm)); };
    cv::rectangle(image, cv::Point(pixel(x), pixel(y)), cv::Point(pixel(x + w) - 1, pixel(y + h) - 1), cv::Scalar(0),
                  cv::FILLED);
  }
  return image;
}

/// Takes pictures of a printed board with a camera: what each of 16 parts of a pixel sees of the plane of the board,
/// and their mean.
class BoardCamera {
 public:
  static constexpr int parts = 4;
  static constexpr double pixels_per_mm = 4.0;

  BoardCamera(const CalibrationBoard& board, const Camera& camera)
      : board_(board), camera_(camera), print_(rasterised(board_svg(board), pixels_per_mm)) {
    for (int y = 0; y < camera.height * parts; ++y)
      for (int x = 0; x < camera.width * parts; ++x) {
        const Eigen::Vector2d raw((x + 0.5) / parts - 0.5, (y + 0.5) / parts - 0.5);
        const Eigen::Vector2d pixel = camera.undistort(raw);
        rays_.emplace_back(static_cast<float>((pixel.x() - camera.cx) / camera.fx),
                           static_cast<float>((pixel.y() - camera.cy) / camera.fy));
      }
  }

  cv::Mat picture(const Eigen::Isometry3d& pose, std::uint64_t seed = 1) const {
    // From a ray to the plane z = 0 of the board: the homography of the pose, the other way round.
    Eigen::Matrix3d forth;
    forth << pose.linear().col(0), pose.linear().col(1), pose.translation();
    const Eigen::Matrix3d back = forth.inverse();
    cv::Mat image(camera_.height, camera_.width, CV_8UC1);
    Random random(seed);
    for (int y = 0; y < camera_.height; ++y) {
      for (int x = 0; x < camera_.width; ++x) {
        double sum = 0.0;
        for (int part = 0; part < parts * parts; ++part)
          sum += seen(back, rays_[static_cast<std::size_t>((y * parts + part / parts) * camera_.width * parts +
                                                           x * parts + part % parts)]);
        const double value = 0.8 * sum / (parts * parts) + 20.0 + 1.5 * random.normal();
        image.at<std::uint8_t>(y, x) = cv::saturate_cast<std::uint8_t>(value);
      }
    }
    cv::GaussianBlur(image, image, cv::Size(), 0.6);
    return image;
  }

 private:
  double seen(const Eigen::Matrix3d& back, const cv::Point2f& ray) const {
    const Eigen::Vector3d place = back * Eigen::Vector3d(ray.x, ray.y, 1.0);
    if (!(place.z() > 0.0)) return wall;
    // The margin and the first square lie before the first inner corner.
    const double mm = 1e3, offset = 2.0 * board_.square * mm;
    const double x = (place.x() / place.z() * mm + offset) * pixels_per_mm;
    const double y = (place.y() / place.z() * mm + offset) * pixels_per_mm;
    if (!(x >= 0.0 && y >= 0.0 && x < print_.cols && y < print_.rows)) return wall;
    return print_.at<std::uint8_t>(static_cast<int>(y), static_cast<int>(x));
  }

  static constexpr double wall = 120.0;
  CalibrationBoard board_;
  Camera camera_;
  cv::Mat print_;
  std::vector<cv::Point2f> rays_;
};

/// 640x480 with a usual lens.
inline Camera usual_camera() {
  Camera camera;
  camera.fx = 517.3, camera.fy = 516.5, camera.cx = 318.6, camera.cy = 245.3;
  camera.distortion = {.k1 = 0.12, .k2 = -0.25, .p1 = -0.002, .p2 = 0.0015, .k3 = 0.05};
  return camera;
}

/// 640x480, 130 degrees wide.
inline Camera wide_camera() {
  Camera camera;
  camera.fx = 252.0, camera.fy = 253.0, camera.cx = 322.5, camera.cy = 237.0;
  camera.distortion = {.k1 = 0.02, .k2 = -0.006, .k3 = 0.002, .k4 = -0.0008, .lens = Lens::fisheye};
  return camera;
}

}  // namespace holdfast::test
