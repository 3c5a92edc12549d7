// SPDX-License-Identifier: BSD-3-Clause
#include "room_builder.hpp"
#include "rooms.hpp"

namespace holdfast::simulation {

namespace {
constexpr double width = 20.0, depth = 2.6, height = 2.6, pitch = 2.0;
constexpr int modules = 10;
constexpr int built = 5;  // the module that is furnished and copied

// What repeats, around x = `middle`: a desk at the wall y = depth, a cabinet across.
void furnish_module(RoomBuilder& room, double middle) {
  const auto desk = [&](double x, double y, double yaw = 0.0) { return Place{middle + x, 2.2 + y, table_top, yaw}; };
  room.desk({middle, 2.2, 0, 0}, 1.60, 0.75);
  room.monitor(desk(-0.18, 0.18, 0.1), 0.52);
  room.keyboard_and_mouse(desk(-0.15, -0.17, 0.05));
  room.book_pile(desk(0.58, 0.14, 0.3), 5);
  room.book_pile(desk(-0.66, 0.16, -0.2), 3);
  room.package(desk(0.36, 0.22, 0.4), 0.13, 0.09, 0.23);
  room.package(desk(0.26, 0.26, -0.1), 0.09, 0.08, 0.16);
  room.pen_holder(desk(0.40, -0.02));
  room.telephone(desk(0.55, -0.20, -0.3));
  room.page(desk(-0.62, -0.18, 0.2));
  room.page(desk(0.30, -0.22, -0.25));
  room.lamp(desk(-0.50, 0.25, 0.5));
  room.cable(desk(-0.1, 0.26), desk(0.5, 0.30));
  room.cable(desk(-0.2, 0.1), desk(-0.6, 0.28));
  room.wall_shelf({middle + 0.1, depth - 0.12, 1.55, 0}, 1.2);
  room.poster({middle - 0.72, depth, 1.45, 0}, 0.36, 0.51);
  room.painting({middle + 0.1, depth, 2.12, 0}, 0.8, 0.42);
  room.poster({middle - 1.0, depth, 1.95, 0}, 0.30, 0.42);
  room.cardboard_box({middle - 0.98, 2.36, 0, 0.1}, 0.32, 0.32, 0.36);

  room.cabinet({middle, 0.20, 0, 2 * quarter_turn}, 0.95, 0.36, 0.90);
  room.package({middle + 0.25, 0.18, 0.90, 0.5}, 0.22, 0.15, 0.28);
  room.book_pile({middle - 0.2, 0.19, 0.90, 0.2}, 4);
  room.notice_board({middle, 0, 1.65, 2 * quarter_turn}, 1.1, 0.75);
  room.poster({middle + 0.95, 0, 1.50, 2 * quarter_turn}, 0.55, 0.78);
  room.cardboard_box({middle + 0.98, 0.22, 0, 1.4}, 0.36, 0.34, 0.40);
  room.cardboard_box({middle + 0.96, 0.22, 0.40, 1.8}, 0.26, 0.24, 0.24);
}
}  // namespace

Stage corridor_stage() {
  Stage stage;
  stage.walls = {Eigen::Vector3d::Zero(), Eigen::Vector3d(width, depth, height)};
  stage.free_floor = {Eigen::Vector2d(0.5, 0.60), Eigen::Vector2d(width - 0.5, 1.75)};
  stage.home = {9.0, 1.02, 1.40};
  stage.target = {9.0, 2.35, 0.82};
  stage.table = {{9.0, 2.2}, {1.60, 0.75}, table_top};
  stage.table_edge = {9.0, 1.48, 1.12};
  stage.table_edge_target = {9.0, 2.35, 0.85};
  stage.spot = {9.0, 1.15, 1.40};
  stage.corridor.places = {{1.2, 1.15, 1.45}, {width - 1.2, 1.15, 1.45}};
  stage.corridor.closed = false;
  stage.corridor.aside = 0.6;
  stage.corridor.glance = 0.15;
  stage.loop.places = {{3.0, 0.85, 1.45}, {17.0, 0.85, 1.45}, {17.0, 1.40, 1.45}, {3.0, 1.40, 1.45}};
  stage.loop.rounding = 0.4;
  stage.loop.speed = 0.4;
  stage.loop.aside = 0.5;
  stage.square.places = {{9.0, 0.80, 1.4}, {9.9, 0.80, 1.4}, {9.9, 1.45, 1.4}, {8.1, 1.45, 1.4}, {8.1, 0.80, 1.4}};
  stage.square.speed = 0.25;
  stage.square.rounding = 0.3;
  stage.square.target = {9.0, 2.45, 0.95};
  return stage;
}

World make_corridor(std::uint64_t seed) {
  World world;
  RoomBuilder room(world, seed);
  room.end_walls(width, depth, height);
  room.poster({0, 0.75, 1.55, quarter_turn}, 0.8, 1.1);
  room.poster({0, 1.75, 1.55, quarter_turn}, 0.7, 1.0);
  room.bookcase({0.17, 1.3, 0, quarter_turn}, 1.0, 0.9);
  room.poster({width, 0.75, 1.55, -quarter_turn}, 0.8, 1.1);
  room.poster({width, 1.75, 1.55, -quarter_turn}, 0.7, 1.0);
  room.bookcase({width - 0.17, 1.3, 0, -quarter_turn}, 1.0, 0.9);

  const std::size_t from = room.mark();
  room.corridor_section(pitch * (built - 1), pitch * built, depth, height);
  furnish_module(room, pitch * (built - 0.5));
  const std::size_t mug = room.mark();
  room.mug({pitch * (built - 0.5) - 0.42, 2.02, table_top, 0.4});
  const std::size_t to = room.mark();
  for (int i = 0; i < modules; ++i) world.lamps.push_back({{static_cast<float>(pitch * (i + 0.5)), 1.2F, 2.4F}, 0.42F});
  world.ambient = 0.58F;
  // Copied with its light: lamps hang alike over all.
  Random random = Random(seed).fork(0xc0);
  for (int i = 0; i < modules; ++i) {
    const Eigen::Vector3d offset(pitch * (i + 1 - built), 0, 0);
    if (i + 1 != built) room.repeat(from, mug, offset);
    const double share = random.uniform();
    const double moved_y = random.uniform(-0.05, 0.04), moved_x = random.uniform(-0.05, 0.08);
    const Eigen::Vector3d moved(moved_x, moved_y, 0);
    if (i + 1 != built && share < 0.7) room.repeat(mug, to, offset + moved);
  }
  return world;
}

}  // namespace holdfast::simulation
