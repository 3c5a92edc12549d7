// SPDX-License-Identifier: BSD-3-Clause
#include "diagnosis.hpp"

#include <cstdio>

#include "holdfast/core/health_reason_names.hpp"

namespace holdfast::bridge {

namespace {

using Level = Diagnostics::Level;

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.3f", value);
  return text;
}

Level level_of(HealthState state) {
  switch (state) {
    case HealthState::good:
      return Level::ok;
    case HealthState::lost:
    case HealthState::stalled:
      return Level::error;
    default:
      return Level::warning;
  }
}

std::string reason_names(const HealthReasons& reasons) {
  std::string text;
  for (const std::string& name : names_of(reasons)) text += (text.empty() ? "" : ", ") + name;
  return text;
}

std::string text_of(const FrameHealth& health) {
  std::string text = to_string(health.state);
  const std::string reasons = reason_names(health.reasons);
  if (!reasons.empty()) text += ": " + reasons;
  if (health.state == HealthState::relocalised) text += ": the pose moved by " + number(health.jump) + " m";
  return text;
}

void describe_state(const BridgeStatus& status, Diagnostics& result) {
  const BridgeCounts& counts = status.counts;
  const auto say = [&](Level level, std::string text) { result.level = level, result.message = std::move(text); };
  if (!status.failure.empty()) return say(Level::error, status.failure);
  if (status.is_paused) return say(Level::ok, "paused");
  if (counts.colour == 0) return say(Level::warning, "no colour image has come yet");
  if (status.needs_camera)
    return say(Level::warning, "no camera_info has come yet; give its topic, or the camera in the configuration");
  if (status.health && counts.answered > 0)
    return say(level_of(status.health->health.state), text_of(status.health->health));
  if (counts.unpaired > 0)
    return say(Level::warning,
               "colour images come without a partner of the same time; check the topics and `tolerance`");
  say(Level::warning, "waits for the first frame");
}

}  // namespace

Diagnostics diagnose(const BridgeStatus& status) {
  Diagnostics result;
  describe_state(status, result);
  const BridgeCounts& counts = status.counts;
  const auto add = [&](const char* name, std::string value) { result.values.emplace_back(name, std::move(value)); };
  if (status.health) {
    add("state", to_string(status.health->health.state));
    add("reasons", reason_names(status.health->health.reasons));
    add("jump", number(status.health->health.jump));
    add("since_frame", number(status.health->since_frame));
  }
  for (const auto& [name, count] :
       {std::pair("colour_images", counts.colour), std::pair("depth_images", counts.depth),
        std::pair("right_images", counts.right), std::pair("inertial_samples", counts.inertia),
        std::pair("unusable", counts.unusable), std::pair("unpaired", counts.unpaired),
        std::pair("dropped", counts.dropped), std::pair("answered", counts.answered),
        std::pair("with_pose", counts.with_pose), std::pair("late", counts.late),
        std::pair("keyframes_added", std::uint64_t{status.keyframes})})
    add(name, std::to_string(count));
  add("latency_ms", number(1e3 * counts.latency));
  add("largest_latency_ms", number(1e3 * counts.largest_latency));
  return result;
}

}  // namespace holdfast::bridge
