// SPDX-License-Identifier: BSD-3-Clause
#include "room_builder.hpp"
#include "rooms.hpp"

namespace holdfast::simulation {

namespace {
constexpr double plan_width = 12.0, plan_depth = 9.0;
constexpr double desk_columns[] = {2.9, 4.7, 6.5, 8.3};
constexpr double desk_rows[] = {2.75, 4.65, 6.55};

/// A desk that faces south, with one or two screens and a few things. Each number is drawn in a statement of its own:
/// in which order a call's arguments are evaluated is left to the compiler.
void plan_workplace(RoomBuilder& room, double x, double y, Random random) {
  const auto on_desk = [&](double aside, double back, double yaw) {
    return Place{x + aside, y + back, table_top, yaw};
  };
  room.desk({x, y, 0, 0}, 1.60, 0.75);
  const bool has_two_screens = random.uniform() < 0.5;
  const double turn = random.uniform(-0.15, 0.15), shift = random.uniform(-0.08, 0.08);
  room.monitor(on_desk(has_two_screens ? -0.30 : shift, 0.18, has_two_screens ? 0.15 : turn), 0.52);
  if (has_two_screens) room.monitor(on_desk(0.30, 0.18, -0.15), 0.52);
  const double typing = random.uniform(-0.1, 0.1);
  room.keyboard_and_mouse(on_desk(0.0, -0.17, typing));
  const double mug_x = random.uniform(-0.7, -0.45), mug_y = random.uniform(-0.25, 0.0);
  room.mug(on_desk(mug_x, mug_y, turn));
  const double page_x = random.uniform(0.45, 0.65), page_turn = random.uniform(-0.4, 0.4);
  room.page(on_desk(page_x, -0.12, page_turn));
  if (random.uniform() < 0.5) room.book_pile(on_desk(0.66, 0.18, page_turn), 3);
}

/// One chair in front of each desk, all of one model: copies with the same pictures.
void place_chairs(RoomBuilder& room, World& world, Random random) {
  const double first_x = desk_columns[0], first_y = desk_rows[0] - 0.75;
  const std::size_t from = room.mark();
  room.chair({first_x, first_y, 0, 0});
  const std::size_t to = room.mark();
  for (const double y : desk_rows)
    for (const double x : desk_columns) {
      if (x != first_x || y - 0.75 != first_y) room.repeat(from, to, {x - first_x, y - 0.75 - first_y, 0.0});
      const double yaw = 2 * quarter_turn + random.uniform(-0.8, 0.8);
      Object& chair = world.objects[x == first_x && y - 0.75 == first_y ? from : room.mark() - 1];
      chair.T_world_object.linear() = Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    }
}

void furnish_plan_walls(RoomBuilder& room) {
  const auto south = [](double x, double off, double z = 0.0) { return Place{x, off, z, 2 * quarter_turn}; };
  const auto north = [](double x, double off, double z = 0.0) { return Place{x, plan_depth - off, z, 0.0}; };
  const auto east = [](double y, double off, double z = 0.0) { return Place{plan_width - off, y, z, -quarter_turn}; };
  const auto west = [](double y, double off, double z = 0.0) { return Place{off, y, z, quarter_turn}; };
  room.bookcase(south(1.4, 0.17), 1.2, 1.9);
  room.poster(south(3.1, 0, 1.6), 0.7, 1.0);
  room.notice_board(south(5.0, 0, 1.55), 1.4, 0.9);
  room.cabinet(south(7.0, 0.25), 1.0, 0.45, 1.1);
  room.painting(south(8.8, 0, 1.65), 0.9, 0.6);
  room.bookcase(south(10.6, 0.17), 1.2, 1.7);
  room.poster(east(1.6, 0, 1.6), 0.6, 0.84);
  room.cabinet(east(3.0, 0.25), 1.0, 0.45, 1.2);
  room.notice_board(east(4.6, 0, 1.6), 1.5, 0.9);
  room.bookcase(east(6.2, 0.17), 1.3, 2.0);
  room.plant({11.4, 7.6, 0, 0}, 1.4);
  room.painting(east(8.2, 0, 1.6), 0.8, 0.6);
  room.notice_board(north(10.4, 0, 1.6), 1.3, 0.9);
  room.bookcase(north(8.6, 0.17), 1.4, 2.0);
  room.poster(north(7.0, 0, 1.6), 0.8, 1.1);
  room.cabinet(north(5.4, 0.25), 0.9, 0.45, 0.9);
  room.painting(north(5.4, 0, 1.7), 0.8, 0.5);
  room.bookcase(north(3.6, 0.17), 1.2, 1.6);
  room.poster(north(1.8, 0, 1.55), 0.7, 0.95);
  room.notice_board(west(7.4, 0, 1.6), 1.4, 0.9);
  room.cabinet(west(5.9, 0.25), 1.0, 0.45, 1.3);
  room.bookcase(west(4.4, 0.17), 1.3, 1.8);
  room.poster(west(2.9, 0, 1.6), 0.6, 0.84);
  room.cardboard_box({0.4, 1.7, 0, 1.2}, 0.45, 0.4, 0.45);
}
}  // namespace

Stage open_plan_stage() {
  Stage stage;
  stage.walls = {Eigen::Vector3d::Zero(), Eigen::Vector3d(plan_width, plan_depth, 2.8)};
  stage.free_floor = {Eigen::Vector2d(9.4, 1.0), Eigen::Vector2d(11.2, 7.8)};
  stage.home = {6.5, 0.95, 1.40};
  stage.target = {6.5, 2.80, 0.85};
  stage.table = {{6.5, 2.75}, {1.60, 0.75}, table_top};
  stage.table_edge = {6.5, 2.10, 1.12};
  stage.table_edge_target = {6.5, 2.90, 0.85};
  stage.spot = {10.3, 4.5, 1.40};
  stage.loop.places = {{1.5, 1.25, 1.45}, {10.2, 1.25, 1.45}, {10.2, 7.75, 1.45}, {1.5, 7.75, 1.45}};
  stage.loop.aside = 0.55;
  stage.loop.glance = 0.25;
  stage.corridor.places = {{1.5, 1.25, 1.45}, {10.2, 1.25, 1.45}};
  stage.corridor.closed = false;
  stage.corridor.aside = 0.9;
  stage.square.places = {{9.9, 1.3, 1.4}, {10.9, 1.3, 1.4}, {10.9, 7.5, 1.4}, {9.9, 7.5, 1.4}};
  stage.square.speed = 0.4;
  stage.square.rounding = 0.4;
  stage.square.target = {6.5, 4.6, 0.95};
  return stage;
}

World make_open_plan(std::uint64_t seed) {
  World world;
  RoomBuilder room(world, seed);
  room.shell({.width = plan_width,
              .depth = plan_depth,
              .height = 2.8F,
              .wall_density = 140.0,
              .floor_density = 110.0,
              .ceiling_density = 60.0});
  furnish_plan_walls(room);
  const Random random = Random(seed).fork(0x09e7);
  std::uint64_t number = 0;
  for (const double y : desk_rows)
    for (const double x : desk_columns) plan_workplace(room, x, y, random.fork(++number));
  place_chairs(room, world, random.fork(0xc4a1));
  for (const float x : {2.0F, 6.0F, 10.0F})
    for (const float y : {2.3F, 6.7F}) world.lamps.push_back({{x, y, 2.7F}, 0.78F});
  world.ambient = 0.58F;
  return world;
}

}  // namespace holdfast::simulation
