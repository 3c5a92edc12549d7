// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <opencv2/core/types.hpp>
#include <optional>
#include <string>
#include <vector>

#include "holdfast/inference/model_metadata.hpp"
#include "holdfast/inference/onnx_signature.hpp"
#include "holdfast/settings/onnx.hpp"

namespace holdfast {

/// How a network for objects writes its boxes.
enum class BoxForm {
  centre,   ///< centre x, centre y, width, height
  corners,  ///< left, top, right, bottom
  cell      ///< offsets of the centre from the cell of a grid, before tanh, and sizes, before the sigmoid
};

/// Unit of its boxes. either: fractions, unless one of the coordinates is above 2.
enum class BoxUnit { pixels, fractions, either };

/// How it writes its scores.
enum class ScoreForm {
  probabilities,     ///< one for each class
  objectness,        ///< probability of an object, and of each class if there is one
  best,              ///< score and number of the best class
  logits,            ///< one for each class, before the sigmoid
  softmax,           ///< one for each class before softmax, "no object" last
  background_first,  ///< probability of each class, the background first
  cell,              ///< objectness, four numbers of the box, probability of each class: objectness^0.6 * best^0.4
  numbered           ///< score and number of the best class in outputs of their own, 0 = background
};

/// A family of networks for objects: what their outputs mean. `holdfast modules onnx` describes the families.
struct ObjectPreset {
  ObjectFamily family;
  const char* title;  ///< for people: "YOLO (v8, v9, 11, 12)"
  BoxForm box;
  BoxUnit unit;
  ScoreForm scores;
  float mask_threshold;  ///< value of the masks from which on a pixel is the object's: 0.5 or, before a sigmoid, 0
};

/// Where the numbers of a network for objects are: which of its outputs, and which numbers.
struct ObjectLayout {
  ObjectPreset preset;
  std::size_t boxes = 0;               ///< number of the output with the boxes
  std::optional<std::size_t> scores;   ///< of the output with scores, if they are not with the boxes
  std::optional<std::size_t> numbers;  ///< of the output with class numbers
  std::optional<std::size_t> prototypes;
  std::optional<std::size_t> masks;  ///< of the output with an image for each box, in the order of the boxes
  bool has_boxes = true;             ///< otherwise the masks say where objects are, and `boxes` is that of the scores
  bool is_transposed = false;  ///< the output with the boxes is 1 x numbers x boxes instead of 1 x boxes x numbers
  int count = 0;               ///< boxes; 0 = differs from image to image
  int width = 0;               ///< numbers of a box, in the output with the boxes
  int classes = 0;             ///< of the network, without the background; 0 = it gives class numbers
  int coefficients = 0;        ///< of a mask
  int grid_columns = 0;        ///< of BoxForm::cell
};

/// What is asked of recognise_objects().
struct ObjectQuestion {
  std::vector<OnnxTensor> outputs;  ///< names, types and shapes, without free dimensions; 0 where nothing was found
  cv::Size input;                   ///< [px]
  std::string task;                 ///< ModelMetadata::task
  int classes = 0;                  ///< without the background; 0 if unknown
  ObjectFamily family = ObjectFamily::automatic;
  bool wants_masks = true;      ///< prototypes are used if there are any
  std::filesystem::path model;  ///< named in messages
};

/// Whether the declarations of a model are those of a network for objects rather than for semantic segmentation: its
/// metadata say so, or it has an output with four numbers for each box, one with a list that is no image, or one with a
/// list and one with images.
bool declares_objects(const OnnxSignature& signature, const ModelMetadata& metadata);

/// Finds the family and the meaning of the outputs of a network for objects. Throws InputError, which states what was
/// found and what was expected, for outputs of no known family, of another family than the one asked for, of another
/// number of classes, and for networks of other tasks, such as poses.
ObjectLayout recognise_objects(const ObjectQuestion& question);

}  // namespace holdfast
