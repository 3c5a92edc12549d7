// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "holdfast/core/frame.hpp"
#include "holdfast/interfaces/dynamic_filter.hpp"
#include "holdfast/tracking/evidence_settings.hpp"

namespace holdfast {

/// The dynamic filters of a run, one after the other, and what becomes of their evidence. For each frame: begin(), then
/// judge() for each stage, with weigh() as often as matches or evidence change, then carry(). An empty chain says
/// nothing: every feature keeps full weight. One thread.
///
/// The log-odds of a feature are the sum of what holds before anything is known (settings), the priors of this frame's
/// filters, what they measured, and what is carried by the map point that the feature shows. A map point remembers
/// measurements only: "movable" is said anew in every frame, "moving" lasts.
class FilterChain {
 public:
  /// When a filter speaks: before features are matched, so that what it suspects cannot lead the pose astray; once
  /// there is a first pose, when it needs one; or once the local map is matched, when it needs matches.
  enum class Stage { before_matching, with_pose, after_matching };

  explicit FilterChain(const EvidenceSettings& settings = {}) : settings_(settings) {}
  void add(std::string name, std::unique_ptr<DynamicFilter> filter) {
    names_.push_back(std::move(name));
    filters_.push_back(std::move(filter));
  }
  bool empty() const { return filters_.empty(); }
  bool has(Stage stage) const;
  std::size_t size() const { return filters_.size(); }
  const std::string& name(std::size_t i) const { return names_[i]; }
  const DynamicFilter& filter(std::size_t i) const { return *filters_[i]; }

  void begin(const Frame& frame) { evidence_.reset(frame.size(), frame.coarse.depth.size()); }
  /// Lets the filters of a stage speak, in their order.
  void judge(Stage stage, const FilterContext& context);
  /// Sets static_probability, measured_log_odds and the log-odds of the coarse cells.
  void weigh(const Map& map, Frame& frame) const;
  /// Adds what was measured to the map points that the frame shows, and to those that filters spoke of.
  void carry(const Frame& frame, Map& map) const;
  /// Judges a keyframe again by its own segmentation (context.segmentation and context.carried_mask): priors of its
  /// features anew, measurements as they were; its coarse cells learn what they did not know to be suspect.
  void judge_segmented(const FilterContext& context, Frame& frame);

  /// Of the last frame that was judged, keyframes judged again included.
  const StaticEvidence& evidence() const { return evidence_; }
  const EvidenceSettings& settings() const { return settings_; }

 private:
  static Stage stage_of(const DynamicFilter& filter);
  void apply(std::size_t filter, const FilterContext& context);
  float probability(float log_odds) const;

  EvidenceSettings settings_;
  std::vector<std::string> names_;
  std::vector<std::unique_ptr<DynamicFilter>> filters_;
  StaticEvidence evidence_;
};

}  // namespace holdfast
