// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <mutex>
#include <optional>
#include <vector>

#include "holdfast/core/map.hpp"
#include "holdfast/core/map_mutex.hpp"
#include "holdfast/core/stage_times.hpp"
#include "holdfast/interfaces/feature_matcher.hpp"
#include "holdfast/interfaces/loop_detector.hpp"
#include "holdfast/interfaces/optimizer.hpp"
#include "holdfast/interfaces/place_weights.hpp"
#include "holdfast/loop_closing/closed_loop.hpp"
#include "holdfast/loop_closing/full_adjustment.hpp"
#include "holdfast/loop_closing/loop_candidates.hpp"
#include "holdfast/loop_closing/loop_closing_settings.hpp"
#include "holdfast/loop_closing/loop_verdict.hpp"

namespace holdfast {

struct LoopMeasurement;

/// Detects revisited places and corrects the accumulated drift (Mur-Artal et al. 2015, section VII; with depth,
/// Mur-Artal and Tardos 2017, section III-D).
///
/// 1. Candidates by place recognition, see LoopCandidates.
/// 2. Geometric check: matched descriptors, rigid alignment by RANSAC, guided search, motion-only adjustment. If the
///    detector weights classes (LoopDetector::class_weights()), matches count by their class, and the classes of the
///    matched points must agree with those of the features.
/// 3. Plausibility. Two places of similar appearance pass steps 1 and 2 and can only be distinguished by the path
///    between them. The correction must be within the possible drift: correction <= drift_constant + drift_per_metre *
///    path length, and likewise for the rotation, where the path is the shortest one in the graph of keyframes. A
///    keyframe that shares points with old keyframes near its current pose therefore has a short path and is not moved
///    far. In addition, the current pose is tested as the competing hypothesis: if enough old points visible from it
///    are matched in the keyframe and disagree with the loop, the pose is confirmed and the loop rejected. In case of
///    doubt the loop is rejected: a missed loop is detected again later, a wrong one is permanent.
/// 4. Correction: pose graph over the essential graph (spanning tree, strong covisibility edges, loop edges) with the
///    oldest keyframe fixed; points are moved with their reference keyframes; duplicate points of the candidate's and
///    of the keyframe's neighbourhood are fused; covisibility is updated; a loop edge is added.
///
/// Threads: process() and forget() are called by one thread. Steps 2 to 4 hold the structure mutex, and the map's lock
/// within it for a few milliseconds at a time and never during an optimization. Keyframes inserted meanwhile are moved
/// with their parents. No other thread may move or remove keyframes or points without holding the structure mutex.
class LoopCloser {
 public:
  /// All references must outlive this object; detector, optimizer and matcher are used by process() and forget() only.
  /// Random samples depend on the seed and the keyframe only.
  LoopCloser(const LoopClosingSettings& settings, const SharedMap& shared, LoopDetector& detector, Optimizer& optimizer,
             std::uint64_t seed, const FeatureMatcher& matcher = nearest_matcher());

  /// Sets the full adjustment that a new loop invalidates; it is requested to stop before the map is corrected.
  void set_full_adjustment(FullAdjustment* adjustment) { adjustment_ = adjustment; }

  /// The run has inertial measurements: views that people hide are bridged, where the drift grows with time.
  void use_inertia() { is_inertial_ = true; }

  /// Searches for a loop at a keyframe, closes it, and adds the keyframe to the detector. Query and database use the
  /// descriptors of static features only (static_probability), so that the keyframe's own mask must have been applied
  /// before. For a detector with global descriptors they use Frame::image_descriptor, which must have been set. It must
  /// be called once for each keyframe by increasing sequence, after local mapping has processed it; a removed keyframe
  /// is skipped. Adds stages "loops: ...".
  std::optional<ClosedLoop> process(KeyFrameId keyframe, StageTimes& times);

  /// Removes a keyframe from the detector after its removal from the map. Has no effect for an unknown keyframe.
  void forget(KeyFrameId keyframe) { detector_.remove(keyframe); }

  const LoopCounts& counts() const { return counts_; }

 private:
  std::vector<KeyFrameId> find_candidates(KeyFrameId keyframe);
  std::optional<LoopMeasurement> check(CandidateReport& trial);
  std::optional<ClosedLoop> correct(const std::lock_guard<std::mutex>& structure, CandidateReport& trial,
                                    const LoopMeasurement& measurement);

  LoopClosingSettings settings_;
  Map& map_;
  MapMutex& map_mutex_;
  std::mutex& structure_mutex_;
  LoopDetector& detector_;
  Optimizer& optimizer_;
  const FeatureMatcher& matcher_;
  std::uint64_t seed_;
  bool is_inertial_ = false;
  FullAdjustment* adjustment_ = nullptr;
  LoopCandidates candidates_;
  std::optional<PlaceWeights> weights_;  // for the labels of the map; set at the first keyframe
  LoopCounts counts_;
  std::optional<std::uint64_t> last_loop_;  // sequence of the keyframe
};

}  // namespace holdfast
