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

/// Corrects the keyframes of a stereo pair by the errors of its calibration, and estimates those that motion
/// determines: bundle adjustment of a window of keyframes with the displacement of columns as unknowns. A window grows
/// by each keyframe and is adjusted anew; once it is complete, its estimate is kept and the next window begins, so that
/// no observation counts twice. Used by the thread of LocalMapper::refine(), add() excepted.
class PairCalibrator {
 public:
  /// All must outlive the object.
  PairCalibrator(Map& map, MapMutex& mutex, StereoCalibration& calibration);
  ~PairCalibrator();

  /// Declares that a keyframe of the last frame was inserted.
  void add(const MapAccess&, KeyFrameId keyframe);
  /// Corrects right columns and depths of all added keyframes by the errors in use now; true if they have changed.
  bool correct(const MapAccess& map);
  /// Adjusts the window with one more keyframe. Acquires the lock of the map.
  void learn(KeyFrameId keyframe);
  /// The map is empty. What is known of the pair stays.
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
