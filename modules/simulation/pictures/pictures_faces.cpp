// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "holdfast/simulation/noise.hpp"
#include "holdfast/simulation/pictures.hpp"
#include "pictures_folds.hpp"

namespace holdfast::simulation::pictures {

namespace {
constexpr int fine = 4;  // fractional bits of coordinates, so that small features keep their shape

cv::Point at(double x, double y) {
  return {static_cast<int>(std::lround(x * (1 << fine))), static_cast<int>(std::lround(y * (1 << fine)))};
}

// Paints on the front of a head: x from its middle to its own left, y up from the chin, both in heights of the head.
class FacePainter {
 public:
  FacePainter(cv::Mat& picture, const Face& face)
      : picture_(picture),
        face_(face),
        unit_y_(picture.rows / 1.035),
        // The head is about 2.5 of its heights around, and drawn wider in front.
        unit_x_(picture.cols / 2.5 / (1.0 - face_density)) {}

  double x(double right) const { return 0.5 * picture_.cols + right * unit_x_; }
  double y(double up) const { return (1.0 - up) * unit_y_; }
  cv::Point point(double right, double up) const { return at(x(right), y(up)); }
  double unit() const { return unit_y_; }

  void ellipse(double right, double up, double radius_x, double radius_y, const cv::Scalar& colour, double from = 0.0,
               double to = 360.0, int thickness = cv::FILLED) {
    cv::ellipse(picture_, point(right, up), at(radius_x * unit_x_, radius_y * unit_y_), 0.0, from, to, colour,
                thickness, cv::LINE_AA, fine);
  }
  void polygon(const std::vector<std::pair<double, double>>& corners, const cv::Scalar& colour) {
    std::vector<cv::Point> points;
    for (const auto& [right, up] : corners) points.push_back(point(right, up));
    cv::fillPoly(picture_, std::vector<std::vector<cv::Point>>{points}, colour, cv::LINE_AA, fine);
  }
  void line(double x1, double y1, double x2, double y2, const cv::Scalar& colour, double thickness) {
    cv::line(picture_, point(x1, y1), point(x2, y2), colour, std::max(1, static_cast<int>(thickness * unit_y_ + 0.5)),
             cv::LINE_AA, fine);
  }

  void eye(double side, double openness) {
    const double middle = side * 0.150, up = 0.520;
    const cv::Scalar lid = mix(face_.skin, {30, 35, 60}, 0.35), lash(22, 22, 28);
    ellipse(middle, up + 0.028, 0.085, 0.040, mix(face_.skin, {40, 45, 80}, 0.22));
    ellipse(middle, up, 0.066, 0.026 * openness, {195, 205, 210});
    ellipse(middle, up, 0.030, 0.030 * openness, {45, 55, 75});
    ellipse(middle, up, 0.015, 0.017, {15, 14, 15});
    ellipse(middle + 0.010, up + 0.008, 0.006, 0.006, {240, 240, 240});
    for (int i = 0; i < 2; ++i) {
      const double lift = 0.004 * i;
      ellipse(middle, up - 0.003 + lift, 0.068, 0.029 * openness, lash, 195, 345, 2);
    }
    ellipse(middle, up + 0.012, 0.072, 0.036, lid, 200, 340, 1);
    ellipse(middle, up + 0.002, 0.066, 0.027 * openness, lid, 20, 160, 1);
    ellipse(middle, up - 0.018, 0.07, 0.028, mix(face_.skin, {50, 50, 90}, 0.25), 30, 150, 1);
  }

  void brow(double side, Random& random) {
    const cv::Scalar colour = mix(face_.hair, {25, 25, 30}, 0.45);
    const double thickness = random.uniform(0.020, 0.034);
    polygon({{side * 0.060, 0.604},
             {side * 0.130, 0.640},
             {side * 0.235, 0.606},
             {side * 0.150, 0.634 - thickness},
             {side * 0.062, 0.604 - thickness}},
            colour);
  }

  void nose() {
    const cv::Scalar shadow = mix(face_.skin, {35, 40, 75}, 0.24), nostril = mix(face_.skin, {25, 25, 45}, 0.62);
    for (const double side : {-1.0, 1.0}) {
      line(side * 0.035, 0.50, side * 0.045, 0.40, mix(face_.skin, shadow, 0.45), 0.012);
      ellipse(side * 0.082, 0.352, 0.024, 0.030, shadow, side > 0 ? -70 : 110, side > 0 ? 70 : 250, 2);
      ellipse(side * 0.040, 0.322, 0.017, 0.008, nostril);
    }
    ellipse(0.0, 0.312, 0.045, 0.008, shadow);
    ellipse(0.0, 0.375, 0.022, 0.022, mix(face_.skin, {255, 255, 255}, 0.14));
    ellipse(0.0, 0.450, 0.012, 0.060, mix(face_.skin, {255, 255, 255}, 0.10));
  }

  void mouth(Random& random) {
    const cv::Scalar lip = mix(face_.skin, {70, 60, 150}, 0.35 + 0.45 * face_.lips);
    const double wide = random.uniform(0.135, 0.165);
    polygon({{-wide, 0.218}, {-0.045, 0.246}, {0.0, 0.238}, {0.045, 0.246}, {wide, 0.218}, {0.0, 0.208}}, lip * 0.85);
    polygon({{-wide, 0.218}, {0.0, 0.212}, {wide, 0.218}, {0.06, 0.182}, {-0.06, 0.182}}, lip);
    line(-wide, 0.219, 0.0, 0.213, mix(lip, {20, 15, 30}, 0.7), 0.009);
    line(wide, 0.219, 0.0, 0.213, mix(lip, {20, 15, 30}, 0.7), 0.009);
    ellipse(0.0, 0.163, 0.065, 0.010, mix(face_.skin, {40, 40, 80}, 0.30));
    ellipse(0.0, 0.198, 0.035, 0.006, mix(lip, {255, 255, 255}, 0.2));
  }

  void glasses() {
    const cv::Scalar rim(28, 26, 28);
    for (const double side : {-1.0, 1.0}) {
      ellipse(side * 0.155, 0.515, 0.110, 0.072, rim, 0, 360, std::max(2, static_cast<int>(0.016 * unit_y_)));
      line(side * 0.265, 0.530, side * 0.385, 0.535, rim, 0.016);  // to the ear
    }
    line(-0.045, 0.528, 0.045, 0.528, rim, 0.014);
  }

 private:
  cv::Mat& picture_;
  const Face& face_;
  double unit_y_, unit_x_;
};

// Strands: noise drawn out along them.
void add_strands(NoiseField& field, float across, float along, const Random& random) {
  add_value_noise(field, across, along, 0.45F, random.fork(1));
  add_value_noise(field, 0.45F * across, 0.6F * along, 0.30F, random.fork(2));
  add_value_noise(field, 4.0F * across, 1.5F * along, 0.30F, random.fork(3));
}

cv::Mat skin_ground(cv::Size size, const cv::Scalar& skin, float texels, const Random& random, float stretch = 1.0F) {
  cv::Mat picture(size, CV_8UC3, skin);
  Shade shade(size);
  shade.uneven(stretch * 0.05F * texels, 0.05F * texels, 0.04F, 3, random.fork(1));
  shade.uneven(stretch * 0.008F * texels, 0.008F * texels, 0.025F, 2, random.fork(2));
  shade.apply(picture);
  return picture;
}
}  // namespace

cv::Mat head(cv::Size size, const Face& face, Random random) {
  cv::Mat picture = skin_ground(size, face.skin, 640.0F, random.fork(1), 1.0F / (1.0F - face_density));
  FacePainter painter(picture, face);
  Random own = random.fork(2);
  const double openness = own.uniform(0.8, 1.15);
  for (const double side : {-1.0, 1.0}) painter.eye(side, openness), painter.brow(side, own);
  painter.nose();
  painter.mouth(own);

  Shade shade(size);
  const auto unit = static_cast<float>(painter.unit());
  const auto spot = [&](double right, double up, float radius_x, float radius_y, float strength) {
    shade.spot({static_cast<float>(painter.x(right)), static_cast<float>(painter.y(up))}, radius_x * unit,
               radius_y * unit, strength);
  };
  for (const double side : {-1.0, 1.0}) {
    spot(side * 0.11, 0.545, 0.22F, 0.09F, 0.16F);  // eye sockets
    spot(side * 0.30, 0.38, 0.35F, 0.14F, -0.06F);  // cheekbones
    spot(side * 0.42, 0.20, 0.45F, 0.22F, 0.17F);   // below them
    spot(side * 0.17, 0.30, 0.08F, 0.14F, 0.10F);   // from nose to mouth
  }
  spot(0.0, 0.29, 0.16F, 0.05F, 0.07F);
  spot(0.0, 0.75, 0.7F, 0.15F, -0.07F);
  spot(0.0, 0.07, 0.25F, 0.07F, -0.05F);
  spot(0.0, -0.03, 2.0F, 0.10F, 0.42F);  // under the chin

  // Beard and the shadow of cropped hair: dark noise where hair grows.
  if (face.beard || !face.bald) {
    NoiseField strands(size.width, size.height);
    add_strands(strands, 5.0F, 7.0F, random.fork(4));
    for (int y = 0; y < size.height; ++y)
      for (int x = 0; x < size.width; ++x) {
        const double right = (x - painter.x(0.0)) / (painter.x(1.0) - painter.x(0.0)), up = 1.0 - y / painter.unit();
        const double side = std::abs(right);
        double cover = 0.0;
        if (face.beard && side < 0.40 && up < 0.48) {
          // Below the mouth, rising over the jaw to the ears.
          const double edge = 0.178 + 1.0 * std::max(0.0, side - 0.17) + (side > 0.30 ? 1.5 * (side - 0.30) : 0.0);
          cover = std::clamp(std::min((edge - up) / 0.05, (0.40 - side) / 0.03), 0.0, 0.85);
          if (side < 0.21 && up > 0.245 && up < 0.290 - 0.2 * side) cover = std::max(cover, 0.75);
          const double mouth = (right / 0.16) * (right / 0.16) + ((up - 0.213) / 0.034) * ((up - 0.213) / 0.034);
          cover *= std::clamp((mouth - 1.0) / 0.5, 0.0, 1.0);
        }
        if (!face.bald) {
          // The scalp, in case it shows at the rim of the hair.
          const double line = side < 0.45 ? 0.84 - 0.25 * side : 0.72 - 0.6 * (side - 0.45);
          cover = std::max(cover, std::clamp((up - std::max(line, 0.25)) / 0.03, 0.0, 0.9));
        }
        if (cover <= 0.0) continue;
        auto& pixel = picture.at<cv::Vec3b>(y, x);
        for (int channel = 0; channel < 3; ++channel) {
          const double strand = face.hair[channel] * (1.0 + 0.8 * strands.row(y)[x]);
          pixel[channel] = cv::saturate_cast<std::uint8_t>(pixel[channel] * (1.0 - cover) + strand * cover);
        }
      }
  }
  shade.apply(picture);
  if (face.glasses) painter.glasses();
  return picture;
}

cv::Mat ear(cv::Size size, const cv::Scalar& skin, double texels, Random random) {
  cv::Mat picture = skin_ground(size, mix(skin, {110, 110, 200}, 0.12), static_cast<float>(texels), random);
  Shade shade(size);
  for (int i = 0; i < 4; ++i)
    shade.spot({static_cast<float>(size.width) * (0.125F + 0.25F * static_cast<float>(i)), 0.5F * size.height},
               0.07F * size.width, 0.30F * size.height, 0.45F);
  shade.apply(picture);
  return picture;
}

cv::Mat hair(cv::Size size, const cv::Scalar& colour, bool curly, double texels, Random random) {
  const int overlap = size.width / 8;
  cv::Mat picture(size.height, size.width + overlap, CV_8UC3, colour);
  NoiseField strands(picture.cols, picture.rows);
  const auto scale = static_cast<float>(texels);
  if (curly) {
    add_value_noise(strands, 0.014F * scale, 0.014F * scale, 0.55F, random.fork(1));
    add_value_noise(strands, 0.007F * scale, 0.007F * scale, 0.40F, random.fork(2));
  } else {
    add_strands(strands, 0.007F * scale, 0.10F * scale, random.fork(1));
  }
  for (int y = 0; y < picture.rows; ++y) {
    auto* out = picture.ptr<std::uint8_t>(y);
    for (int x = 0; x < picture.cols; ++x)
      for (int channel = 0; channel < 3; ++channel, ++out) {
        // Dark hair shines too.
        const float value = static_cast<float>(colour[channel]);
        *out = cv::saturate_cast<std::uint8_t>(value + (0.55F * value + 16.0F) * strands.row(y)[x]);
      }
  }
  return joined(picture, overlap);
}

cv::Mat bare_neck(cv::Size size, const cv::Scalar& skin, double texels, Random random) {
  cv::Mat picture = skin_ground(size, skin, static_cast<float>(texels), random.fork(1));
  Shade shade(size);
  const auto width = static_cast<float>(size.width), height = static_cast<float>(size.height);
  shade.spot({0.5F * width, 0.0F}, 0.45F * width, 0.55F * height, 0.42F);
  for (const float side : {-1.0F, 1.0F})
    shade.fold({(0.5F + 0.20F * side) * width, 0.1F * height}, {(0.5F + 0.03F * side) * width, 0.95F * height}, 0.0F,
               0.05F * width, 0.14F);
  shade.apply(picture);
  return picture;
}

cv::Mat bare_limb(cv::Size size, const cv::Scalar& skin, double texels, Random random) {
  cv::Mat picture = skin_ground(size, skin, static_cast<float>(texels), random.fork(1));
  Shade shade(size);
  // Darker at the inner side.
  shade.spot({0.0F, 0.5F * size.height}, 0.28F * size.width, 2.0F * size.height, 0.16F);
  shade.apply(picture);
  return picture;
}

cv::Mat hand(cv::Size size, const cv::Scalar& skin, double texels, Random random) {
  cv::Mat picture = skin_ground(size, skin, static_cast<float>(texels), random.fork(1));
  Shade shade(size);
  const auto width = static_cast<float>(size.width), height = static_cast<float>(size.height);
  // Four fingers outside and four inside, their gaps dark; knuckles.
  for (const float middle : {0.5F, 0.0F, 1.0F})
    for (const float gap : {-0.11F, 0.0F, 0.11F}) {
      const float x = (middle + gap) * width;
      shade.fold({x, 0.56F * height}, {x, 1.08F * height}, 0.0F, 0.025F * width, 0.55F);
      shade.spot({x + 0.055F * width, 0.52F * height}, 0.045F * width, 0.06F * height, middle == 0.5F ? -0.12F : 0.1F);
    }
  shade.folds({{0.3F * width, 0.6F * height, 0.4F * width, 0.3F * height}, 6, 0.0, 0.3, 0.12 * width, 2.0, 0.12},
              random);
  shade.apply(picture);
  return picture;
}

}  // namespace holdfast::simulation::pictures
