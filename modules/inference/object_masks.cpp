// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/inference/object_masks.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "holdfast/core/error.hpp"
#include "holdfast/core/sensor_frame.hpp"

namespace holdfast {

namespace {

/// Interpolation of one axis of the prototypes for the pixels of one axis of the frame.
struct PrototypeAxis {
  std::vector<int> first;     ///< neighbour before each pixel
  std::vector<float> weight;  ///< of the neighbour behind it
  int low = 0, high = 0;      ///< neighbours used

  PrototypeAxis(int from, int count, double scale, double offset, int size) {
    for (int i = 0; i < count; ++i) {
      const double at = std::clamp((from + i + 0.5) * scale + offset - 0.5, 0.0, size - 1.0);
      first.push_back(std::min(static_cast<int>(at), std::max(0, size - 2)));
      weight.push_back(static_cast<float>(at - first.back()));
    }
    low = first.front(), high = std::min(first.back() + 1, size - 1);
  }
};

/// The pixels at which the values of a part of an image (from the first neighbours of the axes on), resized bilinearly,
/// are above a threshold.
cv::Mat resized_above(const cv::Mat& sum, const PrototypeAxis& x, const PrototypeAxis& y, float threshold) {
  cv::Mat mask = cv::Mat::zeros(static_cast<int>(y.first.size()), static_cast<int>(x.first.size()), CV_8UC1);
  for (int row = 0; row < mask.rows; ++row) {
    const auto r = static_cast<std::size_t>(row);
    const int above_row = y.first[r] - y.low;
    const auto* above = sum.ptr<float>(above_row);
    const auto* below = sum.ptr<float>(std::min(above_row + 1, sum.rows - 1));
    auto* to = mask.ptr<std::uint8_t>(row);
    for (int column = 0; column < mask.cols; ++column) {
      const auto c = static_cast<std::size_t>(column);
      const int left = x.first[c] - x.low, right = std::min(left + 1, sum.cols - 1);
      const float upper = above[left] + x.weight[c] * (above[right] - above[left]);
      const float lower = below[left] + x.weight[c] * (below[right] - below[left]);
      to[column] = upper + y.weight[r] * (lower - upper) > threshold ? 255 : 0;
    }
  }
  return mask;
}

/// Interval of depths [m].
struct DepthRange {
  float nearest = 0.0F, farthest = 0.0F;
};

/// The largest cluster of sorted depths, the nearest one in case of a tie.
DepthRange largest_cluster(const std::vector<float>& depths) {
  constexpr float least_gap = 0.1F, relative_gap = 0.03F;
  std::size_t first = 0, best_first = 0, best_size = 0;
  for (std::size_t i = 1; i <= depths.size(); ++i) {
    const bool ends = i == depths.size() || depths[i] - depths[i - 1] > std::max(least_gap, relative_gap * depths[i]);
    if (!ends) continue;
    if (i - first > best_size) best_first = first, best_size = i - first;
    first = i;
  }
  return {depths[best_first], depths[best_first + best_size - 1]};
}

/// The depths of the object in a box; nothing if too little of its middle is measured.
std::optional<DepthRange> object_depths(const cv::Mat& depth, const cv::Rect& pixels) {
  const cv::Rect middle(pixels.x + pixels.width / 4, pixels.y + pixels.height / 4, std::max(1, pixels.width / 2),
                        std::max(1, pixels.height / 2));
  constexpr int samples_per_axis = 64;
  const int step_x = 1 + middle.width / samples_per_axis, step_y = 1 + middle.height / samples_per_axis;
  std::vector<float> measured;
  std::size_t count = 0;
  for (int y = middle.y; y < middle.y + middle.height; y += step_y)
    for (int x = middle.x; x < middle.x + middle.width; x += step_x, ++count)
      if (const float z = depth.at<float>(y, x); is_measured_depth(z)) measured.push_back(z);
  if (measured.empty() || measured.size() * 10 < count) return std::nullopt;
  std::sort(measured.begin(), measured.end());
  return largest_cluster(measured);
}

}  // namespace

FramePlace place_of_frame(const cv::Size& frame, const cv::Size& input, bool letterbox) {
  FramePlace place{frame, input, cv::Rect({}, input)};
  if (!letterbox) return place;
  const double scale =
      std::min(static_cast<double>(input.width) / frame.width, static_cast<double>(input.height) / frame.height);
  const auto scaled = [&](int size, int limit) {
    return std::clamp(static_cast<int>(std::lround(size * scale)), 1, limit);
  };
  place.content.width = scaled(frame.width, input.width);
  place.content.height = scaled(frame.height, input.height);
  place.content.x = (input.width - place.content.width) / 2;
  place.content.y = (input.height - place.content.height) / 2;
  return place;
}

cv::Rect2f FramePlace::box_in_frame(const cv::Rect2f& box) const {
  const auto in_frame = [](float at, int first, int content_size, int frame_size) {
    const double scaled = (double{at} - first) * frame_size / content_size;
    return static_cast<float>(std::clamp(scaled, 0.0, static_cast<double>(frame_size)));
  };
  const float left = in_frame(box.x, content.x, content.width, frame.width);
  const float top = in_frame(box.y, content.y, content.height, frame.height);
  return {left, top, in_frame(box.x + box.width, content.x, content.width, frame.width) - left,
          in_frame(box.y + box.height, content.y, content.height, frame.height) - top};
}

cv::Rect pixels_of(const cv::Rect2f& box, const cv::Size& image) {
  if (!(box.width > 0.0F && box.height > 0.0F)) return {};
  const auto range = [](float first, float size, int limit) {
    const int from = static_cast<int>(std::clamp(std::ceil(double{first} - 0.5), 0.0, limit - 1.0));
    const int to = static_cast<int>(std::clamp(std::ceil(double{first} + size - 0.5), 0.0, double(limit)));
    return std::pair(from, std::max(1, to - from));
  };
  const bool is_outside = box.x >= static_cast<float>(image.width) || box.y >= static_cast<float>(image.height) ||
                          box.x + box.width <= 0.0F || box.y + box.height <= 0.0F;
  if (image.empty() || is_outside) return {};
  const auto [left, width] = range(box.x, box.width, image.width);
  const auto [top, height] = range(box.y, box.height, image.height);
  return cv::Rect(left, top, width, height) & cv::Rect({}, image);
}

cv::Mat prototype_mask(const cv::Mat& prototypes, std::span<const float> coefficients, const FramePlace& place,
                       const cv::Rect& pixels) {
  HOLDFAST_CHECK(prototypes.dims == 4 && prototypes.size[1] == static_cast<int>(coefficients.size()) &&
                     prototypes.type() == CV_32FC1 && prototypes.isContinuous(),
                 "prototypes for " << coefficients.size() << " coefficients");
  HOLDFAST_CHECK((pixels & cv::Rect({}, place.frame)) == pixels, "pixels outside the frame");
  if (pixels.empty()) return cv::Mat::zeros(pixels.size(), CV_8UC1);
  const int rows = prototypes.size[2], columns = prototypes.size[3];
  const auto axis = [](int from, int count, int content_first, int content_size, int frame, int input, int size) {
    const double by_input = static_cast<double>(size) / input;
    return PrototypeAxis(from, count, by_input * content_size / frame, by_input * content_first, size);
  };
  const cv::Rect& content = place.content;
  const PrototypeAxis x =
      axis(pixels.x, pixels.width, content.x, content.width, place.frame.width, place.input.width, columns);
  const PrototypeAxis y =
      axis(pixels.y, pixels.height, content.y, content.height, place.frame.height, place.input.height, rows);
  cv::Mat sum = cv::Mat::zeros(y.high - y.low + 1, x.high - x.low + 1, CV_32FC1);
  for (int k = 0; k < prototypes.size[1]; ++k)
    for (int row = 0; row < sum.rows; ++row) {
      const float* from = prototypes.ptr<float>() + (std::ptrdiff_t{k} * rows + y.low + row) * columns + x.low;
      auto* to = sum.ptr<float>(row);
      const float coefficient = coefficients[static_cast<std::size_t>(k)];
      for (int column = 0; column < sum.cols; ++column) to[column] += coefficient * from[column];
    }
  return resized_above(sum, x, y, 0.0F);
}

cv::Mat image_mask(const cv::Mat& image, const cv::Rect2f& covered, float threshold, const FramePlace& place,
                   const cv::Rect& pixels) {
  HOLDFAST_CHECK(image.type() == CV_32FC1 && !image.empty() && covered.width > 0.0F && covered.height > 0.0F,
                 "type " << image.type());
  HOLDFAST_CHECK((pixels & cv::Rect({}, place.frame)) == pixels, "pixels outside the frame");
  if (pixels.empty()) return cv::Mat::zeros(pixels.size(), CV_8UC1);
  const auto axis = [](int from, int count, int content_first, int content_size, int frame, float first, float length,
                       int size) {
    const double by_input = size / double{length};
    return PrototypeAxis(from, count, by_input * content_size / frame, by_input * (content_first - double{first}),
                         size);
  };
  const cv::Rect& content = place.content;
  const PrototypeAxis x =
      axis(pixels.x, pixels.width, content.x, content.width, place.frame.width, covered.x, covered.width, image.cols);
  const PrototypeAxis y = axis(pixels.y, pixels.height, content.y, content.height, place.frame.height, covered.y,
                               covered.height, image.rows);
  return resized_above(image(cv::Range(y.low, y.high + 1), cv::Range(x.low, x.high + 1)), x, y, threshold);
}

cv::Mat depth_mask(const cv::Mat& depth, const cv::Rect& pixels) {
  cv::Mat mask(pixels.size(), CV_8UC1, cv::Scalar(255));
  if (depth.empty() || pixels.empty()) return mask;
  HOLDFAST_CHECK(depth.type() == CV_32FC1 && (pixels & cv::Rect({}, depth.size())) == pixels, "pixels outside depth");
  const std::optional<DepthRange> range = object_depths(depth, pixels);
  if (!range) return mask;
  constexpr float margin = 0.25F;
  for (int row = 0; row < mask.rows; ++row) {
    const auto* z = depth.ptr<float>(pixels.y + row) + pixels.x;
    auto* to = mask.ptr<std::uint8_t>(row);
    for (int column = 0; column < mask.cols; ++column)
      if (is_measured_depth(z[column]) && (z[column] < range->nearest - margin || z[column] > range->farthest + margin))
        to[column] = 0;
  }
  return mask;
}

Segmentation join_objects(const std::vector<ObjectMask>& objects, const cv::Size& frame) {
  Segmentation result{
      cv::Mat::zeros(frame, CV_8UC1), cv::Mat(frame, CV_8UC1, cv::Scalar(255)), cv::Mat::zeros(frame, CV_16UC1), {}};
  for (const ObjectMask& object : objects) result.found.push_back(object.instance);
  for (const bool movable : {false, true})
    for (std::size_t i = objects.size(); i-- > 0;) {
      const ObjectMask& object = objects[i];
      if (object.is_movable != movable) continue;
      result.labels(object.pixels).setTo(object.instance.label, object.mask);
      result.confidence(object.pixels).setTo(std::lround(127.5 * (1.0 + object.instance.score)), object.mask);
      result.instances(object.pixels).setTo(static_cast<double>(i + 1), object.mask);
    }
  return result;
}

}  // namespace holdfast
