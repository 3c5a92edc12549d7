// SPDX-License-Identifier: BSD-3-Clause
#include <array>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "holdfast/core/feature_label.hpp"
#include "holdfast/core/trajectory.hpp"
#include "holdfast/interfaces/observer.hpp"
#include "holdfast/plugin/plugin.hpp"
#include "holdfast/settings/class_motion.hpp"

namespace holdfast {

void ClassMotionSettings::describe(ParameterTable<ClassMotionSettings>& table) {
  table
      .add("moving_log_odds", &ClassMotionSettings::moving_log_odds,
           "a feature counts as moving if its measured log-odds of being static are at most this")
      .range(-20, 0);
}

namespace {

/// Counts, by class, the features that filters measured, and those that they measured to move; writes
/// class_motion.csv at the end of a run. Priors are excluded (Frame::measured_log_odds), so that the result is not what
/// was assumed. Needs an output folder, and does nothing without one.
class ClassMotion final : public Observer {
 public:
  ClassMotion(const ClassMotionSettings& settings, const CreationContext& context)
      : settings_(settings), folder_(context.output_directory) {}

  void on_start(const std::vector<std::string>& classes) override { classes_ = classes; }
  void on_frame(const SensorFrame&, const Frame& frame, const FrameResult& result) override {
    if (result.status != TrackingStatus::tracked || frame.measured_log_odds.size() != frame.size()) return;
    for (std::size_t i = 0; i < frame.size(); ++i) {
      const float measured = frame.measured_log_odds[i];
      const std::uint8_t label = feature_label(frame, i);
      if (measured == 0.0F || label >= classes_.size()) continue;
      ++counts_[label].measured;
      if (static_cast<double>(measured) <= settings_.moving_log_odds) ++counts_[label].moving;
    }
  }
  void on_finish(const Map&) override {
    if (folder_.empty()) return;
    std::string text = "class,measured,moving,share\n";
    for (std::size_t label = 0; label < classes_.size() && label < counts_.size(); ++label) {
      const Count& count = counts_[label];
      if (count.measured == 0) continue;
      char numbers[96];
      std::snprintf(numbers, sizeof(numbers), ",%llu,%llu,%.4f\n", static_cast<unsigned long long>(count.measured),
                    static_cast<unsigned long long>(count.moving),
                    static_cast<double>(count.moving) / static_cast<double>(count.measured));
      text += classes_[label] + numbers;
    }
    write_file_atomically(folder_ / "class_motion.csv", text);
  }

 private:
  struct Count {
    std::uint64_t measured = 0, moving = 0;
  };
  ClassMotionSettings settings_;
  std::filesystem::path folder_;
  std::vector<std::string> classes_;
  std::array<Count, CellMask::unknown> counts_{};  // by label
};

}  // namespace

HOLDFAST_PLUGIN(class_motion, registry) {
  registry.add<Observer, ClassMotion, ClassMotionSettings>(
      {.name = ClassMotionSettings::module,
       .summary = "Counts how often features of each class were measured to move, for `movable` of semantic_mask."});
}

}  // namespace holdfast
