// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "holdfast/core/map_defaults.hpp"

namespace holdfast {

template <class Settings>
class ParameterTable;

/// Conversion of the static probability into the weight of a feature.
enum class Removal {
  soft,  ///< the weight is the probability
  hard,  ///< the weight is 0 below a threshold and 1 above it, as in Zeng et al. 2023
};

/// The `evidence` section of a configuration: conversion of static log-odds into weights, their accumulation by map
/// points, and thresholds of the pose check by dense depth.
struct EvidenceSettings {
  Removal removal = Removal::soft;
  double static_log_odds = 2.0;           ///< prior of every feature; 2 is a probability of 0.88
  double threshold = 0.5;                 ///< probability, for hard removal
  double ignore_below = 0.2;              ///< probability, for soft removal
  double carried_share = 0.95;            ///< share of a point's log-odds that is kept until its next observation
  double measured_share = 0.3;            ///< share of a frame's measurement that is added to its points
  double limit = default_evidence_limit;  ///< bound of a point's log-odds
  bool skip_moving = true;
  /// Minimum lead of the predicted pose in the share of agreeing cells to replace the pose from matches; above the
  /// depth noise.
  double prediction_lead = 0.03;
  /// Number of inliers below which a pose is checked against dense depth.
  int depth_check_inliers = 50;
  /// Minimum share of compared cells that agree in this check; small, because people may fill most of the view.
  double depth_check_share = 0.05;
  /// The same two for relocalisation, which selects the best of many hypotheses, so that chance agreement is more
  /// likely.
  int depth_check_inliers_lost = 60;
  double depth_check_share_lost = 0.08;
  /// Maximum number of keyframes whose depth is compared; the time is proportional to it.
  int depth_check_keyframes = 3;
  /// Age of keyframes that are preferred for the comparison [s], so that walking people have moved since.
  double depth_check_age = 0.7;
  /// Minimum number of cells (16 pixels apart) for a significant share.
  int depth_check_cells = 50;
  /// Whether frames whose static features do not determine the pose are tracked by masked features, then by dense
  /// depth. Off by default: it tracks more frames among near people, with lower accuracy (docs/moving_world.md).
  bool fallback = false;
  double fallback_log_odds = -1.5;  ///< minimum class prior in this fallback; 2 - 1.5 is a probability of 0.62
  /// Minimum share of agreeing cells among those that agree or see through surfaces of keyframes.
  double fallback_share = 0.7;
  /// Minimum share of agreeing cells among all compared ones; rejects poses for which nearly all cells are nearer than
  /// the known surfaces.
  double fallback_agreement = 0.2;

  static void describe(ParameterTable<EvidenceSettings>& table);
};

}  // namespace holdfast
