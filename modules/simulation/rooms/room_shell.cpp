// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/simulation/pictures.hpp"
#include "room_builder.hpp"

namespace holdfast::simulation {

using Eigen::AlignedBox3f;
using Eigen::Vector3f;

namespace {
// The part of an area that a part of its rectangle shows; shares of its width and height.
TextureArea part(const TextureArea& area, float left, float top, float right, float bottom) {
  return {area.texture, area.u + left * area.width, area.v + top * area.height, (right - left) * area.width,
          (bottom - top) * area.height};
}

const cv::Scalar skirting(60, 95, 140);
constexpr float wall_thickness = 0.12F, skirting_height = 0.09F;
}  // namespace

void RoomBuilder::shell(const Shell& shell) {
  const float width = shell.width, depth = shell.depth, height = shell.height;
  Object& walls = add("wall", {});
  const Vector3f x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
  const cv::Scalar colours[] = {{205, 215, 218}, {190, 208, 205}, {208, 205, 195}, {185, 200, 212}};
  const auto wall = [&](int number, const Vector3f& origin, const Vector3f& along, float length) {
    const TextureArea area = paint(
        pictures::plaster(texels(length, height, shell.wall_density), colours[number], random_.fork(number + 1U)));
    const TextureArea strip = paint(
        pictures::wood(texels(length, skirting_height, shell.wall_density), skirting, 0, random_.fork(number + 11U)));
    const auto piece = [&](float from, float to, float bottom) {
      if (to - from < 0.01F) return;
      add_rectangle(walls.mesh, origin + from * along, along * (to - from), -z * (height - bottom),
                    part(area, from / length, 0, to / length, 1.0F - bottom / height), 0.2F);
      if (bottom == 0.0F)
        add_rectangle(walls.mesh, origin + from * along - z * (height - skirting_height) + 0.012F * (-z).cross(along),
                      along * (to - from), -z * skirting_height, part(strip, from / length, 0, to / length, 1), 0.25F);
    };
    const bool with_door = number == 0 && shell.door_from < shell.door_to;
    if (with_door) {
      piece(0, shell.door_from, 0);
      piece(shell.door_from, shell.door_to, door_height);
      piece(shell.door_to, length, 0);
    } else {
      piece(0, length, 0);
    }
  };
  wall(0, {0, depth, height}, x, width);  // seen from inside, +y wall: left to right is +x
  wall(1, {width, depth, height}, -y, depth);
  wall(2, {width, 0, height}, -x, width);
  wall(3, {0, 0, height}, y, depth);
  Object& floor = add("floor", {});
  add_rectangle(floor.mesh, {0, depth, 0}, x * width, -y * depth,
                paint(pictures::wood(texels(width, depth, shell.floor_density), {85, 125, 172}, 26, random())), 0.2F);
  Object& ceiling = add("ceiling", {});
  add_rectangle(ceiling.mesh, {0, 0, height}, x * width, y * depth,
                paint(pictures::plaster(texels(width, depth, shell.ceiling_density), {225, 228, 228}, random())), 0.4F);
  if (shell.door_from == shell.door_to) return;

  // Behind the doorway lies a piece of another room: wide enough that its side walls are seen through the door.
  Object& beyond = add("wall", {});
  const float left = shell.door_from - 0.35F, right = shell.door_to + 0.35F, near = depth + wall_thickness;
  const float far = depth + 1.5F, top = 2.3F;
  const auto plastered = [&](float length, std::uint64_t stream) {
    return paint(pictures::plaster(texels(length, top, 160.0), {165, 190, 200}, random_.fork(stream)));
  };
  add_rectangle(beyond.mesh, {left, far, top}, x * (right - left), -z * top, plastered(right - left, 21), 0.25F);
  add_rectangle(beyond.mesh, {left, near, top}, y * (far - near), -z * top, plastered(far - near, 22), 0.25F);
  add_rectangle(beyond.mesh, {right, far, top}, -y * (far - near), -z * top, plastered(far - near, 23), 0.25F);
  add_rectangle(beyond.mesh, {left, near, top}, x * (right - left), y * (far - near), plastered(1.0F, 24), 0.4F);
  add_rectangle(beyond.mesh, {left, far, 0}, x * (right - left), -y * (far - depth),
                paint(pictures::wood(texels(right - left, far - depth, 160.0), {70, 95, 125}, 24, random_.fork(25))),
                0.25F);
}

void RoomBuilder::corridor_section(double from, double to, double depth, double height) {
  const auto x0 = static_cast<float>(from), length = static_cast<float>(to - from), y1 = static_cast<float>(depth);
  const auto top = static_cast<float>(height);
  Object& walls = add("wall", {});
  const auto plastered = [&](const cv::Scalar& colour, std::uint64_t stream) {
    return paint(pictures::plaster(texels(length, height, 200.0), colour, random_.fork(stream)));
  };
  const auto strip = [&](std::uint64_t stream) {
    return paint(pictures::wood(texels(length, skirting_height, 200.0), skirting, 0, random_.fork(stream)));
  };
  const Vector3f along(length, 0, 0);
  add_rectangle(walls.mesh, {x0, y1, top}, along, {0, 0, -top}, plastered({205, 215, 218}, 1), 0.2F);
  add_rectangle(walls.mesh, {x0 + length, 0, top}, -along, {0, 0, -top}, plastered({208, 205, 195}, 2), 0.2F);
  add_rectangle(walls.mesh, {x0, y1 - 0.012F, skirting_height}, along, {0, 0, -skirting_height}, strip(3), 0.25F);
  add_rectangle(walls.mesh, {x0 + length, 0.012F, skirting_height}, -along, {0, 0, -skirting_height}, strip(4), 0.25F);
  Object& floor = add("floor", {});
  add_rectangle(floor.mesh, {x0, y1, 0}, along, {0, -y1, 0},
                paint(pictures::wood(texels(length, depth, 200.0), {85, 125, 172}, 26, random())), 0.2F);
  Object& ceiling = add("ceiling", {});
  add_rectangle(ceiling.mesh, {x0, 0, top}, along, {0, y1, 0},
                paint(pictures::plaster(texels(length, depth, 120.0), {225, 228, 228}, random())), 0.4F);
}

void RoomBuilder::end_walls(double width, double depth, double height) {
  const auto x1 = static_cast<float>(width), y1 = static_cast<float>(depth), top = static_cast<float>(height);
  Object& walls = add("wall", {});
  const TextureArea area = paint(pictures::plaster(texels(depth, height, 200.0), {190, 208, 205}, random()));
  add_rectangle(walls.mesh, {x1, y1, top}, {0, -y1, 0}, {0, 0, -top}, area, 0.2F);
  add_rectangle(walls.mesh, {0, 0, top}, {0, y1, 0}, {0, 0, -top}, area, 0.2F);
}

void RoomBuilder::door(const Place& place, double width) {
  const double height = door_height, edge = 0.06, thick = wall_thickness;
  {
    Object& frame = add("door frame", place);
    const auto wooden = [](cv::Size size, Random random) { return pictures::wood(size, {95, 130, 160}, 0, random); };
    const auto bar = [&](const AlignedBox3f& shape) { add_box(frame.mesh, shape, skin(shape, 250.0, wooden), 0.2F); };
    bar(box(0.0, -0.015, 0, edge, thick, height + edge));
    bar(box(-width - edge, -0.015, 0, -width, thick, height + edge));
    bar(box(-width, -0.015, height, 0, thick, height + edge));
  }
  Object& leaf = add("door", place);
  const AlignedBox3f shape = box(-width + 0.004, 0, 0.008, -0.004, 0.04, height - 0.004);
  BoxSkin sides = skin(shape, 220.0, [](cv::Size size, Random random) {
    return pictures::wood(size, {120, 150, 175}, 0, random);
  });
  add_box(leaf.mesh, shape, sides, 0.2F);
  // Four panels, a notice or two on either side, and the handle.
  const auto face = [&](double x0, double z0, double x1, double z1, const TextureArea& area, double out) {
    const auto w = static_cast<float>(x1 - x0), h = static_cast<float>(z1 - z0);
    add_rectangle(leaf.mesh, Vector3f(Eigen::Vector3d(x0, -out, z1).cast<float>()), {w, 0, 0}, {0, 0, -h}, area, 0.15F);
    add_rectangle(leaf.mesh, Vector3f(Eigen::Vector3d(x1, 0.04 + out, z1).cast<float>()), {-w, 0, 0}, {0, 0, -h}, area,
                  0.15F);
  };
  for (int i = 0; i < 4; ++i) {
    const double x0 = -width + (i % 2 == 0 ? 0.10 : 0.5 * width + 0.04), z0 = i < 2 ? 0.15 : 1.05;
    const double x1 = x0 + 0.5 * width - 0.14, z1 = z0 + (i < 2 ? 0.70 : 0.80);
    face(x0, z0, x1, z1,
         paint(pictures::wood(texels(x1 - x0, z1 - z0, 250.0), {75, 105, 140}, 0, random_.fork(30U + i))), 0.004);
  }
  face(-0.66, 1.30, -0.45, 1.597, paint(pictures::page({300, 424}, random_.fork(40))), 0.006);
  face(-0.36, 1.18, -0.15, 1.477, paint(pictures::poster({300, 424}, random_.fork(41))), 0.006);
  face(-0.58, 1.68, -0.28, 1.78, paint(pictures::label({360, 120}, random_.fork(42))), 0.006);
  face(-0.60, 0.40, -0.30, 0.80, paint(pictures::poster({380, 506}, random_.fork(43))), 0.006);
  const BoxSkin metal = plain_skin({120, 125, 130});
  for (const double side : {-0.055, 0.04}) {
    add_box(leaf.mesh, box(-width + 0.04, side < 0 ? -0.012 : 0.04, 0.93, -width + 0.09, side < 0 ? 0 : 0.052, 1.13),
            metal, 0.3F, false);
    add_box(leaf.mesh, box(-width + 0.05, side, 1.05, -width + 0.18, side + 0.015, 1.07), metal, 0.3F, false);
  }
}

void RoomBuilder::repeat(std::size_t from, std::size_t to, const Eigen::Vector3d& offset) {
  for (std::size_t i = from; i < to; ++i) {
    Object copy = world_.objects[i];
    Object& added = add(copy.class_name, {});
    copy.name = added.name;
    copy.T_world_object.pretranslate(offset);
    added = std::move(copy);
  }
}

}  // namespace holdfast::simulation
