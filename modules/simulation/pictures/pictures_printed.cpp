// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "holdfast/simulation/noise.hpp"
#include "holdfast/simulation/pictures.hpp"

namespace holdfast::simulation::pictures {

namespace {
int whole(Random& random, double low, double high) { return static_cast<int>(std::floor(random.uniform(low, high))); }

cv::Scalar any_colour(Random& random) {
  return {random.uniform(15, 245), random.uniform(15, 245), random.uniform(15, 245)};
}

// Dark on light and light on dark.
cv::Scalar contrasting(const cv::Scalar& ground, Random& random) {
  const bool light = brightness(ground) > 120.0;
  return light ? colour_between({0, 0, 0}, {80, 60, 80}, random)
               : colour_between({170, 190, 170}, {255, 255, 255}, random);
}

// Two words, or three with a small one in the middle; the last is drawn first.
std::string title_of(int words, Random& random) {
  std::string text = word(random, true);
  for (int i = words - 2; i >= 0; --i) text.insert(0, word(random, i == 0) + " ");
  return text;
}

// Letters `height` texels high with the base line's left end at `position`.
void write(cv::Mat& picture, const std::string& text, cv::Point position, double height, const cv::Scalar& colour,
           Random& random) {
  static const int faces[] = {cv::FONT_HERSHEY_SIMPLEX, cv::FONT_HERSHEY_DUPLEX, cv::FONT_HERSHEY_COMPLEX,
                              cv::FONT_HERSHEY_TRIPLEX};
  const int thickness = std::max(1, static_cast<int>(height / 7.0));
  cv::putText(picture, text, position, faces[random.below(4)], height / 21.0, colour, thickness, cv::LINE_AA);
}

void blend_noise(cv::Mat& picture, double amplitude, const Random& random) {
  NoiseField field(picture.cols, picture.rows);
  add_fractal_noise(field, 40.0F, 40.0F, static_cast<float>(amplitude), 3, 0.8F, random);
  for (int y = 0; y < picture.rows; ++y) {
    auto* out = picture.ptr<std::uint8_t>(y);
    for (int x = 0; x < picture.cols; ++x, out += 3)
      for (int channel = 0; channel < 3; ++channel)
        out[channel] =
            static_cast<std::uint8_t>(std::clamp(static_cast<float>(out[channel]) + field.row(y)[x], 0.0F, 255.0F));
  }
}

void draw_figure(cv::Mat& picture, cv::Rect area, Random& random) {
  const cv::Scalar colour = any_colour(random);
  const cv::Point centre(area.x + area.width / 2, area.y + area.height / 2);
  const int radius = std::max(2, std::min(area.width, area.height) / 2);
  switch (random.below(6)) {
    case 0: {
      cv::circle(picture, centre, radius, colour, cv::FILLED, cv::LINE_AA);
      cv::circle(picture, centre, std::max(1, radius * 2 / 3), any_colour(random), cv::FILLED, cv::LINE_AA);
      const cv::Scalar inner = any_colour(random);
      const int down = whole(random, -radius, radius) / 3, aside = whole(random, -radius, radius) / 3;
      cv::circle(picture, centre + cv::Point(aside, down), std::max(1, radius / 3), inner, cv::FILLED, cv::LINE_AA);
      break;
    }
    case 1:
      cv::rectangle(picture, area, colour, cv::FILLED);
      break;
    case 2:
    case 3: {
      std::vector<cv::Point> corners;
      const int count = 3 + static_cast<int>(random.below(4));
      for (int i = 0; i < count; ++i) {
        const double angle = 6.283185307 * (i + random.uniform(-0.3, 0.3)) / count,
                     reach = radius * random.uniform(0.6, 1.2);
        corners.emplace_back(centre.x + static_cast<int>(reach * std::cos(angle)),
                             centre.y + static_cast<int>(reach * std::sin(angle)));
      }
      cv::fillPoly(picture, std::vector<std::vector<cv::Point>>{corners}, colour, cv::LINE_AA);
      break;
    }
    case 4:
      for (int i = 0; i < 7; ++i) {
        const int thickness = 1 + static_cast<int>(random.below(3));
        const cv::Scalar ink = any_colour(random);
        const cv::Point to{area.x + whole(random, 0, area.width), area.y + whole(random, 0, area.height)};
        const cv::Point from{area.x + whole(random, 0, area.width), area.y + whole(random, 0, area.height)};
        cv::line(picture, from, to, ink, thickness, cv::LINE_AA);
      }
      break;
    default:
      cv::ellipse(picture, centre, {radius, std::max(1, radius / 2)}, random.uniform(0, 180), 0, 360, colour,
                  cv::FILLED, cv::LINE_AA);
  }
}

void write_lines(cv::Mat& picture, cv::Rect area, double height, const cv::Scalar& colour, Random& random) {
  const int step = std::max(4, static_cast<int>(height * 1.9));
  for (int y = area.y + step; y < area.y + area.height; y += step) {
    if (random.uniform() < 0.12) continue;
    const int end = area.x + static_cast<int>(area.width * (random.uniform() < 0.2 ? random.uniform(0.3, 0.8) : 1.0));
    for (int x = area.x; x < end;) {
      const std::string text = word(random, random.uniform() < 0.15);
      const int width = static_cast<int>(0.86 * height * static_cast<double>(text.size()));
      if (x + width > end) break;
      write(picture, text, {x, y}, height, colour, random);
      x += width + static_cast<int>(0.7 * height);
    }
  }
}
}  // namespace

std::string word(Random& random, bool capital) {
  static const char* const onsets[] = {"b", "d", "f", "g", "k", "l",  "m",  "n",
                                       "p", "r", "s", "t", "v", "st", "tr", "w"};
  static const char* const vowels[] = {"a", "e", "i", "o", "u", "ei", "ou", "y"};
  static const char* const codas[] = {"", "", "n", "r", "s", "l", "x", "nd"};
  std::string text;
  const int syllables = 1 + static_cast<int>(random.below(3));
  for (int i = 0; i < syllables; ++i) {
    text += onsets[random.below(16)];
    text += vowels[random.below(8)];
    text += codas[random.below(8)];
  }
  if (capital) text[0] = static_cast<char>(text[0] - 'a' + 'A');
  return text;
}

cv::Mat page(cv::Size size, Random random) {
  cv::Mat picture(size, CV_8UC3, colour_between({205, 215, 215}, {235, 240, 240}, random));
  const int margin = size.width / 12;
  const double height = std::max(5.0, size.width * random.uniform(0.022, 0.032));
  const cv::Scalar ink = any_colour(random) * 0.4;
  write(picture, title_of(2, random), {margin, margin + static_cast<int>(2 * height)}, 2.2 * height, ink, random);
  int y = margin + static_cast<int>(3.0 * height);
  while (y < size.height - margin) {
    const int part = std::min(static_cast<int>(size.height * random.uniform(0.12, 0.3)), size.height - margin - y);
    if (random.uniform() < 0.35) {
      const int width = static_cast<int>(size.width * random.uniform(0.3, 0.6)),
                x = margin + whole(random, 0, size.width / 4);
      for (int i = 0; i < 4; ++i)
        draw_figure(picture,
                    {x + whole(random, 0, width / 2), y + whole(random, 0, part / 2), std::max(4, width / 3),
                     std::max(4, part / 2)},
                    random);
    } else {
      write_lines(picture, {margin, y, size.width - 2 * margin, part}, height, cv::Scalar::all(random.uniform(10, 60)),
                  random);
    }
    y += part + static_cast<int>(height);
  }
  blend_noise(picture, 4.0, random.fork(9));
  return picture;
}

cv::Mat poster(cv::Size size, Random random) {
  const cv::Scalar ground = any_colour(random);
  cv::Mat picture(size, CV_8UC3, ground);
  const int areas = 3 + static_cast<int>(random.below(4));
  for (int i = 0; i < areas; ++i) {
    const cv::Scalar colour = any_colour(random);
    const int left = whole(random, -0.2 * size.width, size.width), top = whole(random, -0.2 * size.height, size.height);
    random.next();  // to spare
    const int width = static_cast<int>(size.width * random.uniform(0.2, 0.7)),
              height = static_cast<int>(size.height * random.uniform(0.1, 0.5));
    cv::rectangle(picture, {left, top, width, height}, colour, cv::FILLED);
  }
  const int figures = 14 + static_cast<int>(random.below(16));
  const double side = std::min(size.width, size.height);
  for (int i = 0; i < figures; ++i) {
    const int width = std::max(4, static_cast<int>(side * random.uniform(0.05, 0.32)));
    const int height = std::max(4, static_cast<int>(side * random.uniform(0.05, 0.32)));
    draw_figure(picture, {whole(random, 0, size.width - width), whole(random, 0, size.height - height), width, height},
                random);
  }
  const double title = 0.075 * size.height;
  for (int i = 0; i < 2; ++i) {
    const int y = static_cast<int>(size.height * (i == 0 ? random.uniform(0.12, 0.3) : random.uniform(0.6, 0.9)));
    cv::rectangle(picture, {0, y - static_cast<int>(1.4 * title), size.width, static_cast<int>(1.9 * title)}, ground,
                  cv::FILLED);
    const cv::Scalar ink = contrasting(ground, random);
    write(picture, title_of(3, random), {size.width / 20, y}, title, ink, random);
  }
  const int small = size.height / 6;
  cv::rectangle(picture, {0, size.height - small, size.width, small}, ground * 0.9, cv::FILLED);
  write_lines(picture, {size.width / 20, size.height - small, size.width * 9 / 10, small - 4}, std::max(5.0, title / 4),
              contrasting(ground, random), random);
  blend_noise(picture, 7.0, random.fork(9));
  return picture;
}

cv::Mat book_spine(cv::Size size, Random random) {
  const double darkness = random.uniform(0.4, 1.0);
  const cv::Scalar ground = any_colour(random) * darkness;
  cv::Mat lying(size.width, size.height, CV_8UC3, ground);  // written along, then turned upright
  const int length = lying.cols, across = lying.rows;
  const int bands = static_cast<int>(random.below(4));
  for (int i = 0; i < bands; ++i) {
    const cv::Scalar colour = any_colour(random);
    cv::rectangle(lying, {whole(random, 0, length), 0, 2 + static_cast<int>(random.below(length / 10 + 1)), across},
                  colour, cv::FILLED);
  }
  const double height = across * random.uniform(0.3, 0.55);
  const cv::Scalar ink = contrasting(ground, random);
  write(lying, title_of(2, random), {length / 12, static_cast<int>(0.5 * across + 0.45 * height)}, height, ink, random);
  if (random.uniform() < 0.6) draw_figure(lying, {length - across, across / 5, across * 3 / 5, across * 3 / 5}, random);
  cv::rectangle(lying, {0, 0, length, across}, ground * 0.45, 1);
  blend_noise(lying, 6.0, random.fork(9));
  cv::Mat picture;
  cv::rotate(lying, picture, cv::ROTATE_90_CLOCKWISE);
  return picture;
}

cv::Mat cardboard(cv::Size size, Random random) {
  const cv::Scalar ground = colour_between({70, 115, 155}, {100, 145, 185}, random);
  cv::Mat picture(size, CV_8UC3, ground);
  blend_noise(picture, 10.0, random.fork(9));
  const int tape = size.height / 8, tape_y = size.height / 2 - tape / 2 + whole(random, -3, 3);
  cv::rectangle(picture, {0, tape_y, size.width, tape}, ground * 0.8, cv::FILLED);
  const int label_top = whole(random, 0.1 * size.height, 0.5 * size.height),
            label_left = whole(random, 0.08 * size.width, 0.5 * size.width);
  const cv::Rect label_area(label_left, label_top, size.width * 2 / 5, size.height * 2 / 5);
  cv::rectangle(picture, label_area, {225, 230, 230}, cv::FILLED);
  write_lines(picture, {label_area.x + 4, label_area.y, label_area.width - 8, label_area.height / 2},
              std::max(5.0, label_area.height / 12.0), cv::Scalar::all(25), random);
  for (int x = label_area.x + 6; x < label_area.x + label_area.width - 6;) {  // a bar code
    const int bar = 1 + static_cast<int>(random.below(4));
    cv::rectangle(picture, {x, label_area.y + label_area.height * 3 / 5, bar, label_area.height / 3},
                  cv::Scalar::all(20), cv::FILLED);
    x += bar + 1 + static_cast<int>(random.below(4));
  }
  write(picture, word(random, true), {size.width / 20, size.height - size.height / 16}, size.height / 9.0, {30, 40, 70},
        random);
  for (int i = 0; i < 5; ++i)
    draw_figure(
        picture,
        {whole(random, 0, 0.85 * size.width), whole(random, 0, 0.85 * size.height), size.width / 10, size.height / 10},
        random);
  cv::rectangle(picture, {0, 0, size.width, size.height}, ground * 0.6, 2);
  return picture;
}

cv::Mat keyboard(cv::Size size, Random random) {
  const bool dark = random.uniform() < 0.5;
  const cv::Scalar body = cv::Scalar::all(dark ? 35 : 190), key = cv::Scalar::all(dark ? 70 : 225);
  cv::Mat picture(size, CV_8UC3, body);
  constexpr int rows = 6, columns = 21;
  const int width = size.width / (columns + 1), height = size.height / (rows + 1);
  for (int row = 0; row < rows; ++row) {
    int x = width / 2 + whole(random, 0, width / 3.0);
    while (x + width < size.width - width / 3) {
      const int wide = random.uniform() < 0.12 ? width * (row == rows - 1 ? 5 : 2) : width;
      const int actual = std::min(wide, size.width - width / 3 - x);
      const int y = height / 2 + row * height + (row > 0 ? height / 4 : 0);
      cv::rectangle(picture, {x + 1, y + 1, actual - 3, height - 3}, key * random.uniform(0.9, 1.05), cv::FILLED);
      const std::string letter(1, static_cast<char>('A' + random.below(26)));
      write(picture, letter, {x + width / 4, y + height * 2 / 3}, std::max(5.0, 0.45 * height),
            cv::Scalar::all(dark ? 220 : 40), random);
      x += actual + (random.uniform() < 0.05 ? width / 2 : 0);
    }
  }
  return picture;
}

cv::Mat screen(cv::Size size, Random random) {
  cv::Mat picture(size, CV_8UC3, colour_between({40, 30, 20}, {110, 80, 60}, random));
  for (int i = 0; i < 14; ++i)
    draw_figure(
        picture,
        {whole(random, 0, 0.8 * size.width), whole(random, 0, 0.8 * size.height), size.width / 5, size.height / 5},
        random);
  for (int window = 0; window < 3; ++window) {
    const int height = static_cast<int>(size.height * random.uniform(0.35, 0.55)),
              width = static_cast<int>(size.width * random.uniform(0.35, 0.5)),
              top = whole(random, 0.03 * size.height, 0.4 * size.height),
              left = whole(random, 0.02 * size.width, 0.45 * size.width);
    const cv::Rect area(left, top, width, height);
    const bool dark = random.uniform() < 0.5;
    cv::rectangle(picture, area, cv::Scalar::all(dark ? 35 : 235), cv::FILLED);
    cv::rectangle(picture, {area.x, area.y, area.width, size.height / 24}, any_colour(random), cv::FILLED);
    write_lines(picture, {area.x + 8, area.y + size.height / 24, area.width - 16, area.height - size.height / 20},
                std::max(5.0, size.height / 48.0),
                dark ? any_colour(random) * 0.3 + cv::Scalar::all(160) : cv::Scalar::all(30), random);
  }
  cv::rectangle(picture, {0, 0, size.width, size.height}, cv::Scalar::all(18), size.height / 14);
  return picture;
}

cv::Mat label(cv::Size size, Random random) {
  const cv::Scalar ground = any_colour(random);
  cv::Mat picture(size, CV_8UC3, ground);
  const int figures = 8 + static_cast<int>(random.below(10));
  for (int i = 0; i < figures; ++i)
    draw_figure(picture,
                {whole(random, 0, 0.85 * size.width), whole(random, 0, 0.85 * size.height), std::max(4, size.width / 6),
                 std::max(4, size.height / 6)},
                random);
  cv::rectangle(picture, {0, size.height / 3, size.width, size.height / 4}, ground * 0.5, cv::FILLED);
  for (int x = 0; x < size.width; x += size.width / 2)
    write(picture, word(random, true), {x + size.width / 30, size.height / 2}, size.height / 9.0, {240, 245, 245},
          random);
  write_lines(picture, {size.width / 20, size.height * 3 / 4, size.width * 9 / 10, size.height / 5},
              std::max(5.0, size.height / 22.0), contrasting(ground, random), random);
  blend_noise(picture, 6.0, random.fork(9));
  return picture;
}

cv::Mat tarpaulin(cv::Size size, Random random) {
  const cv::Scalar ground = any_colour(random);
  cv::Mat picture = plain(size, ground, random.fork(1));
  for (int x = 0; x < size.width; x += std::max(8, size.height / 4))
    cv::line(picture, {x, 0}, {x, size.height}, ground * 0.8, 1);
  const cv::Scalar ink = contrasting(ground, random);
  write(picture, title_of(1, random), {size.width / 10, size.height * 11 / 20}, 0.28 * size.height, ink, random);
  write(picture, title_of(2, random), {size.width / 8, size.height * 4 / 5}, 0.1 * size.height, ink, random);
  return picture;
}

}  // namespace holdfast::simulation::pictures
