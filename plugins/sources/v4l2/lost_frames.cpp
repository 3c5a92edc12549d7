// SPDX-License-Identifier: BSD-3-Clause
#include "lost_frames.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace holdfast::v4l2_plugin {

namespace {

constexpr std::size_t remembered = 9;
constexpr std::size_t enough = 3;  // gaps for a median

}  // namespace

std::size_t LostFrames::before(double stamp) {
  const std::optional<double> last = std::exchange(last_, stamp);
  if (!last) return 0;
  const double gap = stamp - *last;
  std::size_t lost = 0;
  if (gaps_.size() >= enough) {
    std::vector<double> sorted = gaps_;
    std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2), sorted.end());
    const double intervals = std::round(gap / sorted[sorted.size() / 2]);
    if (intervals > 1.0 && intervals <= static_cast<double>(most_at_once))
      lost = static_cast<std::size_t>(intervals) - 1;
  }
  gaps_.push_back(gap);
  if (gaps_.size() > remembered) gaps_.erase(gaps_.begin());
  return lost;
}

}  // namespace holdfast::v4l2_plugin
