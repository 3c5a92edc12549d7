// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "holdfast/interfaces/segmenter.hpp"

namespace holdfast {

/// What the numbers of a segmentation network mean.
enum class OutputKind {
  logits,         ///< scores of each class, of which softmax makes probabilities; of one channel: sigmoid
  probabilities,  ///< 0 to 1, of each class; of one channel: of the only class beside the background
  labels          ///< index of the class
};

/// What to expect of a network's output: for N classes N channels (or one, where there are two classes: background and
/// what is looked for) of any height and width, for labels one channel.
struct OutputForm {
  OutputKind kind = OutputKind::logits;
  bool channels_last = false;  ///< 1 x height x width x channels
  int classes = 2;
  std::filesystem::path model;  ///< named in messages
};

/// Labels and confidence, of the given size, from a network's output (32F; dimensions as OutputForm says, the first
/// one, of size 1, may be missing). Scores are resized bilinearly (pixel centres at half integers) before the largest
/// is chosen, of equal ones the first; labels take the nearest pixel. Confidence is the winner's softmax probability
/// (probabilities: the winner's share), 0 to 255; for labels it stays empty. A label of 255 is unknown. Throws
/// InputError, with what was found and what was expected, for another shape, numbers that are not finite, probabilities
/// outside 0 to 1 and labels that name no class. The same bits at every SIMD level.
Segmentation decode_segmentation(const cv::Mat& output, const OutputForm& form, int width, int height);

}  // namespace holdfast
