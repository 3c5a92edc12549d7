// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "holdfast/inference/onnx_signature.hpp"
#include "holdfast/interfaces/segmenter.hpp"

namespace holdfast {

/// Meaning of the output values of a segmentation network.
enum class OutputKind {
  logits,         ///< score of each class before softmax; before the sigmoid for one channel
  probabilities,  ///< 0 to 1 for each class; for one channel, of the only class besides the background
  labels          ///< class index
};

/// Expected form of the output: N channels for N classes (or one channel for the second of two classes) of any height
/// and width; one channel for labels.
struct OutputForm {
  OutputKind kind = OutputKind::logits;
  bool channels_last = false;  ///< 1 x height x width x channels
  int classes = 2;
  std::filesystem::path model;  ///< named in messages
  int input_width = 0;          ///< of the network [px]; 0 = unknown
  int input_height = 0;
};

/// Throws InputError if the declaration of an output shows that its values mean something else than `form.kind`: whole
/// numbers or those of ArgMax are labels, and those of Sigmoid and Softmax are probabilities.
void check_output_kind(const OnnxTensor& output, const OutputForm& form);

/// Decodes a network's output (32F with the dimensions of OutputForm; the first dimension of size 1 may be missing) to
/// labels and confidence of the given size. Scores are resized bilinearly (pixel centres at half integers) before the
/// maximum is taken, the first one in case of a tie; labels are resized by nearest neighbour. The confidence is the
/// softmax probability of the selected class (for probabilities, its fraction of their sum), 0 to 255; it is empty for
/// labels. Label 255 is unknown. Throws InputError, which states what was found and what was expected, for a wrong
/// shape, a tensor that is no image of the network's input (boxes of a detector, scores of a classifier), values that
/// are not finite, probabilities outside 0 to 1, labels in place of scores and labels without a class. Results are
/// bit-identical at every SIMD level.
Segmentation decode_segmentation(const cv::Mat& output, const OutputForm& form, int width, int height);

}  // namespace holdfast
