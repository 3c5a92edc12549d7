// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core/mat.hpp>

#include "holdfast/simulation/pictures.hpp"

/// What clothes are cut from, and what is sewn and printed on them.
namespace holdfast::simulation::pictures {

cv::Scalar darker(const cv::Scalar& colour, double factor = 0.55);

/// Cloth before it is sewn, its left and right borders meeting; `texels` per metre.
cv::Mat cloth_ground(cv::Size size, const Cloth& cloth, double texels, const Random& random);
/// A print as on T-shirts: a badge or picture and words, about `width` texels wide.
void print_front(cv::Mat& picture, cv::Point2d centre, double width, const Cloth& cloth, Random random);

}  // namespace holdfast::simulation::pictures
