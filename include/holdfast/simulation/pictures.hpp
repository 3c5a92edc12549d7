// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core/mat.hpp>
#include <string>

#include "holdfast/core/random.hpp"

/// Procedural textures of the simulated world. Every function returns an 8UC3 image (blue green red) of the given size
/// that depends on its arguments only and contains no repetition.
namespace holdfast::simulation::pictures {

/// A meaningless word of two to four syllables.
std::string word(Random& random, bool capital);
/// Luminance of a colour (blue green red), 0 to 255.
double brightness(const cv::Scalar& colour);
/// A random colour with each channel uniformly distributed between those of two colours.
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
/// A monitor with windows, text and pictures.
cv::Mat screen(cv::Size size, Random random);
/// A food or drink package or a mug: bright, with a name and a pattern.
cv::Mat label(cv::Size size, Random random);

/// Asphalt with patches, cracks and stains.
cv::Mat asphalt(cv::Size size, Random random);
/// Grass with bare spots.
cv::Mat grass(cv::Size size, Random random);
/// Leaves of a tree or hedge.
cv::Mat foliage(cv::Size size, Random random);
/// Paving slabs, `slab` texels wide.
cv::Mat paving(cv::Size size, int slab, Random random);
/// The front of a house with storeys of 3 m; `texels` per metre.
cv::Mat facade(cv::Size size, double texels, Random random);
/// Sky with clouds above two chains of wooded hills; `horizon` is the row of the horizon. Left to right all around.
cv::Mat panorama(cv::Size size, int horizon, Random random);
/// Side of a car from sill to bonnet, with wheels and doors.
cv::Mat car_side(cv::Size size, const cv::Scalar& colour, Random random);
/// Front or rear of a car from bumper to bonnet: lamps, grille and number plate.
cv::Mat car_end(cv::Size size, const cv::Scalar& colour, bool rear, Random random);
/// Windows with pillars between them, `count` side by side.
cv::Mat windows(cv::Size size, const cv::Scalar& colour, int count, Random random);
/// Side or rear of a lorry: a coloured tarpaulin with lettering.
cv::Mat tarpaulin(cv::Size size, Random random);

/// Material of clothes. Colours are blue green red.
struct Cloth {
  enum class Weave { plain, plaid, striped, dotted, printed, knitted, denim, flowered };
  Weave weave = Weave::plain;
  cv::Scalar colour, second;  ///< background, and colour of the pattern
  double scale = 1.0;         ///< of the pattern
  std::uint64_t pattern = 1;  ///< seed of properties that all parts of a garment share, such as the order of stripes
};

/// Layout of an unfolded shirt, with the front in the centre and the seam at the back: fractions of the picture's
/// height.
struct ShirtCut {
  enum class Front { closed, buttons, open };
  Front front = Front::closed;
  Cloth under;  ///< visible where the shirt is open
  double neckline = 0.0, shoulder = 0.2, chest = 0.4, waist = 0.8, hem = 1.0;
};

/// Unfolded clothes with seams, folds and their shadows; `texels` per metre.
cv::Mat shirt(cv::Size size, const Cloth& cloth, const ShirtCut& cut, double texels, Random random);
/// From the shoulder down; the borders left and right meet at the inner seam. `lengthy`: with an elbow and a cuff.
cv::Mat sleeve(cv::Size size, const Cloth& cloth, bool lengthy, double texels, Random random);
cv::Mat collar(cv::Size size, const Cloth& cloth, bool open, double texels, Random random);
/// Waistband, pockets and fly; the centre is the front.
cv::Mat trouser_seat(cv::Size size, const Cloth& cloth, bool belt, double texels, Random random);
/// From the hip down; the borders left and right meet at the inner seam, `front` is the fraction of the width in front.
cv::Mat trouser_leg(cv::Size size, const Cloth& cloth, bool shorts, double front, double texels, Random random);
/// `hem`: the fraction of the height at which it ends; the dark inside is below.
cv::Mat skirt(cv::Size size, const Cloth& cloth, double hem, double texels, Random random);
/// Heel at the top, toe at the bottom, laces in the centre, edges of the sole left and right.
cv::Mat shoe(cv::Size size, const cv::Scalar& colour, const cv::Scalar& sole, double texels, Random random);

/// Parameters of a face.
struct Face {
  cv::Scalar skin, hair;
  double lips = 0.4;  ///< 0 = hardly visible, 1 = strongly coloured
  bool beard = false, glasses = false, bald = false;
};
/// Column x of a picture of `width` is at the fraction x / width + face_density sin(2 pi x / width) / (2 pi) of a full
/// turn.
inline constexpr float face_density = 0.5F;
/// The skin of a head: crown at the top, below the chin at the bottom, the nose in the centre.
cv::Mat head(cv::Size size, const Face& face, Random random);
cv::Mat ear(cv::Size size, const cv::Scalar& skin, double texels, Random random);
cv::Mat hair(cv::Size size, const cv::Scalar& colour, bool curly, double texels, Random random);
/// From below the chin to the collarbones; the centre is the front.
cv::Mat bare_neck(cv::Size size, const cv::Scalar& skin, double texels, Random random);
cv::Mat bare_limb(cv::Size size, const cv::Scalar& skin, double texels, Random random);
/// From the wrist to the finger tips: the back of the hand in the centre, the palm at the borders.
cv::Mat hand(cv::Size size, const cv::Scalar& skin, double texels, Random random);

}  // namespace holdfast::simulation::pictures
