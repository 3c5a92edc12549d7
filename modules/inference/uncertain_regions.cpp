// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/inference/uncertain_regions.hpp"

#include <opencv2/core/mat.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "holdfast/interfaces/segmenter.hpp"

namespace holdfast {

void drop_uncertain_regions(Segmentation& segmentation, std::uint8_t label, std::uint8_t certainty) {
  if (segmentation.confidence.empty()) return;
  cv::Mat regions;
  const int count = cv::connectedComponents(segmentation.labels == label, regions, 8, CV_32S);
  std::vector<char> is_kept(static_cast<std::size_t>(count), 0);
  is_kept[0] = 1;  // pixels of other labels
  for (int y = 0; y < regions.rows; ++y) {
    const auto* region = regions.ptr<int>(y);
    const auto* confidence = segmentation.confidence.ptr<std::uint8_t>(y);
    for (int x = 0; x < regions.cols; ++x)
      if (confidence[x] >= certainty) is_kept[static_cast<std::size_t>(region[x])] = 1;
  }
  for (int y = 0; y < regions.rows; ++y) {
    const auto* region = regions.ptr<int>(y);
    auto* labels = segmentation.labels.ptr<std::uint8_t>(y);
    auto* confidence = segmentation.confidence.ptr<std::uint8_t>(y);
    for (int x = 0; x < regions.cols; ++x)
      if (is_kept[static_cast<std::size_t>(region[x])] == 0) labels[x] = confidence[x] = 0;
  }
}

}  // namespace holdfast
