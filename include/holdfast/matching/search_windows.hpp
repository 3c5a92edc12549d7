// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "holdfast/matching/expected_view.hpp"
#include "holdfast/matching/traits.hpp"

namespace holdfast::matching {

/// The image region and the octaves in which a feature is searched for.
struct SearchWindow {
  PredictedPixel pixel;
  float radius = 0.0F;  ///< half the side of the square [px]
  int min_octave = 0;   ///< octaves that may match, both included
  int max_octave = 0;
};

/// The windows of many points; a structure of arrays. Entry i of each belongs to window i.
struct SearchWindows {
  std::vector<std::uint32_t> source;  ///< index of the point in the caller's arrays
  std::vector<float> x, y;            ///< predicted undistorted pixel
  std::vector<float> right_x;         ///< predicted column in the right image, NaN = unknown
  std::vector<float> radius;          ///< [px]
  std::vector<std::int8_t> min_octave, max_octave;

  std::size_t size() const { return source.size(); }
  void clear() {
    source.clear(), x.clear(), y.clear(), right_x.clear(), radius.clear();
    min_octave.clear(), max_octave.clear();
  }
  void add(std::uint32_t index, const SearchWindow& window) {
    source.push_back(index);
    x.push_back(window.pixel.x), y.push_back(window.pixel.y), right_x.push_back(window.pixel.right_x);
    radius.push_back(window.radius);
    min_octave.push_back(static_cast<std::int8_t>(window.min_octave));
    max_octave.push_back(static_cast<std::int8_t>(window.max_octave));
  }
};

/// Settings of the search windows of expected points.
struct WindowSettings {
  /// Half the side of the window at the finest octave [px]; it grows with the scale of the expected octave.
  float radius = 4.0F;
  /// The same for points seen from within 3.6 degrees of their mean viewing direction (cosine above 0.998), whose
  /// prediction is more accurate.
  float frontal_radius = 4.0F;
  float factor = 1.0F;      ///< multiplies both radii, for instance after a loss
  int finer_octaves = 1;    ///< octaves below the expected one that may match
  int coarser_octaves = 0;  ///< octaves above the expected one that may match
};

/// Adds a window for each point i that is predicted to be visible and for which `is_wanted(i)` is true. Returns the
/// number of visible points. `is_wanted` is called once for each visible point, in order.
template <FeatureView View, PointSet Points, class IsWanted>
int add_windows(const View& view, const ViewProjection<View>& projection, const Points& points,
                const WindowSettings& settings, IsWanted&& is_wanted, SearchWindows& windows) {
  constexpr float frontal_cosine = 0.998F;
  const auto count = static_cast<std::uint32_t>(PointTraits<Points>::size(points));
  int expected = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::optional<ExpectedView> seen = projection.expect(points, i);
    if (!seen) continue;
    ++expected;
    if (!is_wanted(i)) continue;
    const int level =
        ViewTraits<View>::predict_level(view, PointTraits<Points>::max_distance(points, i), seen->distance);
    const float radius = (seen->cosine > frontal_cosine ? settings.frontal_radius : settings.radius) * settings.factor *
                         ViewTraits<View>::scale(view, level);
    windows.add(i, {seen->pixel, radius, level - settings.finer_octaves, level + settings.coarser_octaves});
  }
  return expected;
}

}  // namespace holdfast::matching
