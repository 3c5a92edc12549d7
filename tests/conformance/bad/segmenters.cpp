// SPDX-License-Identifier: BSD-3-Clause
#include <atomic>
#include <stdexcept>
#include <thread>

#include "bad/faulty.hpp"
#include "holdfast/core/error.hpp"
#include "holdfast/interfaces/segmenter.hpp"

namespace holdfast::bad {

namespace {

std::atomic<int> calls = 0;

/// Takes bright pixels for people.
class FaultySegmenter final : public Segmenter {
 public:
  FaultySegmenter(std::string fault, const CreationContext&) : fault_(std::move(fault)) {
    if (fault_ == "same_names") classes_[1] = classes_[0];
  }

  const std::vector<std::string>& classes() const override { return classes_; }
  std::vector<std::string> movable() const override { return {fault_ == "movable_stranger" ? "cat" : classes_.back()}; }

  Segmentation segment(const SensorFrame& frame) override {
    const cv::Mat& colour = frame.colour;
    if (colour.empty() && fault_ == "throws_texts") throw std::runtime_error("no image");
    if (colour.empty()) throw InputError({"frame"}, "has no colour image; expected one");
    if (fault_ == "nothing") return {};
    if (fault_ == "one_thread" && std::this_thread::get_id() != thread_) throw PluginError("called by another thread");
    if (fault_ == "needs_depth" && frame.depth.empty()) __builtin_trap();
    cv::Mat labels(colour.size(), CV_8UC1);
    if (fault_ == "one_buffer") {
      if (buffer_.size() != colour.size()) buffer_ = labels;
      labels = buffer_;
    }
    for (int y = 0; y < colour.rows; ++y)
      for (int x = 0; x < colour.cols; ++x)
        labels.at<std::uint8_t>(y, x) = colour.ptr<std::uint8_t>(y)[3 * x + 1] > 120 ? 1 : 0;
    if (fault_ == "stranger") labels.at<std::uint8_t>(0, 0) = 7;
    if (fault_ == "counts_calls") labels.at<std::uint8_t>(0, 0) = static_cast<std::uint8_t>(++calls % 2);
    if (fault_ == "half_size") labels = labels(cv::Rect(0, 0, (labels.cols + 1) / 2, labels.rows)).clone();
    if (fault_ == "wide") labels = cv::Mat(colour.size(), CV_16UC1, cv::Scalar(0));
    if (fault_ == "writes") const_cast<std::uint8_t*>(colour.data)[0] ^= 255;
    if (fault_ == "new_class") classes_.push_back("class " + std::to_string(classes_.size()));
    if (fault_ == "small_confidence") return {labels, cv::Mat(1, 1, CV_8UC1, cv::Scalar(9))};
    if (fault_ == "lost_instance") return {labels, {}, cv::Mat(colour.size(), CV_16UC1, cv::Scalar(2)), {{}}};
    return {labels, {}};
  }

 private:
  std::string fault_;
  std::vector<std::string> classes_{"background", "person"};
  std::thread::id thread_ = std::this_thread::get_id();
  cv::Mat buffer_;
};

}  // namespace

void add_segmenters(Registry& registry) {
  add_faults<Segmenter, FaultySegmenter>(
      registry,
      {"sound", "same_names", "movable_stranger", "throws_texts", "nothing", "one_thread", "needs_depth", "one_buffer",
       "stranger", "counts_calls", "half_size", "wide", "writes", "new_class", "small_confidence", "lost_instance"});
}

}  // namespace holdfast::bad
