// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core/mat.hpp>

#include "holdfast/core/random.hpp"
#include "holdfast/simulation/noise.hpp"

namespace holdfast::simulation::pictures {

/// Light and shadow on cloth or skin: a brightness to add, as a share, by texel. Left and right borders meet.
class Shade {
 public:
  explicit Shade(cv::Size size) : field_(size.width, size.height) {}

  /// A fold of cloth: a dark valley with a lit ridge beside it, `width` texels wide, bowed by `bow` of its length.
  void fold(cv::Point2f from, cv::Point2f to, float bow, float width, float strength);
  /// Folds all over an area (in texels) about a direction [rad, 0 = along x, clockwise].
  struct Folding {
    cv::Rect2f area;
    int count;
    double direction, spread;
    double length, width;  ///< mean [texels]
    double strength;
  };
  void folds(const Folding& folding, Random random);
  /// A soft spot, darker (or lighter: negative) by `strength` in its middle.
  void spot(cv::Point2f centre, float radius_x, float radius_y, float strength);
  /// Fractal unevenness.
  void uneven(float cell_x, float cell_y, float amplitude, int octaves, const Random& random);
  /// Multiplies an 8UC3 picture with 1 plus the shade.
  void apply(cv::Mat& picture) const;

 private:
  NoiseField field_;
};

/// Makes the left and right borders of a picture meet: its last `overlap` columns fade into the first and are cut off.
cv::Mat joined(const cv::Mat& picture, int overlap);

/// `a` to the share 1 - t and `b` to the share t.
cv::Scalar mix(const cv::Scalar& a, const cv::Scalar& b, double t);

}  // namespace holdfast::simulation::pictures
