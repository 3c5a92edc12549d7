// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "holdfast/simulation/pictures.hpp"
#include "room_builder.hpp"

namespace holdfast::simulation {

using Eigen::AlignedBox3f;
using Eigen::Vector3f;

void RoomBuilder::monitor(const Place& place, double width) {
  Object& object = add("monitor", place);
  const double height = 0.6 * width, foot = 0.12;
  BoxSkin sides = plain_skin({40, 38, 38});
  sides[front] = paint(pictures::screen({640, 384}, random_.fork(1)));
  add_box(object.mesh, box(-width / 2, -0.025, foot, width / 2, 0.025, foot + height), sides, 0.1F);
  const BoxSkin plastic = plain_skin({45, 43, 42});
  add_box(object.mesh, box(-0.03, 0.025, 0.01, 0.03, 0.05, foot + 0.5 * height), plastic, 0.2F);
  add_cylinder(object.mesh, {0, 0.02F, 0}, 0.12F, 0.115F, 0.012F, plastic[front], plastic[top], 24);
}

void RoomBuilder::keyboard_and_mouse(const Place& place) {
  Object& object = add("keyboard", place);
  BoxSkin sides = plain_skin({120, 122, 122});
  sides[top] = paint(pictures::keyboard({660, 225}, random_.fork(1)));
  add_box(object.mesh, box(-0.22, -0.075, 0, 0.22, 0.075, 0.022), sides, 0.1F);
  BoxSkin mouse = plain_skin({60, 60, 62});
  mouse[top] = paint(pictures::plain({40, 70}, {90, 90, 95}, random_.fork(2)));
  add_box(object.mesh, box(0.28, -0.05, 0, 0.34, 0.055, 0.03), mouse, 0.1F);
  add_bar(object.mesh,
          {{0.31F, 0.055F, 0.008F}, {0.30F, 0.15F, 0.004F}, {0.22F, 0.24F, 0.004F}, {0.24F, 0.33F, 0.004F}}, 0.003F,
          mouse[front], 4);
}

void RoomBuilder::mug(const Place& place) {
  Object& object = add("mug", place);
  const TextureArea side = paint(pictures::label({256, 96}, random_.fork(1)));
  const TextureArea coffee = paint(pictures::plain({32, 32}, {25, 40, 70}, random_.fork(2)));
  add_cylinder(object.mesh, {0, 0, 0}, 0.040F, 0.043F, 0.095F, side, coffee, 20);
  add_bar(object.mesh, {{0.04F, 0, 0.08F}, {0.068F, 0, 0.075F}, {0.072F, 0, 0.045F}, {0.04F, 0, 0.02F}}, 0.006F,
          plain_skin({190, 195, 200})[front], 6);
}

void RoomBuilder::pen_holder(const Place& place) {
  Object& object = add("pen holder", place);
  const TextureArea side = paint(pictures::label({200, 80}, random_.fork(1)));
  add_cylinder(object.mesh, {0, 0, 0}, 0.04F, 0.04F, 0.10F, side,
               paint(pictures::plain({32, 32}, {20, 20, 20}, random_.fork(2))), 16);
  for (int i = 0; i < 9; ++i) {
    const auto y = static_cast<float>(random_.uniform(-0.022, 0.022)),
               x = static_cast<float>(random_.uniform(-0.022, 0.022));
    const Vector3f foot(x, y, 0.09F);
    const Vector3f tip = foot + Vector3f(foot.x(), foot.y(), static_cast<float>(random_.uniform(0.05, 0.1)));
    const cv::Scalar paint_colour = pictures::colour_between(cv::Scalar::all(20), cv::Scalar::all(240), random_);
    add_bar(object.mesh, {foot, tip}, 0.0045F, plain_skin(paint_colour)[front], 5);
  }
}

void RoomBuilder::package(const Place& place, double width, double depth, double height) {
  Object& object = add("package", place);
  const AlignedBox3f shape = box(-width / 2, -depth / 2, 0, width / 2, depth / 2, height);
  BoxSkin sides;
  for (int side = 0; side < 6; ++side) {
    const bool narrow = side == left || side == right, flat = side == top || side == bottom;
    const cv::Size size(static_cast<int>(900 * (narrow ? depth : width)) + 4,
                        static_cast<int>(900 * (flat ? depth : height)) + 4);
    sides[side] = paint(pictures::label(size, random_.fork(static_cast<std::uint64_t>(side) + 1)));
  }
  add_box(object.mesh, shape, sides, 0.1F);
}

void RoomBuilder::page(const Place& place) {
  Object& object = add("paper", place);
  BoxSkin sides = plain_skin({215, 220, 220});
  sides[top] = paint(pictures::page({210, 297}, random_.fork(1)));
  add_box(object.mesh, box(-0.105, -0.1485, 0, 0.105, 0.1485, 0.0015), sides, 0.15F, false);
}

void RoomBuilder::book_pile(const Place& place, int count) {
  double z = place.z;
  for (int i = 0; i < count; ++i) {
    Object& object = add("book", {place.x, place.y, z, place.yaw});
    const double thick = random_.uniform(0.015, 0.045), width = random_.uniform(0.15, 0.2),
                 depth = random_.uniform(0.2, 0.27);
    object.T_world_object.rotate(Eigen::AngleAxisd(random_.uniform(-0.35, 0.35), Eigen::Vector3d::UnitZ()));
    BoxSkin sides = plain_skin({185, 205, 212});
    sides[top] =
        paint(pictures::poster({static_cast<int>(width * 1100), static_cast<int>(depth * 1100)}, random_.fork(1)));
    sides[left] = paint(pictures::page({200, 30}, random_.fork(2)));
    cv::Mat spine;
    cv::rotate(pictures::book_spine({static_cast<int>(thick * 900), static_cast<int>(depth * 900)}, random_.fork(3)),
               spine, cv::ROTATE_90_COUNTERCLOCKWISE);
    sides[right] = paint(spine);
    add_box(object.mesh, box(-width / 2, -depth / 2, 0, width / 2, depth / 2, thick), sides, 0.1F);
    z += thick;
  }
}

void RoomBuilder::lamp(const Place& place) {
  Object& object = add("lamp", place);
  const cv::Scalar colour = pictures::colour_between(cv::Scalar::all(30), cv::Scalar::all(200), random_);
  const TextureArea metal = plain_skin(colour)[front];
  add_cylinder(object.mesh, {0, 0, 0}, 0.09F, 0.085F, 0.025F, metal, metal, 20);
  add_bar(object.mesh, {{0, 0, 0.02F}, {0.06F, 0, 0.25F}, {-0.08F, 0, 0.45F}}, 0.010F, metal, 6);
  add_cylinder(object.mesh, {-0.10F, 0, 0.38F}, 0.085F, 0.04F, 0.11F,
               paint(pictures::label({256, 64}, random_.fork(1))), metal, 20);
}

void RoomBuilder::telephone(const Place& place) {
  Object& object = add("telephone", place);
  BoxSkin sides = plain_skin({70, 72, 75});
  cv::Mat face = pictures::keyboard({220, 220}, random_.fork(1));
  cv::rectangle(face, {10, 10, 200, 60}, {120, 150, 130}, cv::FILLED);
  sides[top] = paint(face);
  add_box(object.mesh, box(-0.09, -0.1, 0, 0.11, 0.1, 0.05), sides, 0.1F);
  add_box(object.mesh, box(-0.15, -0.1, 0.02, -0.10, 0.1, 0.075), plain_skin({50, 50, 52}), 0.1F);
}

void RoomBuilder::cable(const Place& from, const Place& to) {
  Object& object = add("cable", {});
  const double shade = random_.uniform(15, 70);
  const TextureArea skin_area = plain_skin(cv::Scalar::all(shade))[front];
  std::vector<Vector3f> points;
  constexpr int steps = 14;
  const double wave_x = random_.uniform(0.02, 0.06), wave_y = random_.uniform(0.02, 0.06),
               phase = random_.uniform(0, 6.28);
  for (int i = 0; i <= steps; ++i) {
    const double t = static_cast<double>(i) / steps, bow = std::sin(3.14159 * t);
    points.emplace_back(static_cast<float>(from.x + t * (to.x - from.x) + bow * wave_x * std::sin(9.0 * t + phase)),
                        static_cast<float>(from.y + t * (to.y - from.y) + bow * wave_y * std::cos(11.0 * t + phase)),
                        static_cast<float>(from.z + t * (to.z - from.z) + 0.004));
  }
  add_bar(object.mesh, points, 0.0035F, skin_area, 5);
}

void RoomBuilder::clock(const Place& place) {
  Object& object = add("clock", place);
  cv::Mat face(160, 160, CV_8UC3, cv::Scalar(230, 235, 235));
  cv::circle(face, {80, 80}, 76, {30, 30, 30}, 6, cv::LINE_AA);
  for (int hour = 0; hour < 12; ++hour) {
    const double angle = hour * 0.5235988;
    const cv::Point outer(80 + static_cast<int>(64 * std::sin(angle)), 80 - static_cast<int>(64 * std::cos(angle)));
    cv::putText(face, std::to_string(hour == 0 ? 12 : hour), outer - cv::Point(7, -5), cv::FONT_HERSHEY_SIMPLEX, 0.45,
                {20, 20, 20}, 1, cv::LINE_AA);
  }
  const double minute = random_.uniform(0, 6.28), hour = random_.uniform(0, 6.28);
  cv::line(face, {80, 80}, {80 + static_cast<int>(52 * std::sin(minute)), 80 - static_cast<int>(52 * std::cos(minute))},
           {10, 10, 10}, 3, cv::LINE_AA);
  cv::line(face, {80, 80}, {80 + static_cast<int>(34 * std::sin(hour)), 80 - static_cast<int>(34 * std::cos(hour))},
           {10, 10, 10}, 5, cv::LINE_AA);
  BoxSkin sides = plain_skin({40, 40, 40});
  sides[front] = paint(face);
  add_box(object.mesh, box(-0.15, -0.04, -0.15, 0.15, 0, 0.15), sides, 0.2F, false);
}

void RoomBuilder::plant(const Place& place, double height) {
  Object& object = add("plant", place);
  const TextureArea pot = paint(pictures::fabric({256, 96}, {70, 105, 185}, random_.fork(1)));
  const auto pot_height = static_cast<float>(0.3 * height);
  add_cylinder(object.mesh, {0, 0, 0}, 0.10F, 0.14F, pot_height, pot,
               paint(pictures::fabric({96, 96}, {25, 40, 55}, random_.fork(2))), 20);
  const TextureArea leaf = paint(pictures::fabric({64, 96}, {50, 120, 70}, random_.fork(3)));
  for (int i = 0; i < 46; ++i) {
    const double angle = random_.uniform(0, 6.2832), rise = random_.uniform(0.1, 0.7) * height,
                 reach = random_.uniform(0.08, 0.3);
    const Vector3f out(static_cast<float>(std::cos(angle)), static_cast<float>(std::sin(angle)), 0);
    const Vector3f side(-out.y(), out.x(), 0);
    const auto base = static_cast<float>(random_.uniform(0.3, 0.75)),
               wide = static_cast<float>(random_.uniform(0.02, 0.05));
    const Vector3f root =
        out * static_cast<float>(reach) * base + Vector3f(0, 0, pot_height + static_cast<float>(rise));
    const Vector3f along =
        out * static_cast<float>(reach) * 0.7F + Vector3f(0, 0, static_cast<float>(random_.uniform(-0.06, 0.08)));
    add_bar(object.mesh, {Vector3f(0, 0, pot_height), 0.4F * root + Vector3f(0, 0, 0.5F * pot_height), root}, 0.003F,
            leaf, 4);
    // Both sides, for a leaf is seen from either.
    add_rectangle(object.mesh, root - wide * side, 2 * wide * side, along, leaf, 0.5F);
    add_rectangle(object.mesh, root + wide * side, -2 * wide * side, along, leaf, 0.5F);
  }
}

}  // namespace holdfast::simulation
