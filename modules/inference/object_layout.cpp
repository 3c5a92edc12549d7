// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/inference/object_layout.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <utility>

#include "holdfast/core/counted.hpp"
#include "holdfast/core/error.hpp"
#include "holdfast/inference/onnx_net.hpp"

namespace holdfast {

namespace {

using Form = ScoreForm;

/// The families, as their authors export them.
constexpr std::array<ObjectPreset, 11> presets = {{
    {ObjectFamily::yolo, "YOLO (v8 to 12)", BoxForm::centre, BoxUnit::pixels, Form::probabilities, 0.0F},
    {ObjectFamily::yolov5, "YOLO (v5, v7)", BoxForm::centre, BoxUnit::pixels, Form::objectness, 0.0F},
    {ObjectFamily::yolo_end_to_end, "YOLO, end to end (v10, 26, exported with nms)", BoxForm::corners, BoxUnit::pixels,
     Form::best, 0.0F},
    {ObjectFamily::rtdetr, "RT-DETR, one output", BoxForm::centre, BoxUnit::fractions, Form::probabilities, 0.0F},
    {ObjectFamily::rtdetr, "RT-DETR", BoxForm::centre, BoxUnit::fractions, Form::logits, 0.0F},
    {ObjectFamily::detr, "DETR", BoxForm::centre, BoxUnit::fractions, Form::softmax, 0.0F},
    {ObjectFamily::ssd, "SSD", BoxForm::corners, BoxUnit::either, Form::background_first, 0.0F},
    {ObjectFamily::ssd, "SSD, with class numbers", BoxForm::corners, BoxUnit::either, Form::numbered, 0.5F},
    {ObjectFamily::mask_rcnn, "Mask R-CNN", BoxForm::corners, BoxUnit::either, Form::numbered, 0.5F},
    {ObjectFamily::fastestdet, "FastestDet", BoxForm::cell, BoxUnit::fractions, Form::cell, 0.0F},
    {ObjectFamily::maskformer, "MaskFormer (and Mask2Former)", BoxForm::corners, BoxUnit::pixels, Form::softmax, 0.0F},
}};

const ObjectPreset& preset_of(ObjectFamily family, Form scores) {
  for (const ObjectPreset& preset : presets)
    if (preset.family == family && preset.scores == scores) return preset;
  HOLDFAST_CHECK(false, "a family without a preset");
  return presets[0];
}

/// An output that is a list: 1 x rows x columns, or without the 1; a list of numbers has one column.
struct List {
  std::size_t output = 0;
  std::int64_t rows = 0, columns = 1;
};

std::optional<List> as_list(const OnnxTensor& tensor, std::size_t output) {
  std::vector<std::int64_t> shape = tensor.shape;
  if (shape.size() == 3 && shape.front() == 1) shape.erase(shape.begin());
  if (shape.size() == 2 && shape[0] == 1) std::swap(shape[0], shape[1]);  // numbers
  if (shape.size() == 1) shape.push_back(1);
  constexpr std::int64_t most = 1 << 22;
  if (shape.size() != 2 || shape[0] < 1 || shape[1] < 1 || shape[0] > most || shape[1] > most) return std::nullopt;
  return List{output, shape[0], shape[1]};
}

/// Images of masks: boxes x 1 x height x width, any number of boxes.
bool is_masks(const OnnxTensor& tensor) {
  constexpr std::int64_t most_side = 8192;
  const std::vector<std::int64_t>& s = tensor.shape;
  return s.size() == 4 && s[1] == 1 && s[2] >= 2 && s[3] >= 2 && s[2] <= most_side && s[3] <= most_side;
}

bool is_prototypes(const OnnxTensor& tensor) {
  constexpr std::int64_t most_coefficients = 1024, most_side = 4096;
  const std::vector<std::int64_t>& s = tensor.shape;
  return s.size() == 4 && s[0] == 1 && s[1] >= 1 && s[1] <= most_coefficients && s[2] >= 2 && s[3] >= 2 &&
         s[2] <= most_side && s[3] <= most_side;
}

bool says(const std::string& name, const std::string& part) {
  std::string lower = name;
  std::transform(lower.begin(), lower.end(), lower.begin(), [](unsigned char c) { return std::tolower(c); });
  return lower.find(part) != std::string::npos;
}

/// Finds the layout of the outputs; see recognise_objects().
class Recogniser {
 public:
  explicit Recogniser(const ObjectQuestion& question) : question_(question) {
    for (std::size_t i = 0; i < question.outputs.size(); ++i) {
      const OnnxTensor& tensor = question.outputs[i];
      if (is_prototypes(tensor) && !prototypes_)
        prototypes_ = i;
      else if (const std::optional<List> list = as_list(tensor, i))
        lists_.push_back(*list);
    }
    if (prototypes_) coefficients_ = static_cast<int>(question.outputs[*prototypes_].shape[1]);
  }

  std::optional<ObjectLayout> find() const {
    if (const auto found = boxes_of_any_number()) return found;
    if (const auto found = queries_with_masks()) return found;
    if (question_.family == ObjectFamily::fastestdet) return cells();
    const auto boxes = box_list();
    if (boxes && lists_.size() == 2) return two_outputs(*boxes);
    if (boxes && lists_.size() >= 3) return three_outputs(*boxes);
    return lists_.empty() ? std::nullopt : one_output(lists_.front());
  }

 private:
  bool may_be(ObjectFamily family) const {
    return question_.family == ObjectFamily::automatic || question_.family == family;
  }
  bool has_classes(std::int64_t count) const {
    return count >= 1 && (question_.classes == 0 || question_.classes == count);
  }
  const OnnxTensor& tensor(const List& list) const { return question_.outputs[list.output]; }

  /// The list of boxes beside others; of several with four columns, the one with such a name.
  std::optional<List> box_list() const {
    std::optional<List> found;
    for (const List& list : lists_)
      if (lists_.size() > 1 && list.columns == 4 && (!found || says(tensor(list).name, "box"))) found = list;
    return found;
  }

  ObjectLayout layout(ObjectFamily family, Form scores, const List& boxes, std::int64_t classes) const {
    return {.preset = preset_of(family, scores),
            .boxes = boxes.output,
            .scores = {},
            .numbers = {},
            .prototypes = {},
            .masks = {},
            .count = static_cast<int>(boxes.rows),
            .width = static_cast<int>(boxes.columns),
            .classes = static_cast<int>(classes)};
  }

  ObjectLayout layout_of_one(ObjectFamily family, Form scores, const List& list, bool is_transposed,
                             std::int64_t classes) const {
    ObjectLayout result = layout(family, scores, list, classes);
    result.is_transposed = is_transposed;
    if (is_transposed) std::swap(result.count, result.width);
    result.coefficients = coefficients_;
    if (question_.wants_masks) result.prototypes = prototypes_;
    return result;
  }

  /// As torchvision exports SSD, Faster and Mask R-CNN: boxes x 4, and numbers and scores of as many as there are in
  /// the image, with masks or without.
  std::optional<ObjectLayout> boxes_of_any_number() const {
    std::optional<std::size_t> boxes, numbers, scores, masks;
    for (std::size_t i = 0; i < question_.outputs.size(); ++i) {
      const OnnxTensor& output = question_.outputs[i];
      const bool is_column = output.shape.size() == 1 || (output.shape.size() == 2 && output.shape[1] == 1);
      constexpr int int64 = 7;
      if (output.shape.size() == 2 && output.shape[1] == 4)
        boxes = i;
      else if (is_column && (output.element_type == int64 || says(output.name, "label")))
        numbers = i;
      else if (is_column)
        scores = i;
      else if (is_masks(output))
        masks = i;
    }
    if (!boxes || !numbers || !scores) return std::nullopt;
    const ObjectFamily family = masks ? ObjectFamily::mask_rcnn : ObjectFamily::ssd;
    if (!may_be(family)) return std::nullopt;
    ObjectLayout result = layout(family, Form::numbered, {*boxes, 0, 4}, 0);
    result.scores = scores, result.numbers = numbers;
    if (question_.wants_masks) result.masks = masks;
    return result;
  }

  /// FastestDet: one output, 1 x (5 + classes) x rows x columns of a grid. Other networks have outputs of this shape,
  /// so that it is not recognised unasked.
  std::optional<ObjectLayout> cells() const {
    if (question_.outputs.size() != 1 || !is_prototypes(question_.outputs.front())) return std::nullopt;
    const std::vector<std::int64_t>& shape = question_.outputs.front().shape;
    if (!has_classes(shape[1] - 5)) return std::nullopt;
    ObjectLayout result =
        layout(ObjectFamily::fastestdet, Form::cell, {0, shape[2] * shape[3], shape[1]}, shape[1] - 5);
    result.is_transposed = true;
    result.grid_columns = static_cast<int>(shape[3]);
    return result;
  }

  /// MaskFormer and Mask2Former: 1 x queries x (classes + 1) and 1 x queries x height x width.
  std::optional<ObjectLayout> queries_with_masks() const {
    if (!may_be(ObjectFamily::maskformer) || !prototypes_ || lists_.size() != 1 || !question_.wants_masks)
      return std::nullopt;
    const List& scores = lists_.front();
    const bool fits = scores.rows == question_.outputs[*prototypes_].shape[1] && scores.columns >= 2 &&
                      has_classes(scores.columns - 1);
    if (!fits) return std::nullopt;
    ObjectLayout result = layout(ObjectFamily::maskformer, Form::softmax, scores, scores.columns - 1);
    result.scores = scores.output, result.masks = prototypes_, result.has_boxes = false;
    return result;
  }

  /// Whether there are so many boxes for each cell of the grids of strides 8, 16 and 32, with 4 or 64 if need be.
  bool covers_grids(std::int64_t boxes, std::int64_t boxes_of_cell) const {
    const auto cells = [&](int stride) {
      return std::int64_t{(question_.input.width + stride - 1) / stride} *
             ((question_.input.height + stride - 1) / stride) * boxes_of_cell;
    };
    const std::int64_t usual = cells(8) + cells(16) + cells(32);
    return boxes == usual || boxes == usual + cells(64) || boxes == usual + cells(4);
  }

  std::optional<ObjectLayout> one_output(const List& list) const {
    constexpr std::int64_t most_of_set = 1000;  // boxes of a network that gives no more than it has to
    const bool is_asked_for = question_.family != ObjectFamily::automatic;
    const bool is_known = question_.classes > 0;
    for (const bool transposed : {true, false}) {
      const std::int64_t count = transposed ? list.columns : list.rows, width = transposed ? list.rows : list.columns;
      const std::int64_t classes = width - 4 - coefficients_;
      // Without names, the order of dimensions tells it from other families with boxes in a grid.
      const bool fits = covers_grids(count, 1) ? transposed || is_known : is_asked_for || (is_known && transposed);
      if (may_be(ObjectFamily::yolo) && has_classes(classes) && fits)
        return layout_of_one(ObjectFamily::yolo, Form::probabilities, list, transposed, classes);
    }
    const std::int64_t count = list.rows, width = list.columns;
    const std::int64_t classes = width - 4 - coefficients_;
    if (may_be(ObjectFamily::yolov5) && has_classes(classes - 1) && (covers_grids(count, 3) || is_asked_for))
      return layout_of_one(ObjectFamily::yolov5, Form::objectness, list, false, classes - 1);
    if (may_be(ObjectFamily::yolo_end_to_end) && classes == 2 && (count <= most_of_set || is_asked_for))
      return layout_of_one(ObjectFamily::yolo_end_to_end, Form::best, list, false, 0);
    if (may_be(ObjectFamily::rtdetr) && coefficients_ == 0 && has_classes(classes) && (is_known || count > width) &&
        (count <= most_of_set || is_asked_for))
      return layout_of_one(ObjectFamily::rtdetr, Form::probabilities, list, false, classes);
    return std::nullopt;
  }

  std::optional<ObjectLayout> two_outputs(const List& boxes) const {
    const List& scores = lists_[0].output == boxes.output ? lists_[1] : lists_[0];
    if (scores.rows != boxes.rows || scores.columns < 2) return std::nullopt;
    const std::string& last = tensor(scores).computed_by;
    const bool is_share = last == "Softmax", has_none = has_classes(scores.columns - 1),
               has_all = has_classes(scores.columns);
    std::optional<ObjectLayout> result;
    if (may_be(ObjectFamily::ssd) && has_none && (is_share || question_.family == ObjectFamily::ssd))
      result = layout(ObjectFamily::ssd, Form::background_first, boxes, scores.columns - 1);
    else if (is_share || last == "Sigmoid")
      return std::nullopt;  // of a family that is not known here
    else if (may_be(ObjectFamily::detr) && has_none && (question_.classes > 0 || looks_like_detr(scores)))
      result = layout(ObjectFamily::detr, Form::softmax, boxes, scores.columns - 1);
    else if (may_be(ObjectFamily::rtdetr) && has_all)
      result = layout(ObjectFamily::rtdetr, Form::logits, boxes, scores.columns);
    if (result) result->scores = scores.output;
    return result;
  }
  bool looks_like_detr(const List& scores) const {
    constexpr std::int64_t queries = 100, classes_of_coco = 92;
    return question_.family == ObjectFamily::detr || scores.rows == queries || scores.columns == classes_of_coco;
  }

  std::optional<ObjectLayout> three_outputs(const List& boxes) const {
    if (!may_be(ObjectFamily::ssd)) return std::nullopt;
    ObjectLayout result = layout(ObjectFamily::ssd, Form::numbered, boxes, 0);
    for (const List& list : lists_) {
      if (list.output == boxes.output || list.columns != 1 || list.rows != boxes.rows) continue;
      const std::string& name = tensor(list).name;
      if (says(name, "label") || says(name, "class"))
        result.numbers = list.output;
      else if (says(name, "score"))
        result.scores = list.output;
    }
    if (!result.numbers || !result.scores) return std::nullopt;
    return result;
  }

  const ObjectQuestion& question_;
  std::vector<List> lists_;
  std::optional<std::size_t> prototypes_;
  int coefficients_ = 0;
};

/// Whether a shape, which may have free dimensions, is a list of boxes and no image of the input.
bool declares_list(const std::vector<std::int64_t>& shape, const std::vector<std::int64_t>& input) {
  if (shape.size() != 3 || shape[0] > 1 || shape[1] < 6 || shape[2] < 6) return false;
  if (input.size() != 4) return false;
  const bool is_last = input[3] == 3;  // channels
  const auto height = static_cast<double>(input[is_last ? 1 : 2]), width = static_cast<double>(input[is_last ? 2 : 3]);
  if (height < 1.0 || width < 1.0) return false;
  const double ratio = static_cast<double>(shape[1]) / static_cast<double>(shape[2]) / (height / width);
  return ratio < 0.4 || ratio > 2.5;
}

}  // namespace

bool declares_objects(const OnnxSignature& signature, const ModelMetadata& metadata) {
  for (const char* task : {"detect", "segment", "pose", "obb"})
    if (metadata.task == task) return true;
  bool has_boxes = false, has_list = false, has_queries = false, has_images = false;
  for (const OnnxTensor& output : signature.outputs) {
    const std::vector<std::int64_t>& shape = output.shape;
    has_boxes = has_boxes || ((shape.size() == 2 || shape.size() == 3) && shape.back() == 4);
    has_queries = has_queries || (shape.size() == 3 && shape[1] != 1);
    has_images = has_images || shape.size() == 4;
    has_list = has_list || declares_list(shape, signature.inputs.front().shape);
  }
  return has_list || (has_boxes && signature.outputs.size() > 1) || (has_queries && has_images);
}

ObjectLayout recognise_objects(const ObjectQuestion& question) {
  const auto fail = [&](const std::string& message) { throw InputError({question.model.string()}, message); };
  if (!question.task.empty() && question.task != "detect" && question.task != "segment")
    fail("is a network for the task '" + question.task +
         "', as its metadata says; expected one for segmentation or detection; export such a one");
  if (std::optional<ObjectLayout> layout = Recogniser(question).find()) return *layout;
  const bool is_asked_for = question.family != ObjectFamily::automatic;
  fail("gives " + names(question.outputs) + ", which are not the outputs of " +
       (is_asked_for ? std::string("the `family` ") + choice_name(question.family) : std::string("a known family")) +
       (question.classes > 0 ? " for " + counted(static_cast<std::size_t>(question.classes), "class name") : "") +
       "; expected, for " + std::to_string(question.input.width) + "x" + std::to_string(question.input.height) +
       " pixels, boxes with scores of each class, and with prototypes their coefficients, or masks; correct `classes`" +
       (is_asked_for ? " or `family`" : ", name the `family`") +
       ", or run the network elsewhere and read its masks with the segmenter `precomputed`");
  return {};
}

}  // namespace holdfast
