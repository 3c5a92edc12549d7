// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

namespace holdfast::v4l2_plugin {

/// Finds by their time stamps how many frames of a camera were lost, because nobody fetched them in time: a camera
/// gives frames at equal intervals, and a gap is a multiple of them. The interval is the median of the last gaps,
/// because many cameras expose longer, at half the rate, when it gets dark.
class LostFrames {
 public:
  /// Number of frames that were lost between the last one and that of `stamp` [s], which is later. At most
  /// most_at_once.
  std::size_t before(double stamp);

  /// A longer gap is a camera that paused.
  static constexpr std::size_t most_at_once = 300;

 private:
  std::optional<double> last_;
  std::vector<double> gaps_;  // the last ones
};

}  // namespace holdfast::v4l2_plugin
