// SPDX-License-Identifier: BSD-3-Clause
#include "pictures_cloth.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "holdfast/simulation/noise.hpp"
#include "pictures_folds.hpp"

namespace holdfast::simulation::pictures {

cv::Scalar darker(const cv::Scalar& colour, double factor) { return colour * factor; }

namespace {
using Weave = Cloth::Weave;

// Grain of the yarn, and unevenness of dye and wear.
void add_grain(cv::Mat& picture, double texels, float strength, const Random& random) {
  Shade shade(picture.size());
  const auto scale = static_cast<float>(texels);
  shade.uneven(0.10F * scale, 0.10F * scale, 0.05F, 3, random.fork(1));
  shade.uneven(2.5F, 2.5F, strength, 1, random.fork(2));
  shade.apply(picture);
}

// How much of the second colour a band pattern has at each place: threads of several widths that repeat.
std::vector<float> bands(int length, double period, Random random) {
  struct Band {
    double begin, end;
    float amount;
  };
  std::vector<Band> sett;
  const double wide = random.uniform(0.25, 0.45);
  sett.push_back({0.0, wide, static_cast<float>(random.uniform(0.7, 1.0))});
  for (int i = 0; i < 3; ++i) {
    const double begin = random.uniform(wide, 0.92);
    sett.push_back({begin, begin + random.uniform(0.03, 0.10), static_cast<float>(random.uniform(-0.5, 1.0))});
  }
  const double phase = random.uniform();
  std::vector<float> result(static_cast<std::size_t>(length), 0.0F);
  for (int i = 0; i < length; ++i) {
    const double position = std::fmod(i / period + phase, 1.0);
    for (const Band& band : sett)
      if (position >= band.begin && position < band.end) result[i] = band.amount;
  }
  return result;
}

void weave_plaid(cv::Mat& picture, const Cloth& cloth, int cloth_width, double texels, const Random& random) {
  double period = 0.085 * cloth.scale * texels;
  period = cloth_width / std::max(1.0, std::round(cloth_width / period));  // goes on across the seam
  const std::vector<float> across = bands(picture.cols, period, Random(cloth.pattern).fork(1));
  const std::vector<float> down = bands(picture.rows, period, Random(cloth.pattern).fork(2));
  NoiseField drift(picture.cols, picture.rows);  // cloth never hangs straight
  add_value_noise(drift, 0.16F * static_cast<float>(texels), 0.16F * static_cast<float>(texels),
                  0.012F * static_cast<float>(texels), random.fork(3));
  for (int y = 0; y < picture.rows; ++y) {
    auto* out = picture.ptr<std::uint8_t>(y);
    for (int x = 0; x < picture.cols; ++x, out += 3) {
      const int shift = static_cast<int>(drift.row(y)[x]);
      const float amount = 0.5F * (across[std::clamp(x + shift, 0, picture.cols - 1)] +
                                   down[std::clamp(y + shift, 0, picture.rows - 1)]);
      for (int channel = 0; channel < 3; ++channel) {
        const auto ground = static_cast<float>(cloth.colour[channel]);
        const float thread = amount >= 0.0F ? static_cast<float>(cloth.second[channel]) : 0.15F * ground;
        out[channel] = cv::saturate_cast<std::uint8_t>(ground + std::abs(amount) * (thread - ground));
      }
    }
  }
}

void weave_stripes(cv::Mat& picture, const Cloth& cloth, double texels, Random random) {
  Random pattern(cloth.pattern);
  const double period = pattern.uniform(0.025, 0.065) * cloth.scale * texels, share = pattern.uniform(0.3, 0.55);
  NoiseField drift(picture.cols, 1);
  add_value_noise(drift, 0.10F * static_cast<float>(texels), 1.0F, 0.010F * static_cast<float>(texels), random.fork(3));
  for (int x = 0; x < picture.cols; ++x)
    for (int y = 0; y < picture.rows; ++y) {
      const double position = (y + drift.row(0)[x]) / period + 100.0;
      if (position - std::floor(position) < share)
        for (int channel = 0; channel < 3; ++channel)
          picture.at<cv::Vec3b>(y, x)[channel] = cv::saturate_cast<std::uint8_t>(cloth.second[channel]);
    }
}

void print_dots(cv::Mat& picture, const Cloth& cloth, double texels, Random random) {
  Random pattern(cloth.pattern);
  const double step = pattern.uniform(0.022, 0.04) * cloth.scale * texels, radius = step * pattern.uniform(0.16, 0.27);
  int row = 0;
  for (double y = 0.3 * step; y < picture.rows; y += 0.85 * step, ++row)
    for (double x = (row % 2) * 0.5 * step; x < picture.cols; x += step)
      cv::circle(picture,
                 {static_cast<int>(16 * (x + random.uniform(-0.06, 0.06) * step)),
                  static_cast<int>(16 * (y + random.uniform(-0.06, 0.06) * step))},
                 static_cast<int>(16 * radius), cloth.second, cv::FILLED, cv::LINE_AA, 4);
}

void print_flowers(cv::Mat& picture, const Cloth& cloth, double texels, Random random) {
  const int count = static_cast<int>(picture.total() / (0.0026 * cloth.scale * texels * texels));
  for (int i = 0; i < count; ++i) {
    const double centre_y = random.uniform(0, picture.rows), centre_x = random.uniform(0, picture.cols);
    const cv::Point2d centre(centre_x, centre_y);
    const double size = 0.013 * texels * random.uniform(0.6, 1.3);
    const cv::Scalar petal =
        mix(cloth.second, {random.uniform(40, 240), random.uniform(40, 240), random.uniform(90, 250)}, 0.45);
    const double turned = random.uniform(0, 1.2);
    for (int k = 0; k < 5; ++k) {
      const double angle = turned + 1.2566 * k;
      cv::circle(picture,
                 {static_cast<int>(16 * (centre.x + size * std::cos(angle))),
                  static_cast<int>(16 * (centre.y + size * std::sin(angle)))},
                 static_cast<int>(16 * 0.62 * size), petal, cv::FILLED, cv::LINE_AA, 4);
    }
    cv::circle(picture, {static_cast<int>(16 * centre.x), static_cast<int>(16 * centre.y)}, static_cast<int>(8 * size),
               darker(cloth.colour, 0.4), cv::FILLED, cv::LINE_AA, 4);
  }
}

void knit(cv::Mat& picture, const Cloth& cloth, double texels, const Random& random) {
  const double stitch = 0.009 * cloth.scale * texels;
  NoiseField mottle(picture.cols, picture.rows);
  add_fractal_noise(mottle, 0.014F * static_cast<float>(texels), 0.014F * static_cast<float>(texels), 0.14F, 2, 0.8F,
                    random);
  for (int y = 0; y < picture.rows; ++y) {
    auto* out = picture.ptr<std::uint8_t>(y);
    for (int x = 0; x < picture.cols; ++x) {
      const double column = x / stitch, in_column = column - std::floor(column);
      // Chevrons in columns, with cables between.
      const double chevron = std::sin(6.2832 * (y / stitch + std::abs(in_column - 0.5)));
      const double rib = std::fmod(column, 6.0) < 1.0 ? -0.30 : 0.0;
      const double factor = 1.0 + 0.10 * chevron + rib + mottle.row(y)[x];
      for (int channel = 0; channel < 3; ++channel, ++out) *out = cv::saturate_cast<std::uint8_t>(*out * factor);
    }
  }
}

void twill(cv::Mat& picture, double texels, const Random& random) {
  NoiseField wear(picture.cols, picture.rows);
  add_fractal_noise(wear, 0.05F * static_cast<float>(texels), 0.12F * static_cast<float>(texels), 0.10F, 4, 0.75F,
                    random.fork(1));
  add_value_noise(wear, 2.0F, 9.0F, 0.16F, random.fork(2));
  add_value_noise(wear, 5.0F, 2.5F, 0.09F, random.fork(3));
  for (int y = 0; y < picture.rows; ++y) {
    auto* out = picture.ptr<std::uint8_t>(y);
    for (int x = 0; x < picture.cols * 3; ++x, ++out) {
      const float value = wear.row(y)[x / 3];
      *out = cv::saturate_cast<std::uint8_t>(static_cast<float>(*out) * (1.0F + value) + 14.0F * value);
    }
  }
}
}  // namespace

cv::Mat cloth_ground(cv::Size size, const Cloth& cloth, double texels, const Random& random) {
  const int overlap = std::min(size.width / 4, static_cast<int>(0.03 * texels));
  cv::Mat picture(size.height, size.width + overlap, CV_8UC3, cloth.colour);
  switch (cloth.weave) {
    case Weave::plaid:
      weave_plaid(picture, cloth, size.width, texels, random.fork(11));
      break;
    case Weave::striped:
      weave_stripes(picture, cloth, texels, random.fork(11));
      break;
    case Weave::dotted:
      print_dots(picture, cloth, texels, random.fork(11));
      break;
    case Weave::flowered:
      print_flowers(picture, cloth, texels, random.fork(11));
      break;
    case Weave::knitted:
      knit(picture, cloth, texels, random.fork(11));
      break;
    case Weave::denim:
      twill(picture, texels, random.fork(11));
      break;
    case Weave::plain:
    case Weave::printed:
      break;
  }
  add_grain(picture, texels, 0.06F, random.fork(12));
  return joined(picture, overlap);
}

// A print: a badge or picture with words.
void print_front(cv::Mat& picture, cv::Point2d centre, double width, const Cloth& cloth, Random random) {
  const cv::Scalar ink = cloth.second;
  const cv::Scalar other = mix(ink, {random.uniform(20, 240), random.uniform(20, 240), random.uniform(20, 240)}, 0.7);
  const double kind = random.uniform();
  const double height = kind < 0.35 ? 0.35 * width : width * random.uniform(0.7, 1.1);
  const auto line_of_text = [&](double y, double letter) {
    std::string text = word(random, true);
    for (char& character : text) character = static_cast<char>(std::toupper(static_cast<unsigned char>(character)));
    const double wide = cv::getTextSize(text, cv::FONT_HERSHEY_DUPLEX, 1.0, 1, nullptr).width;
    const double scale = std::min(width / wide, letter / 21.0);
    cv::putText(picture, text, cv::Point2d(centre.x - 0.5 * wide * scale, y), cv::FONT_HERSHEY_DUPLEX, scale, ink,
                std::max(1, static_cast<int>(2.6 * scale)), cv::LINE_AA);
  };
  if (kind >= 0.35) {
    if (kind < 0.65)
      cv::ellipse(picture, centre, cv::Size2d(0.5 * width, 0.42 * height), 0, 0, 360, other, cv::FILLED, cv::LINE_AA);
    else
      cv::rectangle(picture, cv::Rect2d(centre.x - 0.5 * width, centre.y - 0.42 * height, width, 0.84 * height), other,
                    cv::FILLED);
    for (int i = 0; i < 22; ++i) {
      const double down = random.uniform(-0.30, 0.30) * height, aside = random.uniform(-0.36, 0.36) * width;
      const cv::Point2d spot = centre + cv::Point2d(aside, down);
      const cv::Scalar paint = i % 3 == 0 ? cloth.colour : i % 3 == 1 ? ink : darker(other, random.uniform(0.3, 0.8));
      if (i % 2 == 0) {
        const double turned = random.uniform(0, 180), high = width * random.uniform(0.02, 0.08),
                     wide = width * random.uniform(0.02, 0.12);
        cv::ellipse(picture, spot, cv::Size2d(wide, high), turned, 0, 360, paint, cv::FILLED, cv::LINE_AA);
      } else {
        const double rise = random.uniform(-0.2, 0.2) * height, run = random.uniform(-0.2, 0.2) * width;
        cv::line(picture, spot, spot + cv::Point2d(run, rise), paint, 1 + static_cast<int>(0.015 * width), cv::LINE_AA);
      }
    }
    line_of_text(centre.y + 0.56 * height, 0.16 * width);
  }
  if (kind < 0.65) line_of_text(centre.y + (kind < 0.35 ? -0.02 : 0.10) * width, 0.30 * width);
  if (kind < 0.35) line_of_text(centre.y + 0.22 * width, 0.16 * width);
}

}  // namespace holdfast::simulation::pictures
