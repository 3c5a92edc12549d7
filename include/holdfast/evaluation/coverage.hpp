// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <span>
#include <vector>

namespace holdfast {

/// A sequence of consecutive frames without a pose.
struct CoverageGap {
  double begin = 0.0;      ///< stamp of the previous frame, or of the first frame of the sequence [s]
  double end = 0.0;        ///< stamp of the next frame, or of the last frame of the sequence [s]
  std::size_t frames = 0;  ///< number of frames without a pose
};

/// Fraction of the frames of a sequence that have a pose. A pose counts only if its stamp is that of a frame (one to
/// one, with a difference below 1 ms, so that stamps may be written with three or more decimals).
struct Coverage {
  std::size_t frames = 0;             ///< colour-depth pairs of the sequence
  std::size_t poses = 0;              ///< frames that have a pose
  std::size_t poses_of_no_frame = 0;  ///< poses of the estimate without a frame; they do not count
  std::vector<CoverageGap> gaps;      ///< in temporal order, including gaps at the begin and the end

  /// Number of frames of the longest gap; 0 without gaps.
  std::size_t longest_gap() const {
    std::size_t longest = 0;
    for (const CoverageGap& gap : gaps) longest = std::max(longest, gap.frames);
    return longest;
  }
  /// poses / frames, 0 to 1.
  double ratio() const { return static_cast<double>(poses) / static_cast<double>(frames); }
};

/// Computes the coverage from sorted time stamps [s]. There must be at least one frame.
Coverage measure_coverage(std::span<const double> frame_stamps, std::span<const double> pose_stamps);

/// Reads the time stamps [s] of a sequence's frames, sorted and without duplicates. `source` is a file whose lines
/// begin with a stamp (a TUM rgb.txt or depth.txt, or an association file), or the folder of a TUM sequence, whose
/// rgb.txt and depth.txt are associated one to one within 0.02 s, nearest first; the stamp of a pair is that of its
/// colour image. Throws InputError with file and line for a file that cannot be read or contains no frame.
std::vector<double> read_frame_stamps(const std::filesystem::path& source);

}  // namespace holdfast
