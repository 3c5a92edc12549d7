// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "holdfast/core/descriptor.hpp"
#include "holdfast/core/frame.hpp"

namespace holdfast {

/// Points projected into a frame, each with the window in which its feature is looked for; a structure of arrays.
struct SearchWindows {
  std::vector<std::uint32_t> source;      ///< index of the point in the caller's arrays
  std::vector<float> x, y;                ///< predicted undistorted pixel
  std::vector<float> right_x;             ///< predicted column in the virtual right image, NaN = unknown
  std::vector<float> radius;              ///< [px]
  std::vector<std::int8_t> lowest_level;  ///< octaves that may match, both included
  std::vector<std::int8_t> highest_level;

  std::size_t size() const { return source.size(); }
  void clear() {
    source.clear(), x.clear(), y.clear(), right_x.clear(), radius.clear(), lowest_level.clear(), highest_level.clear();
  }
  void add(std::uint32_t index, float pixel_x, float pixel_y, float pixel_right_x, float window, int lowest,
           int highest) {
    source.push_back(index), x.push_back(pixel_x), y.push_back(pixel_y), right_x.push_back(pixel_right_x);
    radius.push_back(window), lowest_level.push_back(static_cast<std::int8_t>(lowest));
    highest_level.push_back(static_cast<std::int8_t>(highest));
  }
};

/// One feature of the frame matched with one point of the caller.
struct ProjectionMatch {
  std::uint32_t source = 0;
  std::uint32_t feature = 0;
  int distance = 0;
};

/// What makes a match.
struct MatchRule {
  int maximum_distance = 100;  ///< [bits]
  /// Best to second best distance when both lie on the same octave; 1 = not asked for.
  float ratio = 1.0F;
  /// When not nullptr, angles of the caller's points by source index: matches whose rotation is not among the three
  /// most frequent of 30 bins are dropped (Mur-Artal et al. 2015, section V-C).
  const float* angles = nullptr;
};

/// Matches projected points with the features of a frame that show no map point yet: nearest descriptor in the window,
/// a feature goes to the point with the smallest distance. Keeps its buffers; one thread.
class ProjectionSearch {
 public:
  /// `descriptors` are the caller's points', by source index. The result is ordered by feature and valid until the next
  /// call.
  const std::vector<ProjectionMatch>& match(const SearchWindows& windows, const Descriptor* descriptors,
                                            const Frame& frame, const MatchRule& rule);

 private:
  void keep_consistent_rotations(const Frame& frame, const float* angles);

  std::vector<std::uint32_t> candidates_;
  std::vector<std::uint16_t> distances_;
  std::vector<ProjectionMatch> best_of_feature_;
  std::vector<ProjectionMatch> matches_;
};

}  // namespace holdfast
