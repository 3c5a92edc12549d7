// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace holdfast {

class DynamicFilter;
template <class Settings>
class ParameterTable;

/// Settings of the filter `multi_view_depth`. Ranges and units: `holdfast modules multi_view_depth`.
struct MultiViewDepthSettings {
  using Interface = DynamicFilter;
  static constexpr const char* module = "multi_view_depth";

  int keyframes = 8;        ///< maximum number of keyframes to compare with, distributed over four age groups
  int point_keyframes = 3;  ///< number of these keyframes whose map points are compared with the depth of the frame
  double reach = 1.0;       ///< maximum distance between the camera centres of frame and keyframe [m]
  /// Depth difference above which a keyframe observed free space where the frame observes a surface, at depth
  /// zero [m]; 0.4 m in DynaSLAM.
  double margin = 0.06;
  double margin_slope = 0.03;  ///< growth of the margin with depth
  /// Score of confirming keyframes from which on moving regions do not grow into a block; 1 = one old keyframe.
  double confirmed_score = 0.7;
  int growth = 12;                ///< maximum number of region-growing steps, each of one block of 8 px
  double moving_log_odds = -4.0;  ///< evidence of features, cells and map points that are measured to move
  double static_log_odds = 1.0;   ///< maximum evidence of surfaces that keyframes confirm, reached at a score of 2
  /// Features within this distance of a moving region, times the scale of their octave, lie on its outline [px].
  double edge = 4.0;
  double edge_log_odds = -3.0;  ///< prior of features on the outline of a moving region
  /// Prior of unconfirmed surfaces if there is no mask, times the fraction of the view that moves.
  double crowd_log_odds = -5.0;

  static void describe(ParameterTable<MultiViewDepthSettings>& table);
};

}  // namespace holdfast
