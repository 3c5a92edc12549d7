// SPDX-License-Identifier: BSD-3-Clause
// Metadata and outputs of a network. The input is a line of class names, a line of the task, one of the size of the
// input, then bytes: family, number of outputs, the dimensions of each (their number, then 12 bits each), and numbers
// of four bytes, which are repeated. The first output is also read as that of a semantic network.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <opencv2/core.hpp>

#include "fuzz.hpp"
#include "holdfast/inference/object_layout.hpp"
#include "holdfast/inference/object_masks.hpp"
#include "holdfast/inference/object_output.hpp"
#include "holdfast/inference/segmentation_output.hpp"

using namespace holdfast;

namespace {

constexpr std::size_t most_numbers = 1 << 16;  // of an output
const cv::Size frame(48, 32);

class Reader {
 public:
  explicit Reader(fuzz::Bytes bytes) : rest_(bytes) {}

  std::string line() {
    const auto end = std::find(rest_.begin(), rest_.end(), '\n');
    const auto size = static_cast<std::size_t>(end - rest_.begin());
    const std::string text = fuzz::text_of(rest_.first(size));
    rest_ = rest_.subspan(std::min(size + 1, rest_.size()));
    return text;
  }
  std::uint8_t byte() {
    if (rest_.empty()) return 0;
    const std::uint8_t value = rest_.front();
    rest_ = rest_.subspan(1);
    return value;
  }
  fuzz::Bytes rest() const { return rest_; }

 private:
  fuzz::Bytes rest_;
};

std::vector<int> shape_of(Reader& reader) {
  std::vector<int> shape(reader.byte() % 6U);
  std::size_t total = 1;
  for (int& size : shape) {
    const int high = reader.byte();
    size = (high & 15) << 8 | reader.byte();
    total *= static_cast<std::size_t>(size);
    if (total > most_numbers) return {};
  }
  return shape;
}

/// An output of these dimensions; the numbers are repeated from the given one on.
cv::Mat values_of(const std::vector<int>& shape, fuzz::Bytes numbers, std::size_t first) {
  cv::Mat values(static_cast<int>(shape.size()), shape.data(), CV_32FC1);
  for (std::size_t i = 0; i < values.total(); ++i) {
    float value = 0.5F;
    if (numbers.size() >= 4)
      std::memcpy(&value, numbers.data() + (first + i) % (numbers.size() / 4) * 4, sizeof(value));
    values.ptr<float>()[i] = value;
  }
  return values;
}

void require_sound(const std::vector<Detection>& objects, const cv::Size& input) {
  float last = 1.0F;
  for (const Detection& object : objects) {
    fuzz::require(object.score >= 0.0F && object.score <= last, "scores decrease");
    last = object.score;
    const cv::Rect2f& box = object.box;
    fuzz::require(box.x >= 0.0F && box.y >= 0.0F && box.width > 0.0F && box.height > 0.0F, "a box has an area");
    fuzz::require(box.x + box.width <= static_cast<float>(input.width) + 0.01F &&
                      box.y + box.height <= static_cast<float>(input.height) + 0.01F,
                  "a box lies in the input");
  }
}

/// The mask of an object from its own image, as the segmenter takes it.
cv::Mat mask_of_image(const cv::Mat& images, const Detection& object, const ObjectLayout& layout, const cv::Size& input,
                      const FramePlace& place, const cv::Rect& pixels) {
  const int rows = images.size[2], columns = images.size[3];
  const std::ptrdiff_t first = std::ptrdiff_t{object.number} * rows * columns;
  fuzz::require(first + std::ptrdiff_t{rows} * columns <= static_cast<std::ptrdiff_t>(images.total()),
                "an object has its image");
  const cv::Mat image(rows, columns, CV_32F, const_cast<float*>(images.ptr<float>()) + first);
  const bool is_of_box = layout.has_boxes && image.size() != input;
  return image_mask(image, is_of_box ? object.box : cv::Rect2f({}, cv::Size2f(input)), layout.preset.mask_threshold,
                    place, pixels);
}

Segmentation masks_of(const std::vector<Detection>& objects, const std::vector<cv::Mat>& outputs,
                      const ObjectLayout& layout, const cv::Size& input, const cv::Mat& depth) {
  const FramePlace place = place_of_frame(frame, input, layout.preset.unit == BoxUnit::pixels);
  std::vector<ObjectMask> masks;
  for (const Detection& object : objects) {
    ObjectMask mask{{1, object.score, place.box_in_frame(object.box)}};
    mask.pixels = pixels_of(mask.instance.box, frame);
    if (mask.pixels.empty()) continue;
    mask.mask = layout.prototypes
                    ? prototype_mask(outputs[*layout.prototypes], object.mask_coefficients, place, mask.pixels)
                : layout.masks ? mask_of_image(outputs[*layout.masks], object, layout, input, place, mask.pixels)
                               : depth_mask(depth, mask.pixels);
    masks.push_back(mask);
  }
  return join_objects(masks, frame);
}

void decode_semantic(const cv::Mat& output, int classes, std::uint8_t choices) {
  const OutputForm form = {.kind = static_cast<OutputKind>(choices % 3),
                           .channels_last = (choices & 8) != 0,
                           .classes = classes,
                           .model = "net",
                           .input_width = (choices & 16) != 0 ? 64 : 0,
                           .input_height = (choices & 16) != 0 ? 48 : 0};
  const Segmentation result = decode_segmentation(output, form, frame.width, frame.height);
  fuzz::require(result.labels.size() == frame, "labels have the frame's size");
  for (int y = 0; y < frame.height; ++y)
    for (int x = 0; x < frame.width; ++x) {
      const int label = result.labels.at<std::uint8_t>(y, x);
      fuzz::require(label < classes || label == 255, "a label has a class");
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Reader reader({data, size});
  const std::string names = reader.line(), task = reader.line(), imgsz = reader.line();
  const ModelMetadata metadata = read_model_metadata({{"names", names}, {"task", task}, {"imgsz", imgsz}});
  fuzz::require(metadata.width >= 0 && metadata.width <= 8192 && metadata.height <= 8192, "a size is in its range");
  ObjectQuestion question{.task = metadata.task, .classes = static_cast<int>(metadata.names.size()), .model = "net"};
  question.input = {std::clamp(metadata.width, 8, 96), std::clamp(metadata.height, 8, 96)};
  const std::uint8_t choices = reader.byte();
  question.family = static_cast<ObjectFamily>(choices % 10);
  question.wants_masks = (choices & 128) == 0;
  std::vector<std::vector<int>> shapes(1 + reader.byte() % 4U);
  for (std::vector<int>& shape : shapes) shape = shape_of(reader);
  std::vector<cv::Mat> outputs;
  for (const std::vector<int>& shape : shapes) {
    if (shape.empty()) return 0;
    outputs.push_back(values_of(shape, reader.rest(), outputs.size()));
    question.outputs.push_back({.name = outputs.size() == 1 ? "labels" : "scores", .element_type = 1});
    question.outputs.back().shape.assign(shape.begin(), shape.end());
  }
  fuzz::accepts([&] { decode_semantic(outputs.front(), std::clamp(question.classes, 2, 254), choices); });
  fuzz::accepts([&] {
    const ObjectLayout layout = recognise_objects(question);
    std::vector<Detection> objects = decode_objects(outputs, layout, question.input, 0.25, 80, "net");
    require_sound(objects, question.input);
    suppress_duplicates(objects, 0.45, 20);
    const Segmentation masks =
        masks_of(objects, outputs, layout, question.input, values_of({frame.height, frame.width}, reader.rest(), 3));
    double highest = 0.0;
    cv::minMaxLoc(masks.instances, nullptr, &highest);
    fuzz::require(highest <= static_cast<double>(masks.found.size()), "an instance is in the table");
  });
  return 0;
}
