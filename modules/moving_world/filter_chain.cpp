// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/moving_world/filter_chain.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace holdfast {

FilterStage FilterChain::stage_of(const DynamicFilter& filter) {
  const Needs needs = filter.needs();
  return needs.matches      ? FilterStage::after_matching
         : needs.pose_prior ? FilterStage::with_pose
                            : FilterStage::before_matching;
}

bool FilterChain::has(FilterStage stage) const {
  return std::any_of(filters_.begin(), filters_.end(), [&](const auto& filter) { return stage_of(*filter) == stage; });
}

std::vector<std::string> FilterChain::movable_classes(const std::vector<std::string>& specified) const {
  std::vector<std::string> classes;
  for (const auto& filter : filters_)
    for (std::string& name : filter->movable_classes(specified)) classes.push_back(std::move(name));
  return classes;
}

void FilterChain::apply(std::size_t filter, const FilterContext& context) {
  has_new_cells_ = true;
  evidence_.begin_stage(names_[filter]);
  filters_[filter]->apply(context, evidence_);
}

void FilterChain::evaluate(FilterStage stage, const FilterContext& context) {
  if (std::exchange(evaluated_[static_cast<std::size_t>(stage)], true)) return;
  for (std::size_t i = 0; i < filters_.size(); ++i)
    if (stage_of(*filters_[i]) == stage) apply(i, context);
}

float FilterChain::probability(float log_odds) const {
  const float p = 1.0F / (1.0F + std::exp(-log_odds));
  if (settings_.removal == Removal::hard) return p < static_cast<float>(settings_.threshold) ? 0.0F : 1.0F;
  return p < static_cast<float>(settings_.ignore_below) ? 0.0F : p;
}

float FilterChain::prior(std::size_t feature) const {
  const float prior = evidence_.prior(feature);
  return discounts_priors_ ? std::max(prior, static_cast<float>(settings_.fallback_log_odds)) : prior;
}

bool FilterChain::discount_priors() {
  if (!settings_.fallback || discounts_priors_) return false;
  for (std::size_t i = 0; i < evidence_.size() && !discounts_priors_; ++i)
    discounts_priors_ = evidence_.prior(i) < static_cast<float>(settings_.fallback_log_odds);
  return discounts_priors_;
}

void FilterChain::weight_features(const Map& map, Frame& frame) {
  if (filters_.empty()) return;
  frame.static_probability.resize(frame.size());
  frame.measured_log_odds.resize(frame.size());
  const float start = static_cast<float>(settings_.static_log_odds);
  for (std::size_t i = 0; i < frame.size(); ++i) {
    float measured = evidence_.measurement(i);
    if (frame.map_points[i].valid())
      if (const MapPoint* point = map.find_point(frame.map_points[i])) measured += point->static_log_odds;
    frame.measured_log_odds[i] = measured;
    Weight& weight = weighted_[i];
    const float log_odds = start + prior(i) + measured;
    if (log_odds != weight.log_odds) weight = {log_odds, probability(log_odds)};
    frame.static_probability[i] = weight.probability;
  }
  if (std::exchange(has_new_cells_, false)) frame.coarse.static_log_odds = evidence_.cells();
}

void FilterChain::accumulate(const Frame& frame, Map& map) const {
  const float limit = static_cast<float>(settings_.limit);
  const float kept = static_cast<float>(settings_.carried_share), share = static_cast<float>(settings_.measured_share);
  for (std::size_t i = 0; i < frame.size(); ++i) {
    MapPoint* point = map.find_point(frame.map_points[i]);
    if (point == nullptr) continue;
    point->static_log_odds =
        std::clamp(kept * point->static_log_odds + share * evidence_.measurement(i), -limit, limit);
  }
  for (const StaticEvidence::PointContribution& measured : evidence_.point_contributions())
    if (MapPoint* point = map.find_point(measured.point))
      point->static_log_odds = std::clamp(point->static_log_odds + share * measured.log_odds, -limit, limit);
}

void FilterChain::evaluate_keyframe(const FilterContext& context, Frame& frame) {
  begin(frame);
  for (std::size_t i = 0; i < filters_.size(); ++i)
    if (filters_[i]->needs().segmentation) apply(i, context);
  const float start = static_cast<float>(settings_.static_log_odds);
  for (std::size_t i = 0; i < frame.size(); ++i)
    frame.static_probability[i] = probability(start + evidence_.prior(i) + frame.measured_log_odds[i]);
  const std::vector<float>& cells = evidence_.cells();
  std::vector<float>& known = frame.coarse.static_log_odds;
  if (known.empty()) known.assign(cells.size(), 0.0F);
  for (std::size_t i = 0; i < cells.size(); ++i)
    if (cells[i] < 0.0F) known[i] = std::min(known[i], cells[i]);
}

}  // namespace holdfast
