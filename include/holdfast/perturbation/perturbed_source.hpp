// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "holdfast/interfaces/frame_source.hpp"
#include "holdfast/perturbation/perturbation_settings.hpp"

namespace holdfast {

/// Wraps a source and perturbs its frames. The random numbers of a frame depend on the seed and SensorFrame::index
/// alone, not on which frames came before; only repeated and late frames depend on the previous frame. Images of the
/// wrapped source are never written to. Ground truth is that of the source: pose and masks of a frame belong to its
/// images, and the occluder is a moving object (255) without a class. Used by one thread.
class PerturbedSource final : public FrameSource {
 public:
  /// `camera`: the true camera of the source, for the position of the occluder in the right image.
  PerturbedSource(std::unique_ptr<FrameSource> source, const PerturbationSettings& settings, const Camera& camera,
                  std::uint64_t seed_of_run);

  /// Description of the wrapped source, with the camera of perturbed_camera() and the number of frames that are not
  /// dropped.
  SourceDescription describe() const override;
  std::optional<SensorFrame> next() override;
  /// By the stamps after delays and without dropped frames; with one of these settings only if the wrapped source knows
  /// SourceDescription::frame_timestamps.
  std::vector<double> pass_over(double timestamp) override;
  Trajectory truth() const override { return source_->truth(); }
  std::vector<SkippedFrame> skipped() const override { return source_->skipped(); }
  void interrupt() override { source_->interrupt(); }
  Warnings warnings() const override { return source_->warnings(); }

 private:
  struct Rectangle {
    int x = 0, y = 0;  ///< of the left upper pixel
  };

  double draw(std::uint64_t stream, std::uint64_t index) const;
  bool is_dropped(std::uint64_t index) const;
  double brightness(std::uint64_t index) const;
  Rectangle occluder_place(const SensorFrame& frame) const;
  void occlude(SensorFrame& frame);
  bool is_covered(std::uint64_t index) const;
  void shear(SensorFrame& frame) const;
  void spoil_depth(SensorFrame& frame) const;
  void spoil_images(SensorFrame& frame) const;
  double delayed(double timestamp, std::uint64_t index, const std::optional<double>& previous) const;

  std::unique_ptr<FrameSource> source_;
  PerturbationSettings settings_;
  Camera camera_;
  std::uint64_t seed_;
  cv::Mat occluder_;  ///< texture, made with the first frame
  std::optional<SensorFrame> last_;
  std::optional<double> last_timestamp_;       ///< of the frame given or passed over last, after its delay
  std::uint64_t next_index_ = 0;               ///< of the wrapped source
  std::optional<std::vector<double>> stamps_;  ///< of all frames of the wrapped source, once they were asked for
};

/// Camera with the calibration error of the setting `calibration`.
Camera perturbed_camera(Camera camera, const PerturbationSettings& settings, std::uint64_t seed_of_run);

}  // namespace holdfast
