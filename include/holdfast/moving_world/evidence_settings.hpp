// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "holdfast/core/map_defaults.hpp"

namespace holdfast {

template <class Settings>
class ParameterTable;

/// How the probability of being static becomes the weight of a feature.
enum class Removal {
  soft,  ///< the weight is the probability
  hard,  ///< the weight is 0 below a threshold and 1 above it, as in Zeng et al. 2023
};

/// The `evidence` section of a configuration: how the log-odds that filters add become weights, how map points
/// accumulate them, and when dense depth overrules a pose.
struct EvidenceSettings {
  Removal removal = Removal::soft;
  double static_log_odds = 2.0;           ///< prior of every feature; 2 is a probability of 0.88
  double threshold = 0.5;                 ///< probability, for hard removal
  double ignore_below = 0.2;              ///< probability, for soft removal
  double carried_share = 0.95;            ///< share of a point's log-odds that lasts until its next observation
  double measured_share = 0.3;            ///< share of a frame's measurement that is added to its points
  double limit = default_evidence_limit;  ///< bound of a point's log-odds
  bool skip_moving = true;
  /// Share of compared cells by which the motion model's prediction must agree better with keyframes than the pose from
  /// matches. The lead keeps noise of depth from deciding.
  double prediction_lead = 0.03;
  /// A pose with fewer inliers than this is checked against dense depth: so few can agree by chance.
  int depth_check_inliers = 50;
  /// Share of compared cells that must agree. It is small, because people may fill most of the view.
  double depth_check_share = 0.05;
  /// The same two for a pose that was found after a loss: it is the best of many hypotheses, so chance has more tries.
  int depth_check_inliers_lost = 60;
  double depth_check_share_lost = 0.08;
  /// Maximum number of keyframes whose depth is compared; each costs as much as the first.
  int depth_check_keyframes = 3;
  /// Age from which keyframes are preferred for the comparison [s]: people who walk have left their place by then.
  double depth_check_age = 0.7;
  /// Minimum number of cells (16 pixels apart) for a share of them to be significant.
  int depth_check_cells = 50;
  /// Whether a frame that its static features do not determine is tracked by masked features, then by dense depth. Off:
  /// where people are near, it saves frames at the cost of accuracy (docs/moving_world.md).
  bool fallback = false;
  double fallback_log_odds = -1.5;  ///< most that class priors then cost a feature; 2 - 1.5 is a probability of 0.62
  /// Share of the cells that must agree with keyframes among those that agree or contradict them.
  double fallback_share = 0.7;
  /// Share of the compared cells that must agree, too: a pose from which everything seems to be nearer than the known
  /// surfaces is wrong.
  double fallback_agreement = 0.2;

  static void describe(ParameterTable<EvidenceSettings>& table);
};

}  // namespace holdfast
