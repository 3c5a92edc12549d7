// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <span>
#include <vector>

namespace holdfast {

/// A run of successive frames without a pose.
struct CoverageGap {
  double begin = 0.0;      ///< stamp of the frame before it, or of its first frame where the sequence begins [s]
  double end = 0.0;        ///< stamp of the frame after it, or of its last frame where the sequence ends [s]
  std::size_t frames = 0;  ///< that are missing
};

/// How much of a sequence has a pose. A pose counts only when its stamp is that of a frame (one-to-one, closer than
/// 1 ms, which allows for stamps that were written with three or more decimals).
struct Coverage {
  std::size_t frames = 0;             ///< colour-depth pairs of the sequence
  std::size_t poses = 0;              ///< frames that have a pose
  std::size_t poses_of_no_frame = 0;  ///< poses of the estimate whose stamp is that of no frame; they do not count
  std::vector<CoverageGap> gaps;      ///< in order of time, those at the begin and the end included

  /// Missing frames of the longest gap; 0 without gaps.
  std::size_t longest_gap() const {
    std::size_t longest = 0;
    for (const CoverageGap& gap : gaps) longest = std::max(longest, gap.frames);
    return longest;
  }
  /// poses / frames, 0 to 1.
  double ratio() const { return static_cast<double>(poses) / static_cast<double>(frames); }
};

/// Both lists sorted [s]; there must be at least one frame.
Coverage measure_coverage(std::span<const double> frame_stamps, std::span<const double> pose_stamps);

/// The stamps [s] of a sequence's frames, sorted, each once. `source` is a file whose lines begin with a stamp (a TUM
/// rgb.txt or depth.txt, or an association file), or the folder of a TUM sequence, whose rgb.txt and depth.txt are then
/// paired one-to-one within 0.02 s, nearest first; the stamp of a pair is that of its colour frame. Throws InputError
/// with file and line for what cannot be read or holds no frame.
std::vector<double> read_frame_stamps(const std::filesystem::path& source);

}  // namespace holdfast
