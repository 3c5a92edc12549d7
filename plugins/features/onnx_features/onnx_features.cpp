// SPDX-License-Identifier: BSD-3-Clause
#include "onnx_features.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "holdfast/core/error.hpp"
#include "holdfast/core/size_text.hpp"

namespace holdfast::onnx_features_plugin {

namespace {

constexpr const char* expected_input = "expected one input, 1 x 1 x height x width or 1 x 3 x height x width";
constexpr const char* advice = "expected a network for such an image; check `width` and `height`";

}  // namespace

OnnxFeatures::OnnxFeatures(const OnnxFeaturesSettings& settings, const CreationContext&)
    : settings_(settings), net_({settings.model}) {
  choose_input();
  choose_descriptors();
  output_names_ = {settings.scores, settings.descriptors};
  net_.output(settings.scores, "scores");
  if (!settings.keypoints.empty()) {
    net_.output(settings.keypoints, "keypoints");
    output_names_.push_back(settings.keypoints);
  }
  const int shape[] = {1, channels_, height_, width_};
  input_.create(4, shape, CV_32F);
  net_.load({.inputs = {{net_.signature().inputs.front().name, {1, channels_, height_, width_}}},
             .outputs = output_names_,
             .advice = advice});
}

void OnnxFeatures::fail(const std::string& message) const { throw InputError({settings_.model.string()}, message); }

void OnnxFeatures::choose_input() {
  const OnnxSignature& signature = net_.signature();
  if (signature.inputs.size() != 1) fail("has the inputs " + names(signature.inputs) + "; " + expected_input);
  const OnnxTensor& input = signature.inputs.front();
  std::vector<std::int64_t> shape = input.shape;
  if (shape.empty()) shape = {1, 1, -1, -1};
  if (shape.size() != 4 || (shape[0] != 1 && shape[0] != -1) || (shape[1] != 1 && shape[1] != 3 && shape[1] != -1))
    fail("has an input of " + input.shape_text() + "; " + expected_input);
  channels_ = shape[1] == 3 ? 3 : 1;
  height_ = net_.agreed_size(input, settings_.height, shape[2], "height");
  width_ = net_.agreed_size(input, settings_.width, shape[3], "width");
}

void OnnxFeatures::choose_descriptors() {
  const OnnxTensor& output = net_.output(settings_.descriptors, "descriptors");
  const bool is_map = settings_.keypoints.empty();
  const std::size_t dimensions = output.shape.size();
  std::int64_t length = -1;
  if (is_map && dimensions == 4) length = output.shape[1];
  if (!is_map && (dimensions == 2 || dimensions == 3)) length = output.shape[dimensions - 1];
  if (length < 1)
    fail("declares descriptors of " + output.shape_text() + "; expected " +
         (is_map ? "1 x length x rows x columns, with a fixed length"
                 : "n x length or 1 x n x length, with a fixed length"));
  type_.kind = DescriptorKind::float32;
  type_.metric = settings_.metric == NumberMetric::cosine ? DescriptorMetric::cosine : DescriptorMetric::euclidean;
  type_.length = static_cast<std::uint32_t>(length);
  type_.strict_distance = static_cast<float>(settings_.strict_distance);
  type_.loose_distance = static_cast<float>(std::max(settings_.loose_distance, settings_.strict_distance));
  if (const std::string trouble = trouble_of(type_); !trouble.empty()) fail("descriptors: " + trouble);
}

void OnnxFeatures::fill_input(const cv::Mat& grey) {
  const cv::Mat* image = &grey;
  if (grey.cols != width_ || grey.rows != height_) {
    const bool shrinks = grey.cols >= width_ && grey.rows >= height_;
    cv::resize(grey, resized_, {width_, height_}, 0, 0, shrinks ? cv::INTER_AREA : cv::INTER_LINEAR);
    image = &resized_;
  }
  for (int channel = 0; channel < channels_; ++channel) {
    cv::Mat plane(height_, width_, CV_32FC1, input_.ptr<float>(0, channel));
    image->convertTo(plane, CV_32F, settings_.scale, settings_.offset);
  }
}

std::vector<HeatPoint> OnnxFeatures::find_keypoints() const {
  const cv::Mat heat = heat_map_of(outputs_[0]);
  if (heat.empty() || heat.cols != width_ || heat.rows != height_)
    fail("gives scores that are no map of the input's " + size_text(width_, height_) +
         " pixels; expected 1 x 1 x height x width, or cells as SuperPoint has them; correct `scores`, or name "
         "`keypoints`");
  return keypoints_of(heat, {.threshold = static_cast<float>(settings_.threshold),
                             .suppression_radius = settings_.suppression_radius,
                             .border = settings_.border,
                             .subpixel = settings_.subpixel,
                             .count = static_cast<std::size_t>(std::lround(settings_.count * budget_))});
}

std::vector<HeatPoint> OnnxFeatures::read_keypoints() const {
  const cv::Mat &scores = outputs_[0], &descriptors = outputs_[1], &keypoints = outputs_[2];
  const std::size_t count = scores.total();
  if (keypoints.total() != 2 * count || descriptors.total() != count * type_.length)
    fail("gives " + std::to_string(count) + " scores, " + std::to_string(keypoints.total()) +
         " numbers of keypoints and " + std::to_string(descriptors.total()) + " of descriptors; expected 2 and " +
         std::to_string(type_.length) + " for each score");
  std::vector<HeatPoint> points(count);
  for (std::size_t i = 0; i < count; ++i)
    points[i] = {keypoints.ptr<float>()[2 * i], keypoints.ptr<float>()[2 * i + 1], scores.ptr<float>()[i]};
  return points;
}

bool OnnxFeatures::describe(const HeatPoint& point, std::size_t i, std::span<float> descriptor) const {
  const cv::Mat& output = outputs_[1];
  if (!settings_.keypoints.empty()) {
    const float* row = output.ptr<float>() + i * type_.length;
    std::copy_n(row, type_.length, descriptor.begin());
  } else {
    // Centres of pixels correspond: a pixel of the map covers several of the input.
    const int rows = output.size[2], columns = output.size[3];
    const float step_x = static_cast<float>(columns) / static_cast<float>(width_);
    const float step_y = static_cast<float>(rows) / static_cast<float>(height_);
    const float x = std::clamp((point.x + 0.5F) * step_x - 0.5F, 0.0F, static_cast<float>(columns - 1));
    const float y = std::clamp((point.y + 0.5F) * step_y - 0.5F, 0.0F, static_cast<float>(rows - 1));
    const int left = std::min(static_cast<int>(x), std::max(columns - 2, 0)), right = std::min(left + 1, columns - 1);
    const int above = std::min(static_cast<int>(y), std::max(rows - 2, 0)), below = std::min(above + 1, rows - 1);
    const float to_right = x - static_cast<float>(left), down = y - static_cast<float>(above);
    for (std::uint32_t c = 0; c < type_.length; ++c) {
      const float* upper = output.ptr<float>(0, static_cast<int>(c), above);
      const float* lower = output.ptr<float>(0, static_cast<int>(c), below);
      descriptor[c] = (1.0F - down) * ((1.0F - to_right) * upper[left] + to_right * upper[right]) +
                      down * ((1.0F - to_right) * lower[left] + to_right * lower[right]);
    }
  }
  double squares = 0.0;
  for (const float number : descriptor) squares += static_cast<double>(number) * number;
  if (!std::isfinite(squares)) return false;
  if (type_.metric != DescriptorMetric::cosine) return true;
  if (!(squares > 1e-20)) return false;
  const auto scale = static_cast<float>(1.0 / std::sqrt(squares));
  for (float& number : descriptor) number *= scale;
  return true;
}

void OnnxFeatures::extract(const cv::Mat& grey, const cv::Mat& ignore, Features& out) {
  HOLDFAST_CHECK(grey.empty() || grey.type() == CV_8UC1, "image type " << grey.type() << ", expected 8UC1");
  HOLDFAST_CHECK(ignore.empty() || (ignore.type() == CV_8UC1 && ignore.size() == grey.size()),
                 "mask " << ignore.cols << " x " << ignore.rows << " type " << ignore.type() << ", image " << grey.cols
                         << " x " << grey.rows);
  out.resize(0, type_);
  if (grey.cols < 2 || grey.rows < 2) return;
  fill_input(grey);
  net_.set_input(input_, net_.signature().inputs.front().name);
  net_.run(outputs_);
  const bool is_map = settings_.keypoints.empty();
  if (is_map && (outputs_[1].dims != 4 || outputs_[1].size[1] != static_cast<int>(type_.length)))
    fail("gives descriptors of another shape than it declares; correct `descriptors`");
  const std::vector<HeatPoint> points = is_map ? find_keypoints() : read_keypoints();

  const float scale_x = static_cast<float>(grey.cols) / static_cast<float>(width_);
  const float scale_y = static_cast<float>(grey.rows) / static_cast<float>(height_);
  const auto count = static_cast<std::size_t>(std::lround(settings_.count * budget_));
  std::size_t kept = 0;
  for (std::size_t i = 0; i < points.size() && kept < count; ++i) {
    const float x = (points[i].x + 0.5F) * scale_x - 0.5F, y = (points[i].y + 0.5F) * scale_y - 0.5F;
    const auto column = static_cast<int>(std::lround(x)), row = static_cast<int>(std::lround(y));
    if (!(points[i].score >= static_cast<float>(settings_.threshold)) || !std::isfinite(points[i].score) ||
        column < 0 || row < 0 || column >= grey.cols || row >= grey.rows)
      continue;
    if (!ignore.empty() && ignore.at<std::uint8_t>(row, column) != 0) continue;
    out.resize(kept + 1);
    if (!describe(points[i], i, out.descriptors.numbers(kept))) continue;
    out.x[kept] = x, out.y[kept] = y, out.response[kept] = points[i].score;
    out.angle[kept] = 0.0F, out.octave[kept] = 0;
    ++kept;
  }
  out.resize(kept);
}

}  // namespace holdfast::onnx_features_plugin
