// SPDX-License-Identifier: BSD-3-Clause
#include "scene_preview.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

namespace holdfast {

namespace {

using simulation::NumberedObject;
using simulation::Simulator;

constexpr int tile_width = 240;
constexpr double plan_margin = 0.35;  // around the walls [m]
constexpr int letters = cv::FONT_HERSHEY_SIMPLEX;

/// A colour of its own for every number.
cv::Scalar colour_of(int number) {
  static const cv::Scalar colours[] = {{60, 60, 255},  {60, 220, 60},  {255, 140, 40}, {40, 220, 255},
                                       {255, 60, 220}, {255, 255, 60}, {80, 160, 255}, {200, 120, 255}};
  return colours[static_cast<std::size_t>(number - 1) % std::size(colours)];
}

void write(cv::Mat& image, const std::string& text, cv::Point position, double size, const cv::Scalar& colour) {
  cv::putText(image, text, position, letters, size, {0, 0, 0}, 3, cv::LINE_AA);
  cv::putText(image, text, position, letters, size, colour, 1, cv::LINE_AA);
}

cv::Mat tile(Simulator& simulator, std::uint64_t index) {
  const SensorFrame frame = simulator.frame(index);
  const cv::Size size(tile_width, frame.colour.rows * tile_width / frame.colour.cols);
  cv::Mat picture, mask;
  cv::resize(frame.colour, picture, size, 0, 0, cv::INTER_AREA);
  cv::resize(frame.truth->object_mask, mask, size, 0, 0, cv::INTER_NEAREST);
  for (const NumberedObject& numbered : simulator.numbered_objects()) {
    const cv::Mat own = mask == numbered.number;
    if (cv::countNonZero(own) < 30) continue;
    std::vector<std::vector<cv::Point>> outlines;
    cv::findContours(own, outlines, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_SIMPLE);
    cv::drawContours(picture, outlines, -1, colour_of(numbered.number), 1, cv::LINE_AA);
    const cv::Rect box = cv::boundingRect(own);
    const auto& moving = frame.truth->moving_objects;
    const bool moves = std::binary_search(moving.begin(), moving.end(), numbered.number);
    write(picture, std::to_string(numbered.number) + (moves ? " moves" : ""), {box.x + 2, std::max(26, box.y + 12)},
          0.36, colour_of(numbered.number));
  }
  char text[32];
  std::snprintf(text, sizeof(text), "%.1f s", frame.timestamp);
  write(picture, text, {4, 12}, 0.38, {255, 255, 255});
  return picture;
}

/// The room from so high above that it looks like a plan. Faces that look up show; the ceiling does not.
class FloorPlan {
 public:
  FloorPlan(Simulator& simulator, cv::Size size) {
    const Eigen::AlignedBox3d& walls = simulator.stage().walls;
    constexpr double height = 60.0;
    const Eigen::Vector3d extent = walls.sizes() + Eigen::Vector3d::Constant(2.0 * plan_margin);
    const double pixels_per_metre = std::min(size.width / extent.x(), size.height / extent.y());
    camera_.width = size.width, camera_.height = size.height;
    camera_.fx = camera_.fy = pixels_per_metre * height;
    camera_.cx = 0.5 * size.width, camera_.cy = 0.5 * size.height;
    Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();
    T_world_camera.linear() =
        Eigen::Vector3d(1, -1, -1).asDiagonal();  // x right, y of the image down: y of the room up
    T_world_camera.translation() = walls.center();
    T_world_camera.translation().z() = height;
    T_camera_world_ = T_world_camera.inverse();
    simulation::Renderer renderer(simulator.world(), camera_);
    picture_ = renderer.render(T_world_camera, 0.0).colour;
    draw_grid(walls);
  }

  void draw_way(const std::vector<Eigen::Vector3d>& places, const cv::Scalar& colour, const std::string& name) {
    for (std::size_t i = 1; i < places.size(); ++i)
      cv::line(picture_, pixel(places[i - 1]), pixel(places[i]), colour, 2, cv::LINE_AA);
    cv::circle(picture_, pixel(places.front()), 5, colour, cv::FILLED, cv::LINE_AA);
    write(picture_, name, pixel(places.front()) + cv::Point(7, -5), 0.42, colour);
  }

  void draw_gaze(const Eigen::Isometry3d& T_world_camera) {
    const Eigen::Vector3d ahead = T_world_camera * Eigen::Vector3d(0, 0, 0.35);
    cv::line(picture_, pixel(T_world_camera.translation()), pixel(ahead), {255, 255, 255}, 1, cv::LINE_AA);
  }

  const cv::Mat& picture() const { return picture_; }

 private:
  cv::Point pixel(Eigen::Vector3d place) const {
    place.z() = 0.0;
    const Eigen::Vector2d position = camera_.project(T_camera_world_ * place);
    return {static_cast<int>(std::lround(position.x())), static_cast<int>(std::lround(position.y()))};
  }

  void draw_grid(const Eigen::AlignedBox3d& walls) {
    const auto mark = [&](double x, double y, double x_end, double y_end, int metres) {
      cv::line(picture_, pixel({x, y, 0}), pixel({x_end, y_end, 0}), {120, 120, 120}, 1, cv::LINE_AA);
      write(picture_, std::to_string(metres), pixel({x, y, 0}) + cv::Point(2, -3), 0.36, {255, 255, 255});
    };
    const int step = walls.sizes().x() > 100.0 ? 50 : 1;
    const auto first = [&](double from) { return step * static_cast<int>(std::ceil(from / step)); };
    for (int x = first(walls.min().x()); x <= walls.max().x(); x += step)
      mark(x, walls.min().y(), x, walls.max().y(), x);
    for (int y = first(walls.min().y()); y <= walls.max().y(); y += step)
      mark(walls.min().x(), y, walls.max().x(), y, y);
  }

  Camera camera_;
  Eigen::Isometry3d T_camera_world_;
  cv::Mat picture_;
};

cv::Mat floor_plan(Simulator& simulator, cv::Size size) {
  FloorPlan plan(simulator, size);
  const std::uint64_t count = simulator.frame_count(), step = std::max<std::uint64_t>(1, count / 400);
  for (const NumberedObject& numbered : simulator.numbered_objects()) {
    std::vector<Eigen::Vector3d> places;
    for (std::uint64_t i = 0; i < count; i += step)
      places.push_back(simulator.object(numbered).pose(simulator.timestamp(i)).translation());
    plan.draw_way(places, colour_of(numbered.number),
                  std::to_string(numbered.number) + " " + simulator.object(numbered).name);
  }
  std::vector<Eigen::Vector3d> places;
  for (std::uint64_t i = 0; i < count; i += step) places.push_back(simulator.T_world_camera(i).translation());
  plan.draw_way(places, {255, 255, 255}, "camera");
  for (std::uint64_t i = 0; i < count; i += std::max<std::uint64_t>(1, count / 16))
    plan.draw_gaze(simulator.T_world_camera(i));
  return plan.picture();
}

}  // namespace

cv::Mat scene_preview(Simulator& simulator, int columns, int rows) {
  const auto tiles = static_cast<std::uint64_t>(columns) * static_cast<std::uint64_t>(rows);
  const Camera& camera = simulator.camera();
  const cv::Size one(tile_width, camera.height * tile_width / camera.width);
  const int width = columns * one.width, height = rows * one.height;
  const Eigen::Vector3d room = simulator.stage().walls.sizes() + Eigen::Vector3d::Constant(2.0 * plan_margin);
  const int plan_height = static_cast<int>(width * std::min(0.5, room.y() / room.x()));
  cv::Mat picture(height + plan_height, width, CV_8UC3);
  for (std::uint64_t k = 0; k < tiles; ++k) {
    const std::uint64_t index = simulator.frame_count() * (2 * k + 1) / (2 * tiles);
    const cv::Point corner(static_cast<int>(k) % columns * one.width, static_cast<int>(k) / columns * one.height);
    tile(simulator, index).copyTo(picture(cv::Rect(corner, one)));
  }
  floor_plan(simulator, {width, plan_height}).copyTo(picture.rowRange(height, height + plan_height));
  return picture;
}

}  // namespace holdfast
