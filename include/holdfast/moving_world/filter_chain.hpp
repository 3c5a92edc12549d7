// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "holdfast/core/frame.hpp"
#include "holdfast/interfaces/dynamic_filter.hpp"
#include "holdfast/moving_world/evidence_settings.hpp"

namespace holdfast {

/// Stage in which a filter runs: before matching if it needs neither pose_prior nor matches, so that dynamic features
/// do not bias the pose; after the first pose estimate if it needs a pose; after the local map was matched if it needs
/// matches.
enum class FilterStage { before_matching, with_pose, after_matching };

/// The dynamic filters of a run in their order, and the conversion of their evidence into weights. For each frame:
/// begin(), then evaluate() for each stage, with weight_features() whenever matches or evidence have changed, then
/// accumulate(). With an empty chain every feature keeps full weight. One thread.
///
/// The log-odds of a feature are the sum of a constant prior (settings), the class priors of this frame's filters,
/// their measurements, and the accumulated log-odds of the matched map point. Map points accumulate measurements only:
/// class priors are evaluated anew in every frame.
class FilterChain {
 public:
  explicit FilterChain(const EvidenceSettings& settings = {}) : settings_(settings) {}
  void add(std::string name, std::unique_ptr<DynamicFilter> filter) {
    names_.push_back(std::move(name));
    filters_.push_back(std::move(filter));
  }
  bool empty() const { return filters_.empty(); }
  bool has(FilterStage stage) const;
  /// The stage in which a filter runs, by its needs.
  static FilterStage stage_of(const DynamicFilter& filter);
  std::size_t size() const { return filters_.size(); }
  const std::string& name(std::size_t i) const { return names_[i]; }
  const DynamicFilter& filter(std::size_t i) const { return *filters_[i]; }
  /// DynamicFilter::movable_classes() of all filters.
  std::vector<std::string> movable_classes(const std::vector<std::string>& specified) const;

  void begin(const Frame& frame) {
    evidence_.reset(frame.size(), frame.coarse.depth.size());
    evaluated_ = {};
    discounts_priors_ = false;
    weighted_.assign(frame.size(), {});
    has_new_cells_ = true;
  }
  /// Runs the filters of a stage in their order, once per frame; a second call has no effect.
  void evaluate(FilterStage stage, const FilterContext& context);
  /// Clamps class priors to at least `fallback_log_odds` until the next frame. False if no feature changes or the
  /// fallback is disabled.
  bool discount_priors();
  bool discounts_priors() const { return discounts_priors_; }
  /// Sets static_probability, measured_log_odds and the log-odds of the coarse cells of the current frame.
  void weight_features(const Map& map, Frame& frame);
  /// Adds the frame's measurements to its matched map points, and to points that filters measured directly.
  void accumulate(const Frame& frame, Map& map) const;
  /// Evaluates a keyframe again by its own segmentation (context.segmentation and the mask in `frame`): the class
  /// priors of its features are replaced, measurements are kept; the log-odds of cells of its coarse view can only
  /// decrease.
  void evaluate_keyframe(const FilterContext& context, Frame& frame);

  /// Evidence of the most recently evaluated frame, including re-evaluated keyframes.
  const StaticEvidence& evidence() const { return evidence_; }
  const EvidenceSettings& settings() const { return settings_; }

 private:
  void apply(std::size_t filter, const FilterContext& context);
  float probability(float log_odds) const;
  float prior(std::size_t feature) const;

  EvidenceSettings settings_;
  std::vector<std::string> names_;
  std::vector<std::unique_ptr<DynamicFilter>> filters_;
  StaticEvidence evidence_;
  std::array<bool, 3> evaluated_ = {};  // by FilterStage, of this frame
  bool discounts_priors_ = false;
  /// Cached weight of a feature of this frame, because most log-odds do not change with the matches.
  struct Weight {
    float log_odds = std::numeric_limits<float>::quiet_NaN();  // not computed
    float probability = 0.0F;
  };
  std::vector<Weight> weighted_;
  bool has_new_cells_ = false;  // since the frame was weighted
};

}  // namespace holdfast
