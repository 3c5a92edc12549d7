// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "holdfast/core/map.hpp"
#include "holdfast/core/map_mutex.hpp"
#include "holdfast/core/stereo_calibration.hpp"

namespace holdfast {

class PairBundle;

/// Corrects keyframes of a stereo pair for calibration errors, and estimates the errors of columns by bundle adjustment
/// of a window of keyframes with the column displacement as unknown. A window is adjusted again with each new keyframe.
/// When it is complete, its estimate is kept and another window begins, so that no observation counts twice. All
/// functions except add() are called by the thread of LocalMapper::refine().
class PairCalibrator {
 public:
  /// All must outlive the object.
  PairCalibrator(Map& map, MapMutex& mutex, StereoCalibration& calibration);
  ~PairCalibrator();

  /// Registers the keyframe inserted from the last frame.
  void add(const MapAccess&, KeyFrameId keyframe);
  /// Updates right columns and depths of all registered keyframes to the current errors. True if they have changed.
  bool correct(const MapAccess& map);
  /// Adds a keyframe to the window and adjusts it. Acquires the lock of the map.
  void learn(KeyFrameId keyframe);
  /// Forgets all keyframes after the map was cleared. The estimated errors are kept.
  void forget_map() { corrected_by_.clear(), window_.clear(); }

 private:
  Map& map_;
  MapMutex& mutex_;
  StereoCalibration& calibration_;
  std::unique_ptr<PairBundle> bundle_;
  // The errors by which each keyframe is corrected; keyframes of a loaded map are left out.
  std::vector<std::pair<KeyFrameId, PairErrors>> corrected_by_;
  PairErrors corrected_;  // of all keyframes, by the last correct()
  std::vector<KeyFrameId> window_;
};

}  // namespace holdfast
