// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "output_folder.hpp"

namespace holdfast {

/// Writes label images for the segmenter `precomputed`: STAMP.png (8 bit, index into the classes, 255 = unknown),
/// labels.txt (their list) and classes.yaml (what the values mean). Every file is written in one step; classes.yaml
/// first, the list last, so an interrupted run leaves images that can be used.
class LabelWriter {
 public:
  /// Makes the folder where it is missing. One that is not empty is refused (InputError) unless `overwrite`; then the
  /// files of an earlier run are removed, which its classes.yaml vouches for: a folder without that is refused, too.
  LabelWriter(std::filesystem::path folder, std::vector<std::string> classes, bool overwrite);

  /// Stamps rise. A picture of the labels for people, unless it is empty, becomes STAMP.jpg.
  void write(double timestamp, const cv::Mat& labels, const cv::Mat& picture = {});
  void finish();

  std::size_t count() const { return stamps_.size(); }
  /// The section of a configuration that reads the folder: exact stamps, or, when only every N-th frame was written,
  /// the nearest within half of the widest gap.
  std::string configuration(bool every_frame) const;

 private:
  std::filesystem::path folder_;
  std::vector<std::string> classes_;
  FolderLock lock_;
  std::vector<double> stamps_;
  std::string list_;
};

}  // namespace holdfast
