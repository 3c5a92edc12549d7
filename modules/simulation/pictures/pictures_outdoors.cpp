// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "full_turn.hpp"
#include "holdfast/simulation/pictures.hpp"
#include "pictures_folds.hpp"
#include "pictures_materials.hpp"

namespace holdfast::simulation::pictures {

namespace {
cv::Rect part_of(cv::Size size, double left, double top, double right, double bottom) {
  const auto x = static_cast<int>(std::lround(left * size.width)), y = static_cast<int>(std::lround(top * size.height));
  return {x, y, static_cast<int>(std::lround(right * size.width)) - x,
          static_cast<int>(std::lround(bottom * size.height)) - y};
}

void fill(cv::Mat& picture, const cv::Rect& area, const cv::Scalar& colour) {
  cv::rectangle(picture, area, colour, cv::FILLED);
}

// A window with frame and cross, and the room or the sky in its pane.
void draw_window(cv::Mat& picture, cv::Rect area, const cv::Scalar& frame, Random& random) {
  fill(picture, area, frame);
  const int border = std::max(1, area.width / 12);
  const cv::Rect pane(area.x + border, area.y + border, area.width - 2 * border, area.height - 2 * border);
  if (pane.width < 2 || pane.height < 2) return;
  fill(picture, pane, colour_between({45, 40, 35}, {110, 95, 85}, random));
  const auto curtain = static_cast<int>(pane.height * random.uniform(0.0, 0.8));
  fill(picture, {pane.x, pane.y, pane.width, curtain}, colour_between({120, 130, 140}, {215, 220, 225}, random));
  const int middle = pane.x + pane.width / 2;
  cv::line(picture, {middle, pane.y}, {middle, pane.y + pane.height}, frame, border);
  cv::line(picture, {area.x, area.y + area.height}, {area.x + area.width, area.y + area.height}, frame * 0.5, border);
}

// Height of a chain of hills [0, 1] at a share of a full turn.
class Skyline {
 public:
  explicit Skyline(Random random) {
    for (int i = 0; i < 24; ++i) {
      phases_[i] = random.uniform(0.0, full_turn<double>);
      sizes_[i] = random.uniform(0.4, 1.0) / (1.0 + 0.4 * i);
    }
  }
  double at(double share) const {
    double height = 0.0;
    for (int i = 0; i < 24; ++i) height += sizes_[i] * std::sin(full_turn<double> * (i + 2) * share * 2.0 + phases_[i]);
    return std::clamp(0.5 + 0.16 * height, 0.0, 1.0);
  }

 private:
  double phases_[24], sizes_[24];
};
}  // namespace

cv::Mat asphalt(cv::Size size, Random random) {
  NoiseField field(size.width, size.height);
  add_fractal_noise(field, 500.0F, 60.0F, 0.07F, 3, 0.7F, random.fork(1));
  add_fractal_noise(field, 12.0F, 12.0F, 0.07F, 3, 1.0F, random.fork(2));
  cv::Mat picture = coloured(field, {98, 96, 94});
  for (int i = 0; i < 3; ++i) {  // repaired places
    const cv::Point corner = any_texel(size, random);
    const auto width = static_cast<int>(random.uniform(15, 160)), height = static_cast<int>(random.uniform(15, 70));
    cv::Mat patch = picture(cv::Rect(corner, cv::Size(width, height)) & cv::Rect({0, 0}, size));
    patch *= random.uniform(0.8, 1.12);
  }
  for (int i = 0; i < 9; ++i) {  // cracks, sealed with tar
    cv::Point from = any_texel(size, random);
    double angle = random.uniform(0.0, full_turn<double>);
    const cv::Scalar tar = cv::Scalar(98, 96, 94) * random.uniform(0.5, 0.8);
    for (int k = 0; k < 12; ++k) {
      angle += random.uniform(-0.6, 0.6);
      const double length = random.uniform(4.0, 16.0);
      const cv::Point to =
          from + cv::Point(static_cast<int>(length * std::cos(angle)), static_cast<int>(length * std::sin(angle)));
      cv::line(picture, from, to, tar, 1 + i % 2, cv::LINE_AA);
      from = to;
    }
  }
  const int stains = size.area() / 12000;
  for (int i = 0; i < stains; ++i) {
    const cv::Point centre = any_texel(size, random);
    const int radius = 1 + static_cast<int>(random.below(4));
    cv::circle(picture, centre, radius, cv::Scalar(98, 96, 94) * random.uniform(0.55, 1.3), cv::FILLED, cv::LINE_AA);
  }
  return picture;
}

cv::Mat grass(cv::Size size, Random random) {
  NoiseField field(size.width, size.height), tint(size.width, size.height);
  add_fractal_noise(field, 90.0F, 90.0F, 0.18F, 4, 0.75F, random.fork(1));
  add_fractal_noise(field, 5.0F, 3.0F, 0.22F, 2, 0.9F, random.fork(2));
  add_fractal_noise(tint, 120.0F, 120.0F, 0.2F, 3, 0.7F, random.fork(3));
  return coloured(field, {52, 105, 88}, &tint);
}

cv::Mat foliage(cv::Size size, Random random) {
  NoiseField field(size.width, size.height);
  add_fractal_noise(field, 40.0F, 40.0F, 0.35F, 3, 0.8F, random.fork(1));
  add_fractal_noise(field, 7.0F, 6.0F, 0.3F, 2, 0.9F, random.fork(2));
  cv::Mat picture = coloured(field, colour_between({32, 66, 48}, {56, 100, 92}, random));
  const int leaves = size.area() / 60;
  for (int i = 0; i < leaves; ++i) {
    const cv::Point centre = any_texel(size, random);
    const cv::Scalar leaf = colour_between({12, 30, 20}, {80, 150, 130}, random);
    const double turned = random.uniform(0, 180);
    cv::ellipse(picture, centre, {1 + static_cast<int>(random.below(3)), 1}, turned, 0, 360, leaf, cv::FILLED);
  }
  return picture;
}

cv::Mat paving(cv::Size size, int slab, Random random) {
  cv::Mat picture = plain(size, {140, 146, 150}, random.fork(1));
  for (int y = 0; y < size.height; y += slab)
    for (int x = 0; x < size.width; x += slab) {
      const cv::Rect area = cv::Rect(x, y, slab, slab) & cv::Rect({0, 0}, size);
      picture(area) *= random.uniform(0.82, 1.08);
      cv::rectangle(picture, area, {95, 98, 100}, 1);
    }
  return picture;
}

cv::Mat facade(cv::Size size, double texels, Random random) {
  const cv::Scalar wall = colour_between({125, 150, 160}, {185, 200, 212}, random);
  const cv::Scalar frame =
      random.uniform() < 0.7 ? cv::Scalar::all(225) : colour_between({40, 50, 60}, {80, 90, 110}, random);
  cv::Mat picture = plaster(size, wall, random.fork(1));
  const auto length = [&](double metres) { return static_cast<int>(std::lround(metres * texels)); };
  const double between = random.uniform(1.9, 2.9), wide = random.uniform(0.9, 1.3), high = random.uniform(1.2, 1.6);
  const int count = std::max(1, static_cast<int>(size.width / texels / between));
  const int storeys = std::max(1, static_cast<int>(size.height / texels / 3.0));
  const auto door = static_cast<int>(random.below(static_cast<std::uint32_t>(count)));
  for (int storey = 0; storey < storeys; ++storey) {
    const int floor = size.height - length(3.0 * storey);
    for (int i = 0; i < count; ++i) {
      const int middle = static_cast<int>((i + 0.5) * size.width / count);
      if (storey == 0 && i == door) {
        const cv::Rect leaf(middle - length(0.5), floor - length(2.2), length(1.0), length(2.2));
        fill(picture, leaf, colour_between({30, 40, 50}, {90, 100, 140}, random));
        cv::rectangle(picture, leaf, frame * 0.7, std::max(1, length(0.08)));
      } else {
        draw_window(picture, {middle - length(wide / 2), floor - length(0.9 + high), length(wide), length(high)}, frame,
                    random);
      }
    }
    if (storey > 0) cv::line(picture, {0, floor}, {size.width, floor}, wall * 0.75, std::max(1, length(0.06)));
  }
  fill(picture, {0, size.height - length(0.5), size.width, length(0.5)}, wall * 0.55);
  fill(picture, {0, 0, size.width, length(0.3)}, {60, 70, 105});
  return picture;
}

cv::Mat panorama(cv::Size size, int horizon, Random random) {
  NoiseField clouds(size.width, size.height);
  add_fractal_noise(clouds, 340.0F, 70.0F, 0.10F, 4, 0.6F, random.fork(1));
  cv::Mat picture(size, CV_8UC3);
  for (int y = 0; y < size.height; ++y) {
    const cv::Scalar sky = mix({228, 222, 214}, {205, 165, 130}, std::min(1.0, std::abs(y - horizon) / 260.0));
    for (int x = 0; x < size.width; ++x)
      for (int channel = 0; channel < 3; ++channel)
        picture.at<cv::Vec3b>(y, x)[channel] = cv::saturate_cast<std::uint8_t>(sky[channel] * (1.0 + clouds.row(y)[x]));
  }
  NoiseField woods(size.width, size.height);
  add_fractal_noise(woods, 24.0F, 8.0F, 0.22F, 3, 0.9F, random.fork(2));
  const cv::Mat far = coloured(woods, {135, 130, 112}), near = coloured(woods, {70, 92, 74});
  const Skyline back(random.fork(3)), front(random.fork(4));
  for (int x = 0; x < size.width; ++x) {
    const double share = static_cast<double>(x) / size.width;
    const auto cover = [&](const cv::Mat& hills, double height) {
      const int top = std::max(0, horizon - static_cast<int>(height));
      hills(cv::Rect(x, top, 1, size.height - top)).copyTo(picture(cv::Rect(x, top, 1, size.height - top)));
    };
    cover(far, 10.0 + 30.0 * back.at(share));
    cover(near, 3.0 + 14.0 * front.at(share) + 2.5 * std::abs(woods.row(0)[x]) / 0.2);
  }
  return picture;
}

cv::Mat windows(cv::Size size, const cv::Scalar& colour, int count, Random random) {
  cv::Mat picture = plain(size, colour, random.fork(1));
  for (int i = 0; i < count; ++i) {
    const cv::Rect pane = part_of(size, (i + 0.08) / count, 0.14, (i + 0.92) / count, 0.92);
    fill(picture, pane, colour_between({40, 38, 35}, {90, 80, 70}, random));
    const double from = random.uniform(0.1, 0.6);  // reflections
    fill(picture, part_of(size, (i + 0.1 + 0.8 * from) / count, 0.18, (i + 0.2 + 0.8 * from) / count, 0.88),
         colour_between({110, 105, 100}, {170, 160, 150}, random));
  }
  return picture;
}

cv::Mat car_side(cv::Size size, const cv::Scalar& colour, Random random) {
  cv::Mat picture = plain(size, colour, random);
  fill(picture, part_of(size, 0, 0.82, 1, 1), cv::Scalar::all(35));
  for (const double middle : {0.2, 0.8}) {
    const cv::Point hub(static_cast<int>(middle * size.width), static_cast<int>(0.72 * size.height));
    const int radius = static_cast<int>(0.085 * size.width);
    cv::circle(picture, hub, radius, cv::Scalar::all(25), cv::FILLED, cv::LINE_AA);
    cv::circle(picture, hub, radius * 3 / 5, cv::Scalar::all(150), cv::FILLED, cv::LINE_AA);
    cv::circle(picture, hub, radius / 3, cv::Scalar::all(60), cv::FILLED, cv::LINE_AA);
  }
  for (const double seam : {0.34, 0.52, 0.68})
    cv::line(picture, {static_cast<int>(seam * size.width), 0},
             {static_cast<int>(seam * size.width), static_cast<int>(0.8 * size.height)}, colour * 0.45, 1);
  for (const double handle : {0.48, 0.64})
    fill(picture, part_of(size, handle, 0.16, handle + 0.03, 0.22), colour * 0.4);
  return picture;
}

cv::Mat car_end(cv::Size size, const cv::Scalar& colour, bool rear, Random random) {
  cv::Mat picture = plain(size, colour, random.fork(1));
  const cv::Scalar lamp = rear ? cv::Scalar(30, 30, 190) : cv::Scalar(225, 230, 230);
  fill(picture, part_of(size, 0.03, 0.12, 0.2, 0.38), lamp);
  fill(picture, part_of(size, 0.8, 0.12, 0.97, 0.38), lamp);
  if (!rear) fill(picture, part_of(size, 0.28, 0.15, 0.72, 0.42), cv::Scalar::all(40));
  fill(picture, part_of(size, 0, 0.8, 1, 1), cv::Scalar::all(40));
  const cv::Rect plate = part_of(size, 0.35, 0.5, 0.65, 0.66);
  fill(picture, plate, cv::Scalar::all(230));
  cv::putText(picture, word(random, true), {plate.x + 3, plate.y + plate.height - 2}, cv::FONT_HERSHEY_DUPLEX,
              plate.height / 30.0, cv::Scalar::all(20), 1, cv::LINE_AA);
  return picture;
}

}  // namespace holdfast::simulation::pictures
