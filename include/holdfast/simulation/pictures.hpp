// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core/mat.hpp>
#include <string>

#include "holdfast/core/random.hpp"

/// Pictures from random numbers: what the surfaces of the simulated world look like. Every function gives an 8UC3 image
/// (blue green red) of the asked size that depends on its arguments alone and repeats nowhere within itself.
namespace holdfast::simulation::pictures {

/// A word of two to four syllables that means nothing.
std::string word(Random& random, bool capital);

cv::Mat plaster(cv::Size size, const cv::Scalar& colour, Random random);
/// Boards along the x axis, `board` texels high; 0 = one piece.
cv::Mat wood(cv::Size size, const cv::Scalar& colour, int board, Random random);
cv::Mat fabric(cv::Size size, const cv::Scalar& colour, Random random);
/// One colour with slight stains, for plastic and metal.
cv::Mat plain(cv::Size size, const cv::Scalar& colour, Random random);
/// An oriental rug: a border, medallions and scattered figures, all different.
cv::Mat rug(cv::Size size, Random random);
/// A printed sheet: headings, lines of text, figures.
cv::Mat page(cv::Size size, Random random);
/// A poster or book cover: areas of colour, figures and lettering.
cv::Mat poster(cv::Size size, Random random);
/// A painting: fractal landscape in a frame.
cv::Mat painting(cv::Size size, Random random);
/// The back of a book, upright, with its title along it.
cv::Mat book_spine(cv::Size size, Random random);
/// A parcel: cardboard with tape, a label and printed signs.
cv::Mat cardboard(cv::Size size, Random random);
/// A keyboard seen from above.
cv::Mat keyboard(cv::Size size, Random random);
/// A monitor that shows windows with text and pictures.
cv::Mat screen(cv::Size size, Random random);
/// A food or drink package or a mug: bright, with a name and a pattern.
cv::Mat label(cv::Size size, Random random);

}  // namespace holdfast::simulation::pictures
