// SPDX-License-Identifier: BSD-3-Clause
#include "onnx_matcher.hpp"

#include <algorithm>
#include <cstring>
#include <opencv2/core.hpp>

#include "assignment.hpp"
#include "holdfast/core/descriptor_distance.hpp"
#include "holdfast/core/error.hpp"

namespace holdfast::onnx_matcher_plugin {

OnnxMatcher::OnnxMatcher(const OnnxMatcherSettings& settings, const CreationContext&)
    : settings_(settings), net_({settings.model}) {
  queries_.keypoints_name = settings.keypoints0, queries_.descriptors_name = settings.descriptors0;
  references_.keypoints_name = settings.keypoints1, references_.descriptors_name = settings.descriptors1;
  net_.output(settings.scores, "scores");
  choose_inputs();
  for (Half* half : {&queries_, &references_}) {
    const int of_keypoints[] = {1, count_, 2}, of_descriptors[] = {1, count_, length_};
    half->keypoints.create(3, of_keypoints, CV_32F);
    half->descriptors.create(3, of_descriptors, CV_32F);
  }
  const std::vector<std::int64_t> keypoints = {1, count_, 2}, descriptors = {1, count_, length_};
  net_.load({.inputs = {{settings.keypoints0, keypoints},
                        {settings.descriptors0, descriptors},
                        {settings.keypoints1, keypoints},
                        {settings.descriptors1, descriptors}},
             .outputs = {settings.scores},
             .advice = "expected a network with inputs of a fixed size; check `count`"});
}

void OnnxMatcher::fail(const std::string& message) const { throw InputError({settings_.model.string()}, message); }

void OnnxMatcher::choose_inputs() {
  const auto check = [&](const std::string& name, const std::string& setting, bool is_descriptor) {
    const OnnxTensor& input = net_.input(name, setting);
    const std::string expected = is_descriptor ? "1 x count x length" : "1 x count x 2";
    if (input.shape.size() != 3 || (!is_descriptor && input.shape[2] != 2) || (is_descriptor && input.shape[2] < 1))
      fail("has an input '" + name + "' of " + input.shape_text() + "; expected " + expected);
    const auto declared = static_cast<int>(input.shape[1]);
    const int chosen = settings_.count > 0 ? settings_.count : declared;
    if (chosen < 1) fail("takes any number of features in '" + name + "'; set `count`");
    if (declared > 0 && chosen != declared)
      fail("takes " + std::to_string(declared) + " features in '" + name + "', but `count` is " +
           std::to_string(chosen) + "; leave `count` out");
    if (count_ != 0 && chosen != count_)
      fail("takes different numbers of features of both images; expected one number");
    count_ = chosen;
    if (!is_descriptor) return;
    if (length_ != 0 && length_ != input.shape[2]) fail("takes descriptors of different lengths; expected one length");
    length_ = static_cast<int>(input.shape[2]);
  };
  check(settings_.keypoints0, "keypoints0", false);
  check(settings_.keypoints1, "keypoints1", false);
  check(settings_.descriptors0, "descriptors0", true);
  check(settings_.descriptors1, "descriptors1", true);
}

void OnnxMatcher::fill(const MatchSide& side, Half& half) const {
  half.taken.assign(side.selection.begin(), side.selection.end());
  if (half.taken.size() > static_cast<std::size_t>(count_)) {
    std::stable_sort(half.taken.begin(), half.taken.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return side.response[a] > side.response[b]; });
    half.taken.resize(static_cast<std::size_t>(count_));
    std::sort(half.taken.begin(), half.taken.end());
  }
  half.keypoints.setTo(0.0F);
  half.descriptors.setTo(0.0F);
  const float scale = 2.0F / static_cast<float>(std::max(side.width, side.height));
  const float middle_x = 0.5F * static_cast<float>(side.width - 1),
              middle_y = 0.5F * static_cast<float>(side.height - 1);
  for (std::size_t i = 0; i < half.taken.size(); ++i) {
    const std::uint32_t feature = half.taken[i];
    float* keypoint = half.keypoints.ptr<float>(0, static_cast<int>(i));
    keypoint[0] = (side.x[feature] - middle_x) * scale, keypoint[1] = (side.y[feature] - middle_y) * scale;
    std::memcpy(half.descriptors.ptr<float>(0, static_cast<int>(i)), side.descriptors.row(feature),
                side.descriptors.type().bytes());
  }
}

std::string OnnxMatcher::incompatibility(const DescriptorType& type) const {
  if (type.kind == DescriptorKind::float32 && static_cast<int>(type.length) == length_) return {};
  return "takes descriptors of " + std::to_string(length_) + " float32";
}

void OnnxMatcher::match(const MatchSide& queries, const MatchSide& references, const MatchLimits& limits,
                        std::vector<FeatureMatch>& matches) const {
  const DescriptorType& type = queries.descriptors.type();
  if (queries.x.empty() || references.x.empty()) return NearestMatcher::match(queries, references, limits, matches);
  if (const std::string trouble = incompatibility(type); !trouble.empty())
    fail(trouble + ", and the features have " + to_string(type) +
         "; expected the features that the network was made for");
  matches.clear();
  if (queries.selection.empty() || references.selection.empty()) return;
  const std::lock_guard lock(mutex_);
  fill(queries, queries_);
  fill(references, references_);
  for (const Half* half : {&queries_, &references_}) {
    net_.set_input(half->keypoints, half->keypoints_name);
    net_.set_input(half->descriptors, half->descriptors_name);
  }
  net_.run(outputs_);
  const cv::Mat& output = outputs_.front();
  const int rows = output.dims == 3 ? output.size[1] : 0, columns = output.dims == 3 ? output.size[2] : 0;
  if ((rows != count_ && rows != count_ + 1) || columns != rows)
    fail("gives scores of another shape than 1 x " + std::to_string(count_) + " x " + std::to_string(count_) +
         ", or one row and column more; correct `scores`");

  const cv::Rect used(0, 0, static_cast<int>(references_.taken.size()), static_cast<int>(queries_.taken.size()));
  cv::Mat probabilities = cv::Mat(rows, columns, CV_32FC1, output.data)(used).clone();
  if (settings_.dual_softmax) {
    probabilities.convertTo(probabilities, CV_32F, 1.0 / settings_.temperature);
    dual_softmax(probabilities);
  } else {
    cv::exp(probabilities, probabilities);
  }
  const DescriptorDistances distances(type);
  for (const Assigned& pair : mutual_best(probabilities, static_cast<float>(settings_.threshold))) {
    const std::uint32_t query = queries_.taken[pair.row], reference = references_.taken[pair.column];
    matches.push_back(
        {query, reference, distances.of_two(queries.descriptors.row(query), references.descriptors.row(reference))});
  }
}

}  // namespace holdfast::onnx_matcher_plugin
