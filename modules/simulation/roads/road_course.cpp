// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>

#include "full_turn.hpp"
#include "holdfast/core/error.hpp"
#include "holdfast/core/random.hpp"
#include "holdfast/simulation/road.hpp"

namespace holdfast::simulation {

namespace {
constexpr double speed_change = 0.08, speed_period = 13.0;  // [s]
}

const char* to_string(RoadKind kind) { return kind == RoadKind::street ? "street" : "motorway"; }

std::vector<std::string> road_names() { return {"street", "motorway"}; }

RoadKind road_kind(const std::string& name) {
  for (const RoadKind kind : {RoadKind::street, RoadKind::motorway})
    if (name == to_string(kind)) return kind;
  throw ConfigurationError(SourceLocation{}, "road '" + name + "' is not known; expected street or motorway");
}

const RoadProfile& road_profile(RoadKind kind) {
  static const RoadProfile street{{1.75}, 3.5, 5.7, 8.7}, motorway{{4.625, 8.375}, 3.75, 12.75, 12.75};
  return kind == RoadKind::street ? street : motorway;
}

RoadCourse::RoadCourse(const RoadPlan& plan, std::uint64_t seed) : plan_(plan) {
  const bool street = plan.kind == RoadKind::street;
  Random random = Random(seed).fork(0x70ad);
  // The largest angle of each wave is 2 pi amplitude / length.
  const double lengths[] = {street ? 210.0 : 900.0, street ? 83.0 : 370.0};
  const double angles[] = {street ? 0.16 : 0.10, street ? 0.06 : 0.05};
  for (int i = 0; i < 2; ++i) {
    const double length = lengths[i] * random.uniform(0.85, 1.15);
    const double angle = angles[i] * random.uniform(0.6, 1.0) * plan.bends;
    const double phase = random.uniform(0.0, full_turn<double>);
    waves_[i] = {angle * length / full_turn<double>, full_turn<double> / length, phase};
  }
  phase_ = random.uniform(0.0, full_turn<double>);
}

Eigen::Isometry3d RoadCourse::frame(double x, double left) const {
  double y = 0.0, slope = 0.0;
  for (const Wave& wave : waves_) {
    y += wave.amplitude * std::sin(wave.frequency * x + wave.phase);
    slope += wave.amplitude * wave.frequency * std::cos(wave.frequency * x + wave.phase);
  }
  return Eigen::Translation3d(x, y, 0.0) * Eigen::AngleAxisd(std::atan(slope), Eigen::Vector3d::UnitZ()) *
         Eigen::Translation3d(0.0, left, 0.0);
}

double RoadCourse::driven(double time) const {
  const double frequency = full_turn<double> / speed_period;
  return plan_.mean_speed() *
         (time + speed_change / frequency * (std::sin(frequency * time + phase_) - std::sin(phase_)));
}

double RoadCourse::lane() const { return -road_profile(plan_.kind).lanes.back(); }

}  // namespace holdfast::simulation
