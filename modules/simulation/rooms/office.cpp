// SPDX-License-Identifier: BSD-3-Clause
#include "room_builder.hpp"
#include "rooms.hpp"

namespace holdfast::simulation {

namespace {
constexpr double stool_height = 0.40;
constexpr double door_left = 1.40, door_right = 2.25;

void furnish_desks(RoomBuilder& room, Random random) {
  const auto yaw = [&] { return random.uniform(-0.35, 0.35); };
  const auto on_desk = [&](double x, double y) {
    return Place{x + random.uniform(-0.03, 0.03), y + random.uniform(-0.02, 0.02), table_top, yaw()};
  };
  room.desk({3.35, 4.40, 0, 0}, 1.90, 0.85);
  room.desk({5.13, 4.45, 0, 0}, 1.50, 0.75);
  room.monitor({3.25, 4.55, table_top, 0.08}, 0.52);
  room.monitor({3.86, 4.52, table_top, -0.25}, 0.48);
  room.monitor({5.18, 4.55, table_top, -0.3}, 0.50);
  room.keyboard_and_mouse({3.30, 4.17, table_top, 0.06});
  room.keyboard_and_mouse({5.03, 4.22, table_top, -0.12});
  room.book_pile(on_desk(2.62, 4.42), 4);
  room.book_pile(on_desk(4.13, 4.20), 2);
  room.book_pile(on_desk(5.63, 4.35), 5);
  room.mug(on_desk(2.93, 4.22));
  room.mug(on_desk(3.82, 4.14));
  room.mug(on_desk(4.70, 4.36));
  room.pen_holder(on_desk(2.90, 4.46));
  room.pen_holder(on_desk(5.51, 4.62));
  room.package(on_desk(3.58, 4.33), 0.10, 0.07, 0.19);
  room.package(on_desk(2.78, 4.62), 0.16, 0.08, 0.24);
  room.package(on_desk(4.58, 4.58), 0.12, 0.09, 0.22);
  room.package(on_desk(4.76, 4.60), 0.09, 0.09, 0.15);
  room.telephone(on_desk(4.22, 4.52));
  room.lamp({2.52, 4.68, table_top, 0.4});
  for (const auto& [x, y] :
       {std::pair(2.82, 4.12), {3.72, 4.10}, {2.52, 4.18}, {3.98, 4.33}, {5.30, 4.20}, {4.60, 4.22}, {5.56, 4.18}})
    room.page(on_desk(x, y));
  for (int i = 0; i < 7; ++i) {
    const double x = random.uniform(2.55, 4.1);
    const Place to{x + random.uniform(-0.5, 0.5), random.uniform(4.2, 4.75), table_top, 0};
    const Place from{x, random.uniform(4.3, 4.7), table_top, 0};
    room.cable(from, to);
  }
  for (int i = 0; i < 3; ++i) {
    const Place to{random.uniform(5.08, 5.78), random.uniform(4.3, 4.7), table_top, 0};
    const Place from{random.uniform(4.58, 5.18), random.uniform(4.3, 4.7), table_top, 0};
    room.cable(from, to);
  }
}

void furnish_desk_wall(RoomBuilder& room) {
  room.wall_shelf({3.12, 4.88, 1.62, 0}, 1.40);
  room.wall_shelf({4.95, 4.88, 1.50, 0}, 1.20);
  room.poster({4.08, 5.0, 1.60, 0}, 0.42, 0.60);
  room.poster({4.22, 5.0, 1.12, 0}, 0.28, 0.40);
  room.poster({0.92, 5.0, 1.60, 0}, 0.60, 0.84);
  room.poster({5.76, 5.0, 1.62, 0}, 0.40, 0.56);
  room.painting({3.05, 5.0, 2.22, 0}, 0.80, 0.50);
  room.painting({4.85, 5.0, 2.18, 0}, 0.70, 0.45);
  room.clock({1.82, 5.0, 2.32, 0});
  for (const auto& [x, z] :
       {std::pair(2.52, 1.25), {2.76, 1.32}, {3.56, 1.32}, {4.48, 1.25}, {5.62, 1.18}, {0.62, 1.20}})
    room.poster({x, 5.0, z, 0}, 0.21, 0.297);
}

void furnish_around(RoomBuilder& room) {
  room.rug({3.0, 3.0, 0, 0.06}, 2.6, 1.7);
  room.chair({2.42, 3.62, 0, 2.2});
  room.chair({3.84, 3.64, 0, -0.45});
  room.chair({1.20, 1.10, 0, 0.9});
  room.cabinet({0.85, 4.72, 0, 0}, 0.80, 0.45, 0.95);
  room.package({0.65, 4.70, 0.95, 0.3}, 0.22, 0.15, 0.28);
  room.book_pile({1.02, 4.68, 0.95, 0.2}, 4);
  room.plant({1.95, 0.45, 0, 0}, 1.0);
  room.cardboard_box({0.92, 3.85, 0, 0.35}, 0.42, 0.36, 0.33);
  room.cardboard_box({0.88, 3.88, 0.33, 0.75}, 0.32, 0.28, 0.24);
  room.stool({3.13, 3.74, 0, 0}, 0.52, 0.40, stool_height);
  room.cardboard_box({3.13, 3.74, stool_height, 0.12}, 0.45, 0.35, 0.35);
  room.cardboard_box({5.35, 3.60, 0, 0.5}, 0.45, 0.40, 0.38);

  // Wall x = 6, seen looking to +x: its things face -x.
  room.bookcase({5.83, 2.70, 0, -quarter_turn}, 1.20, 2.0);
  room.cabinet({5.75, 1.30, 0, -quarter_turn}, 1.0, 0.45, 1.1);
  room.package({5.75, 1.10, 1.1, -1.2}, 0.3, 0.2, 0.3);
  room.poster({6.0, 1.30, 1.80, -quarter_turn}, 0.7, 0.9);
  room.poster({6.0, 3.80, 1.60, -quarter_turn}, 0.6, 0.84);
  room.painting({6.0, 4.45, 1.75, -quarter_turn}, 0.6, 0.45);
  room.poster({6.0, 0.45, 1.5, -quarter_turn}, 0.42, 0.6);
  // Wall x = 0.
  room.bookcase({0.17, 2.20, 0, quarter_turn}, 1.40, 1.9);
  room.poster({0.0, 3.35, 1.60, quarter_turn}, 0.6, 0.84);
  room.painting({0.0, 4.15, 1.75, quarter_turn}, 0.8, 0.55);
  room.poster({0.0, 0.80, 1.55, quarter_turn}, 0.7, 1.0);
  room.cardboard_box({0.40, 3.40, 0, 1.3}, 0.5, 0.4, 0.4);
  room.cardboard_box({0.42, 0.60, 0, 1.7}, 0.5, 0.45, 0.5);
  // Wall y = 0, behind the camera.
  room.desk({3.2, 0.45, 0, 2 * quarter_turn}, 1.6, 0.75);
  room.monitor({3.3, 0.35, table_top, 2 * quarter_turn + 0.2}, 0.5);
  room.keyboard_and_mouse({3.25, 0.65, table_top, 2 * quarter_turn});
  room.book_pile({2.75, 0.50, table_top, 1.0}, 3);
  room.package({3.75, 0.40, table_top, 3.0}, 0.14, 0.1, 0.22);
  room.page({2.98, 0.66, table_top, 2.9});
  room.chair({3.3, 1.15, 0, 0.2});
  room.poster({1.5, 0.0, 1.6, 2 * quarter_turn}, 0.8, 1.1);
  room.poster({3.9, 0.0, 1.55, 2 * quarter_turn}, 0.6, 0.84);
  room.painting({2.7, 0.0, 1.7, 2 * quarter_turn}, 0.9, 0.6);
  room.wall_shelf({4.9, 0.12, 1.4, 2 * quarter_turn}, 1.1);
  room.plant({5.3, 0.5, 0, 0}, 1.2);
}
}  // namespace

Stage office_stage() {
  Stage stage;
  stage.walls = {Eigen::Vector3d::Zero(), Eigen::Vector3d(6.0, 5.0, 2.6)};
  stage.free_floor = {Eigen::Vector2d(0.75, 1.60), Eigen::Vector2d(5.20, 3.25)};
  stage.home = {3.0, 2.45, 1.38};
  stage.target = {3.05, 4.3, 0.88};
  stage.table = {{3.35, 4.40}, {1.90, 0.85}, table_top};
  stage.table_edge = {3.10, 3.66, 1.12};
  stage.table_edge_target = {3.12, 4.55, 0.85};
  stage.spot = {3.0, 2.40, 1.40};
  stage.loop.places = {{3.1, 1.85, 1.4}, {4.9, 1.85, 1.4}, {4.9, 2.95, 1.4}, {1.3, 2.95, 1.4}, {1.3, 1.85, 1.4}};
  stage.loop.speed = 0.45;
  stage.loop.aside = 0.3;
  stage.loop.glance = 0.2;
  stage.corridor.places = {{1.6, 2.5, 1.4}, {4.6, 2.5, 1.4}};
  stage.corridor.closed = false;
  stage.corridor.speed = 0.45;
  stage.corridor.aside = 0.8;
  stage.square.places = {{3.0, 1.75, 1.4}, {3.8, 1.75, 1.4}, {3.8, 2.95, 1.4}, {2.3, 2.95, 1.4}, {2.3, 1.75, 1.4}};
  stage.square.speed = 0.35;
  stage.square.rounding = 0.4;
  stage.square.target = stage.target;
  return stage;
}

World make_office(std::uint64_t seed) {
  World world;
  RoomBuilder room(world, seed);
  room.shell({.door_from = door_left, .door_to = door_right});
  furnish_desk_wall(room);
  furnish_desks(room, Random(seed).fork(0xde5c));
  furnish_around(room);
  room.door({door_right, 5.0, 0, 0}, door_right - door_left);
  world.lamps = {{{1.6F, 3.0F, 2.45F}, 0.85F}, {{4.4F, 3.1F, 2.45F}, 0.80F}, {{3.0F, 1.0F, 2.4F}, 0.75F}};
  world.ambient = 0.62F;
  return world;
}

}  // namespace holdfast::simulation
