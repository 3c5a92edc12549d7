// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "holdfast/core/scale_pyramid.hpp"
#include "kernels.hpp"

namespace holdfast::orb_plugin {

/// The image at every scale, each level reduced from the one before. Buffers are kept from image to image.
class ImagePyramid {
 public:
  ImagePyramid(const ScalePyramid& scales, const Kernels& kernels) : scales_(scales), kernels_(kernels) {}

  /// Makes level 0 a view of the image, which must outlive the use of the pyramid, and computes the others. Levels with
  /// a side below `minimum_size` are left out.
  void build(const cv::Mat& grey, int minimum_size);

  int levels() const { return static_cast<int>(views_.size()); }
  const ImageView& view(int level) const { return views_[level]; }
  /// From a position in a level to the full image; pixel centres are at whole numbers in both, so this is more than a
  /// scale: x0 = (x + 0.5) * ratio - 0.5, with the ratio of the actual widths.
  float full_x(int level, float x) const { return (x + 0.5F) * ratio_x_[level] - 0.5F; }
  float full_y(int level, float y) const { return (y + 0.5F) * ratio_y_[level] - 0.5F; }

 private:
  void plan(int width, int height, int minimum_size);

  struct Level {
    int width = 0, height = 0;
    ResizeAxis columns, rows;
    std::vector<std::uint8_t> pixels;
  };

  const ScalePyramid& scales_;
  const Kernels& kernels_;
  std::vector<Level> planned_;
  std::vector<ImageView> views_;
  std::vector<float> ratio_x_, ratio_y_;
  std::vector<std::uint8_t> row_;
};

}  // namespace holdfast::orb_plugin
