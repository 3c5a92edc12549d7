// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "label_files.hpp"

namespace holdfast::precomputed_plugin {

/// How label images fit the frames of a recording in time.
struct LabelFit {
  std::size_t frames = 0;  ///< of the recording
  std::size_t found = 0;   ///< those with a label image within the tolerance
  /// Time by which every label image is later than its frame [s], where there is one label image for each frame and
  /// the difference is constant and more than half a frame interval, so that frames get masks of others; otherwise 0.
  double shift = 0.0;
  std::string found_text;  ///< "160 of 798 frames have a label image within 0.000 s"
  std::string advice;      ///< what is suspected, and what to do about it
};

/// Compares the label images, sorted by time and at least one, with the time stamps of all frames.
LabelFit fit_labels(const std::vector<LabelFile>& files, const std::vector<double>& frames, double tolerance);

}  // namespace holdfast::precomputed_plugin
