// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/simulation/room.hpp"

#include "room_builder.hpp"

namespace holdfast::simulation {

namespace {
constexpr double table_top = 0.73;
constexpr double quarter_turn = 1.57079632679;

void furnish_desks(RoomBuilder& room, Random random) {
  const auto yaw = [&] { return random.uniform(-0.35, 0.35); };
  const auto on_desk = [&](double x, double y) {
    return Place{x + random.uniform(-0.03, 0.03), y + random.uniform(-0.02, 0.02), table_top, yaw()};
  };
  room.desk({2.55, 4.40, 0, 0}, 1.90, 0.85);
  room.desk({4.45, 4.45, 0, 0}, 1.50, 0.75);
  room.monitor({2.45, 4.55, table_top, 0.08}, 0.52);
  room.monitor({3.06, 4.52, table_top, -0.25}, 0.48);
  room.monitor({4.50, 4.55, table_top, -0.3}, 0.50);
  room.keyboard_and_mouse({2.50, 4.17, table_top, 0.06});
  room.keyboard_and_mouse({4.35, 4.22, table_top, -0.12});
  room.book_pile(on_desk(1.82, 4.42), 4);
  room.book_pile(on_desk(3.33, 4.20), 2);
  room.book_pile(on_desk(4.95, 4.35), 5);
  room.mug(on_desk(2.13, 4.22));
  room.mug(on_desk(3.02, 4.14));
  room.mug(on_desk(4.02, 4.36));
  room.pen_holder(on_desk(2.10, 4.46));
  room.pen_holder(on_desk(4.83, 4.62));
  room.package(on_desk(2.78, 4.33), 0.10, 0.07, 0.19);
  room.package(on_desk(1.98, 4.62), 0.16, 0.08, 0.24);
  room.package(on_desk(3.90, 4.58), 0.12, 0.09, 0.22);
  room.package(on_desk(4.08, 4.60), 0.09, 0.09, 0.15);
  room.telephone(on_desk(3.42, 4.52));
  room.lamp({1.72, 4.68, table_top, 0.4});
  for (const auto& [x, y] :
       {std::pair(2.02, 4.12), {2.92, 4.10}, {1.72, 4.18}, {3.18, 4.33}, {4.62, 4.20}, {3.92, 4.22}, {4.88, 4.18}})
    room.page(on_desk(x, y));
  for (int i = 0; i < 7; ++i) {
    const double x = random.uniform(1.75, 3.3);
    room.cable({x, random.uniform(4.3, 4.7), table_top, 0},
               {x + random.uniform(-0.5, 0.5), random.uniform(4.2, 4.75), table_top, 0});
  }
  for (int i = 0; i < 3; ++i)
    room.cable({random.uniform(3.9, 4.5), random.uniform(4.3, 4.7), table_top, 0},
               {random.uniform(4.4, 5.1), random.uniform(4.3, 4.7), table_top, 0});
}

void furnish_desk_wall(RoomBuilder& room) {
  room.wall_shelf({2.20, 4.88, 1.62, 0}, 1.40);
  room.wall_shelf({4.55, 4.88, 1.50, 0}, 1.20);
  room.poster({3.28, 5.0, 1.58, 0}, 0.50, 0.70);
  room.poster({3.72, 5.0, 1.28, 0}, 0.30, 0.42);
  room.poster({1.12, 5.0, 1.55, 0}, 0.60, 0.84);
  room.poster({5.52, 5.0, 1.60, 0}, 0.59, 0.84);
  room.painting({2.15, 5.0, 2.20, 0}, 0.80, 0.50);
  room.painting({4.40, 5.0, 2.15, 0}, 0.70, 0.45);
  room.clock({3.45, 5.0, 2.25, 0});
  for (const auto& [x, z] :
       {std::pair(1.62, 1.25), {1.90, 1.30}, {2.80, 1.32}, {4.10, 1.25}, {5.05, 1.22}, {0.62, 1.20}})
    room.poster({x, 5.0, z, 0}, 0.21, 0.297);
}

void furnish_around(RoomBuilder& room) {
  room.rug({3.0, 3.0, 0, 0.06}, 2.6, 1.7);
  room.chair({2.35, 3.62, 0, 2.7});
  room.chair({4.30, 3.55, 0, 3.6});
  room.chair({1.20, 1.10, 0, 0.9});
  room.cabinet({0.95, 4.72, 0, 0}, 0.80, 0.45, 0.95);
  room.package({0.75, 4.70, 0.95, 0.3}, 0.22, 0.15, 0.28);
  room.book_pile({1.12, 4.68, 0.95, 0.2}, 4);
  room.plant({5.55, 4.55, 0, 0}, 1.0);
  room.cardboard_box({1.35, 3.75, 0, 0.35}, 0.42, 0.36, 0.33);
  room.cardboard_box({1.30, 3.78, 0.33, 0.75}, 0.32, 0.28, 0.24);
  room.cardboard_box({3.35, 3.75, 0, -0.3}, 0.38, 0.30, 0.28);
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

World make_room(std::uint64_t seed) {
  World world;
  RoomBuilder room(world, seed);
  room.shell();
  furnish_desk_wall(room);
  furnish_desks(room, Random(seed).fork(0xde5c));
  furnish_around(room);
  world.lamps = {{{1.6F, 3.0F, 2.45F}, 0.85F}, {{4.4F, 3.1F, 2.45F}, 0.80F}, {{3.0F, 1.0F, 2.4F}, 0.75F}};
  world.ambient = 0.62F;
  bake_light(world);
  return world;
}

}  // namespace holdfast::simulation
