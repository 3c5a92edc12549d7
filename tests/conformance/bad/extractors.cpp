// SPDX-License-Identifier: BSD-3-Clause
#include <atomic>
#include <cmath>
#include <limits>

#include "bad/faulty.hpp"
#include "holdfast/core/error.hpp"
#include "holdfast/interfaces/feature_extractor.hpp"

extern "C" void holdfast_register_plugin_orb(holdfast::Registry&);

namespace holdfast::bad {

namespace {

std::atomic<int> calls = 0;

class FaultyExtractor final : public FeatureExtractor {
 public:
  FaultyExtractor(std::string fault, const CreationContext& context)
      : fault_(std::move(fault)), orb_(sound_module<FeatureExtractor>(holdfast_register_plugin_orb, "orb", context)) {}

  void extract(const cv::Mat& grey, const cv::Mat& ignore, Features& out) override {
    if (fault_ == "refuses_tiny" && !grey.empty() && grey.total() < 9)
      throw InputError({"image"}, "is too small; expected more");
    if (fault_ == "crashes" && grey.total() == 1) __builtin_trap();
    Features before;
    if (fault_ == "appends") before = out;
    const bool takes_rows_as_contiguous = fault_ == "ignores_gaps" && !grey.empty();
    const cv::Mat seen =
        takes_rows_as_contiguous ? cv::Mat(grey.rows, grey.cols, CV_8UC1, const_cast<std::uint8_t*>(grey.data)) : grey;
    orb_->extract(seen, fault_ == "ignores_ignore" ? cv::Mat() : ignore, out);
    if (fault_ == "appends") out.x.insert(out.x.end(), before.x.begin(), before.x.end());
    if (fault_ == "writes" && !grey.empty()) const_cast<std::uint8_t*>(grey.data)[0] ^= 255;
    if (out.empty()) return;
    if (fault_ == "outside") out.x[0] = static_cast<float>(grey.cols) + 5.0F;
    if (fault_ == "short_array") out.angle.pop_back();
    if (fault_ == "degrees") out.angle[0] = 270.0F;
    if (fault_ == "no_number") out.response[0] = std::numeric_limits<float>::quiet_NaN();
    if (fault_ == "high_octave") out.octave[0] = 200;
    if (fault_ == "counts_calls") out.response[0] += static_cast<float>(++calls);
    if (fault_ == "blind") out.clear();
    if (fault_ == "grows") pyramid_ = ScalePyramid(pyramid_.levels() + 1, 1.2);
  }
  const ScalePyramid& pyramid() const override { return pyramid_; }

 private:
  std::string fault_;
  std::unique_ptr<FeatureExtractor> orb_;
  ScalePyramid pyramid_;
};

}  // namespace

void add_extractors(Registry& registry) {
  add_faults<FeatureExtractor, FaultyExtractor>(
      registry, {"sound", "refuses_tiny", "crashes", "appends", "ignores_gaps", "ignores_ignore", "writes", "outside",
                 "short_array", "degrees", "no_number", "high_octave", "counts_calls", "blind", "grows"});
}

}  // namespace holdfast::bad
