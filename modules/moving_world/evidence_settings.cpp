// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/moving_world/evidence_settings.hpp"

#include "holdfast/plugin/parameter_table.hpp"

namespace holdfast {

template <>
inline constexpr Choice<Removal> choice_table<Removal>[] = {{"soft", Removal::soft}, {"hard", Removal::hard}};

void EvidenceSettings::describe(ParameterTable<EvidenceSettings>& table) {
  using S = EvidenceSettings;
  table.add("removal", &S::removal,
            "soft: the weight of a feature is its probability of being static; hard: features below the threshold "
            "have no weight, all others full weight");
  table.add("static_log_odds", &S::static_log_odds, "log-odds that a feature is static before anything is known")
      .range(-5, 10);
  table.add("threshold", &S::threshold, "hard removal: features that are static with less probability have no weight")
      .range(0, 1);
  table.add("ignore_below", &S::ignore_below, "soft removal: less probable features have no weight").range(0, 1);
  table.add("carried_share", &S::carried_share, "share of a map point's log-odds that lasts until its next observation")
      .range(0, 1);
  table.add("measured_share", &S::measured_share, "share of a frame's measurement that is added to its map points")
      .range(0, 1);
  table.add("skip_moving", &S::skip_moving,
            "extract no features on masked objects that moved in the last frame, so that all features are useful");
  table.add("limit", &S::limit, "bound of the magnitude of a map point's log-odds").range(0.1, 100);
  table
      .add("prediction_lead", &S::prediction_lead,
           "the motion model's prediction replaces the pose from matches when its depth agrees with keyframes in "
           "this much more of the view")
      .range(0, 1);
  table
      .add("depth_check_inliers", &S::depth_check_inliers,
           "a pose with fewer inliers is checked against the depth of keyframes")
      .range(0, 100000);
  table
      .add("depth_check_share", &S::depth_check_share,
           "share of the view whose depth must agree with keyframes in this check, at least")
      .range(0, 1);
  table
      .add("depth_check_inliers_lost", &S::depth_check_inliers_lost,
           "like depth_check_inliers, for a pose that was found after a loss")
      .range(0, 100000);
  table
      .add("depth_check_share_lost", &S::depth_check_share_lost,
           "like depth_check_share, for a pose that was found after a loss")
      .range(0, 1);
  table
      .add("depth_check_keyframes", &S::depth_check_keyframes,
           "maximum number of keyframes whose depth is compared with that of the view")
      .range(1, 20);
  table
      .add("depth_check_age", &S::depth_check_age,
           "age from which keyframes are preferred for this comparison, because people have walked on since")
      .range(0, 60)
      .unit("s");
  table
      .add("depth_check_cells", &S::depth_check_cells,
           "minimum number of compared cells, one of 16 x 16 pixels each, for a share of them to be significant")
      .range(1, 100000);
  table.add("fallback", &S::fallback,
            "whether a frame that its static features do not determine is tracked by masked features as well, and if "
            "these do not suffice by aligning its depth with keyframes; depth has to confirm the pose");
  table
      .add("fallback_log_odds", &S::fallback_log_odds,
           "least log-odds that class priors add to a feature in such a frame")
      .range(-20, 0);
  table
      .add("fallback_share", &S::fallback_share,
           "share of the view, without what people may occlude, whose depth must agree with keyframes in such a frame")
      .range(0, 1);
  table
      .add("fallback_agreement", &S::fallback_agreement,
           "share of the whole compared view whose depth must agree with keyframes in such a frame")
      .range(0, 1);
}

}  // namespace holdfast
