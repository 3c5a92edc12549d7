// SPDX-License-Identifier: BSD-3-Clause
#include "orb.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "brief.hpp"
#include "detector.hpp"
#include "holdfast/core/error.hpp"
#include "holdfast/plugin/parameter_table.hpp"
#include "kernels.hpp"
#include "orientation.hpp"
#include "pyramid.hpp"
#include "spread.hpp"
#include "subpixel.hpp"

namespace holdfast {

using orb_plugin::Corner;
using orb_plugin::CornerDetector;
using orb_plugin::ImageView;

void OrbSettings::describe(ParameterTable<OrbSettings>& table) {
  using S = OrbSettings;
  table.add("count", &S::count, "number of features to extract per image").range(10, 50000);
  table.add("levels", &S::levels, "number of pyramid levels").range(1, 16);
  table.add("scale_factor", &S::scale_factor, "scale between adjacent pyramid levels").range(1.05, 2.0);
  table.add("fast_threshold", &S::fast_threshold, "minimum contrast of a FAST corner").range(1, 250).unit("grey level");
  table
      .add("fast_threshold_low", &S::fast_threshold_low,
           "fallback threshold of cells without a corner; a value that is not below fast_threshold disables the "
           "fallback")
      .range(1, 250)
      .unit("grey level");
  table.add("cell_size", &S::cell_size, "side of these cells, in pixels of the level").range(16, 512).unit("px");
  table
      .add("spread", &S::spread,
           "fraction of the features that is selected for even coverage of the image; the rest is selected by response")
      .range(0, 1);
  table.add("subpixel", &S::subpixel, "refine positions to sub-pixel accuracy");
}

/// Buffers, kept from image to image.
struct OrbExtractor::Work {
  Work(const OrbSettings& settings, const ScalePyramid& scales, const orb_plugin::Kernels& chosen_kernels)
      : kernels(chosen_kernels),
        pyramid(scales, kernels),
        detector(settings.fast_threshold, settings.fast_threshold_low, settings.cell_size, kernels),
        corners(scales.levels()) {}

  const orb_plugin::Kernels& kernels;
  orb_plugin::ImagePyramid pyramid;
  CornerDetector detector;
  orb_plugin::EvenSpread spread;
  orb_plugin::SteeredPattern pattern;
  std::vector<std::vector<Corner>> corners;  // by level
  std::vector<std::uint8_t> blurred, rows;
};

OrbExtractor::OrbExtractor(const OrbSettings& settings, const CreationContext&, SimdLevel level)
    : settings_(settings),
      scales_(settings.levels, settings.scale_factor),
      work_(std::make_unique<Work>(settings_, scales_, orb_plugin::kernels(level))) {}

OrbExtractor::~OrbExtractor() = default;

void OrbExtractor::extract(const cv::Mat& grey, const cv::Mat& ignore, Features& out) {
  HOLDFAST_CHECK(grey.empty() || grey.type() == CV_8UC1, "image type " << grey.type() << ", expected 8UC1");
  HOLDFAST_CHECK(ignore.empty() || (ignore.type() == CV_8UC1 && ignore.size() == grey.size()),
                 "mask " << ignore.cols << " x " << ignore.rows << " type " << ignore.type() << ", image " << grey.cols
                         << " x " << grey.rows);
  HOLDFAST_CHECK(std::max(grey.cols, grey.rows) <= 0xffff, "image " << grey.cols << " x " << grey.rows);
  work_->pyramid.build(grey, CornerDetector::minimum_image_size);
  detect(ignore);
  select();
  describe(out);
}

void OrbExtractor::detect(const cv::Mat& ignore) {
  const orb_plugin::ImagePyramid& pyramid = work_->pyramid;
  for (int level = 0; level < pyramid.levels(); ++level) {
    std::vector<Corner>& corners = work_->corners[level];
    if (ignore.empty()) {
      work_->detector.detect(
          pyramid.view(level), [](int, int) { return false; }, corners);
      continue;
    }
    const auto is_ignored = [&](int x, int y) {
      const auto column = static_cast<int>(pyramid.full_x(level, static_cast<float>(x)) + 0.5F);
      const auto row = static_cast<int>(pyramid.full_y(level, static_cast<float>(y)) + 0.5F);
      return ignore.at<std::uint8_t>(std::min(row, ignore.rows - 1), std::min(column, ignore.cols - 1)) != 0;
    };
    work_->detector.detect(pyramid.view(level), is_ignored, corners);
  }
}

void OrbExtractor::select() {
  // Shares in proportion to the levels' inverse scale; what a coarse level lacks goes to the finer ones, whose
  // positions are the more accurate.
  const int levels = work_->pyramid.levels();
  double share_left = 0;
  for (int level = 0; level < levels; ++level) share_left += scales_.inverse_scale[level];
  std::size_t left = static_cast<std::size_t>(std::lround(settings_.count * budget_));
  for (int level = levels - 1; level >= 0; --level) {
    const double share = scales_.inverse_scale[level];
    const auto wanted =
        level == 0 ? left : static_cast<std::size_t>(std::lround(static_cast<double>(left) * share / share_left));
    work_->spread.select(wanted, static_cast<std::size_t>(std::lround(static_cast<double>(wanted) * settings_.spread)),
                         work_->corners[level]);
    left -= work_->corners[level].size();
    share_left -= share;
  }
}

void OrbExtractor::describe(Features& out) {
  const orb_plugin::ImagePyramid& pyramid = work_->pyramid;
  const orb_plugin::Kernels& kernels = work_->kernels;
  std::size_t count = 0;
  for (int level = 0; level < pyramid.levels(); ++level) count += work_->corners[level].size();
  out.resize(count, DescriptorType());
  const std::span<Descriptor256> descriptors = out.descriptors.of_256_bits();
  if (count == 0) return;

  // All levels are blurred into one buffer of one stride, so that one table of offsets serves them all.
  const ImageView& full = pyramid.view(0);
  const std::ptrdiff_t stride = (full.width + 63) / 64 * 64;
  if (const std::size_t size = static_cast<std::size_t>(stride) * full.height; work_->blurred.size() < size)
    work_->blurred.resize(size);
  if (const std::size_t size = static_cast<std::size_t>(2 * full.width); work_->rows.size() < size)
    work_->rows.resize(size);
  work_->pattern.build(stride);

  std::size_t i = 0;
  for (int level = 0; level < pyramid.levels(); ++level) {
    if (work_->corners[level].empty()) continue;
    const ImageView& image = pyramid.view(level);
    kernels.blur(image, work_->rows.data(), {work_->blurred.data(), stride});
    for (const Corner& corner : work_->corners[level]) {
      int moment_x = 0, moment_y = 0;
      kernels.moments(image.at(corner.x, corner.y), image.stride, moment_x, moment_y);
      out.angle[i] = orb_plugin::direction(moment_x, moment_y);
      kernels.describe(work_->blurred.data() + corner.y * stride + corner.x, work_->pattern.offsets(out.angle[i]),
                       descriptors[i]);
      orb_plugin::SubpixelOffset offset;
      if (settings_.subpixel) {
        std::array<std::uint8_t, 9> scores;
        kernels.neighbour_scores(image.at(corner.x, corner.y), image.stride, scores.data());
        offset = orb_plugin::score_peak(scores);
      }
      out.x[i] = pyramid.full_x(level, static_cast<float>(corner.x) + offset.x);
      out.y[i] = pyramid.full_y(level, static_cast<float>(corner.y) + offset.y);
      out.response[i] = corner.score;
      out.octave[i] = static_cast<std::uint8_t>(level);
      ++i;
    }
  }
}

}  // namespace holdfast
