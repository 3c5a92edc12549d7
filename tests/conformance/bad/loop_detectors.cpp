// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <atomic>
#include <limits>

#include "bad/faulty.hpp"
#include "holdfast/core/error.hpp"
#include "holdfast/interfaces/loop_detector.hpp"

extern "C" void holdfast_register_plugin_flann(holdfast::Registry&);

namespace holdfast::bad {

namespace {

std::atomic<int> calls = 0;

/// The mean colour of every cell of 40 x 40 pixels, as bits of which the more are set, the brighter it is.
DescriptorBlock mean_colours(const cv::Mat& image, const cv::Mat& moving) {
  constexpr int cell = 40, bits_of_channel = 64;
  DescriptorBlock block;
  for (int top = 0; top + cell <= image.rows; top += cell)
    for (int left = 0; left + cell <= image.cols; left += cell) {
      const cv::Rect where(left, top, cell, cell);
      Descriptor256 descriptor;
      for (int channel = 0; channel < image.channels(); ++channel) {
        int sum = 0, count = 0;
        for (int y = where.y; y < where.br().y; ++y)
          for (int x = where.x; x < where.br().x; ++x) {
            if (!moving.empty() && moving.at<std::uint8_t>(y, x) != 0) continue;
            sum += image.ptr<std::uint8_t>(y)[x * image.channels() + channel];
            ++count;
          }
        const int bits = count == 0 ? 0 : sum * bits_of_channel / (255 * count);
        for (int bit = 0; bit < bits; ++bit)
          descriptor.words[static_cast<std::size_t>(channel)] |= std::uint64_t{1} << bit;
      }
      block.push_back(descriptor);
    }
  return block;
}

class FaultyLoopDetector final : public LoopDetector {
 public:
  FaultyLoopDetector(std::string fault, const CreationContext& context)
      : fault_(std::move(fault)),
        flann_(sound_module<LoopDetector>(holdfast_register_plugin_flann, "flann", context,
                                          is_of_images() ? ParameterValues{{"radius", 8.0}} : ParameterValues{})) {}

  // Those whose names begin with "image" describe images.
  std::optional<DescriptorType> image_descriptor() const override {
    return is_of_images() ? std::optional(DescriptorType()) : std::nullopt;
  }
  DescriptorBlock describe(const cv::Mat& image, const cv::Mat& moving) override {
    DescriptorBlock block = mean_colours(image, fault_ == "image_with_people" ? cv::Mat() : moving);
    if (fault_ == "image_of_a_mood") block.row(0)->words[3] = ++descriptions_;
    if (fault_ == "image_of_numbers") return DescriptorBlock({DescriptorKind::float32, DescriptorMetric::cosine, 8}, 1);
    return block;
  }

  void add(KeyFrameId keyframe, const DescriptorView& descriptors) override {
    if (fault_ == "needs_descriptors" && descriptors.empty()) __builtin_trap();
    known_.push_back(keyframe);
    flann_->add(keyframe, descriptors);
  }
  void remove(KeyFrameId keyframe) override {
    const bool is_known = std::find(known_.begin(), known_.end(), keyframe) != known_.end();
    if (fault_ == "strict" && !is_known) throw PluginError("this keyframe is not known");
    if (fault_ == "never_forgets") return;
    std::erase(known_, keyframe);
    flann_->remove(keyframe);
  }
  std::vector<PlaceMatch> query(const DescriptorView& descriptors, int max_count) const override {
    if (fault_ == "blind") return {};
    auto matches = flann_->query(descriptors, fault_ == "generous" ? 1000 : max_count);
    ++queries_;
    if (matches.empty()) return matches;
    if (fault_ == "worst_first") std::reverse(matches.begin(), matches.end());
    if (fault_ == "twice" && static_cast<int>(matches.size()) < max_count) matches.push_back(matches.back());
    if (fault_ == "no_number") matches[0].score = std::numeric_limits<double>::quiet_NaN();
    if (fault_ == "learns_by_asking") matches[0].score += 1e-6 * queries_;
    if (fault_ == "counts_calls") matches[0].score += 1e-6 * ++calls;
    return matches;
  }

 private:
  bool is_of_images() const { return fault_.starts_with("image"); }

  std::string fault_;
  std::unique_ptr<LoopDetector> flann_;
  std::vector<KeyFrameId> known_;
  mutable int queries_ = 0;
  std::uint64_t descriptions_ = 0;
};

}  // namespace

void add_loop_detectors(Registry& registry) {
  add_faults<LoopDetector, FaultyLoopDetector>(
      registry, {"sound", "needs_descriptors", "strict", "never_forgets", "blind", "generous", "worst_first", "twice",
                 "no_number", "learns_by_asking", "counts_calls", "image", "image_with_people", "image_of_a_mood",
                 "image_of_numbers"});
}

}  // namespace holdfast::bad
