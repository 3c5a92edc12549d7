// SPDX-License-Identifier: BSD-3-Clause
#include "reprojection_error.hpp"

#include <algorithm>
#include <bit>

#include "holdfast/plugin/plugin.hpp"

namespace holdfast::reprojection_error_plugin {

ReprojectionError::ReprojectionError(const ReprojectionErrorSettings& settings, const CreationContext&)
    : settings_(settings) {}

bool ReprojectionError::collect(const FilterContext& context) {
  const Frame& frame = context.frame;
  const Camera& camera = *frame.camera;
  const Eigen::Isometry3d& T_camera_world = *context.T_camera_world;
  const Eigen::Isometry3d T_world_camera = T_camera_world.inverse();
  int trusted = 0, passed = 0;
  matches_.clear();
  for (std::size_t i = 0; i < frame.size(); ++i) {
    const MapPoint* point = context.map.find_point(frame.map_points[i]);
    if (point == nullptr) continue;
    const Eigen::Vector3d in_camera = T_camera_world * point->position;
    if (in_camera.z() < 0.05) continue;
    const Eigen::Vector2d pixel = camera.project(in_camera);
    double error = (pixel - Eigen::Vector2d(frame.x[i], frame.y[i])).squaredNorm();
    double limit = settings_.threshold;
    Eigen::Vector3f displacement = Eigen::Vector3f::Zero();
    if (frame.has_depth(i)) {
      const double difference = frame.right_x[i] - camera.right_x(pixel.x(), in_camera.z());
      error += difference * difference;
      limit = settings_.threshold_depth;
      displacement = (T_world_camera * frame.camera_point(i) - point->position).cast<float>();
    }
    error *= frame.pyramid->inverse_sigma2[frame.features.octave[i]] / limit;
    matches_.push_back({static_cast<std::uint32_t>(i), frame.map_points[i], static_cast<float>(error), displacement,
                        point->found_ratio()});
    if (i < frame.static_probability.size() && frame.static_probability[i] < 0.5F) continue;
    ++trusted;
    passed += error <= 1.0 ? 1 : 0;
  }
  return trusted >= settings_.minimum_matches && passed >= settings_.support * trusted;
}

ReprojectionError::History& ReprojectionError::remember(const Match& match) {
  if (match.point.slot >= histories_.size()) histories_.resize(match.point.slot + 1U);
  History& history = histories_[match.point.slot];
  if (history.generation != match.point.generation) history = {.generation = match.point.generation};
  history.failures = static_cast<std::uint8_t>((history.failures << 1U) | (match.error > 1.0F ? 1U : 0U));
  history.observations = static_cast<std::uint8_t>(std::min(8, history.observations + 1));
  if (!match.displacement.isZero()) {
    constexpr float share_of_newest = 0.3F;
    history.displacement += share_of_newest * (match.displacement - history.displacement);
    history.length += share_of_newest * (match.displacement.norm() - history.length);
  }
  return history;
}

float ReprojectionError::log_odds(const Match& match, const History& history) const {
  const int failures = std::popcount(history.failures);
  if (match.error <= 1.0F)
    return static_cast<float>(settings_.static_log_odds) *
           (1.0F - static_cast<float>(failures) / static_cast<float>(history.observations));
  const bool unstable = match.found_ratio < static_cast<float>(settings_.minimum_found_ratio);
  if (!settings_.soften)
    return failures >= settings_.frames || unstable ? static_cast<float>(settings_.moving_log_odds) : 0.0F;
  const float lasting = std::min(1.0F, static_cast<float>(failures) / static_cast<float>(settings_.frames));
  // Four times the squared threshold, twice the distance, gives full evidence.
  float certainty = lasting * (0.25F + 0.75F * std::min(1.0F, (match.error - 1.0F) / 3.0F));
  // With depth: displacements that agree in direction are motion; others are noise or wrong matches.
  if (history.length > 0.0F)
    certainty *= history.displacement.norm() >= static_cast<float>(settings_.agreement) * history.length ? 1.0F : 0.5F;
  if (unstable) certainty = std::min(1.0F, 1.5F * certainty);
  return static_cast<float>(settings_.moving_log_odds) * certainty;
}

void ReprojectionError::apply(const FilterContext& context, StaticEvidence& evidence) {
  if (context.T_camera_world == nullptr || !collect(context)) return;
  for (const Match& match : matches_) {
    const float said = log_odds(match, remember(match));
    if (said != 0.0F) evidence.add(match.feature, said);
  }
}

}  // namespace holdfast::reprojection_error_plugin

HOLDFAST_PLUGIN(reprojection_error, registry) {
  registry.add<holdfast::DynamicFilter, holdfast::reprojection_error_plugin::ReprojectionError,
               holdfast::ReprojectionErrorSettings>(
      {.name = holdfast::ReprojectionErrorSettings::module,
       .summary =
           "What lies far from its map point for several frames moves; silent when the pose may be what is wrong.",
       .paper =
           "Zeng et al.: A Semantics-Guided Visual SLAM with U-Net for Complex Dynamic Indoor Environments. Remote "
           "Sensing 15, 5479, 2023, steps 2 to 6"});
}
