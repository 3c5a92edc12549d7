// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/inference/segmentation_output.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/core.hpp>

#include "holdfast/core/error.hpp"
#include "holdfast/core/random.hpp"

namespace holdfast {
namespace {

using testing::HasSubstr;

/// Scores of every class at every pixel, in either layout.
struct Output {
  int channels, height, width;
  bool channels_last;
  cv::Mat data;

  Output(int c, int h, int w, bool last) : channels(c), height(h), width(w), channels_last(last) {
    const int first[] = {1, c, h, w}, last_sizes[] = {1, h, w, c};
    data = cv::Mat(4, last ? last_sizes : first, CV_32F, cv::Scalar(0));
  }
  float& at(int c, int y, int x) {
    const int first[] = {0, c, y, x}, last[] = {0, y, x, c};
    return data.at<float>(channels_last ? last : first);
  }
  /// Bilinear, by definition.
  double resized(int c, int y, int x, int to_height, int to_width) {
    const double sy = std::clamp((y + 0.5) * height / to_height - 0.5, 0.0, height - 1.0);
    const double sx = std::clamp((x + 0.5) * width / to_width - 0.5, 0.0, width - 1.0);
    double sum = 0.0;
    for (int v = 0; v < height; ++v)
      for (int u = 0; u < width; ++u)
        sum += std::max(0.0, 1.0 - std::abs(sy - v)) * std::max(0.0, 1.0 - std::abs(sx - u)) * at(c, v, u);
    return sum;
  }
};

OutputForm form_of(const Output& output, OutputKind kind, int classes) {
  return {kind, output.channels_last, classes, "net.onnx"};
}

void fill(Output& output, std::uint64_t seed, double size) {
  Random random(seed);
  for (int c = 0; c < output.channels; ++c)
    for (int y = 0; y < output.height; ++y)
      for (int x = 0; x < output.width; ++x) output.at(c, y, x) = static_cast<float>(random.uniform(-size, size));
}

TEST(SegmentationOutput, LogitsAreResizedThenChosenAndWeighed) {
  constexpr int width = 23, height = 17;
  for (const bool last : {false, true})
    for (const int channels : {1, 2, 3, 21}) {
      Output output(channels, 5, 7, last);
      fill(output, 3, 6.0);
      const int classes = std::max(channels, 2);
      const Segmentation result =
          decode_segmentation(output.data, form_of(output, OutputKind::logits, classes), width, height);
      ASSERT_EQ(result.labels.type(), CV_8UC1);
      ASSERT_EQ(result.confidence.size(), cv::Size(width, height));
      for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
          std::vector<double> scores;
          if (channels == 1) scores.push_back(0.0);
          for (int c = 0; c < channels; ++c) scores.push_back(output.resized(c, y, x, height, width));
          double sum = 0.0;
          const auto best = std::max_element(scores.begin(), scores.end());
          for (const double score : scores) sum += std::exp(score - *best);
          std::vector<double> sorted = scores;
          std::sort(sorted.rbegin(), sorted.rend());
          if (sorted[0] - sorted[1] > 1e-4) {
            EXPECT_EQ(result.labels.at<std::uint8_t>(y, x), best - scores.begin());
          }
          EXPECT_NEAR(result.confidence.at<std::uint8_t>(y, x), 255.0 / sum, 0.51) << channels;
        }
    }
}

TEST(SegmentationOutput, ProbabilitiesKeepTheirShare) {
  Output two(2, 1, 2, false), one(1, 1, 2, false), three(3, 1, 2, true);
  const float foreground[] = {0.2F, 0.9F};
  for (int x = 0; x < 2; ++x) {
    two.at(0, 0, x) = 1.0F - foreground[x];
    two.at(1, 0, x) = one.at(0, 0, x) = foreground[x];
    three.at(0, 0, x) = 0.1F;
    three.at(2, 0, x) = 0.9F;
  }
  for (Output* output : {&one, &two}) {
    const Segmentation result = decode_segmentation(output->data, form_of(*output, OutputKind::probabilities, 2), 2, 1);
    EXPECT_EQ(result.labels.at<std::uint8_t>(0, 0), 0);
    EXPECT_EQ(result.labels.at<std::uint8_t>(0, 1), 1);
    EXPECT_EQ(result.confidence.at<std::uint8_t>(0, 0), 204);
    EXPECT_EQ(result.confidence.at<std::uint8_t>(0, 1), 230);
  }
  const Segmentation result = decode_segmentation(three.data, form_of(three, OutputKind::probabilities, 3), 2, 1);
  EXPECT_EQ(result.labels.at<std::uint8_t>(0, 0), 2);
  EXPECT_EQ(result.confidence.at<std::uint8_t>(0, 0), 230);
}

TEST(SegmentationOutput, LabelsTakeTheNearestPixel) {
  Output output(1, 2, 2, false);
  output.at(0, 0, 1) = 2.0F;
  output.at(0, 1, 0) = 255.0F;
  const Segmentation result = decode_segmentation(output.data, form_of(output, OutputKind::labels, 3), 4, 6);
  for (int y = 0; y < 6; ++y)
    for (int x = 0; x < 4; ++x)
      EXPECT_EQ(result.labels.at<std::uint8_t>(y, x), y < 3 ? (x < 2 ? 0 : 2) : (x < 2 ? 255 : 0)) << x << ' ' << y;
  EXPECT_TRUE(result.confidence.empty());
}

TEST(SegmentationOutput, EqualScoresGoToTheFirst) {
  for (const int channels : {1, 2, 5}) {
    Output output(channels, 2, 2, false);
    const Segmentation result =
        decode_segmentation(output.data, form_of(output, OutputKind::logits, std::max(channels, 2)), 2, 2);
    EXPECT_EQ(cv::countNonZero(result.labels), 0) << channels;
    EXPECT_EQ(result.confidence.at<std::uint8_t>(0, 0), std::lround(255.0 / std::max(channels, 2)));
  }
}

std::string problem(const cv::Mat& output, const OutputForm& form) {
  try {
    decode_segmentation(output, form, 8, 8);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(SegmentationOutput, LabelsInPlaceOfScoresAreRecognised) {
  Output output(1, 12, 10, false);
  for (int x = 0; x < 10; ++x) output.at(0, 3, x) = 7.0F;
  EXPECT_THAT(problem(output.data, form_of(output, OutputKind::logits, 2)),
              HasSubstr("gives whole numbers from 0 to 7, which are labels and no scores; expected scores for `output: "
                        "logits`; set `output: labels`"));
  EXPECT_THAT(problem(output.data, form_of(output, OutputKind::probabilities, 2)), HasSubstr("set `output: labels`"));
  output.at(0, 11, 9) = 0.25F;
  EXPECT_EQ(problem(output.data, form_of(output, OutputKind::logits, 2)), "no error");
  output.at(0, 11, 9) = -1.0F;
  EXPECT_EQ(problem(output.data, form_of(output, OutputKind::logits, 2)), "no error");
}

TEST(SegmentationOutput, ShapesOfImages) {
  const auto problem_of = [](std::vector<int> sizes, int width, int height, int classes = 2) {
    const cv::Mat data(static_cast<int>(sizes.size()), sizes.data(), CV_32F, cv::Scalar(0));
    return problem(data, {OutputKind::logits, false, classes, "net.onnx", width, height});
  };
  // Strides with and without padding, U-Nets without padding, a portrait input.
  EXPECT_EQ(problem_of({1, 2, 65, 65}, 513, 513), "no error");
  EXPECT_EQ(problem_of({1, 1, 388, 228}, 412, 572), "no error");
  EXPECT_EQ(problem_of({1, 15, 20}, 640, 480), "no error");
  EXPECT_EQ(problem_of({1, 2, 1, 2}, 64, 48), "no error");
  EXPECT_EQ(problem_of({1, 2, 40, 12}, 384, 1248), "no error");
  for (const std::vector<int>& boxes :
       std::vector<std::vector<int>>{{1, 84, 8400}, {1, 116, 8400}, {1, 25200, 85}, {1, 300, 6}, {1, 1, 200, 7}})
    EXPECT_THAT(problem_of(boxes, 640, 640), HasSubstr("boxes of a detector"));
  EXPECT_THAT(problem_of({1, 1000}, 224, 224), HasSubstr("scores of the whole image, 1000"));
  EXPECT_THAT(problem_of({1, 2, 1, 1}, 224, 224), HasSubstr("scores of the whole image, 2"));
  EXPECT_THAT(problem_of({1, 480, 640, 3}, 640, 480, 3), HasSubstr("correct `classes`, `output`, `output_name` or"));
}

TEST(SegmentationOutput, SaysWhatWasFoundAndExpected) {
  Output output(3, 4, 5, false);
  EXPECT_EQ(problem(output.data, form_of(output, OutputKind::logits, 21)),
            "net.onnx: gives an output of 1x3x4x5; expected 1 x 21 x height x width for the 21 names in `classes`; "
            "correct `classes`, `output`, `output_name` or `layout`");
  EXPECT_THAT(problem(output.data, form_of(output, OutputKind::logits, 2)), HasSubstr("1 x 2 (or 1) x height x width"));
  EXPECT_THAT(problem(output.data, form_of(output, OutputKind::labels, 3)), HasSubstr("expected 1 x 1 x height"));
  EXPECT_THAT(problem(output.data, {OutputKind::logits, true, 3, "net.onnx"}), HasSubstr("height x width x 3"));
  const int batch[] = {2, 3, 4, 5};
  EXPECT_THAT(problem(cv::Mat(4, batch, CV_32F, cv::Scalar(0)), form_of(output, OutputKind::logits, 3)),
              HasSubstr("2x3x4x5"));
  output.at(1, 2, 3) = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THAT(problem(output.data, form_of(output, OutputKind::logits, 3)), HasSubstr("not finite"));
  output.at(1, 2, 3) = -2.5F;
  EXPECT_THAT(problem(output.data, form_of(output, OutputKind::probabilities, 3)),
              HasSubstr("from -2.500000 to 0.000000; expected probabilities"));
  Output labels(1, 2, 2, false);
  for (const float wrong : {3.0F, 0.5F, -1.0F}) {
    labels.at(0, 1, 1) = wrong;
    EXPECT_THAT(problem(labels.data, form_of(labels, OutputKind::labels, 3)), HasSubstr("expected whole numbers"));
  }
}

}  // namespace
}  // namespace holdfast
