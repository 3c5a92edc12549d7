// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <mutex>
#include <optional>
#include <vector>

#include "holdfast/core/map.hpp"
#include "holdfast/core/map_mutex.hpp"
#include "holdfast/core/stage_times.hpp"
#include "holdfast/interfaces/loop_detector.hpp"
#include "holdfast/interfaces/optimizer.hpp"
#include "holdfast/loop_closing/full_adjustment.hpp"
#include "holdfast/loop_closing/loop_candidates.hpp"
#include "holdfast/loop_closing/loop_closing_settings.hpp"
#include "holdfast/loop_closing/loop_verdict.hpp"

namespace holdfast {

struct LoopMeasurement;

/// A loop that was found and corrected.
struct ClosedLoop {
  KeyFrameId keyframe;   ///< at the end of the loop
  KeyFrameId candidate;  ///< the place that it saw again
  int inliers = 0;       ///< points of the place found in the keyframe
  int points_fused = 0;
  double way = 0.0;       ///< shortest way between the two through the map before [m], see below
  PoseChange correction;  ///< of the keyframe, as measured
  /// Measured by the check, as maps points of the candidate's camera to the keyframe's.
  Eigen::Isometry3d T_keyframe_candidate = Eigen::Isometry3d::Identity();
  double seconds = 0.0;  ///< of the correction
};

/// Recognises places seen again and pulls the map together there (Mur-Artal et al. 2015, section VII; with depth,
/// Mur-Artal and Tardos 2017, section III-D).
///
/// 1. Candidates by place recognition, see LoopCandidates.
/// 2. Geometric check: matched descriptors, rigid alignment by RANSAC, guided matching, pose adjustment.
/// 3. Plausibility. Two desks that look alike agree in everything that 1 and 2 look at; only the way between them tells
///    them apart. So a loop must be one that odometry can have caused: the correction may not exceed
///    drift_constant + drift_per_metre * way (the same for the turn), where the way is the shortest one through the
///    graph of keyframes. That the shortest counts means that a keyframe which shares points with old keyframes near
///    its present pose is held there, whatever place it looks like. And the present pose is given a hearing: where old
///    points in view from it are found in the keyframe, as many as make a place, and disagree with the loop, the pose
///    is confirmed and the loop refused. In doubt nothing is closed: a missed loop comes again, a false one stays.
/// 4. Correction: pose graph over the essential graph (spanning tree, strong covisibility edges, loop edges) with the
///    oldest keyframe fixed; points follow their reference keyframes; points of the place and of the keyframe's
///    surroundings that are the same become one; covisibility is counted anew; a loop edge remembers it.
///
/// Threads: process() and forget() from one thread. Takes `work` for steps 2 to 4 and the map's lock within it, a few
/// milliseconds at a time and never while solving. Keyframes that others add to the map meanwhile are carried along by
/// their parents. Nobody else may move or remove keyframes or points without holding `work`.
class LoopCloser {
 public:
  /// All references must outlive this; detector and optimizer are used by process() and forget() only. Random samples
  /// follow from the seed and the keyframe alone.
  LoopCloser(const LoopClosingSettings& settings, Map& map, MapMutex& map_mutex, std::mutex& work,
             LoopDetector& detector, Optimizer& optimizer, std::uint64_t seed);

  /// A full adjustment that a new loop makes void: it is asked to stop before the map is corrected.
  void set_full_adjustment(FullAdjustment* adjustment) { adjustment_ = adjustment; }

  /// Looks for a loop at a keyframe, closes it, and adds the keyframe to the detector. To be called once for each
  /// keyframe by rising sequence, when local mapping is done with it; a keyframe that is gone already is passed over.
  /// Adds stages "loops: ...".
  std::optional<ClosedLoop> process(KeyFrameId keyframe, StageTimes& times);

  /// Removes a keyframe that left the map from the detector; harmless for one that was never added.
  void forget(KeyFrameId keyframe) { detector_.remove(keyframe); }

  /// The candidates that the last process() looked at closely, the closed one last.
  const std::vector<LoopTrial>& trials() const { return trials_; }
  const LoopCounts& counts() const { return counts_; }

 private:
  std::vector<KeyFrameId> find_candidates(KeyFrameId keyframe);
  std::optional<LoopMeasurement> check(LoopTrial& trial);
  std::optional<ClosedLoop> correct(LoopTrial& trial, const LoopMeasurement& measurement);

  LoopClosingSettings settings_;
  Map& map_;
  MapMutex& map_mutex_;
  std::mutex& work_;
  LoopDetector& detector_;
  Optimizer& optimizer_;
  std::uint64_t seed_;
  FullAdjustment* adjustment_ = nullptr;
  LoopCandidates candidates_;
  std::vector<LoopTrial> trials_;
  LoopCounts counts_;
  std::optional<std::uint64_t> last_loop_;  // sequence of the keyframe
};

}  // namespace holdfast
