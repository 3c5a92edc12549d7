// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "holdfast/simulation/pictures.hpp"
#include "pictures_cloth.hpp"
#include "pictures_folds.hpp"

namespace holdfast::simulation::pictures {

namespace {
using Weave = Cloth::Weave;

// A row of stitches.
void stitch(cv::Mat& picture, cv::Point2d from, cv::Point2d to, const cv::Scalar& colour, double texels) {
  const cv::Point2d way = to - from;
  const double length = std::sqrt(way.x * way.x + way.y * way.y), step = 0.0060 * texels;
  for (double s = 0.0; s + 0.6 * step < length; s += step) {
    const cv::Point2d a = from + way * (s / length), b = from + way * ((s + 0.62 * step) / length);
    cv::line(picture, {static_cast<int>(16 * a.x), static_cast<int>(16 * a.y)},
             {static_cast<int>(16 * b.x), static_cast<int>(16 * b.y)}, colour, 1, cv::LINE_AA, 4);
  }
}

void seam_line(cv::Mat& picture, cv::Point2d from, cv::Point2d to, const cv::Scalar& cloth, double texels) {
  cv::line(picture, from, to, darker(cloth), std::max(1, static_cast<int>(0.0045 * texels)), cv::LINE_AA);
  const cv::Point2d aside = std::abs(to.x - from.x) > std::abs(to.y - from.y) ? cv::Point2d(0, 0.009 * texels)
                                                                              : cv::Point2d(0.009 * texels, 0);
  stitch(picture, from + aside, to + aside,
         mix(cloth, brightness(cloth) > 90 ? cv::Scalar::all(30) : cv::Scalar(150, 185, 200), 0.5), texels);
}

void patch_pocket(cv::Mat& picture, const cv::Rect2d& area, const cv::Scalar& cloth, double texels, bool buttoned) {
  Shade shade(picture.size());
  shade.spot(cv::Point2d(area.x + 0.5 * area.width, area.y + area.height), static_cast<float>(0.7 * area.width),
             static_cast<float>(0.02 * texels), 0.25F);
  shade.apply(picture);
  const cv::Point2d corners[] = {{area.x, area.y},
                                 {area.x + area.width, area.y},
                                 {area.x + area.width, area.y + 0.86 * area.height},
                                 {area.x + 0.5 * area.width, area.y + area.height},
                                 {area.x, area.y + 0.86 * area.height}};
  for (int i = 0; i < 5; ++i) {
    cv::line(picture, corners[i], corners[(i + 1) % 5], darker(cloth, 0.5),
             std::max(1, static_cast<int>(0.004 * texels)), cv::LINE_AA);
  }
  seam_line(picture, corners[0] + cv::Point2d(0, 0.016 * texels), corners[1] + cv::Point2d(0, 0.016 * texels), cloth,
            texels);
  if (buttoned)
    cv::circle(picture, cv::Point2d(area.x + 0.5 * area.width, area.y + 0.02 * texels),
               static_cast<int>(0.006 * texels) + 1,
               brightness(cloth) > 100 ? cv::Scalar::all(60) : cv::Scalar::all(210), cv::FILLED, cv::LINE_AA);
}

void buttons(cv::Mat& picture, double x, double from, double to, const cv::Scalar& cloth, double texels) {
  const double half = 0.016 * texels;
  cv::line(picture, cv::Point2d(x + half, from), cv::Point2d(x + half, to), darker(cloth, 0.45),
           std::max(1, static_cast<int>(0.005 * texels)), cv::LINE_AA);
  stitch(picture, {x - half, from}, {x - half, to}, darker(cloth, 0.6), texels);
  const cv::Scalar button = brightness(cloth) > 110 ? cv::Scalar(70, 75, 80) : cv::Scalar(210, 220, 225);
  for (double y = from + 0.035 * texels; y < to; y += 0.085 * texels) {
    const cv::Point2d centre(x, y);
    cv::circle(picture, centre + cv::Point2d(1, 1), static_cast<int>(0.0055 * texels) + 1, darker(cloth, 0.4),
               cv::FILLED, cv::LINE_AA);
    cv::circle(picture, centre, static_cast<int>(0.0045 * texels) + 1, button, cv::FILLED, cv::LINE_AA);
  }
}

// A shirt's cut in texels.
struct ShirtLines {
  double width, height, middle, neckline, shoulder, chest, waist, hem;
};
ShirtLines lines_of(const ShirtCut& cut, double w, double h) {
  return {w, h, 0.5 * w, cut.neckline * h, cut.shoulder * h, cut.chest * h, cut.waist * h, cut.hem * h};
}

// The first `columns` moved to the right end.
cv::Mat rolled(const cv::Mat& picture, int columns) {
  cv::Mat result;
  cv::hconcat(picture.colRange(columns, picture.cols), picture.colRange(0, columns), result);
  return result;
}

void print_shirt(cv::Mat& picture, const Cloth& cloth, const ShirtLines& at, double texels, Random& random) {
  const Random front = random.fork(1);
  const double wide = 0.24 * texels * random.uniform(0.7, 1.1);
  print_front(picture, {at.middle, at.chest + 0.03 * texels}, wide, cloth, front);
  if (random.uniform() >= 0.6) return;
  // One on the back, half each at the left and right border.
  const int half = picture.cols / 2;
  cv::Mat back = rolled(picture, half);
  print_front(back, {at.middle, at.chest}, 0.26 * texels, cloth, random.fork(2));
  picture = rolled(back, picture.cols - half);
}

// Drawn from the armpits, hanging from the chest, gathered at the waist.
Shade shirt_folds(cv::Size size, const Cloth& cloth, const ShirtLines& at, double texels, const Random& random) {
  Shade shade(size);
  const auto w = static_cast<float>(at.width), h = static_cast<float>(at.height);
  const double strength = cloth.weave == Weave::knitted ? 0.20 : 0.34;
  const auto fold = [&](double x, double y, double wide, double high, int count, double direction, double spread,
                        double length, double thick, double factor) {
    shade.folds({{static_cast<float>(x), static_cast<float>(y), static_cast<float>(wide), static_cast<float>(high)},
                 count,
                 direction,
                 spread,
                 length * texels,
                 thick * texels,
                 factor * strength},
                random.fork(static_cast<std::uint64_t>(100.0 + x + 7.0 * y + count)));
  };
  for (const double side : {0.25, 0.75}) {
    for (const double towards : {-1.0, 1.0})
      fold((side + 0.06 * towards - 0.05) * at.width, at.shoulder + 0.02 * at.height, 0.10 * at.width,
           at.chest - at.shoulder, 6, 0.75 * towards, 0.45, 0.14, 0.010, 1.0);
    fold((side - 0.10) * at.width, at.chest + 0.3 * (at.waist - at.chest), 0.2 * at.width, at.waist - at.chest, 9,
         side < 0.5 ? 0.4 : -0.4, 0.5, 0.13, 0.010, 1.0);
    shade.spot({static_cast<float>(side) * w, static_cast<float>(at.chest)}, 0.10F * w,
               static_cast<float>(0.5 * (at.waist - at.shoulder)), 0.30F);
  }
  fold(0.0, at.chest, at.width, at.waist - at.chest, 14, 1.57, 0.5, 0.16, 0.013, 0.8);
  fold(0.0, at.waist - 0.06 * texels, at.width, 0.10 * texels, 20, 0.0, 0.55, 0.12, 0.009, 1.1);
  fold(0.0, at.shoulder, at.width, at.chest - at.shoulder, 8, 1.57, 0.7, 0.12, 0.012, 0.6);
  if (at.hem < at.height || at.waist < 0.9 * at.height)
    fold(0.0, at.waist, at.width, at.hem - at.waist, 12, 1.3, 0.6, 0.10, 0.011, 0.9);
  shade.uneven(0.09F * static_cast<float>(texels), 0.07F * static_cast<float>(texels), 0.07F, 2, random.fork(9));
  shade.spot({static_cast<float>(at.middle), static_cast<float>(at.neckline)}, 0.20F * w, 0.10F * h, 0.18F);
  shade.spot({static_cast<float>(at.middle), static_cast<float>(at.chest + 0.06 * texels)}, 0.22F * w,
             static_cast<float>(0.05 * texels), 0.10F);
  return shade;
}

void open_front(cv::Mat& picture, const Cloth& cloth, const Cloth& under, const ShirtLines& at, double texels,
                const Random& random) {
  // What is worn under it shows between the edges.
  cv::Mat beneath = cloth_ground(picture.size(), under, texels, random);
  buttons(beneath, at.middle, at.neckline, at.height, under.colour, texels);
  const double at_neck = 0.060 * texels, at_chest = 0.028 * texels, at_hem = 0.050 * texels;
  const auto edge = [&](double y) {
    if (y < at.chest)
      return at_neck + (at_chest - at_neck) * std::clamp((y - at.neckline) / (at.chest - at.neckline), 0.0, 1.0);
    return at_chest + (at_hem - at_chest) * std::clamp((y - at.chest) / (at.hem - at.chest), 0.0, 1.0);
  };
  for (int y = 0; y < picture.rows; ++y) {
    const double half = edge(y);
    for (int x = static_cast<int>(at.middle - half); x <= static_cast<int>(at.middle + half); ++x) {
      if (x < 0 || x >= picture.cols) continue;
      const double inside = std::min(x - (at.middle - half), at.middle + half - x) / (0.02 * texels);
      const double shadow = 0.45 + 0.5 * std::clamp(inside, 0.0, 1.0);
      const cv::Vec3b colour = beneath.at<cv::Vec3b>(y, x);
      for (int channel = 0; channel < 3; ++channel)
        picture.at<cv::Vec3b>(y, x)[channel] = cv::saturate_cast<std::uint8_t>(shadow * colour[channel]);
    }
  }
  for (const double side : {-1.0, 1.0}) {
    for (int y = 0; y + 4 < picture.rows; y += 4) {
      const cv::Point2d a(at.middle + side * edge(y), y), b(at.middle + side * edge(y + 4), y + 4);
      cv::line(picture, a, b, darker(cloth.colour, 0.4), 2, cv::LINE_AA);
      const cv::Point2d aside(side * 0.012 * texels, 0);
      if (y % 8 == 0)
        cv::line(picture, a + aside, b + aside, mix(cloth.colour, cv::Scalar::all(150), 0.5), 1, cv::LINE_AA);
    }
    seam_line(picture, {at.middle + side * 0.10 * texels, at.waist + 0.02 * texels},
              {at.middle + side * 0.16 * texels, at.waist + 0.10 * texels}, cloth.colour, texels);
    const double left = at.middle + side * 0.115 * texels - 0.05 * texels;
    patch_pocket(picture, {left, at.chest - 0.01 * texels, 0.10 * texels, 0.12 * texels}, cloth.colour, texels, true);
  }
}

void buttoned_front(cv::Mat& picture, const Cloth& cloth, const ShirtLines& at, double texels, Random& random) {
  buttons(picture, at.middle, at.neckline, at.hem, cloth.colour, texels);
  const double pocket = 0.105 * texels;
  patch_pocket(picture, {at.middle + 0.045 * texels, at.chest - 0.03 * texels, pocket, 1.15 * pocket}, cloth.colour,
               texels, random.uniform() < 0.5);
  if (random.uniform() < 0.5)
    patch_pocket(picture, {at.middle - 0.045 * texels - pocket, at.chest - 0.03 * texels, pocket, 1.15 * pocket},
                 cloth.colour, texels, true);
}

// Shoulders, sides, hem; `ribbed`: the neckline of what has no collar.
void shirt_seams(cv::Mat& picture, const Cloth& cloth, const ShirtLines& at, bool ribbed, double texels) {
  for (const double side : {0.25, 0.75})
    seam_line(picture, {side * at.width, at.chest}, {side * at.width, at.height}, cloth.colour, texels);
  if (at.hem < at.height) {
    seam_line(picture, {0, at.hem - 0.022 * texels}, {at.width, at.hem - 0.022 * texels}, cloth.colour, texels);
    cv::rectangle(picture, cv::Rect2d(0, at.hem, at.width, at.height - at.hem), darker(cloth.colour, 0.25), cv::FILLED);
  }
  if (ribbed)
    cv::rectangle(picture, cv::Rect2d(0, 0, at.width, at.neckline + 0.014 * texels), darker(cloth.colour, 0.8),
                  cv::FILLED);
  seam_line(picture, {0, at.neckline + 0.016 * texels}, {at.width, at.neckline + 0.016 * texels}, cloth.colour, texels);
  if (at.neckline > 1.0)
    cv::rectangle(picture, cv::Rect2d(0, 0, at.width, at.neckline), darker(cloth.colour, 0.35), cv::FILLED);
}
}  // namespace

cv::Mat shirt(cv::Size size, const Cloth& cloth, const ShirtCut& cut, double texels, Random random) {
  cv::Mat picture = cloth_ground(size, cloth, texels, random.fork(1));
  const ShirtLines at = lines_of(cut, size.width, size.height);
  Random own = random.fork(2);
  if (cloth.weave == Weave::printed) print_shirt(picture, cloth, at, texels, own);
  const Shade folds = shirt_folds(size, cloth, at, texels, own);
  if (cut.front == ShirtCut::Front::open) open_front(picture, cloth, cut.under, at, texels, random.fork(3));
  if (cut.front == ShirtCut::Front::buttons) buttoned_front(picture, cloth, at, texels, own);
  shirt_seams(picture, cloth, at, cut.front == ShirtCut::Front::closed, texels);
  folds.apply(picture);
  return picture;
}

cv::Mat sleeve(cv::Size size, const Cloth& cloth, bool lengthy, double texels, Random random) {
  cv::Mat picture = cloth_ground(size, cloth, texels, random.fork(1));
  Shade shade(size);
  const auto width = static_cast<float>(size.width), height = static_cast<float>(size.height);
  const double strength = cloth.weave == Weave::knitted ? 0.22 : 0.36;
  shade.folds({{0.0F, 0.15F * height, width, 0.8F * height},
               lengthy ? 16 : 8,
               0.5,
               0.5,
               0.12 * texels,
               0.010 * texels,
               strength},
              random.fork(2));
  shade.folds({{0.0F, 0.15F * height, width, 0.8F * height},
               lengthy ? 12 : 4,
               -0.5,
               0.4,
               0.10 * texels,
               0.009 * texels,
               strength},
              random.fork(3));
  if (lengthy)
    shade.folds(
        {{0.0F, 0.50F * height, width, 0.12F * height}, 10, 0.0, 0.4, 0.09 * texels, 0.009 * texels, 1.2 * strength},
        random.fork(4));
  shade.spot({0.0F, 0.35F * height}, 0.35F * width, 0.6F * height, 0.26F);
  shade.uneven(0.08F * static_cast<float>(texels), 0.06F * static_cast<float>(texels), 0.06F, 2, random.fork(5));
  const double end = height - 0.012 * texels, cuff = end - (lengthy ? 0.06 : 0.022) * texels;
  seam_line(picture, {0, cuff}, {width, cuff}, cloth.colour, texels);
  if (lengthy)
    cv::circle(picture, cv::Point2d(0.8 * width, 0.5 * (cuff + end)), static_cast<int>(0.006 * texels) + 1,
               brightness(cloth.colour) > 110 ? cv::Scalar::all(70) : cv::Scalar::all(205), cv::FILLED, cv::LINE_AA);
  shade.apply(picture);
  cv::rectangle(picture, cv::Rect2d(0, end, width, height - end), darker(cloth.colour, 0.25), cv::FILLED);
  return picture;
}

cv::Mat collar(cv::Size size, const Cloth& cloth, bool open, double texels, Random random) {
  cv::Mat picture = cloth_ground(size, cloth, texels, random.fork(1));
  const double width = size.width, height = size.height;
  cv::rectangle(picture, cv::Rect2d(0, 0, width, 0.30 * height), darker(cloth.colour, 0.5), cv::FILLED);
  cv::line(picture, cv::Point2d(0, 0.36 * height), cv::Point2d(width, 0.36 * height),
           mix(cloth.colour, cv::Scalar::all(255), 0.15), 2, cv::LINE_AA);
  seam_line(picture, {0, 0.80 * height}, {width, 0.80 * height}, cloth.colour, texels);
  cv::rectangle(picture, cv::Rect2d(0, 0.92 * height, width, 0.1 * height), darker(cloth.colour, 0.4), cv::FILLED);
  if (open) {
    // The points of the collar part in front.
    const cv::Point corners[] = {cv::Point2d(0.5 * width, 0.25 * height),
                                 cv::Point2d(0.5 * width + 0.035 * texels, height),
                                 cv::Point2d(0.5 * width - 0.035 * texels, height)};
    cv::fillConvexPoly(picture, corners, 3, darker(cloth.colour, 0.35), cv::LINE_AA);
  }
  return picture;
}

cv::Mat trouser_seat(cv::Size size, const Cloth& cloth, bool belt, double texels, Random random) {
  cv::Mat picture = cloth_ground(size, cloth, texels, random.fork(1));
  const double width = size.width, height = size.height, middle = 0.5 * width;
  Shade shade(size);
  const auto w = static_cast<float>(width), h = static_cast<float>(height);
  // Whiskers from the crotch, folds under the seat.
  for (const double side : {-1.0, 1.0})
    shade.folds({{static_cast<float>(middle + (side > 0 ? 0.02 : -0.16) * width), 0.45F * h, 0.14F * w, 0.3F * h},
                 7,
                 -0.45 * side,
                 0.35,
                 0.10 * texels,
                 0.010 * texels,
                 0.34},
                random.fork(side > 0 ? 2 : 3));
  shade.folds({{-0.15F * w, 0.45F * h, 0.3F * w, 0.35F * h}, 8, 0.0, 0.6, 0.10 * texels, 0.011 * texels, 0.26},
              random.fork(4));
  shade.spot({0.5F * w, 0.95F * h}, 0.22F * w, 0.35F * h, 0.45F);
  shade.spot({0.0F, 0.95F * h}, 0.16F * w, 0.4F * h, 0.40F);
  const double waistband = 0.055 * texels + 0.02 * height;
  seam_line(picture, {0, waistband}, {width, waistband}, cloth.colour, texels);
  seam_line(picture, {middle, waistband}, {middle, height}, cloth.colour, texels);
  seam_line(picture, {middle + 0.03 * texels, waistband}, {middle + 0.03 * texels, 0.62 * height}, cloth.colour,
            texels);
  for (const double side : {-1.0, 1.0}) {
    seam_line(picture, {middle + side * 0.10 * texels, waistband},
              {middle + side * 0.17 * texels, waistband + 0.10 * texels}, cloth.colour, texels);
    const double back = side > 0 ? 0.03 * width : 0.97 * width - 0.13 * texels;
    patch_pocket(picture, {back, waistband + 0.04 * texels, 0.13 * texels, 0.14 * texels}, cloth.colour, texels, false);
  }
  shade.apply(picture);
  if (belt) {
    const cv::Rect2d strap(0, 0.016 * texels, width, 0.036 * texels);
    cv::rectangle(picture, strap, {28, 34, 48}, cv::FILLED);
    stitch(picture, {0, strap.y + 2}, {width, strap.y + 2}, {70, 85, 105}, texels);
    const cv::Rect2d buckle(middle - 0.024 * texels, strap.y - 1, 0.048 * texels, strap.height + 2);
    cv::rectangle(picture, buckle, {165, 180, 185}, std::max(2, static_cast<int>(0.007 * texels)), cv::LINE_AA);
  }
  for (int loop = 0; loop < 6; ++loop) {
    const double x = (loop + 0.5) / 6.0 * width;
    cv::rectangle(picture, cv::Rect2d(x - 0.006 * texels, 0, 0.012 * texels, 0.06 * texels), darker(cloth.colour, 0.85),
                  cv::FILLED);
    cv::rectangle(picture, cv::Rect2d(x - 0.006 * texels, 0, 0.012 * texels, 0.06 * texels), darker(cloth.colour, 0.5),
                  1);
  }
  return picture;
}

cv::Mat trouser_leg(cv::Size size, const Cloth& cloth, bool shorts, double front, double texels, Random random) {
  cv::Mat picture = cloth_ground(size, cloth, texels, random.fork(1));
  const double width = size.width, height = size.height;
  const auto w = static_cast<float>(width), h = static_cast<float>(height);
  Shade shade(size);
  const bool denim = cloth.weave == Weave::denim;
  const double strength = 0.36;
  const float knee = shorts ? 1.5F : 0.51F;
  shade.folds({{0.0F, 0.02F * h, w, 0.16F * h}, 9, 0.2, 0.7, 0.11 * texels, 0.010 * texels, strength}, random.fork(2));
  shade.folds({{0.0F, (knee - 0.07F) * h, w, 0.14F * h}, 16, 0.0, 0.5, 0.09 * texels, 0.009 * texels, strength},
              random.fork(3));
  shade.folds({{0.0F, 0.15F * h, w, 0.35F * h}, 8, 1.4, 0.5, 0.16 * texels, 0.012 * texels, 0.7 * strength},
              random.fork(4));
  shade.folds({{0.0F, 0.55F * h, w, 0.3F * h}, 10, 0.3, 0.9, 0.11 * texels, 0.010 * texels, 0.9 * strength},
              random.fork(5));
  if (!shorts)
    shade.folds({{0.0F, 0.84F * h, w, 0.14F * h}, 14, 0.0, 0.5, 0.09 * texels, 0.009 * texels, 1.15 * strength},
                random.fork(6));
  shade.spot({0.0F, 0.15F * h}, 0.25F * w, 0.5F * h, 0.30F);
  shade.spot({0.0F, 0.8F * h}, 0.2F * w, 0.5F * h, 0.15F);
  if (denim) {  // faded where it rubs
    shade.spot({static_cast<float>(front) * w, 0.25F * h}, 0.20F * w, 0.25F * h, -0.30F);
    shade.spot({static_cast<float>(front) * w, knee * h}, 0.18F * w, 0.08F * h, -0.22F);
  }
  shade.uneven(0.08F * static_cast<float>(texels), 0.10F * static_cast<float>(texels), 0.06F, 2, random.fork(7));
  for (const double x : {0.004, 0.5}) seam_line(picture, {x * width, 0}, {x * width, height}, cloth.colour, texels);
  const double end = height - 0.012 * texels;
  seam_line(picture, {0, end - 0.02 * texels}, {width, end - 0.02 * texels}, cloth.colour, texels);
  shade.apply(picture);
  cv::rectangle(picture, cv::Rect2d(0, end, width, height - end), darker(cloth.colour, 0.2), cv::FILLED);
  return picture;
}

cv::Mat skirt(cv::Size size, const Cloth& cloth, double hem, double texels, Random random) {
  cv::Mat picture = cloth_ground(size, cloth, texels, random.fork(1));
  Shade shade(size);
  const auto w = static_cast<float>(size.width), h = static_cast<float>(hem * size.height);
  shade.folds({{0.0F, 0.35F * h, w, 0.4F * h}, 22, 1.57, 0.12, 0.30 * texels, 0.014 * texels, 0.30}, random.fork(2));
  shade.apply(picture);
  seam_line(picture, {0, 0.06 * texels}, {w, 0.06 * texels}, cloth.colour, texels);
  seam_line(picture, {0, h - 0.03 * texels}, {w, h - 0.03 * texels}, cloth.colour, texels);
  cv::rectangle(picture, cv::Rect2d(0, h, w, size.height - h), darker(cloth.colour, 0.2), cv::FILLED);
  return picture;
}

cv::Mat shoe(cv::Size size, const cv::Scalar& colour, const cv::Scalar& sole, double texels, Random random) {
  cv::Mat picture(size, CV_8UC3, colour);
  Shade wear(size);
  wear.uneven(0.04F * static_cast<float>(texels), 0.04F * static_cast<float>(texels), 0.07F, 4, random.fork(1));
  wear.apply(picture);
  const double width = size.width, height = size.height, middle = 0.5 * width;
  const cv::Scalar line = brightness(colour) > 100 ? darker(colour, 0.5) : mix(colour, cv::Scalar::all(230), 0.45);
  // Toe cap, side panels, laces.
  cv::ellipse(picture, cv::Point2d(middle, 0.86 * height), cv::Size2d(0.20 * width, 0.09 * height), 0, 180, 360, line,
              2, cv::LINE_AA);
  for (const double side : {-1.0, 1.0}) {
    cv::line(picture, cv::Point2d(middle + side * 0.07 * width, 0.40 * height),
             cv::Point2d(middle + side * 0.09 * width, 0.72 * height), line, 1, cv::LINE_AA);
    cv::line(picture, cv::Point2d(middle + side * 0.10 * width, 0.70 * height),
             cv::Point2d(middle + side * 0.26 * width, 0.52 * height), line, 2, cv::LINE_AA);
    cv::line(picture, cv::Point2d(middle + side * 0.24 * width, 0.28 * height),
             cv::Point2d(middle + side * 0.14 * width, 0.44 * height), line, 2, cv::LINE_AA);
  }
  cv::rectangle(picture, cv::Rect2d(middle - 0.055 * width, 0.40 * height, 0.11 * width, 0.32 * height),
                darker(colour, 0.6), cv::FILLED);
  const cv::Scalar lace = brightness(colour) > 120 ? cv::Scalar(60, 60, 65) : cv::Scalar(215, 220, 220);
  for (int i = 0; i < 5; ++i) {
    const double y = (0.43 + 0.065 * i) * height;
    cv::line(picture, cv::Point2d(middle - 0.075 * width, y), cv::Point2d(middle + 0.075 * width, y + 0.035 * height),
             lace, 2, cv::LINE_AA);
    cv::line(picture, cv::Point2d(middle + 0.075 * width, y), cv::Point2d(middle - 0.075 * width, y + 0.035 * height),
             lace, 2, cv::LINE_AA);
  }
  // The opening at the ankle is dark; soles lie at the borders.
  cv::rectangle(picture, cv::Rect2d(middle - 0.12 * width, 0.14 * height, 0.24 * width, 0.22 * height),
                darker(colour, 0.4), cv::FILLED);
  for (const double x : {0.0, 0.83 * width})
    cv::rectangle(picture, cv::Rect2d(x, 0, 0.17 * width + 1, height), sole, cv::FILLED);
  for (const double x : {0.17 * width, 0.83 * width})
    cv::line(picture, cv::Point2d(x, 0), cv::Point2d(x, height), darker(sole, 0.5), 1, cv::LINE_AA);
  return picture;
}

}  // namespace holdfast::simulation::pictures
