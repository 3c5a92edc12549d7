// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "holdfast/simulation/pictures.hpp"
#include "room_builder.hpp"

namespace holdfast::simulation {

using Eigen::AlignedBox3f;
using Eigen::Vector3f;

namespace {
const cv::Scalar light_wood(120, 165, 205), dark_wood(60, 95, 140), grey_plastic(150, 152, 155),
    black_plastic(38, 36, 36);
}  // namespace

Object& RoomBuilder::add(const std::string& class_name, const Place& place) {
  const auto same = std::count_if(world_.objects.begin(), world_.objects.end(),
                                  [&](const Object& object) { return object.class_name == class_name; });
  Object& object = world_.objects.emplace_back();
  object.class_name = class_name;
  object.name = class_name + " " + std::to_string(same + 1);
  object.T_world_object.translation() = Eigen::Vector3d(place.x, place.y, place.z);
  object.T_world_object.linear() = Eigen::AngleAxisd(place.yaw, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  std::uint64_t hash = 14695981039346656037ULL;  // FNV-1a of the name
  for (const char letter : object.name) hash = (hash ^ static_cast<std::uint8_t>(letter)) * 1099511628211ULL;
  random_ = Random(seed_).fork(hash);
  return object;
}

BoxSkin RoomBuilder::plain_skin(const cv::Scalar& colour) {
  const TextureArea area = paint(pictures::plain({96, 96}, colour, random_.fork(77)));
  random_.next();
  return {area, area, area, area, area, area};
}

void RoomBuilder::rug(const Place& place, double width, double depth) {
  Object& object = add("rug", place);
  const AlignedBox3f shape = box(-width / 2, -depth / 2, 0, width / 2, depth / 2, 0.012);
  BoxSkin sides = plain_skin({45, 40, 110});
  sides[top] = paint(pictures::rug(texels(width, depth, 330.0), random_));
  add_box(object.mesh, shape, sides, 0.12F, false);
}

void RoomBuilder::desk(const Place& place, double width, double depth) {
  Object& object = add("desk", place);
  const auto wooden = [](cv::Size size, Random random) { return pictures::wood(size, light_wood, 0, random); };
  const AlignedBox3f board = box(-width / 2, -depth / 2, 0.70, width / 2, depth / 2, 0.73);
  add_box(object.mesh, board, skin(board, 400.0, wooden), 0.08F);
  const AlignedBox3f modesty = box(-width / 2 + 0.06, depth / 2 - 0.08, 0.25, width / 2 - 0.06, depth / 2 - 0.06, 0.70);
  add_box(object.mesh, modesty, skin(modesty, 200.0, wooden), 0.2F);
  const BoxSkin metal = plain_skin(grey_plastic);
  for (const double side : {-1.0, 1.0})
    for (const double end : {-1.0, 1.0}) {
      const double x = side * (width / 2 - 0.05), y = end * (depth / 2 - 0.06);
      add_box(object.mesh, box(x - 0.025, y - 0.025, 0, x + 0.025, y + 0.025, 0.70), metal, 0.2F);
    }
  // A container with drawers under the right end.
  const AlignedBox3f drawers = box(width / 2 - 0.52, -depth / 2 + 0.05, 0.06, width / 2 - 0.10, depth / 2 - 0.12, 0.64);
  add_box(object.mesh, drawers,
          skin(drawers, 250.0, [](cv::Size size, Random random) { return pictures::wood(size, dark_wood, 0, random); }),
          0.2F);
  for (int i = 0; i < 3; ++i) {
    const double z = 0.16 + 0.19 * i;
    add_box(object.mesh, box(width / 2 - 0.36, -depth / 2 + 0.03, z, width / 2 - 0.26, -depth / 2 + 0.05, z + 0.02),
            metal, 0.2F, false);
  }
}

void RoomBuilder::chair(const Place& place) {
  Object& object = add("chair", place);
  const cv::Scalar cloth = pictures::colour_between({60, 40, 30}, {140, 90, 110}, random_);
  const auto covered = [&](cv::Size size, Random random) { return pictures::fabric(size, cloth, random); };
  const AlignedBox3f seat = box(-0.24, -0.24, 0.43, 0.24, 0.23, 0.50);
  add_box(object.mesh, seat, skin(seat, 350.0, covered), 0.1F);
  const AlignedBox3f rest = box(-0.21, 0.21, 0.62, 0.21, 0.27, 1.05);
  add_box(object.mesh, rest, skin(rest, 350.0, covered), 0.1F);
  const TextureArea plastic = plain_skin(black_plastic)[front];
  add_bar(object.mesh, {{0, 0.16F, 0.44F}, {0, 0.27F, 0.47F}, {0, 0.28F, 0.70F}}, 0.018F, plastic, 6);
  add_cylinder(object.mesh, {0, 0, 0.08F}, 0.03F, 0.03F, 0.36F, plastic, plastic, 10);
  for (int i = 0; i < 5; ++i) {
    const float angle = 1.2566F * static_cast<float>(i) + 0.3F;
    const Vector3f out(std::cos(angle), std::sin(angle), 0);
    add_bar(object.mesh, {Vector3f(0, 0, 0.12F), out * 0.28F + Vector3f(0, 0, 0.06F)}, 0.018F, plastic, 5);
    add_cylinder(object.mesh, out * 0.28F, 0.026F, 0.026F, 0.05F, plastic, plastic, 8, false);
  }
  for (const float side : {-1.0F, 1.0F}) {
    add_bar(object.mesh, {{side * 0.23F, 0.05F, 0.46F}, {side * 0.28F, 0.05F, 0.50F}, {side * 0.28F, 0.05F, 0.66F}},
            0.014F, plastic, 5);
    add_box(object.mesh, box(side * 0.28 - 0.03, -0.12, 0.66, side * 0.28 + 0.03, 0.14, 0.69),
            plain_skin(black_plastic), 0.2F);
  }
}

void RoomBuilder::cabinet(const Place& place, double width, double depth, double height) {
  Object& object = add("cabinet", place);
  const cv::Scalar tone = random_.uniform() < 0.5 ? light_wood : cv::Scalar(150, 160, 165);
  const AlignedBox3f body = box(-width / 2, -depth / 2, 0, width / 2, depth / 2, height);
  add_box(object.mesh, body,
          skin(body, 250.0, [&](cv::Size size, Random random) { return pictures::wood(size, tone, 0, random); }),
          0.15F);
  const BoxSkin metal = plain_skin(grey_plastic * 0.6);
  const int rows = std::max(1, static_cast<int>(height / 0.3));
  for (int i = 0; i < rows; ++i) {
    const double z = height * (i + 1) / rows;
    add_box(object.mesh, box(-width / 2 + 0.02, -depth / 2 - 0.004, z - 0.012, width / 2 - 0.02, -depth / 2, z - 0.004),
            plain_skin(black_plastic), 0.5F, false);
    add_box(object.mesh, box(-0.07, -depth / 2 - 0.03, z - 0.09, 0.07, -depth / 2, z - 0.07), metal, 0.5F, false);
    const TextureArea tag = paint(pictures::page({60, 40}, random_.fork(50U + static_cast<unsigned>(i))));
    add_rectangle(object.mesh,
                  Vector3f(static_cast<float>(-width / 2 + 0.05), static_cast<float>(-depth / 2 - 0.002),
                           static_cast<float>(z - 0.05)),
                  {0.09F, 0, 0}, {0, 0, -0.06F}, tag, 0.5F);
  }
}

void RoomBuilder::cardboard_box(const Place& place, double width, double depth, double height) {
  Object& object = add("box", place);
  const AlignedBox3f shape = box(-width / 2, -depth / 2, 0, width / 2, depth / 2, height);
  add_box(object.mesh, shape,
          skin(
              shape, 450.0, [](cv::Size size, Random random) { return pictures::cardboard(size, random); }, true),
          0.1F);
}

void RoomBuilder::row_of_books(Object& object, double from, double to, double front_y, double ground,
                               double most_height) {
  Random random = random_.fork(0xb00c);
  random_.next();
  const BoxSkin pages = plain_skin({170, 195, 205});
  for (double x = from; x < to - 0.015;) {
    if (random.uniform() < 0.12) {
      x += random.uniform(0.04, 0.18);
      continue;
    }
    const double thick = std::min(random.uniform(0.022, 0.062), to - x),
                 height = most_height * random.uniform(0.72, 0.97);
    const double back_off = random.uniform(0.0, 0.03), deep = random.uniform(0.13, 0.19);
    const auto place = static_cast<std::int64_t>(x * 1e4);  // may be negative
    const TextureArea spine =
        paint(pictures::book_spine(texels(thick, height, 700.0), random.fork(static_cast<std::uint64_t>(place))));
    // Covers continue the colour of the spine's upper end. Backs and undersides are never seen.
    const TextureArea cover{spine.texture, 0.3F * spine.width, 2.0F, 0.4F * spine.width, 0.1F * spine.height};
    const Vector3f low(Eigen::Vector3d(x, front_y + back_off, ground).cast<float>());
    const auto w = static_cast<float>(thick - 0.001), d = static_cast<float>(deep), h = static_cast<float>(height);
    const Vector3f right_way(w, 0, 0), back_way(0, d, 0), up(0, 0, h);
    add_rectangle(object.mesh, low + up, right_way, -up, spine, 0.3F);
    add_rectangle(object.mesh, low + up + back_way, -back_way, -up, cover, 0.3F);
    add_rectangle(object.mesh, low + up + right_way, back_way, -up, cover, 0.3F);
    add_rectangle(object.mesh, low + up + back_way, right_way, -back_way, pages[front], 0.3F);
    x += thick;
    random.next();
  }
}

void RoomBuilder::bookcase(const Place& place, double width, double height) {
  Object& object = add("bookcase", place);
  constexpr double depth = 0.30, thick = 0.025;
  const auto wooden = [](cv::Size size, Random random) { return pictures::wood(size, dark_wood, 0, random); };
  for (const double x : {-width / 2, width / 2 - thick}) {
    const AlignedBox3f side = box(x, -depth / 2, 0, x + thick, depth / 2, height);
    add_box(object.mesh, side, skin(side, 250.0, wooden), 0.15F);
  }
  const AlignedBox3f panel = box(-width / 2, depth / 2 - 0.01, 0, width / 2, depth / 2, height);
  add_box(object.mesh, panel, skin(panel, 200.0, wooden), 0.15F);
  const int boards = std::max(2, static_cast<int>(height / 0.34));
  const int closed = boards / 3;  // lower rows behind doors
  const auto row = [&](int i) { return 0.05 + (height - 0.05 - thick) * i / boards; };
  for (int i = 0; i <= boards; ++i) {
    const double z = row(i);
    const AlignedBox3f board = box(-width / 2 + thick, -depth / 2, z, width / 2 - thick, depth / 2 - 0.01, z + thick);
    if (i == 0 || i >= closed) add_box(object.mesh, board, skin(board, 250.0, wooden), 0.15F);
    if (i >= closed && i < boards)
      row_of_books(object, -width / 2 + thick + 0.005, width / 2 - thick - 0.005, -depth / 2 + 0.02, z + thick,
                   height / boards - 0.05);
  }
  if (closed == 0) return;
  const BoxSkin metal = plain_skin(grey_plastic);
  for (const double side : {-1.0, 1.0}) {
    const double from = side < 0 ? -width / 2 + thick : 0.002, to = side < 0 ? -0.002 : width / 2 - thick;
    const AlignedBox3f leaf = box(from, -depth / 2 - 0.012, row(0), to, -depth / 2, row(closed));
    add_box(object.mesh, leaf, skin(leaf, 250.0, wooden), 0.15F, false);
    const double handle = side * 0.06;
    add_box(object.mesh,
            box(handle - 0.008, -depth / 2 - 0.035, row(closed) - 0.22, handle + 0.008, -depth / 2 - 0.012,
                row(closed) - 0.1),
            metal, 0.2F, false);
  }
}

void RoomBuilder::wall_shelf(const Place& place, double width) {
  Object& object = add("shelf", place);
  const AlignedBox3f board = box(-width / 2, -0.12, -0.025, width / 2, 0.12, 0);
  add_box(object.mesh, board,
          skin(board, 400.0, [](cv::Size size, Random random) { return pictures::wood(size, light_wood, 0, random); }),
          0.1F);
  row_of_books(object, -width / 2 + 0.02, width / 2 - 0.05, -0.10, 0.0, 0.27);
}

void RoomBuilder::poster(const Place& place, double width, double height) {
  Object& object = add("poster", place);
  const AlignedBox3f sheet = box(-width / 2, -0.004, -height / 2, width / 2, 0, height / 2);
  BoxSkin sides = plain_skin({200, 200, 200});
  sides[front] = paint(pictures::poster(texels(width, height, 450.0), random_));
  add_box(object.mesh, sheet, sides, 0.2F, false);
}

void RoomBuilder::painting(const Place& place, double width, double height) {
  Object& object = add("picture", place);
  const AlignedBox3f canvas = box(-width / 2, -0.03, -height / 2, width / 2, 0, height / 2);
  BoxSkin sides = plain_skin({28, 45, 70});
  sides[front] = paint(pictures::painting(texels(width, height, 450.0), random_));
  add_box(object.mesh, canvas, sides, 0.2F, false);
}

void RoomBuilder::four_legs(Object& object, double width, double depth, double height) {
  const auto wooden = [](cv::Size size, Random random) { return pictures::wood(size, light_wood, 0, random); };
  const AlignedBox3f board = box(-width / 2, -depth / 2, height - 0.03, width / 2, depth / 2, height);
  add_box(object.mesh, board, skin(board, 350.0, wooden), 0.08F);
  const BoxSkin metal = plain_skin(grey_plastic);
  for (const double side : {-1.0, 1.0})
    for (const double end : {-1.0, 1.0}) {
      const double x = side * (width / 2 - 0.05), y = end * (depth / 2 - 0.05);
      add_box(object.mesh, box(x - 0.025, y - 0.025, 0, x + 0.025, y + 0.025, height - 0.03), metal, 0.2F);
    }
}

void RoomBuilder::table(const Place& place, double width, double depth, double height) {
  four_legs(add("table", place), width, depth, height);
}

void RoomBuilder::stool(const Place& place, double width, double depth, double height) {
  four_legs(add("stool", place), width, depth, height);
}

void RoomBuilder::partition(const Place& place, double width, double height) {
  Object& object = add("partition", place);
  const cv::Scalar cloth = pictures::colour_between({70, 60, 50}, {150, 130, 130}, random_);
  const auto covered = [&](cv::Size size, Random random) { return pictures::fabric(size, cloth, random); };
  const AlignedBox3f panel = box(-width / 2, -0.025, 0.08, width / 2, 0.025, height);
  add_box(object.mesh, panel, skin(panel, 200.0, covered), 0.15F);
  const BoxSkin metal = plain_skin(grey_plastic);
  for (const double x : {-width / 2 + 0.08, width / 2 - 0.08})
    add_box(object.mesh, box(x - 0.03, -0.2, 0, x + 0.03, 0.2, 0.04), metal, 0.2F, false);
  for (const float side : {-1.0F, 1.0F})
    for (double x = -width / 2 + 0.08; x < width / 2 - 0.30;) {
      const bool printed = random_.uniform() < 0.6;
      const double wide = printed ? 0.21 : random_.uniform(0.22, 0.34), high = wide * 1.414;
      const double z = random_.uniform(std::max(0.3, height - 0.75), height - 0.04 - high);
      const std::uint64_t stream = random_.next();
      const TextureArea sheet = paint(printed ? pictures::page(texels(wide, high, 1000.0), Random(stream))
                                              : pictures::poster(texels(wide, high, 800.0), Random(stream)));
      const auto left_x = static_cast<float>(side < 0 ? x : x + wide);
      add_rectangle(object.mesh, {left_x, side * 0.028F, static_cast<float>(z + high)},
                    {-side * static_cast<float>(wide), 0, 0}, {0, 0, static_cast<float>(-high)}, sheet, 0.2F);
      x += wide + random_.uniform(0.03, 0.22);
    }
}

void RoomBuilder::notice_board(const Place& place, double width, double height) {
  Object& object = add("notice board", place);
  const AlignedBox3f board = box(-width / 2, -0.02, -height / 2, width / 2, 0, height / 2);
  BoxSkin sides = plain_skin({70, 110, 150});
  cv::Mat cork = pictures::fabric(texels(width, height, 400.0), {85, 130, 175}, random_.fork(1));
  for (int x = 12; x + 100 < cork.cols;) {
    const int wide = 84 + static_cast<int>(random_.below(40));
    int y = 10 + static_cast<int>(random_.below(30));
    while (true) {
      const bool printed = random_.uniform() < 0.7;
      const int high = static_cast<int>(wide * (printed ? 1.41 : random_.uniform(0.6, 1.2)));
      if (x + wide + 6 > cork.cols || y + high + 6 > cork.rows) break;
      const Random own(random_.next());
      (printed ? pictures::page({wide, high}, own) : pictures::poster({wide, high}, own))
          .copyTo(cork(cv::Rect(x, y, wide, high)));
      y += high + 6 + static_cast<int>(random_.below(24));
    }
    x += wide + 6 + static_cast<int>(random_.below(20));
  }
  sides[front] = paint(cork);
  add_box(object.mesh, board, sides, 0.2F, false);
}

}  // namespace holdfast::simulation
