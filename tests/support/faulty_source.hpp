// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "holdfast/core/random.hpp"
#include "holdfast/interfaces/frame_source.hpp"
#include "holdfast/perturbation/image_faults.hpp"

namespace holdfast::test {

/// What goes wrong with the frames of a sensor.
enum class Fault {
  drop,           ///< single frames are missing
  gap,            ///< all frames of the fault are missing
  freeze,         ///< the images of the frame before the fault are repeated
  black,          ///< the colour image is black
  white,          ///< the colour image is saturated
  noise,          ///< the colour image is noise
  depth_zero,     ///< no depth has a value
  depth_biased,   ///< depth is 8 % too large
  late_stamp,     ///< the time stamp is up to 10 ms late
  exposure_jump,  ///< the colour image is half as bright
};

inline constexpr Fault all_faults[] = {Fault::drop,       Fault::gap,          Fault::freeze,     Fault::black,
                                       Fault::white,      Fault::noise,        Fault::depth_zero, Fault::depth_biased,
                                       Fault::late_stamp, Fault::exposure_jump};

inline const char* to_string(Fault fault) {
  static constexpr const char* names[] = {"drop",  "gap",        "freeze",       "black",      "white",
                                          "noise", "depth_zero", "depth_biased", "late_stamp", "exposure_jump"};
  return names[static_cast<int>(fault)];
}

/// Wraps a source and spoils stretches of its frames. Time, length and content of the stretches depend on the seed
/// alone. Images of the wrapped source are copied before they are changed.
class FaultySource final : public FrameSource {
 public:
  /// `begins`: the earliest frame that a fault may strike; `stretches` faults of 3 to `longest` frames follow, each
  /// with at least `pause` untouched frames before it.
  FaultySource(std::unique_ptr<FrameSource> source, Fault fault, std::uint64_t seed, std::uint64_t begins = 20,
               int stretches = 2, std::uint64_t longest = 8, std::uint64_t pause = 10)
      : source_(std::move(source)), fault_(fault), random_(seed) {
    std::uint64_t at = begins;
    for (int i = 0; i < stretches; ++i) {
      const std::uint64_t begin = at + random_.below(5);
      const std::uint64_t end = begin + 3 + random_.below(static_cast<std::uint32_t>(longest - 2));
      stretches_.emplace_back(begin, end);
      at = end + pause;
    }
  }

  SourceDescription describe() const override { return source_->describe(); }
  Trajectory truth() const override { return source_->truth(); }
  std::optional<SensorFrame> next() override {
    while (true) {
      std::optional<SensorFrame> frame = source_->next();
      if (!frame) return frame;
      const bool is_hit = strikes(frame->index);
      if (!is_hit) last_good_ = *frame;
      if (is_hit && (fault_ == Fault::gap || (fault_ == Fault::drop && random_.below(2) == 0))) continue;
      if (is_hit) spoil(*frame);
      return frame;
    }
  }

  bool strikes(std::uint64_t index) const {
    return std::any_of(stretches_.begin(), stretches_.end(),
                       [&](const auto& stretch) { return index >= stretch.first && index < stretch.second; });
  }
  /// The first frame after the last fault.
  std::uint64_t end() const { return stretches_.back().second; }

 private:
  /// Always with new images, because those of the source are shared.
  void spoil(SensorFrame& frame) {
    switch (fault_) {
      case Fault::freeze:
        frame.colour = last_good_.colour;
        frame.depth = last_good_.depth;
        frame.truth = last_good_.truth;  // the pose that the images show
        break;
      case Fault::black:
        frame.colour = scaled_brightness(frame.colour, 0.0);
        break;
      case Fault::white:
        frame.colour = cv::Mat(frame.colour.size(), frame.colour.type(), cv::Scalar::all(255));
        break;
      case Fault::noise:
        frame.colour = cv::Mat(frame.colour.size(), frame.colour.type());
        for (int y = 0; y < frame.colour.rows; ++y)
          for (int x = 0; x < 3 * frame.colour.cols; ++x)
            frame.colour.ptr<std::uint8_t>(y)[x] = static_cast<std::uint8_t>(random_.below(256));
        break;
      case Fault::depth_zero:
        frame.depth = scaled_depth(frame.depth, 0.0);
        break;
      case Fault::depth_biased:
        frame.depth = scaled_depth(frame.depth, 1.08);
        break;
      case Fault::late_stamp:
        frame.timestamp += random_.uniform(0.0, 0.010);
        break;
      case Fault::exposure_jump:
        frame.colour = scaled_brightness(frame.colour, 0.5);
        break;
      case Fault::drop:
      case Fault::gap:
        break;
    }
  }

  std::unique_ptr<FrameSource> source_;
  Fault fault_;
  Random random_;
  std::vector<std::pair<std::uint64_t, std::uint64_t>> stretches_;
  SensorFrame last_good_;
};

}  // namespace holdfast::test
