// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/perturbation/image_faults.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <opencv2/core.hpp>
#include <vector>

#include "holdfast/core/check.hpp"

namespace holdfast {

namespace {

std::uint8_t saturated(int value) { return static_cast<std::uint8_t>(std::clamp(value, 0, 255)); }

void check_bytes(const cv::Mat& image) {
  HOLDFAST_CHECK(image.depth() == CV_8U, "an image of type " << image.type() << "; expected 8UC1 or 8UC3");
}

}  // namespace

cv::Mat scaled_brightness(const cv::Mat& image, double factor) {
  check_bytes(image);
  std::array<std::uint8_t, 256> scaled;
  for (int i = 0; i < 256; ++i)
    scaled[static_cast<std::size_t>(i)] = static_cast<std::uint8_t>(std::clamp(std::nearbyint(i * factor), 0.0, 255.0));
  cv::Mat result(image.size(), image.type());
  const int width = image.cols * image.channels();
  for (int y = 0; y < image.rows; ++y) {
    const auto* from = image.ptr<std::uint8_t>(y);
    auto* to = result.ptr<std::uint8_t>(y);
    for (int x = 0; x < width; ++x) to[x] = scaled[from[x]];
  }
  return result;
}

cv::Mat with_noise(const cv::Mat& image, double standard_deviation, Random random) {
  check_bytes(image);
  // Normal numbers are slow to draw: rows take theirs from a list, each from another place.
  std::vector<std::int16_t> noise(1 << 15);
  for (auto& each : noise) each = static_cast<std::int16_t>(std::nearbyint(standard_deviation * random.normal()));
  cv::Mat result(image.size(), image.type());
  const int width = image.cols * image.channels();
  for (int y = 0; y < image.rows; ++y) {
    const auto* from = image.ptr<std::uint8_t>(y);
    auto* to = result.ptr<std::uint8_t>(y);
    std::size_t at = random.below(static_cast<std::uint32_t>(noise.size()));
    for (int x = 0; x < width; ++x) {
      to[x] = saturated(from[x] + noise[at]);
      at = (at + 1) & (noise.size() - 1);
    }
  }
  return result;
}

cv::Mat blurred(const cv::Mat& image, double length, double direction) {
  check_bytes(image);
  const int count = std::clamp(static_cast<int>(std::ceil(length)) + 1, 1, 201);
  const int channels = image.channels();
  std::vector<cv::Point> offsets;
  for (int i = 0; i < count; ++i) {
    const double along = count == 1 ? 0.0 : length * (static_cast<double>(i) / (count - 1) - 0.5);
    offsets.emplace_back(static_cast<int>(std::lround(along * std::cos(direction))),
                         static_cast<int>(std::lround(along * std::sin(direction))));
  }
  cv::Mat result(image.size(), image.type());
  std::vector<std::uint16_t> sums(static_cast<std::size_t>(image.cols * channels));
  for (int y = 0; y < image.rows; ++y) {
    std::fill(sums.begin(), sums.end(), std::uint16_t{0});
    for (const cv::Point& offset : offsets) {
      const auto* row = image.ptr<std::uint8_t>(std::clamp(y + offset.y, 0, image.rows - 1));
      const int inside_begin = std::clamp(-offset.x, 0, image.cols),
                inside_end = std::clamp(image.cols - offset.x, 0, image.cols);
      const auto add = [&](int x, int from) {
        for (int c = 0; c < channels; ++c) sums[static_cast<std::size_t>(x * channels + c)] += row[from * channels + c];
      };
      for (int x = 0; x < std::min(inside_begin, image.cols); ++x) add(x, 0);
      const auto* from = row + (inside_begin + offset.x) * channels;
      auto* to = sums.data() + inside_begin * channels;
      for (int i = 0; i < (inside_end - inside_begin) * channels; ++i)
        to[i] = static_cast<std::uint16_t>(to[i] + from[i]);
      for (int x = std::max(inside_end, inside_begin); x < image.cols; ++x) add(x, image.cols - 1);
    }
    auto* to = result.ptr<std::uint8_t>(y);
    for (std::size_t i = 0; i < sums.size(); ++i) to[i] = static_cast<std::uint8_t>((sums[i] + count / 2) / count);
  }
  return result;
}

namespace {

/// The shift of a row, in 1/256 of a pixel.
int row_shift(int y, int rows, double shift) {
  if (rows < 2) return 0;
  return static_cast<int>(std::lround(256.0 * shift * (static_cast<double>(y) / (rows - 1) - 0.5)));
}

}  // namespace

cv::Mat sheared(const cv::Mat& image, double shift) {
  check_bytes(image);
  cv::Mat result(image.size(), image.type());
  const int channels = image.channels();
  for (int y = 0; y < image.rows; ++y) {
    // A pixel x comes from x - shift: floor and remainder of that, in 1/256.
    const int back = -row_shift(y, image.rows, shift);
    const int whole = back >> 8, part = back & 255;
    const auto* from = image.ptr<std::uint8_t>(y);
    auto* to = result.ptr<std::uint8_t>(y);
    for (int x = 0; x < image.cols; ++x) {
      const int left = std::clamp(x + whole, 0, image.cols - 1) * channels;
      const int right = std::clamp(x + whole + 1, 0, image.cols - 1) * channels;
      for (int c = 0; c < channels; ++c)
        to[x * channels + c] =
            static_cast<std::uint8_t>((from[left + c] * (256 - part) + from[right + c] * part + 128) >> 8);
    }
  }
  return result;
}

namespace {

/// Copies a row, moved to the right.
void copy_row(const cv::Mat& from, int from_row, cv::Mat& to, int to_row, int columns) {
  const int begin = std::clamp(columns, 0, from.cols), end = std::clamp(from.cols + columns, 0, from.cols);
  if (begin >= end) return;
  const std::size_t size = from.elemSize();
  std::memcpy(to.ptr(to_row) + static_cast<std::size_t>(begin) * size,
              from.ptr(from_row) + static_cast<std::size_t>(begin - columns) * size,
              static_cast<std::size_t>(end - begin) * size);
}

}  // namespace

cv::Mat sheared_values(const cv::Mat& image, double shift) {
  cv::Mat result = cv::Mat::zeros(image.size(), image.type());
  for (int y = 0; y < image.rows; ++y)
    copy_row(image, y, result, y, static_cast<int>(std::lround(row_shift(y, image.rows, shift) / 256.0)));
  return result;
}

cv::Mat shifted(const cv::Mat& image, int columns, int rows) {
  cv::Mat result = cv::Mat::zeros(image.size(), image.type());
  for (int y = std::max(0, rows); y < std::min(image.rows, image.rows + rows); ++y)
    copy_row(image, y - rows, result, y, columns);
  return result;
}

cv::Mat scaled_depth(const cv::Mat& depth, double factor) {
  HOLDFAST_CHECK(depth.type() == CV_32FC1, "a depth image of type " << depth.type() << "; expected 32FC1");
  cv::Mat result(depth.size(), depth.type());
  for (int y = 0; y < depth.rows; ++y) {
    const auto* from = depth.ptr<float>(y);
    auto* to = result.ptr<float>(y);
    for (int x = 0; x < depth.cols; ++x) to[x] = static_cast<float>(from[x] * factor);
  }
  return result;
}

cv::Mat with_holes(const cv::Mat& depth, double share, Random random) {
  HOLDFAST_CHECK(depth.type() == CV_32FC1, "a depth image of type " << depth.type() << "; expected 32FC1");
  cv::Mat result = depth.clone();
  cv::Mat is_hole = cv::Mat::zeros(depth.size(), CV_8UC1);
  const auto wanted = static_cast<std::int64_t>(share * static_cast<double>(depth.total()));
  std::int64_t covered = 0;
  // Patches overlap more and more, so that their number is not known; it is bounded for tiny images.
  for (int patch = 0; patch < 10000 && covered < wanted; ++patch) {
    const double x_radius = depth.cols * random.uniform(0.02, 0.12), y_radius = depth.rows * random.uniform(0.02, 0.12);
    const double x_centre = random.uniform(0.0, depth.cols), y_centre = random.uniform(0.0, depth.rows);
    for (int y = std::max(0, static_cast<int>(y_centre - y_radius));
         y < std::min(depth.rows, static_cast<int>(y_centre + y_radius) + 1); ++y)
      for (int x = std::max(0, static_cast<int>(x_centre - x_radius));
           x < std::min(depth.cols, static_cast<int>(x_centre + x_radius) + 1) && covered < wanted; ++x) {
        const double u = (x - x_centre) / x_radius, v = (y - y_centre) / y_radius;
        if (u * u + v * v > 1.0 || is_hole.at<std::uint8_t>(y, x) != 0) continue;
        is_hole.at<std::uint8_t>(y, x) = 1;
        result.at<float>(y, x) = 0.0F;
        ++covered;
      }
  }
  return result;
}

cv::Mat block_texture(int width, int height, int block, Random random) {
  cv::Mat texture(height, width, CV_8UC3);
  for (int top = 0; top < height; top += block)
    for (int left = 0; left < width; left += block) {
      cv::Vec3b colour;
      for (int channel = 2; channel >= 0; --channel) colour[channel] = static_cast<std::uint8_t>(random.below(256));
      for (int y = top; y < std::min(height, top + block); ++y)
        for (int x = left; x < std::min(width, left + block); ++x) texture.at<cv::Vec3b>(y, x) = colour;
    }
  return texture;
}

}  // namespace holdfast
