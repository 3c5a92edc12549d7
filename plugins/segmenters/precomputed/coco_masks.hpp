// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <opencv2/core/mat.hpp>
#include <string>
#include <utility>
#include <vector>

#include "holdfast/plugin/parameter.hpp"

namespace holdfast::precomputed_plugin {

/// An object of an image of a COCO file: polygons, or run lengths.
struct CocoObject {
  int category = 0;
  float score = 1.0F;
  bool is_crowd = false;                      ///< several objects that are not separated
  std::vector<std::vector<double>> polygons;  ///< x, y, x, y, ... [px], of each part
  /// Numbers of pixels outside and inside in turn, down one column after the other; empty for polygons.
  std::vector<std::uint32_t> runs;
};

/// An image of a COCO file.
struct CocoImage {
  double timestamp = 0.0;  ///< that its file name is, without folder and ending [s]
  cv::Size size;
  std::vector<CocoObject> objects;  ///< in the order of the file
};

/// Annotations of images in the format of COCO's instances (Lin et al., Microsoft COCO, ECCV 2014).
struct CocoFile {
  std::vector<CocoImage> images;  ///< by time stamp
  /// The names of the categories by their numbers, as the parameter `labels` has them: {"1": "person"}.
  TextMap categories;
};

/// Reads a file with `images`, `annotations` and `categories`. Throws InputError, which states what was found and what
/// was expected, for files that are no such JSON, images without a time stamp as their name, two of the same stamp,
/// annotations of images or categories that are not there, and segmentations that are neither polygons nor run lengths
/// of the image's size.
CocoFile read_coco(const std::filesystem::path& file);

/// The mask of an object: 8UC1 of the image's size, 255 = object. Of a polygon, the pixels whose centres it holds, and
/// those that its outline crosses.
cv::Mat mask_of(const CocoObject& object, const cv::Size& size);

/// Decodes COCO's compressed run lengths: groups of five bits, the lowest first, in characters from '0' on; from the
/// third number on, differences from the one before the last. Empty if the text is none.
std::vector<std::uint32_t> decode_runs(const std::string& text);

}  // namespace holdfast::precomputed_plugin
