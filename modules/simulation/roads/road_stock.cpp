// SPDX-License-Identifier: BSD-3-Clause
#include <opencv2/imgproc.hpp>

#include "holdfast/simulation/pictures.hpp"
#include "road_builder.hpp"
#include "rooms/measures.hpp"

namespace holdfast::simulation {

namespace {
using Eigen::AlignedBox3f;

const cv::Scalar paint_white(215, 218, 220);
constexpr double road_density = 40.0;  // [texels/m]

// Asphalt of a stretch with its marks; row 0 is its left border.
cv::Mat marked_asphalt(RoadKind kind, const Random& random) {
  const RoadProfile& profile = road_profile(kind);
  cv::Mat picture = pictures::asphalt(texels(stretch_length, 2.0 * profile.edge, road_density), random);
  const auto mark = [&](double from, double to, double offset, double width) {
    const auto pixel = [](double metres) { return static_cast<int>(std::lround(metres * road_density)); };
    const cv::Rect area(pixel(from), pixel(profile.edge - offset - width / 2), pixel(to - from), pixel(width));
    cv::Mat part = picture(area);
    part = 0.25 * part + 0.75 * paint_white;
  };
  const auto dashes = [&](double offset, double length, double pitch) {
    for (double from = 1.0; from + length < stretch_length; from += pitch) mark(from, from + length, offset, 0.15);
  };
  if (kind == RoadKind::street) {
    dashes(0.0, 3.0, 6.67);
    for (const double side : {-1.0, 1.0}) dashes(side * profile.lane_width, 1.0, 2.0);
  } else {
    const double inner = profile.lanes.front() - profile.lane_width / 2;
    for (const double side : {-1.0, 1.0}) {
      mark(0.0, stretch_length, side * inner, 0.15);
      dashes(side * (inner + profile.lane_width), 6.0, 18.0);
      mark(0.0, stretch_length, side * (inner + 2 * profile.lane_width), 0.25);
    }
  }
  return picture;
}

Mesh car_mesh(World& world, Random random) {
  static const cv::Scalar paints[] = {{60, 60, 62},  {190, 192, 192}, {120, 118, 112}, {40, 36, 150},
                                      {130, 60, 30}, {215, 218, 220}, {30, 28, 26},    {60, 95, 60}};
  const cv::Scalar colour = paints[random.below(8)];
  const double length = random.uniform(3.9, 4.7), width = random.uniform(1.68, 1.84);
  const double waist = random.uniform(0.88, 1.0), height = random.uniform(1.42, 1.65);
  Mesh mesh;
  const auto paint = [&](const cv::Mat& picture) { return world.add_texture(picture); };
  const TextureArea side = paint(pictures::car_side({260, 52}, colour, random.fork(1)));
  const TextureArea plate = paint(pictures::plain({64, 64}, colour, random.fork(2)));
  const TextureArea dark = paint(pictures::plain({16, 16}, cv::Scalar::all(22), random.fork(3)));
  const TextureArea nose = paint(pictures::car_end({110, 52}, colour, false, random.fork(4)));
  const TextureArea tail = paint(pictures::car_end({110, 52}, colour, true, random.fork(5)));
  add_box(mesh, box(-length / 2, -width / 2, 0.22, length / 2, width / 2, waist), {side, side, tail, nose, plate, dark},
          1.0F);
  const TextureArea flank = paint(pictures::windows({150, 34}, colour, 3, random.fork(6)));
  const TextureArea screen = paint(pictures::windows({90, 34}, colour, 1, random.fork(7)));
  add_box(mesh, box(-length * 0.44, -width / 2 + 0.1, waist, length * 0.17, width / 2 - 0.1, height),
          {flank, flank, screen, screen, plate, dark}, 1.0F);
  for (const double x : {-0.3 * length, 0.3 * length})
    add_box(mesh, box(x - 0.28, -width / 2 + 0.04, 0.0, x + 0.28, width / 2 - 0.04, 0.25),
            {dark, dark, dark, dark, dark, dark}, 1.0F);
  return mesh;
}

Mesh lorry_mesh(World& world, Random random) {
  Mesh mesh;
  const auto paint = [&](const cv::Mat& picture) { return world.add_texture(picture); };
  const cv::Scalar cab_colour = pictures::colour_between({40, 40, 40}, {220, 220, 220}, random);
  const TextureArea cover = paint(pictures::tarpaulin({320, 120}, random.fork(1)));
  const TextureArea doors = paint(pictures::tarpaulin({110, 120}, random.fork(2)));
  const TextureArea dark = paint(pictures::plain({16, 16}, cv::Scalar::all(28), random.fork(3)));
  const TextureArea cab = paint(pictures::windows({90, 110}, cab_colour, 1, random.fork(4)));
  const TextureArea plain = paint(pictures::plain({64, 64}, cab_colour, random.fork(5)));
  add_box(mesh, box(-5.0, -1.25, 1.0, 2.6, 1.25, 3.8), {cover, cover, doors, plain, plain, dark}, 2.0F);
  add_box(mesh, box(2.8, -1.2, 0.5, 5.0, 1.2, 3.1), {cab, cab, plain, cab, plain, dark}, 2.0F);
  const TextureArea bumper = paint(pictures::car_end({110, 30}, cv::Scalar::all(60), true, random.fork(6)));
  add_box(mesh, box(-5.0, -1.2, 0.45, 2.6, 1.2, 0.98), {dark, dark, bumper, dark, dark, dark}, 2.0F);
  for (const double x : {-4.0, -2.8, 3.6})
    add_box(mesh, box(x - 0.48, -1.2, 0.0, x + 0.48, 1.2, 0.9), {dark, dark, dark, dark, dark, dark}, 2.0F);
  return mesh;
}
}  // namespace

RoadStock::RoadStock(World& world, RoadKind kind, const Random& random) {
  const bool street = kind == RoadKind::street;
  const auto paint = [&](std::vector<TextureArea>& areas, int count, auto&& painter) {
    for (int i = 0; i < count; ++i)
      areas.push_back(world.add_texture(painter(random.fork(1000 * areas.size() + world.textures.size()))));
  };
  paint(asphalt, 5, [&](const Random& own) { return marked_asphalt(kind, own); });
  paint(grass, 3, [&](const Random& own) { return pictures::grass({400, 400}, own); });
  paint(foliage, 5, [&](const Random& own) { return pictures::foliage({220, 140}, own); });
  paint(signs, 6, [&](const Random& own) { return pictures::tarpaulin({160, 110}, own); });
  paint(plaster, 3, [&](Random own) {
    return pictures::plaster({200, 200}, cv::Scalar(140, 152, 160) * own.uniform(0.75, 1.3), own.fork(1));
  });
  if (street) {
    paint(paving, 3, [&](const Random& own) { return pictures::paving({800, 120}, 20, own); });
    for (int i = 0; i < 12; ++i) {
      const cv::Size size = texels(8.0 + i % 4 * 2.0, 4.0 + 3.0 * (1 + i % 3), 28.0);
      paint(facades, 1, [&](const Random& own) { return pictures::facade(size, 28.0, own); });
    }
  }
  const auto plain = [&](const cv::Scalar& colour, std::uint64_t stream) {
    return world.add_texture(pictures::plain({120, 60}, colour, random.fork(stream)));
  };
  metal = plain({150, 148, 142}, 1), wood = plain({50, 66, 80}, 2), dark = plain({62, 62, 60}, 3);
  for (std::uint64_t i = 0; i < 8; ++i) cars.push_back(car_mesh(world, random.fork(10 + i)));
  for (std::uint64_t i = 0; i < 4; ++i) lorries.push_back(lorry_mesh(world, random.fork(30 + i)));
}

}  // namespace holdfast::simulation
