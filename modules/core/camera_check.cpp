// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "holdfast/core/camera.hpp"
#include "holdfast/core/size_text.hpp"
#include "lens_inverse.hpp"

namespace holdfast {

namespace {

constexpr double degree = 3.14159265358979323846 / 180.0;

std::string rounded(double value) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.0f", value);
  return text;
}

/// With four significant digits.
std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.4g", value);
  return text;
}

std::string pixel_text(const Eigen::Vector2d& pixel) {
  return "(" + rounded(pixel.x()) + ", " + rounded(pixel.y()) + ")";
}

/// Positions on the border of the image, corners included.
std::vector<Eigen::Vector2d> border_of(const Camera& camera) {
  constexpr int steps = 16;
  const double right = camera.width - 1.0, bottom = camera.height - 1.0;
  std::vector<Eigen::Vector2d> border;
  for (int i = 0; i < steps; ++i) {
    const double x = right * i / steps, y = bottom * i / steps;
    border.insert(border.end(), {{x, 0.0}, {right, y}, {right - x, bottom}, {0.0, bottom - y}});
  }
  return border;
}

std::string trouble_of_numbers(const Camera& camera) {
  if (camera.width < 1 || camera.height < 1 || !(camera.fx > 0.0) || !(camera.fy > 0.0))
    return "has no area or no focal length; expected width, height, fx and fy above 0";
  const Distortion& d = camera.distortion;
  for (const double value :
       {camera.fx, camera.fy, camera.cx, camera.cy, d.k1, d.k2, d.p1, d.p2, d.k3, d.k4, d.k5, d.k6})
    if (!std::isfinite(value)) return "has an intrinsic parameter or a distortion coefficient that is no number";
  return "";
}

std::string causes(const Camera& camera) {
  const bool is_fisheye = camera.distortion.lens == Lens::fisheye;
  return std::string(". Usual causes: coefficients in another order (expected ") +
         (is_fisheye ? "k1, k2, k3, k4); those of `lens: radial_tangential`"
                     : "k1, k2, p1, p2, k3); those of a fisheye lens without `lens: fisheye`") +
         "; numbers of another resolution; a calibration whose views did not reach the corners, which have to be cut "
         "off then";
}

std::string no_inverse(const Camera& camera, const std::string& where, double radius) {
  return "the distortion of the lens has no inverse in the image: from " + where + " on, " + rounded(radius) +
         " px from the principal point, the image turns back, so that no direction belongs to the pixels beyond; "
         "expected a radius that grows up to the corners" +
         causes(camera);
}

/// Follows the inverse from the principal point to the border of the image.
std::string trouble_of_radial_tangential(const Camera& camera) {
  if (camera.distortion.is_zero()) return "";
  const Eigen::Vector2d centre(camera.cx, camera.cy);
  Eigen::Vector2d end = centre;
  double radius = 0.0;
  bool is_missing = false, is_too_wide = false;
  for (const Eigen::Vector2d& raw : border_of(camera)) {
    const LensInverse inverse = invert_distortion(camera.distortion, camera.normalised(raw.x(), raw.y()));
    if (inverse.is_complete()) continue;
    const Eigen::Vector2d last = centre + inverse.share * (raw - centre);
    if (is_missing && (last - centre).norm() >= radius) continue;
    is_missing = true;
    is_too_wide = inverse.is_too_wide;
    end = last;
    radius = (end - centre).norm();
  }
  if (!is_missing) return "";
  if (!is_too_wide) return no_inverse(camera, "pixel " + pixel_text(end), radius);
  return "the lens sees pixel " + pixel_text(end) + ", " + rounded(radius) +
         " px from the principal point, more than " + rounded(LensInverse::widest_angle / degree) +
         " degrees from the optical axis; expected a narrower lens, or one with `lens: fisheye`" + causes(camera);
}

/// The radius must grow with the angle up to the corners, or up to the usable angle.
std::string trouble_of_fisheye(const Camera& camera) {
  double farthest = 0.0;
  for (const Eigen::Vector2d& raw : border_of(camera))
    farthest = std::max(farthest, camera.normalised(raw.x(), raw.y()).norm());
  for (double angle = 0.0; angle < Camera::usable_angle; angle += 0.25 * degree) {
    const double radius = fisheye_radius(camera.distortion, angle);
    if (radius >= farthest) return "";
    if (!(fisheye_slope(camera.distortion, angle) > 0.0))
      return no_inverse(camera, rounded(angle / degree) + " degrees from the optical axis", radius * camera.fx);
  }
  return "";
}

void suspect_axis(const Camera& camera, std::vector<std::string>& suspicions) {
  const double half_width = 0.5 * (camera.width - 1), half_height = 0.5 * (camera.height - 1);
  const double x = camera.cx / half_width, y = camera.cy / half_height;
  constexpr double farthest = 0.4;  // of half the image
  if (std::abs(x - 1.0) < farthest && std::abs(y - 1.0) < farthest) return;
  std::string text = "the optical axis is at pixel " + pixel_text({camera.cx, camera.cy}) + " of images of " +
                     size_text(camera.width, camera.height) + "; expected it near their centre " +
                     pixel_text({half_width, half_height});
  const double scale = 0.5 * (x + y);
  if (x > 0.0 && y > 0.0 && std::abs(x - y) < 0.15 * scale)
    text += ". These look like the numbers of images of about " +
            size_text(static_cast<int>(std::lround(scale * camera.width)),
                      static_cast<int>(std::lround(scale * camera.height))) +
            ": multiply fx, fy, cx and cy by " + number(1.0 / scale) + ", unless the images were cut out";
  else
    text += ", unless the images were cut out of larger ones: check cx and cy";
  suspicions.push_back(std::move(text));
}

void suspect_focal_length(const Camera& camera, std::vector<std::string>& suspicions) {
  constexpr double most_stretch = 1.25;
  const double stretch = camera.fx / camera.fy;
  if (stretch > most_stretch || stretch < 1.0 / most_stretch)
    suspicions.push_back("the focal lengths fx " + number(camera.fx) + " px and fy " + number(camera.fy) +
                         " px differ by a factor of " + number(std::max(stretch, 1.0 / stretch)) +
                         "; expected nearly the same, unless the images were stretched: check both");
  const double half = 0.5 * std::max(camera.width, camera.height) / std::max(camera.fx, camera.fy);  // tangent or angle
  const bool is_fisheye = camera.distortion.lens == Lens::fisheye;
  constexpr double least_angle = 12.0, greatest_angle = 150.0, greatest_fisheye_angle = 270.0;  // degrees
  const double angle = 2.0 * (is_fisheye ? half : std::atan(half)) / degree;
  if (angle >= least_angle && angle <= (is_fisheye ? greatest_fisheye_angle : greatest_angle)) return;
  suspicions.push_back("with a focal length of " + number(camera.fx) + " px, images of " +
                       size_text(camera.width, camera.height) + " show " + rounded(angle) +
                       " degrees; expected 12 to 150: is it in millimetres or of images of another size? In pixels it "
                       "is its length in mm / width of the sensor in mm * width of the image");
}

void suspect_baseline(const Camera& camera, std::vector<std::string>& suspicions) {
  constexpr double least = 0.005, greatest = 3.0;  // m
  if (camera.baseline >= least && camera.baseline <= greatest) return;
  std::string text = "the baseline is " + number(camera.baseline) + " m; expected the distance between two cameras, " +
                     number(least) + " to " + number(greatest) + " m";
  bool has_unit = false;
  for (const auto& [unit, per_metre] : {std::pair{"centimetres", 100.0}, std::pair{"millimetres", 1000.0}}) {
    const double metres = camera.baseline / per_metre;
    if (metres < 0.02 || metres > 2.0) continue;
    text += std::string(has_unit ? ", or " : ": is it in ") + unit + ", that is, " + number(metres) + " m";
    has_unit = true;
  }
  if (has_unit) text += "?";
  suspicions.push_back(std::move(text));
}

}  // namespace

std::string Camera::trouble() const {
  if (std::string trouble = trouble_of_numbers(*this); !trouble.empty()) return trouble;
  if (std::string trouble = distortion.trouble(); !trouble.empty()) return trouble;
  return distortion.lens == Lens::fisheye ? trouble_of_fisheye(*this) : trouble_of_radial_tangential(*this);
}

std::vector<std::string> Camera::suspicions(bool with_baseline) const {
  std::vector<std::string> suspicions;
  suspect_axis(*this, suspicions);
  suspect_focal_length(*this, suspicions);
  if (with_baseline) suspect_baseline(*this, suspicions);
  return suspicions;
}

}  // namespace holdfast
