// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>

#include "room_builder.hpp"
#include "rooms.hpp"

namespace holdfast::simulation {

namespace {
constexpr double hall_width = 11.0, hall_depth = 9.0;

// Facing into the hall from its walls, and the same for things that stand free.
constexpr double from_north = 0.0, from_east = -quarter_turn, from_south = 2 * quarter_turn, from_west = quarter_turn;

// A place given in the frame of a piece of furniture.
Place at(const Place& frame, double x, double y, double z, double yaw = 0.0) {
  const double c = std::cos(frame.yaw), s = std::sin(frame.yaw);
  return {frame.x + c * x - s * y, frame.y + s * x + c * y, frame.z + z, frame.yaw + yaw};
}

// A desk of 1.6 m by 0.75 m with somebody's things, no two alike. Each number is drawn in a statement of its own: in
// which order a call's arguments are evaluated is left to the compiler.
void workplace(RoomBuilder& room, const Place& desk, Random random) {
  room.desk(desk, 1.60, 0.75);
  const double side = random.uniform() < 0.5 ? -1.0 : 1.0;
  const auto near = [&](double x, double y) {
    const double yaw = random.uniform(-0.4, 0.4), back = random.uniform(-0.03, 0.03),
                 aside = random.uniform(-0.05, 0.05);
    return at(desk, side * x + aside, y + back, table_top, yaw);
  };
  const double screen = random.uniform(0.44, 0.56), turned = random.uniform(-0.2, 0.2),
               aside = side * random.uniform(0.0, 0.15);
  room.monitor(at(desk, aside, 0.18, table_top, turned), screen);
  room.keyboard_and_mouse(at(desk, side * 0.05, -0.17, table_top, random.uniform(-0.1, 0.1)));
  const int books = 2 + static_cast<int>(random.below(5));
  room.book_pile(near(-0.58, 0.12), books);
  const double height = random.uniform(0.14, 0.27), thick = random.uniform(0.07, 0.12),
               wide = random.uniform(0.09, 0.18);
  room.package(near(0.62, 0.22), wide, thick, height);
  room.mug(near(-0.36, -0.12));
  room.page(near(-0.52, -0.18));
  room.page(near(0.55, -0.15));
  if (random.uniform() < 0.6) {
    const double high = random.uniform(0.15, 0.25);
    room.package(near(-0.38, 0.27), 0.10, 0.08, high);
  }
  if (random.uniform() < 0.5) room.pen_holder(near(0.42, 0.0));
  if (random.uniform() < 0.4) room.telephone(near(0.60, 0.0));
  if (random.uniform() < 0.4) room.lamp(near(-0.68, 0.22));
  const Place from = near(0.2, 0.25), to = near(-0.5, 0.28);
  room.cable(from, to);
}

void furnish_walls(RoomBuilder& room, const Random& random) {
  const auto work = [&](const Place& place, std::uint64_t stream) { workplace(room, place, random.fork(stream)); };
  const auto on_wall = [](const Place& foot, double height) { return Place{foot.x, foot.y, height, foot.yaw}; };

  // South, from west to east.
  const auto south = [](double x, double off) { return Place{x, off, 0, from_south}; };
  room.bookcase(south(1.0, 0.17), 1.3, 2.0);
  work(south(2.75, 0.40), 1);
  room.wall_shelf(on_wall(south(2.75, 0.12), 1.45), 1.3);
  room.poster(on_wall(south(2.5, 0), 2.05), 0.8, 0.56);
  room.cabinet(south(4.25, 0.25), 0.9, 0.45, 1.2);
  room.plant({4.05, 0.28, 1.2, 0}, 0.6);
  room.book_pile({4.45, 0.25, 1.2, 0.5}, 5);
  room.poster(on_wall(south(4.3, 0), 1.95), 0.6, 0.84);
  room.notice_board(on_wall(south(5.65, 0), 1.55), 1.5, 1.0);
  room.cardboard_box({5.3, 0.35, 0, 0.2}, 0.5, 0.42, 0.4);
  room.cardboard_box({5.95, 0.32, 0, -0.3}, 0.45, 0.4, 0.5);
  room.cardboard_box({5.25, 0.34, 0.4, 0.5}, 0.36, 0.3, 0.28);
  work(south(7.45, 0.40), 2);
  room.painting(on_wall(south(7.1, 0), 1.70), 0.8, 0.6);
  room.poster(on_wall(south(7.95, 0), 1.65), 0.5, 0.7);
  room.bookcase(south(9.0, 0.17), 1.2, 1.7);
  room.plant({10.3, 0.6, 0, 0}, 1.4);
  room.poster(on_wall(south(10.3, 0), 1.75), 0.7, 1.0);

  // East, from south to north.
  const auto east = [](double y, double off) { return Place{hall_width - off, y, 0, from_east}; };
  room.painting(on_wall(east(0.75, 0), 1.45), 0.8, 0.6);
  work(east(2.0, 0.40), 3);
  room.notice_board(on_wall(east(2.0, 0), 1.60), 1.4, 0.9);
  room.cabinet(east(3.5, 0.25), 1.0, 0.45, 0.9);
  room.package(at(east(3.5, 0.25), 0.2, 0, 0.9, 0.4), 0.3, 0.2, 0.3);
  room.package(at(east(3.5, 0.25), -0.2, 0, 0.9, -0.2), 0.22, 0.16, 0.36);
  room.poster(on_wall(east(3.5, 0), 1.75), 0.8, 1.1);
  room.bookcase(east(4.9, 0.17), 1.4, 2.1);
  work(east(6.45, 0.40), 4);
  room.wall_shelf(on_wall(east(6.45, 0.12), 1.40), 1.2);
  room.painting(on_wall(east(6.5, 0), 2.10), 0.9, 0.5);
  room.cardboard_box({10.55, 7.6, 0, 0.3}, 0.5, 0.5, 0.55);
  room.cardboard_box({10.6, 7.6, 0.55, 0.8}, 0.4, 0.36, 0.33);
  room.poster(on_wall(east(7.7, 0), 1.65), 0.6, 0.84);

  room.notice_board(on_wall(east(8.45, 0), 1.50), 0.8, 0.9);

  // North, from east to west.
  const auto north = [](double x, double off) { return Place{x, hall_depth - off, 0, from_north}; };
  room.bookcase(north(9.7, 0.17), 1.2, 1.9);
  room.cabinet(north(8.45, 0.25), 0.8, 0.45, 1.1);
  room.lamp({8.3, 8.75, 1.1, 0.4});
  room.book_pile({8.6, 8.75, 1.1, 0.1}, 5);
  room.poster(on_wall(north(8.4, 0), 1.85), 0.6, 0.84);
  work(north(7.0, 0.40), 5);
  room.notice_board(on_wall(north(7.0, 0), 1.60), 1.3, 0.9);
  work(north(5.2, 0.40), 6);
  room.wall_shelf(on_wall(north(5.2, 0.12), 1.50), 1.4);
  room.painting(on_wall(north(5.3, 0), 2.15), 0.8, 0.5);
  room.poster(on_wall(north(4.15, 0), 1.60), 0.5, 0.7);
  room.bookcase(north(3.3, 0.17), 1.3, 2.0);
  room.cabinet(north(1.95, 0.25), 1.0, 0.45, 0.75);
  room.cardboard_box({1.95, 8.74, 0.75, 0.1}, 0.5, 0.35, 0.35);
  room.clock(on_wall(north(2.3, 0), 2.15));
  room.poster(on_wall(north(1.7, 0), 1.75), 0.7, 0.95);
  room.plant({0.6, 8.4, 0, 0}, 1.5);

  room.notice_board(on_wall(north(0.75, 0), 1.50), 0.9, 0.8);

  // West, from north to south.
  const auto west = [](double y, double off) { return Place{off, y, 0, from_west}; };
  room.poster(on_wall(west(8.25, 0), 1.50), 0.75, 1.05);
  work(west(7.0, 0.40), 7);
  room.painting(on_wall(west(7.3, 0), 1.75), 0.7, 0.9);
  room.poster(on_wall(west(6.6, 0), 1.60), 0.42, 0.6);
  room.bookcase(west(5.35, 0.17), 1.2, 1.8);
  room.cabinet(west(4.1, 0.25), 0.9, 0.45, 1.3);
  room.package(at(west(4.1, 0.25), 0.15, 0, 1.3, 0.2), 0.25, 0.2, 0.32);
  room.poster(on_wall(west(4.1, 0), 2.1), 0.9, 0.6);
  work(west(2.6, 0.40), 8);
  room.notice_board(on_wall(west(2.6, 0), 1.65), 1.5, 0.9);
  room.poster(on_wall(west(1.2, 0), 1.60), 0.7, 1.0);
  room.cardboard_box({0.4, 1.35, 0, 1.2}, 0.45, 0.4, 0.45);
}

void furnish_islands(RoomBuilder& room, const Random& random) {
  // Four workplaces back to back with screens between them.
  for (const double y : {3.45, 5.55}) {
    room.partition({3.40, y, 0, quarter_turn}, 2.0, 1.40);
    workplace(room, {3.83, y, 0, quarter_turn}, random.fork(20 + static_cast<std::uint64_t>(y)));
    workplace(room, {2.97, y, 0, -quarter_turn}, random.fork(30 + static_cast<std::uint64_t>(y)));
  }
  room.chair({2.40, 3.3, 0, 1.3});
  room.chair({2.40, 5.7, 0, 1.9});
  room.chair({4.45, 3.6, 0, -1.2});
  room.chair({4.50, 5.5, 0, -1.9});

  // Shelves with screens behind them in the north, cabinets in the south.
  for (const double x : {6.15, 7.50}) {
    room.partition({x, 6.50, 0, 0}, 1.32, 1.50);
    room.bookcase({x, 6.73, 0, from_south}, 1.3, 1.55);
  }
  room.plant({8.5, 6.55, 0, 0}, 1.2);
  room.cabinet({4.35, 2.22, 0, from_south}, 0.9, 0.42, 1.0);
  room.cabinet({5.28, 2.22, 0, from_north}, 0.9, 0.42, 1.0);
  room.cardboard_box({4.3, 2.24, 1.0, 0.2}, 0.4, 0.3, 0.28);
  room.package({4.68, 2.2, 1.0, 0.3}, 0.2, 0.15, 0.3);
  room.plant({5.4, 2.22, 1.0, 0}, 0.6);
  room.book_pile({5.0, 2.22, 1.0, 0.4}, 4);

  // The table of the experiments, with free floor around.
  room.table({7.1, 4.5, 0, 0}, 1.60, 0.90, table_top);
  const Place table{7.1, 4.5, table_top, 0};
  room.monitor(at(table, -0.35, 0.15, 0, 0.3), 0.46);
  room.keyboard_and_mouse(at(table, -0.32, -0.18, 0, 0.15));
  room.book_pile(at(table, 0.25, 0.22, 0, 0.4), 5);
  room.book_pile(at(table, 0.62, 0.25, 0, -0.2), 3);
  room.package(at(table, 0.42, -0.02, 0, 0.5), 0.14, 0.10, 0.22);
  room.package(at(table, -0.68, -0.22, 0, 0.9), 0.10, 0.08, 0.18);
  room.mug(at(table, 0.12, -0.15, 0, 0.3));
  room.mug(at(table, -0.66, 0.10, 0, 2.0));
  room.pen_holder(at(table, 0.02, 0.05, 0, 0));
  room.page(at(table, 0.32, -0.28, 0, 0.2));
  room.page(at(table, 0.60, -0.20, 0, -0.3));
  room.page(at(table, 0.05, -0.30, 0, 0.5));
  room.telephone(at(table, 0.66, 0.02, 0, -0.6));
  room.cable(at(table, -0.3, 0.3, 0), at(table, 0.5, 0.35, 0));
}
}  // namespace

Stage hall_stage() {
  Stage stage;
  stage.walls = {Eigen::Vector3d::Zero(), Eigen::Vector3d(hall_width, hall_depth, 2.8)};
  stage.free_floor = {Eigen::Vector2d(5.0, 2.75), Eigen::Vector2d(9.9, 6.15)};
  stage.home = {7.1, 2.50, 1.38};
  stage.target = {7.1, 4.55, 0.85};
  stage.half_sphere = {2.5, 0.1, 0.50, 0.36, 0.20};
  stage.table = {{7.1, 4.5}, {1.60, 0.90}, table_top};
  stage.table_edge = {7.1, 3.80, 1.12};
  stage.table_edge_target = {7.1, 4.65, 0.85};
  stage.spot = {8.6, 3.0, 1.40};
  stage.loop.places = {{5.5, 1.4, 1.45}, {9.55, 1.4, 1.45}, {9.55, 7.6, 1.45}, {1.45, 7.6, 1.45}, {1.45, 1.4, 1.45}};
  stage.loop.aside = -0.35;
  stage.loop.glance = 0.25;
  stage.corridor.places = {{2.4, 7.45, 1.45}, {8.8, 7.45, 1.45}};
  stage.corridor.closed = false;
  stage.corridor.aside = 0.6;
  stage.square.places = {
      {7.1, 3.05, 1.35}, {8.65, 3.05, 1.35}, {8.65, 5.75, 1.35}, {5.55, 5.75, 1.35}, {5.55, 3.05, 1.35}};
  stage.square.speed = 0.40;
  stage.square.rounding = 0.5;
  stage.square.target = {7.1, 4.5, 0.85};
  return stage;
}

World make_hall(std::uint64_t seed) {
  World world;
  RoomBuilder room(world, seed);
  room.shell({.width = hall_width,
              .depth = hall_depth,
              .height = 2.8F,
              .wall_density = 160.0,
              .floor_density = 130.0,
              .ceiling_density = 60.0});
  furnish_walls(room, Random(seed).fork(0x4a11));
  furnish_islands(room, Random(seed).fork(0x151a));
  for (const float x : {2.0F, 5.5F, 9.0F})
    for (const float y : {2.3F, 6.7F}) world.lamps.push_back({{x, y, 2.7F}, 0.78F});
  world.ambient = 0.58F;
  return world;
}

}  // namespace holdfast::simulation
