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

class FaultyLoopDetector final : public LoopDetector {
 public:
  FaultyLoopDetector(std::string fault, const CreationContext& context)
      : fault_(std::move(fault)),
        flann_(sound_module<LoopDetector>(holdfast_register_plugin_flann, "flann", context)) {}

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
  std::string fault_;
  std::unique_ptr<LoopDetector> flann_;
  std::vector<KeyFrameId> known_;
  mutable int queries_ = 0;
};

}  // namespace

void add_loop_detectors(Registry& registry) {
  add_faults<LoopDetector, FaultyLoopDetector>(
      registry, {"sound", "needs_descriptors", "strict", "never_forgets", "blind", "generous", "worst_first", "twice",
                 "no_number", "learns_by_asking", "counts_calls"});
}

}  // namespace holdfast::bad
