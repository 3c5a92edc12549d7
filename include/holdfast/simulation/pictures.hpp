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
/// Of a colour (blue green red), as the eye weighs channels: 0 to 255.
double brightness(const cv::Scalar& colour);
/// A colour with each channel uniform between those of two others.
cv::Scalar colour_between(const cv::Scalar& low, const cv::Scalar& high, Random& random);

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

/// What clothes are made of. Colours are blue green red.
struct Cloth {
  enum class Weave { plain, plaid, striped, dotted, printed, knitted, denim, flowered };
  Weave weave = Weave::plain;
  cv::Scalar colour, second;  ///< the ground, and what is woven in or printed on
  double scale = 1.0;         ///< of the pattern
  std::uint64_t pattern = 1;  ///< seed of what all parts of a garment have in common: the order of stripes, ...
};

/// Where things are on a shirt that lies flat, its middle in front and its halves meeting in the back: shares of the
/// picture's height.
struct ShirtCut {
  enum class Front { closed, buttons, open };
  Front front = Front::closed;
  Cloth under;  ///< what shows where it is open
  double neckline = 0.0, shoulder = 0.2, chest = 0.4, waist = 0.8, hem = 1.0;
};

/// Clothes laid flat, with seams, folds and the shadows that folds hold; `texels` per metre.
cv::Mat shirt(cv::Size size, const Cloth& cloth, const ShirtCut& cut, double texels, Random random);
/// From the shoulder down; the borders left and right meet at the inner seam. `lengthy`: with an elbow and a cuff.
cv::Mat sleeve(cv::Size size, const Cloth& cloth, bool lengthy, double texels, Random random);
cv::Mat collar(cv::Size size, const Cloth& cloth, bool open, double texels, Random random);
/// Waistband, pockets and fly; the middle is in front.
cv::Mat trouser_seat(cv::Size size, const Cloth& cloth, bool belt, double texels, Random random);
/// From the hip down; the borders left and right meet at the inner seam, `front` is the share of the width in front.
cv::Mat trouser_leg(cv::Size size, const Cloth& cloth, bool shorts, double front, double texels, Random random);
/// `hem`: the share of the height where it ends; below lies its dark inside.
cv::Mat skirt(cv::Size size, const Cloth& cloth, double hem, double texels, Random random);
/// Heel at the top, toe at the bottom, the laces in the middle, the soles' edges left and right.
cv::Mat shoe(cv::Size size, const cv::Scalar& colour, const cv::Scalar& sole, double texels, Random random);

/// What a face is painted from.
struct Face {
  cv::Scalar skin, hair;
  double lips = 0.4;  ///< 0 = hardly seen, 1 = painted
  bool beard = false, glasses = false, bald = false;
};
/// A picture's column x of `width` lies at the share x / width + face_density sin(2 pi x / width) / (2 pi) of a turn.
inline constexpr float face_density = 0.5F;
/// The skin of a head, all around: crown at the top, under the chin at the bottom, the nose in the middle.
cv::Mat head(cv::Size size, const Face& face, Random random);
cv::Mat ear(cv::Size size, const cv::Scalar& skin, double texels, Random random);
cv::Mat hair(cv::Size size, const cv::Scalar& colour, bool curly, double texels, Random random);
/// From under the chin to the collarbones; the middle is in front.
cv::Mat bare_neck(cv::Size size, const cv::Scalar& skin, double texels, Random random);
cv::Mat bare_limb(cv::Size size, const cv::Scalar& skin, double texels, Random random);
/// From the wrist to the finger tips: the back of the hand in the middle, the palm at the borders.
cv::Mat hand(cv::Size size, const cv::Scalar& skin, double texels, Random random);

}  // namespace holdfast::simulation::pictures
