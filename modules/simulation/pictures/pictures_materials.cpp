// SPDX-License-Identifier: BSD-3-Clause
#include "pictures_materials.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "holdfast/simulation/pictures.hpp"

namespace holdfast::simulation::pictures {

namespace {
float smallest_side(cv::Size size) { return static_cast<float>(std::min(size.width, size.height)); }
}  // namespace

cv::Mat coloured(const NoiseField& field, const cv::Scalar& colour, const NoiseField* tint) {
  cv::Mat picture(field.height, field.width, CV_8UC3);
  for (int y = 0; y < field.height; ++y) {
    const float* value = field.row(y);
    const float* shift = tint ? tint->row(y) : nullptr;
    auto* out = picture.ptr<std::uint8_t>(y);
    for (int x = 0; x < field.width; ++x, out += 3) {
      const float hue = shift ? shift[x] : 0.0F;
      for (int channel = 0; channel < 3; ++channel) {
        const float level =
            static_cast<float>(colour[channel]) * (1.0F + value[x] + hue * static_cast<float>(channel - 1));
        out[channel] = static_cast<std::uint8_t>(std::clamp(level + 0.5F, 0.0F, 255.0F));
      }
    }
  }
  return picture;
}

cv::Point any_texel(cv::Size size, Random& random) {
  const auto y = static_cast<int>(random.below(size.height)), x = static_cast<int>(random.below(size.width));
  return {x, y};
}

double brightness(const cv::Scalar& colour) { return 0.114 * colour[0] + 0.587 * colour[1] + 0.299 * colour[2]; }

// Channel by channel in statements of their own: in which order a call's arguments are evaluated is left to the
// compiler, and the same seed shall give the same picture with all of them.
cv::Scalar colour_between(const cv::Scalar& low, const cv::Scalar& high, Random& random) {
  cv::Scalar colour;
  for (int channel = 2; channel >= 0; --channel) colour[channel] = random.uniform(low[channel], high[channel]);
  return colour;
}

cv::Mat plaster(cv::Size size, const cv::Scalar& colour, Random random) {
  NoiseField field(size.width, size.height);
  add_fractal_noise(field, 400.0F, 400.0F, 0.06F, 4, 0.7F, random.fork(1));
  add_fractal_noise(field, 24.0F, 24.0F, 0.035F, 4, 0.9F, random.fork(2));
  cv::Mat picture = coloured(field, colour);
  // Scuffs, drill holes and repairs, as on every office wall.
  const int marks = size.area() / 9000;
  for (int i = 0; i < marks; ++i) {
    const cv::Point centre = any_texel(size, random);
    const double shade = random.uniform(0.45, 1.08);
    const double kind = random.uniform();
    if (kind < 0.5) {
      cv::circle(picture, centre, 1 + static_cast<int>(random.below(3)), colour * shade, cv::FILLED, cv::LINE_AA);
    } else if (kind < 0.8) {
      const int down = static_cast<int>(random.uniform(-12, 12)), aside = static_cast<int>(random.uniform(-25, 25));
      cv::line(picture, centre, centre + cv::Point(aside, down), colour * std::max(0.7, shade),
               1 + static_cast<int>(random.below(2)), cv::LINE_AA);
    } else {
      const cv::Scalar filler = colour * random.uniform(0.8, 1.1);
      const double turned = random.uniform(0, 180);
      const cv::Size axes{3 + static_cast<int>(random.below(9)), 2 + static_cast<int>(random.below(6))};
      cv::ellipse(picture, centre, axes, turned, 0, 360, filler, cv::FILLED, cv::LINE_AA);
    }
  }
  return picture;
}

cv::Mat wood(cv::Size size, const cv::Scalar& colour, int board, Random random) {
  const int height = board > 0 ? board : size.height;
  cv::Mat picture(size, CV_8UC3);
  for (int top = 0, number = 0; top < size.height; top += height, ++number) {
    Random own = random.fork(100 + static_cast<std::uint64_t>(number));
    const int rows = std::min(height, size.height - top);
    // Boards of a row end at different places.
    for (int from = 0; from < size.width;) {
      const int length = board > 0 ? static_cast<int>(height * own.uniform(5.0, 11.0)) : size.width;
      const int columns = std::min(length, size.width - from);
      NoiseField field(columns, rows, static_cast<float>(own.uniform(-0.13, 0.13)));
      add_fractal_noise(field, 260.0F, 22.0F, 0.08F, 3, 0.75F, own.fork(1));
      add_fractal_noise(field, 70.0F, 5.0F, 0.09F, 3, 0.75F, own.fork(2));
      NoiseField tint(columns, rows);
      add_value_noise(tint, 180.0F, 40.0F, 0.05F, own.fork(3));
      cv::Mat part = coloured(field, colour, &tint);
      const int knots = static_cast<int>(own.below(board > 0 ? 3 : 14));
      for (int i = 0; i < knots; ++i) {
        const cv::Point centre = any_texel({columns, rows}, own);
        const int radius = 3 + static_cast<int>(own.below(5));
        for (int ring = 3; ring > 0; --ring)
          cv::ellipse(part, centre, {radius * ring / 2 + 1, radius * ring / 3 + 1}, own.uniform(-10, 10), 0, 360,
                      colour * (0.3 + 0.17 * ring), ring == 1 ? cv::FILLED : 1, cv::LINE_AA);
      }
      if (board > 0) cv::rectangle(part, {0, 0, columns, rows}, colour * 0.55, 1);
      part.copyTo(picture(cv::Rect(from, top, columns, rows)));
      from += columns;
      own.next();
    }
  }
  return picture;
}

cv::Mat fabric(cv::Size size, const cv::Scalar& colour, Random random) {
  NoiseField field(size.width, size.height);
  add_fractal_noise(field, 0.3F * smallest_side(size), 0.3F * smallest_side(size), 0.12F, 3, 0.7F, random.fork(1));
  add_value_noise(field, 9.0F, 2.0F, 0.16F, random.fork(2));
  add_value_noise(field, 2.0F, 9.0F, 0.16F, random.fork(3));
  add_value_noise(field, 3.0F, 3.0F, 0.18F, random.fork(4));
  return coloured(field, colour);
}

cv::Mat plain(cv::Size size, const cv::Scalar& colour, Random random) {
  NoiseField field(size.width, size.height);
  add_fractal_noise(field, 60.0F, 60.0F, 0.07F, 4, 0.7F, random.fork(1));
  return coloured(field, colour);
}

cv::Mat painting(cv::Size size, Random random) {
  NoiseField height(size.width, size.height), tint(size.width, size.height);
  add_fractal_noise(height, 0.35F * smallest_side(size), 0.2F * smallest_side(size), 0.55F, 6, 0.62F, random.fork(1));
  add_fractal_noise(tint, 0.3F * smallest_side(size), 0.15F * smallest_side(size), 0.5F, 4, 0.65F, random.fork(2));
  const cv::Scalar colour = colour_between(cv::Scalar::all(70), cv::Scalar::all(160), random);
  cv::Mat picture = coloured(height, colour, &tint);
  const int strokes = 60 + static_cast<int>(random.below(80));
  for (int i = 0; i < strokes; ++i) {
    const cv::Point from = any_texel(size, random);
    const double down = random.uniform(-0.08, 0.08) * size.height, aside = random.uniform(-0.1, 0.1) * size.width;
    const cv::Scalar paint = colour_between(cv::Scalar::all(10), cv::Scalar::all(245), random);
    cv::line(picture, from, from + cv::Point(static_cast<int>(aside), static_cast<int>(down)), paint,
             1 + static_cast<int>(random.below(5)), cv::LINE_AA);
  }
  const int frame = std::max(3, size.height / 22);
  cv::rectangle(picture, {0, 0, size.width, size.height}, {28, 45, 70}, 2 * frame);
  cv::rectangle(picture, {frame, frame, size.width - 2 * frame, size.height - 2 * frame}, {90, 160, 200}, 2);
  return picture;
}

cv::Mat rug(cv::Size size, Random random) {
  cv::Mat picture = fabric(size, {50, 45, 140}, random.fork(1));
  const auto colour = [&] {
    static const cv::Scalar wools[] = {{40, 30, 60},  {190, 210, 225}, {60, 150, 200},
                                       {120, 80, 40}, {90, 120, 50},   {160, 170, 190}};
    const double shade = random.uniform(0.75, 1.1);
    return wools[random.below(6)] * shade;
  };
  const int side = std::min(size.width, size.height);
  for (int ring = 0; ring < 4; ++ring) {
    const int inset = side * (3 + 4 * ring) / 100;
    cv::rectangle(picture, {inset, inset, size.width - 2 * inset, size.height - 2 * inset}, colour(),
                  std::max(2, side / 120));
  }
  const int figures = size.area() / 700;
  for (int i = 0; i < figures; ++i) {
    const cv::Point centre = any_texel(size, random);
    const int radius = side / 90 + static_cast<int>(random.below(static_cast<std::uint32_t>(side / 35 + 1)));
    const double kind = random.uniform();
    if (kind < 0.35) {
      const cv::Scalar wool = colour();
      cv::ellipse(picture, centre, {radius, 1 + radius / 2}, random.uniform(0, 180), 0, 360, wool, cv::FILLED,
                  cv::LINE_AA);
    } else if (kind < 0.7) {
      std::vector<cv::Point> corners;
      const int count = 3 + static_cast<int>(random.below(4));
      for (int k = 0; k < count; ++k) {
        const double angle = 6.28318 * (k + random.uniform(-0.3, 0.3)) / count;
        corners.emplace_back(centre.x + static_cast<int>(radius * std::cos(angle)),
                             centre.y + static_cast<int>(radius * std::sin(angle)));
      }
      cv::fillConvexPoly(picture, corners, colour(), cv::LINE_AA);
    } else {
      const int down = static_cast<int>(random.uniform(-3, 3) * radius),
                aside = static_cast<int>(random.uniform(-3, 3) * radius);
      cv::line(picture, centre, centre + cv::Point(aside, down), colour(), std::max(1, radius / 4), cv::LINE_AA);
    }
  }
  return picture;
}

}  // namespace holdfast::simulation::pictures
