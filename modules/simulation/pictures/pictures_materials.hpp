// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core/mat.hpp>

#include "holdfast/core/random.hpp"
#include "holdfast/simulation/noise.hpp"

/// What materials indoors and outdoors are made of.
namespace holdfast::simulation::pictures {

/// The colour times (1 + noise), the noise slightly different by channel where `tint` is given.
cv::Mat coloured(const NoiseField& field, const cv::Scalar& colour, const NoiseField* tint = nullptr);
cv::Point any_texel(cv::Size size, Random& random);

}  // namespace holdfast::simulation::pictures
