// SPDX-License-Identifier: BSD-3-Clause
// Warnings of PipelineBuilder about parts that change nothing, because of others or of what is missing beside them.
#include "holdfast/moving_world/filter_chain.hpp"
#include "holdfast/pipeline/pipeline_builder.hpp"

namespace holdfast {

void PipelineBuilder::check_effects() {
  if (parts_.localise_only && parts_.dense_map.enabled)
    suspect(origin_.place,
            "'dense_map' has no effect where the camera is only localised in a map, which stays as it is; continue the "
            "map instead, or remove 'dense_map'");
  if (parts_.localise_only && parts_.surface.enabled)
    suspect(origin_.place,
            "'surface' has no effect where the camera is only localised in a map, which stays as it is; continue the "
            "map instead, or remove 'surface'");
  if (parts_.surface.enabled && parts_.surface.classes && (!segmenter_ || segmenter_->name == "none"))
    suspect(
        origin_.place,
        "'surface.classes' has no effect without a segmenter, which gives pixels their classes; set 'segmenter', or "
        "remove 'surface.classes'");
  if (parts_.loop_closing.keep_vertical && !(parts_.tracking.inertia && parts_.imu))
    suspect(origin_.place,
            "'loop_closing.keep_vertical' has no effect without inertial measurements; set tracking.inertia, with a "
            "source that has an IMU, or remove it");
  else if (parts_.loop_closing.keep_vertical && !parts_.optimizer->keeps_vertical())
    suspect(optimizer_->place, "'loop_closing.keep_vertical' has no effect with the optimizer '" + optimizer_->name +
                                   "', whose pose graphs have six degrees of freedom; choose 'ceres' or 'schur'");
  bool uses_masks = false;
  for (std::size_t i = 0; i < filters_.size(); ++i) {
    const Needs needs = parts_.filters[i].second->needs();
    uses_masks = uses_masks || needs.segmentation;
    if (needs.evidence && !follows_another_filter(i))
      suspect(filters_[i].place, "the filter '" + filters_[i].name +
                                     "' starts from the evidence of filters that run before it, and there is none: it "
                                     "finds nothing; add one before it, such as 'multi_view_depth'");
    if (needs.inertia && !(parts_.tracking.inertia && parts_.imu))
      suspect(filters_[i].place,
              "the filter '" + filters_[i].name +
                  "' judges by inertial measurements, which tracking does not use: it finds nothing; set "
                  "tracking.inertia, with a source that has an IMU, or remove the filter");
  }
  // Without any filter the configuration has said so.
  if (segmenter_ && segmenter_->name != "none" && !filters_.empty() && !uses_masks)
    suspect(segmenter_->place, "no filter needs the masks of the segmenter '" + segmenter_->name +
                                   "', so that features on people count like all others; add 'semantic_mask' to "
                                   "'filters', or remove the segmenter to save its time");
}

/// Filters run stage by stage, and within a stage in their order.
bool PipelineBuilder::follows_another_filter(std::size_t index) const {
  const FilterStage stage = FilterChain::stage_of(*parts_.filters[index].second);
  for (std::size_t i = 0; i < parts_.filters.size(); ++i) {
    const FilterStage other = FilterChain::stage_of(*parts_.filters[i].second);
    if (other < stage || (other == stage && i < index)) return true;
  }
  return false;
}

}  // namespace holdfast
