// SPDX-License-Identifier: BSD-3-Clause
#include "global_detector.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "holdfast/core/error.hpp"
#include "holdfast/inference/network_parameters.hpp"

namespace holdfast::global_plugin {

namespace {

/// Less of an image than this says too little about the place.
constexpr double least_visible_share = 0.1;

}  // namespace

GlobalDetector::GlobalDetector(const GlobalSettings& settings, const CreationContext&)
    : settings_(settings), network_(network_options(settings)) {
  const cv::Mat grey(network_.height(), network_.width(), CV_8UC3, cv::Scalar::all(128));
  type_.kind = DescriptorKind::float32;
  type_.metric = DescriptorMetric::cosine;
  type_.length = static_cast<std::uint32_t>(network_.run(grey).total());
  type_.strict_distance = static_cast<float>((1.0 - settings.minimum_similarity) / 2.0);
  type_.loose_distance = static_cast<float>(1.0 - settings.minimum_similarity);
  if (const std::string trouble = trouble_of(type_); !trouble.empty())
    throw InputError({settings.model.string()},
                     "gives " + std::to_string(type_.length) + " numbers: " + trouble +
                         "; expected a network that describes an image by one vector; check `output_name`");
  distances_.emplace(type_);
  vectors_.reset(type_, 0);
}

DescriptorBlock GlobalDetector::vector_of(const cv::Mat& colour) {
  const cv::Mat output = network_.run(colour);
  HOLDFAST_CHECK(output.total() == type_.length, "output of " << output.total() << " numbers, not " << type_.length);
  const auto* numbers = output.ptr<float>();
  double squares = 0.0;
  for (std::uint32_t i = 0; i < type_.length; ++i) squares += static_cast<double>(numbers[i]) * numbers[i];
  if (!std::isfinite(squares))
    throw InputError({settings_.model.string()},
                     "gives numbers that are not finite for an image; check `scale`, `mean` and `standard_deviation`");
  DescriptorBlock block(type_);
  if (!(squares > 1e-20)) return block;
  block.resize(1);
  const double scale = 1.0 / std::sqrt(squares);
  const std::span<float> vector = block.numbers(0);
  for (std::size_t i = 0; i < vector.size(); ++i) vector[i] = static_cast<float>(numbers[i] * scale);
  return block;
}

DescriptorBlock GlobalDetector::describe(const cv::Mat& image, const cv::Mat& moving) {
  HOLDFAST_CHECK(!image.empty() && (image.type() == CV_8UC1 || image.type() == CV_8UC3), "image type " << image.type());
  HOLDFAST_CHECK(moving.empty() || (moving.type() == CV_8UC1 && moving.size() == image.size()),
                 "mask " << moving.cols << " x " << moving.rows << " type " << moving.type() << ", image " << image.cols
                         << " x " << image.rows);
  cv::Mat colour = image;
  if (image.channels() == 1) cv::cvtColor(image, colour, cv::COLOR_GRAY2BGR);
  if (moving.empty() || cv::countNonZero(moving) == 0) return vector_of(colour);
  const cv::Mat still = moving == 0;
  if (cv::countNonZero(still) < least_visible_share * static_cast<double>(still.total())) return DescriptorBlock(type_);
  const cv::Scalar mean = cv::mean(colour, still);
  colour = colour.clone();
  colour.setTo(mean, moving);
  return vector_of(colour);
}

void GlobalDetector::check(const DescriptorView& descriptors) const {
  HOLDFAST_CHECK(descriptors.empty() || (descriptors.size() == 1 && descriptors.type().is_comparable(type_)),
                 descriptors.size() << " descriptors of " << to_string(descriptors.type())
                                    << "; expected at most one of " << to_string(type_));
}

void GlobalDetector::add(KeyFrameId keyframe, const DescriptorView& descriptors) {
  check(descriptors);
  HOLDFAST_CHECK(std::find(keyframes_.begin(), keyframes_.end(), keyframe) == keyframes_.end(),
                 "keyframe " << keyframe.slot << " is in the database");
  keyframes_.push_back(keyframe);
  has_vector_.push_back(descriptors.empty() ? 0 : 1);
  vectors_.resize(keyframes_.size());
  if (!descriptors.empty()) std::copy_n(descriptors.row(0), descriptors.units(), vectors_.row(keyframes_.size() - 1));
}

void GlobalDetector::remove(KeyFrameId keyframe) {
  const auto found = std::find(keyframes_.begin(), keyframes_.end(), keyframe);
  if (found == keyframes_.end()) return;
  const auto place = static_cast<std::size_t>(found - keyframes_.begin()), last = keyframes_.size() - 1;
  keyframes_[place] = keyframes_[last];
  has_vector_[place] = has_vector_[last];
  if (place != last) std::copy_n(vectors_.row(last), vectors_.view().units(), vectors_.row(place));
  keyframes_.pop_back();
  has_vector_.pop_back();
  vectors_.resize(last);
}

std::vector<PlaceMatch> GlobalDetector::query(const DescriptorView& descriptors, int max_count) const {
  check(descriptors);
  std::vector<PlaceMatch> matches;
  if (descriptors.empty() || keyframes_.empty() || max_count < 1) return matches;
  std::vector<float> distances(keyframes_.size());
  distances_->of_rows(descriptors.row(0), vectors_.row(0), keyframes_.size(), distances.data());
  const double least = settings_.minimum_similarity;
  for (std::size_t i = 0; i < keyframes_.size(); ++i) {
    const double similarity = 1.0 - static_cast<double>(distances[i]);
    if (has_vector_[i] != 0 && similarity >= least)
      matches.push_back({keyframes_[i], (similarity - least) / (1.0 - least)});
  }
  const auto is_better = [](const PlaceMatch& a, const PlaceMatch& b) {
    return a.score > b.score || (a.score == b.score && a.keyframe < b.keyframe);
  };
  const std::size_t count = std::min(matches.size(), static_cast<std::size_t>(max_count));
  std::partial_sort(matches.begin(), matches.begin() + static_cast<std::ptrdiff_t>(count), matches.end(), is_better);
  matches.resize(count);
  return matches;
}

}  // namespace holdfast::global_plugin
