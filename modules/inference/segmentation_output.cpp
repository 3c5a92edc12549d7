// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/inference/segmentation_output.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "holdfast/core/error.hpp"
#include "holdfast/inference/onnx_signature.hpp"

namespace holdfast {

namespace {

/// The values of an output for any position of its channel dimension.
struct Scores {
  const float* data = nullptr;
  int channels = 1, height = 0, width = 0;
  std::ptrdiff_t channel_step = 0, row_step = 0, pixel_step = 1;

  const float* row(int channel, int y) const { return data + channel * channel_step + y * row_step; }
};

/// A network with a larger input does not give one pixel for all of it.
constexpr int max_pixels_of_one = 32 * 32;

[[noreturn]] void fail(const OutputForm& form, const std::string& message) {
  throw InputError({form.model.string()}, message);
}

std::string expected_shape(const OutputForm& form) {
  std::string channels = form.kind == OutputKind::labels ? "1" : std::to_string(form.classes);
  if (form.kind != OutputKind::labels && form.classes == 2) channels += " (or 1)";
  return form.channels_last ? "1 x height x width x " + channels : "1 x " + channels + " x height x width";
}

/// Whether height and width can be those of an image of the network's input, up to padding and rounding: their ratio
/// differs by a factor of two at most. A single pixel is none.
bool can_be_image(int height, int width, const OutputForm& form) {
  if (form.input_width < 1 || form.input_height < 1) return true;
  if (height == 1 && width == 1) return form.input_width * form.input_height <= max_pixels_of_one;
  const double expected = static_cast<double>(form.input_height) / form.input_width;
  const double least = (height - 0.5) / (width + 0.5), most = (height + 0.5) / (width - 0.5);
  return most >= 0.5 * expected && least <= 2.0 * expected;
}

/// What a tensor that is no image looks like.
std::string resemblance(const std::vector<std::int64_t>& shape) {
  std::vector<std::int64_t> sizes;
  for (const std::int64_t size : shape)
    if (size != 1) sizes.push_back(size);
  if (sizes.size() <= 1)
    return ": it looks like a classifier's scores of the whole image, " + std::to_string(sizes.empty() ? 1 : sizes[0]);
  if (sizes.size() > 2) return "";
  const auto [few, many] = std::minmax(sizes[0], sizes[1]);
  constexpr std::int64_t numbers_of_box = 4, least_with_scores = 8;
  if (few < numbers_of_box) return "";
  return ": it looks like the boxes of a detector, " + std::to_string(many) + " with " + std::to_string(few) +
         " numbers each" +
         (few < least_with_scores ? "" : " (position, size and scores, with masks their coefficients)");
}

[[noreturn]] void refuse_tensor(const std::vector<std::int64_t>& shape, const OutputForm& form) {
  fail(form, "gives an output of " + shape_text(shape) + ", which is no image of its input of " +
                 std::to_string(form.input_width) + "x" + std::to_string(form.input_height) + " pixels" +
                 resemblance(shape) + "; expected a network for semantic segmentation, with an output of " +
                 expected_shape(form) +
                 "; correct `output_name` or `layout`, choose another network, or run this one elsewhere and read its "
                 "masks with the segmenter `precomputed`");
}

Scores read_shape(const cv::Mat& output, const OutputForm& form) {
  std::vector<std::int64_t> shape(output.size.p, output.size.p + output.dims);
  const auto refuse = [&] {
    std::string message = "gives an output of " + shape_text(shape) + "; expected " + expected_shape(form);
    if (form.kind != OutputKind::labels) message += " for the " + std::to_string(form.classes) + " names in `classes`";
    fail(form, message + "; correct `classes`, `output`, `output_name` or `layout`");
  };
  if (output.depth() != CV_32F || output.channels() != 1 || !output.isContinuous() || output.dims < 2) refuse();
  std::vector<std::int64_t> sizes = shape;
  if (sizes.size() == 4) {
    if (sizes.front() != 1) refuse();
    sizes.erase(sizes.begin());
  }
  if (sizes.size() == 2) sizes.insert(form.channels_last ? sizes.end() : sizes.begin(), 1);  // one channel, left out
  if (sizes.size() != 3) refuse();
  Scores scores;
  scores.data = output.ptr<float>();
  const std::size_t rows = form.channels_last ? 0 : 1;
  scores.channels = static_cast<int>(sizes[form.channels_last ? 2 : 0]);
  scores.height = static_cast<int>(sizes[rows]);
  scores.width = static_cast<int>(sizes[rows + 1]);
  scores.pixel_step = form.channels_last ? scores.channels : 1;
  scores.row_step = scores.width * scores.pixel_step;
  scores.channel_step = form.channels_last ? 1 : scores.height * scores.row_step;
  const bool is_image = can_be_image(scores.height, scores.width, form);
  // With channels as well, another layout or number of classes is the likelier mistake.
  const bool has_channels = std::count_if(shape.begin(), shape.end(), [](std::int64_t size) { return size > 1; }) > 2;
  if (!is_image && !has_channels) refuse_tensor(shape, form);
  const bool fits = form.kind == OutputKind::labels
                        ? scores.channels == 1
                        : scores.channels == form.classes || (scores.channels == 1 && form.classes == 2);
  if (!fits || scores.height < 1 || scores.width < 1) refuse();
  if (!is_image) refuse_tensor(shape, form);
  return scores;
}

/// Whether all numbers are whole and not negative, and one of them is more than `least`: no network computes such
/// scores of its own accord, so that many of them are labels. Ends at the first number that is not.
bool are_labels(const float* value, std::size_t count, float least) {
  constexpr std::size_t enough = 100;
  float highest = 0.0F;
  for (std::size_t i = 0; i < count; ++i) {
    if (!(value[i] >= 0.0F && value[i] <= 255.0F && value[i] == std::floor(value[i]))) return false;
    highest = std::max(highest, value[i]);
  }
  return count >= enough && highest > least;
}

[[noreturn]] void refuse_labels(const OutputForm& form, const std::string& found) {
  fail(form,
       found + "; expected " +
           (form.kind == OutputKind::logits ? "scores for `output: logits`" : "numbers for `output: probabilities`") +
           "; set `output: labels`, and name all classes of the network in `classes`");
}

/// By TensorProto.DataType: all but float, string, float16, double, complex and bfloat16.
bool is_whole_number(int element_type) {
  return (element_type >= 2 && element_type <= 7) || element_type == 9 || element_type == 12 || element_type == 13;
}

void check_values(const cv::Mat& output, std::size_t pixels, const OutputForm& form) {
  const auto* value = output.ptr<float>();
  const std::size_t count = output.total();
  float lowest = value[0], highest = value[0];
  bool finite = true;
  for (std::size_t i = 0; i < count; ++i) {
    finite &= std::abs(value[i]) <= 1e30F;
    lowest = std::min(lowest, value[i]);
    highest = std::max(highest, value[i]);
  }
  if (!finite) fail(form, "gives numbers that are not finite; expected scores; check `scale`, `mean` and the weights");
  const bool has_one_channel = output.total() == pixels;
  if (form.kind != OutputKind::labels && has_one_channel &&
      are_labels(value, count, form.kind == OutputKind::logits ? 0.0F : 1.0F))
    refuse_labels(form, "gives whole numbers from 0 to " + std::to_string(std::lround(highest)) +
                            ", which are labels and no scores");
  constexpr float slack = 1e-3F;
  if (form.kind == OutputKind::probabilities && (lowest < -slack || highest > 1.0F + slack))
    fail(form, "gives numbers from " + std::to_string(lowest) + " to " + std::to_string(highest) +
                   "; expected probabilities, 0 to 1; is it `output: logits`?");
}

/// e^x for x <= 0, to 4e-6: (e^(x / 256))^256, the inner power by its series. Plain arithmetic without branches, so
/// that compilers make vectors of it and every processor gives the same bits.
float exponential(float x) {
  const float y = std::max(x, -20.0F) * (1.0F / 256.0F);
  const float power_1 = 1.0F + y * (1.0F + 0.5F * y);
  const float power_2 = power_1 * power_1, power_4 = power_2 * power_2, power_8 = power_4 * power_4;
  const float power_16 = power_8 * power_8, power_32 = power_16 * power_16, power_64 = power_32 * power_32;
  const float power_128 = power_64 * power_64;
  return power_128 * power_128;
}

std::uint8_t to_byte(float probability) { return static_cast<std::uint8_t>(probability * 255.0F + 0.5F); }

/// Where the pixels of one axis come from: between two neighbours, at half-integer centres.
struct Axis {
  std::vector<int> first, second;
  std::vector<float> weight;  ///< of the second

  Axis(int from, int to) {
    const double scale = static_cast<double>(from) / to;
    for (int i = 0; i < to; ++i) {
      const double at = std::clamp((i + 0.5) * scale - 0.5, 0.0, from - 1.0);
      const int low = static_cast<int>(at);
      first.push_back(low);
      second.push_back(std::min(low + 1, from - 1));
      weight.push_back(static_cast<float>(at - low));
    }
  }
};

/// Rows of the resized scores, from top to bottom. Each row of the scores is widened once and kept while it is needed.
class RowResizer {
 public:
  RowResizer(const Scores& scores, int width, int height)
      : scores_(scores),
        x_(scores.width, width),
        y_(scores.height, height),
        columns_(static_cast<std::size_t>(width)),
        kept_(2 * static_cast<std::size_t>(scores.channels)) {}

  void row(int channel, int y, float* to) {
    const auto row = static_cast<std::size_t>(y);
    Kept& above = kept_[2 * static_cast<std::size_t>(channel)];
    Kept& below = kept_[2 * static_cast<std::size_t>(channel) + 1];
    if (above.row != y_.first[row]) std::swap(above, below);
    widen(channel, y_.first[row], above);
    widen(channel, y_.second[row], below);
    blend(above.scores.data(), below.scores.data(), y_.weight[row], to);
  }

 private:
  struct Kept {
    int row = -1;
    std::vector<float> scores;
  };

  void widen(int channel, int y, Kept& kept) const {
    if (kept.row == y) return;
    kept.row = y;
    kept.scores.resize(columns_);
    const float* from = scores_.row(channel, y);
    for (std::size_t x = 0; x < columns_; ++x) {
      const float left = from[x_.first[x] * scores_.pixel_step], right = from[x_.second[x] * scores_.pixel_step];
      kept.scores[x] = left + x_.weight[x] * (right - left);
    }
  }
  void blend(const float* above, const float* below, float weight, float* to) const {
    for (std::size_t x = 0; x < columns_; ++x) to[x] = above[x] + weight * (below[x] - above[x]);
  }

  const Scores& scores_;
  Axis x_, y_;
  std::size_t columns_;
  std::vector<Kept> kept_;  // two for each channel
};

/// Background against one class. Of two scores only the difference matters, so that one plane is resized.
void decode_binary(const Scores& scores, OutputKind kind, Segmentation& result) {
  const int width = result.labels.cols, height = result.labels.rows;
  std::vector<float> difference;
  Scores plane = scores;
  if (scores.channels == 2) {
    difference.reserve(static_cast<std::size_t>(scores.width) * static_cast<std::size_t>(scores.height));
    for (int y = 0; y < scores.height; ++y)
      for (int x = 0; x < scores.width; ++x) {
        const float background = scores.row(0, y)[x * scores.pixel_step];
        const float foreground = scores.row(1, y)[x * scores.pixel_step];
        const float sum = std::max(background + foreground, 1e-6F);
        difference.push_back(kind == OutputKind::logits ? foreground - background : foreground / sum);
      }
    plane = {difference.data(), 1, scores.height, scores.width, 0, scores.width, 1};
  }
  RowResizer resizer(plane, width, height);
  const auto columns = static_cast<std::size_t>(width);
  const float boundary = kind == OutputKind::logits ? 0.0F : 0.5F;
  std::vector<float> row(columns), certainty(columns);
  for (int y = 0; y < height; ++y) {
    resizer.row(0, y, row.data());
    auto* label = result.labels.ptr<std::uint8_t>(y);
    auto* confidence = result.confidence.ptr<std::uint8_t>(y);
    if (kind == OutputKind::logits)
      for (std::size_t x = 0; x < columns; ++x) certainty[x] = 1.0F / (1.0F + exponential(-std::abs(row[x])));
    else
      for (std::size_t x = 0; x < columns; ++x) certainty[x] = std::min(0.5F + std::abs(row[x] - 0.5F), 1.0F);
    for (std::size_t x = 0; x < columns; ++x) {
      label[x] = row[x] > boundary ? 1 : 0;
      confidence[x] = to_byte(certainty[x]);
    }
  }
}

void decode_classes(const Scores& scores, OutputKind kind, Segmentation& result) {
  const int width = result.labels.cols, height = result.labels.rows;
  const auto columns = static_cast<std::size_t>(width);
  RowResizer resizer(scores, width, height);
  std::vector<float> rows(columns * static_cast<std::size_t>(scores.channels)), best(columns), sum(columns);
  std::vector<float> winner(columns);  // a number of the same width as the scores: loops become vectors
  for (int y = 0; y < height; ++y) {
    for (int channel = 0; channel < scores.channels; ++channel) {
      float* row = &rows[columns * static_cast<std::size_t>(channel)];
      resizer.row(channel, y, row);
      const auto number = static_cast<float>(channel);
      for (std::size_t x = 0; x < columns; ++x) {
        const bool wins = channel == 0 || row[x] > best[x];
        winner[x] = wins ? number : winner[x];
        best[x] = wins ? row[x] : best[x];
      }
    }
    std::fill(sum.begin(), sum.end(), 0.0F);
    for (int channel = 0; channel < scores.channels; ++channel) {
      const float* row = &rows[columns * static_cast<std::size_t>(channel)];
      if (kind == OutputKind::logits)
        for (std::size_t x = 0; x < columns; ++x) sum[x] += exponential(row[x] - best[x]);
      else
        for (std::size_t x = 0; x < columns; ++x) sum[x] += std::max(row[x], 0.0F);
    }
    auto* label = result.labels.ptr<std::uint8_t>(y);
    auto* confidence = result.confidence.ptr<std::uint8_t>(y);
    for (std::size_t x = 0; x < columns; ++x) {
      const float share = kind == OutputKind::logits ? 1.0F : std::max(best[x], 0.0F);
      label[x] = static_cast<std::uint8_t>(winner[x]);
      confidence[x] = to_byte(std::min(share / std::max(sum[x], 1e-6F), 1.0F));
    }
  }
}

void decode_labels(const Scores& scores, const OutputForm& form, cv::Mat& labels) {
  std::vector<int> column(static_cast<std::size_t>(labels.cols));
  for (int x = 0; x < labels.cols; ++x)
    column[static_cast<std::size_t>(x)] = (2 * x + 1) * scores.width / (2 * labels.cols);
  for (int y = 0; y < labels.rows; ++y) {
    const float* from = scores.row(0, (2 * y + 1) * scores.height / (2 * labels.rows));
    auto* to = labels.ptr<std::uint8_t>(y);
    for (int x = 0; x < labels.cols; ++x) {
      const float value = from[column[static_cast<std::size_t>(x)] * scores.pixel_step];
      const bool is_label = value >= 0.0F && value <= 255.0F && value == std::floor(value) &&
                            (value < static_cast<float>(form.classes) || value == 255.0F);
      if (!is_label)
        fail(form, "gives the label " + std::to_string(value) + "; expected whole numbers from 0 to " +
                       std::to_string(form.classes - 1) + ", for the names in `classes`, or 255; is `output` right?");
      to[x] = static_cast<std::uint8_t>(value);
    }
  }
}

}  // namespace

void check_output_kind(const OnnxTensor& output, const OutputForm& form) {
  if (form.kind == OutputKind::labels) return;
  const std::string& last = output.computed_by;
  const std::string name = "gives in its output '" + output.name + "' ";
  const bool is_choice = last == "ArgMax" || last == "ArgMin" || last == "Greater" || last == "GreaterOrEqual" ||
                         last == "Less" || last == "LessOrEqual";
  if (is_choice) refuse_labels(form, name + "labels, which its layer " + last + " has chosen");
  if (is_whole_number(output.element_type)) refuse_labels(form, name + "whole numbers, which are labels and no scores");
  if (form.kind == OutputKind::logits && (last == "Sigmoid" || last == "Softmax"))
    fail(form, name + "probabilities, because " + last +
                   " is the last layer that computes; expected scores before it "
                   "for `output: logits`; set `output: probabilities`");
}

Segmentation decode_segmentation(const cv::Mat& output, const OutputForm& form, int width, int height) {
  const Scores scores = read_shape(output, form);
  check_values(output, static_cast<std::size_t>(scores.width) * static_cast<std::size_t>(scores.height), form);
  Segmentation result;
  result.labels.create(height, width, CV_8UC1);
  if (form.kind == OutputKind::labels) {
    decode_labels(scores, form, result.labels);
    return result;
  }
  result.confidence.create(height, width, CV_8UC1);
  if (form.classes == 2)
    decode_binary(scores, form.kind, result);
  else
    decode_classes(scores, form.kind, result);
  return result;
}

}  // namespace holdfast
