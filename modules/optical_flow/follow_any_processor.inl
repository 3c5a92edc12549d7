// SPDX-License-Identifier: BSD-3-Clause
// The Lucas-Kanade search, compiled once per set of instructions; every set gives the same bits. The including file
// defines HOLDFAST_TARGET and HOLDFAST_TARGET_INLINE, the way functions are declared for its processor,
// HOLDFAST_FOLLOW, the name of its search, and load(const std::uint8_t*, Row&), which makes numbers of eight pixels.

#include <array>
#include <cmath>

namespace holdfast::point_flow {
namespace {

constexpr float half_window = 3.5F;    // from the point to the centres of the outermost pixels
constexpr float least_texture = 0.1F;  // smaller eigenvalue of the mean of products of derivatives [grey levels^2/px^2]
constexpr float oscillation = 0.01F;   // two steps that cancel out to this: the minimum lies between them [px]

using HalfRow = float __attribute__((vector_size(2 * window), may_alias));

HOLDFAST_TARGET_INLINE float sum_of(const Row& row) {
  const HalfRow* const halves = reinterpret_cast<const HalfRow*>(&row);
  const HalfRow four = halves[0] + halves[1];
  return (four[0] + four[2]) + (four[1] + four[3]);
}

/// Where a window lies in a level: the pixel at its upper left corner, and the position's fraction of a pixel.
struct Place {
  const std::uint8_t* corner;
  float fraction_x, fraction_y;
};

/// Whether the window around a position can be read with `ring` pixels around it, and where it lies.
HOLDFAST_TARGET_INLINE bool find_place(const cv::Mat& level, float x, float y, int ring, Place& place) {
  constexpr auto border = static_cast<float>(ImagePyramid::border);
  const auto least = static_cast<float>(ring) - border;
  const float left = x - half_window, top = y - half_window;
  // Bilinear interpolation reads one pixel more than the window. Written so that a number that is not finite is
  // refused.
  if (!(left >= least && top >= least && left < static_cast<float>(level.cols - window - ring) + border &&
        top < static_cast<float>(level.rows - window - ring) + border))
    return false;
  const float column = std::floor(left), row = std::floor(top);
  place.corner = level.data + static_cast<std::ptrdiff_t>(row) * static_cast<std::ptrdiff_t>(level.step) +
                 static_cast<std::ptrdiff_t>(column);
  place.fraction_x = left - column, place.fraction_y = top - row;
  return true;
}

/// A row of a window, interpolated between columns.
HOLDFAST_TARGET_INLINE void interpolate(const std::uint8_t* pixels, float fraction, Row& row) {
  Row next;
  load(pixels, row);
  load(pixels + 1, next);
  row += fraction * (next - row);
}

/// The window in the first image, with its derivatives.
struct Template {
  std::array<Row, window> grey, along_x, along_y;
  // Inverse of the sum of products of derivatives.
  float inverse_xx, inverse_xy, inverse_yy;
};

/// Returns whether the window has texture in two directions.
HOLDFAST_TARGET_INLINE bool take_template(const cv::Mat& level, float x, float y, Template& result) {
  Place place;
  if (!find_place(level, x, y, 1, place)) return false;
  const auto stride = static_cast<std::ptrdiff_t>(level.step);
  // Rows -1 to 8 of the window, each one pixel to the left, in its place and one pixel to the right: their difference,
  // and their mean with the weights 3, 10 and 3, of which Scharr's derivatives are made.
  std::array<Row, window + 2> across, smooth;
  std::array<Row, 3> upper, lower, now;
  const std::uint8_t* pixels = place.corner - stride - 1;
  for (int shift = 0; shift < 3; ++shift) interpolate(pixels + shift, place.fraction_x, upper[shift]);
  for (int row = 0; row < window + 2; ++row) {
    pixels += stride;
    for (int shift = 0; shift < 3; ++shift) {
      interpolate(pixels + shift, place.fraction_x, lower[shift]);
      now[shift] = upper[shift] + place.fraction_y * (lower[shift] - upper[shift]);
      upper[shift] = lower[shift];
    }
    across[row] = now[2] - now[0];
    smooth[row] = 0.1875F * (now[0] + now[2]) + 0.625F * now[1];
    if (row > 0 && row <= window) result.grey[row - 1] = now[1];
  }
  Row xx{}, xy{}, yy{};
  for (int row = 0; row < window; ++row) {
    const Row along_x = 0.09375F * (across[row] + across[row + 2]) + 0.3125F * across[row + 1];
    const Row along_y = 0.5F * (smooth[row + 2] - smooth[row]);
    xx += along_x * along_x, xy += along_x * along_y, yy += along_y * along_y;
    result.along_x[row] = along_x, result.along_y[row] = along_y;
  }
  const float sum_xx = sum_of(xx), sum_xy = sum_of(xy), sum_yy = sum_of(yy);
  const float apart = sum_xx - sum_yy;
  const float twice_smaller = sum_xx + sum_yy - std::sqrt(apart * apart + 4.0F * sum_xy * sum_xy);
  if (!(twice_smaller >= 2.0F * window * window * least_texture)) return false;
  const float determinant = sum_xx * sum_yy - sum_xy * sum_xy;
  result.inverse_xx = sum_yy / determinant, result.inverse_yy = sum_xx / determinant;
  result.inverse_xy = -sum_xy / determinant;
  return true;
}

/// Moves a position in the second image to the minimum near it. Returns whether it stayed in the image.
HOLDFAST_TARGET_INLINE bool descend(const Template& wanted, const cv::Mat& level, const PointFlowSettings& settings,
                                    float& x, float& y) {
  const auto stride = static_cast<std::ptrdiff_t>(level.step);
  float last_x = 0.0F, last_y = 0.0F;
  for (int iteration = 0; iteration < settings.iterations; ++iteration) {
    Place place;
    if (!find_place(level, x, y, 0, place)) return false;
    Row upper, lower, sum_x{}, sum_y{};
    const std::uint8_t* pixels = place.corner;
    interpolate(pixels, place.fraction_x, upper);
    for (int row = 0; row < window; ++row) {
      pixels += stride;
      interpolate(pixels, place.fraction_x, lower);
      const Row difference = upper + place.fraction_y * (lower - upper) - wanted.grey[row];
      upper = lower;
      sum_x += difference * wanted.along_x[row], sum_y += difference * wanted.along_y[row];
    }
    const float gradient_x = sum_of(sum_x), gradient_y = sum_of(sum_y);
    const float step_x = -(wanted.inverse_xx * gradient_x + wanted.inverse_xy * gradient_y);
    const float step_y = -(wanted.inverse_xy * gradient_x + wanted.inverse_yy * gradient_y);
    x += step_x, y += step_y;
    if (step_x * step_x + step_y * step_y <= settings.precision * settings.precision) break;
    if (iteration > 0 && std::abs(step_x + last_x) < oscillation && std::abs(step_y + last_y) < oscillation) {
      x -= 0.5F * step_x, y -= 0.5F * step_y;
      break;
    }
    last_x = step_x, last_y = step_y;
  }
  return true;
}

/// Mean of the grey levels' differences between both windows; infinite where the second one cannot be read.
HOLDFAST_TARGET_INLINE float difference_at(const Template& wanted, const cv::Mat& level, float x, float y) {
  Place place;
  if (!find_place(level, x, y, 0, place)) return INFINITY;
  const auto stride = static_cast<std::ptrdiff_t>(level.step);
  Row upper, lower, sum{};
  const std::uint8_t* pixels = place.corner;
  interpolate(pixels, place.fraction_x, upper);
  for (int row = 0; row < window; ++row) {
    pixels += stride;
    interpolate(pixels, place.fraction_x, lower);
    const Row difference = upper + place.fraction_y * (lower - upper) - wanted.grey[row];
    upper = lower;
    sum += difference < 0.0F ? -difference : difference;
  }
  return sum_of(sum) / static_cast<float>(window * window);
}

/// Positions of the full image in a level that is `scale` times as wide, and back.
HOLDFAST_TARGET_INLINE float to_level(float full, float scale) { return (full - 0.5F) * scale; }
HOLDFAST_TARGET_INLINE float to_full(float level, float scale) { return level / scale + 0.5F; }

}  // namespace

HOLDFAST_TARGET void HOLDFAST_FOLLOW(const ImagePyramid& from, const ImagePyramid& to,
                                     const PointFlowSettings& settings, PointFlow& flow) {
  const auto width = static_cast<float>(from.size().width), height = static_cast<float>(from.size().height);
  Template wanted;
  for (std::size_t i = 0; i < flow.size(); ++i) {
    bool found = false;
    for (int level = ImagePyramid::levels - 1; level >= 0; --level) {
      if (from.level(level).empty()) continue;
      const float scale = 0.5F / static_cast<float>(1 << level);
      if (!take_template(from.level(level), to_level(flow.from_x[i], scale), to_level(flow.from_y[i], scale), wanted))
        continue;
      float x = to_level(flow.to_x[i], scale), y = to_level(flow.to_y[i], scale);
      // Outside at a coarse level, the point may still be found from where it is expected.
      if (!descend(wanted, to.level(level), settings, x, y)) continue;
      flow.to_x[i] = to_full(x, scale), flow.to_y[i] = to_full(y, scale);
      if (level > 0) continue;
      found = flow.to_x[i] >= 0.0F && flow.to_y[i] >= 0.0F && flow.to_x[i] <= width - 1.0F &&
              flow.to_y[i] <= height - 1.0F &&
              difference_at(wanted, to.level(level), x, y) <= settings.largest_difference;
    }
    flow.found[i] = found ? 1 : 0;
  }
}

}  // namespace holdfast::point_flow
