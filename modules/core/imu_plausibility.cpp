// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/core/imu_plausibility.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <optional>

#include "holdfast/core/counted.hpp"
#include "holdfast/core/median.hpp"

namespace holdfast {

namespace {

constexpr double radians_per_degree = std::numbers::pi / 180.0;

std::string short_number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", value);
  return text;
}

double median_of(std::vector<double> values) { return upper_median(values); }

/// Median interval between samples [s].
double sample_interval(std::span<const ImuSample> samples) {
  std::vector<double> intervals;
  for (std::size_t i = 1; i < samples.size(); ++i) intervals.push_back(samples[i].timestamp - samples[i - 1].timestamp);
  return median_of(std::move(intervals));
}

std::optional<std::string> suspected_force(std::span<const ImuSample> samples) {
  std::vector<double> magnitudes;
  for (const ImuSample& sample : samples) magnitudes.push_back(sample.acceleration.norm());
  const double force = median_of(std::move(magnitudes));
  if (force > 0.8 * standard_gravity && force < 1.25 * standard_gravity) return std::nullopt;
  const std::string found =
      "the accelerations have a median magnitude of " + short_number(force) + " m/s^2; expected about 9.8";
  if (force > 0.8 && force < 1.25)
    return found + ", because gravity is measured too; they look like multiples of g: multiply them by 9.80665";
  if (force > 800.0 && force < 1250.0)
    return found + ", because gravity is measured too; they look like thousandths of g: multiply them by 0.00980665";
  std::vector<double> rates;
  for (const ImuSample& sample : samples) rates.push_back(sample.angular_velocity.norm());
  if (const double rate = median_of(std::move(rates)); rate > 0.9 * standard_gravity && rate < 1.1 * standard_gravity)
    return found + "; the angular velocities have " + short_number(rate) +
           ": the two look exchanged; expected angular velocities first";
  if (force < 0.4 * standard_gravity)
    return found +
           ", because gravity is measured too; it was probably subtracted ('linear acceleration' of a phone or "
           "of a fused sensor): record the raw accelerometer";
  return found + ", because a hand-held or flying sensor mostly measures gravity; check their unit and scale";
}

/// A change of the axes or of the unit of rates.
struct RateChange {
  Eigen::Matrix3d matrix = Eigen::Matrix3d::Identity();
  std::string remedy;
};

/// All rotations and reflections that map axes to axes, the identity first.
std::vector<RateChange> axis_changes() {
  std::vector<RateChange> changes;
  std::array<int, 3> order = {0, 1, 2};
  do {
    for (int signs = 0; signs < 8; ++signs) {
      RateChange change;
      change.matrix.setZero();
      std::string axes;
      for (int row = 0; row < 3; ++row) {
        const bool is_negative = (signs & (1 << row)) != 0;
        change.matrix(row, order[static_cast<std::size_t>(row)]) = is_negative ? -1.0 : 1.0;
        axes +=
            std::string(row == 0 ? "" : ", ") + (is_negative ? "-" : "") + "xyz"[order[static_cast<std::size_t>(row)]];
      }
      change.remedy = "they fit as (" + axes + ")";
      changes.push_back(std::move(change));
    }
  } while (std::next_permutation(order.begin(), order.end()));
  return changes;
}

/// Mean specific forces of windows, and the rates between the middles of neighbouring windows.
struct GravityWindows {
  std::vector<Eigen::Vector3d> directions;
  std::vector<std::vector<Eigen::Vector3d>> turns;  ///< rotation vectors of samples [rad], between i and i + 1
};

GravityWindows gravity_windows(std::span<const ImuSample> samples, double interval) {
  constexpr double duration = 0.25;  // s
  constexpr std::size_t most_windows = 400;
  const auto size = static_cast<std::size_t>(std::clamp(duration / interval, 1.0, static_cast<double>(samples.size())));
  GravityWindows windows;
  const std::size_t count = std::min(samples.size() / size, most_windows);
  for (std::size_t window = 0; window < count; ++window) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (std::size_t i = window * size; i < (window + 1) * size; ++i) sum += samples[i].acceleration;
    windows.directions.push_back(sum.normalized());
    if (window + 1 == count) break;
    std::vector<Eigen::Vector3d>& turns = windows.turns.emplace_back();
    for (std::size_t i = window * size + size / 2; i < (window + 1) * size + size / 2; ++i)
      turns.push_back(samples[i].angular_velocity * interval);
  }
  return windows;
}

/// Root mean square of the angle between the measured direction of gravity and that predicted from the window before
/// [rad]. `change` is applied to rates; zero = they are ignored.
double prediction_error(const GravityWindows& windows, const Eigen::Matrix3d& change) {
  double sum = 0.0;
  for (std::size_t i = 0; i < windows.turns.size(); ++i) {
    Eigen::Vector3d predicted = windows.directions[i];
    for (const Eigen::Vector3d& measured : windows.turns[i]) {
      const Eigen::Vector3d turn = change * measured;
      const double angle = turn.norm();
      if (angle > 0.0) predicted = Eigen::AngleAxisd(-angle, turn / angle) * predicted;
    }
    const double angle =
        std::atan2(predicted.cross(windows.directions[i + 1]).norm(), predicted.dot(windows.directions[i + 1]));
    sum += angle * angle;
  }
  return std::sqrt(sum / static_cast<double>(std::max<std::size_t>(windows.turns.size(), 1)));
}

std::optional<std::string> suspected_rates(std::span<const ImuSample> samples, double interval) {
  constexpr double fastest = 45.0;  // rad/s; gyroscopes measure up to 2000 degrees/s, which are 35
  double largest = 0.0;
  for (const ImuSample& sample : samples) largest = std::max(largest, sample.angular_velocity.cwiseAbs().maxCoeff());
  const std::string degrees = "they look like degrees per second: divide them by 57.2958";
  if (largest > fastest)
    return "the angular velocities reach " + short_number(largest) + " rad/s, more than gyroscopes measure; " + degrees;
  const GravityWindows windows = gravity_windows(samples, interval);
  if (windows.turns.size() < 20) return std::nullopt;
  const double still = prediction_error(windows, Eigen::Matrix3d::Zero());
  const double as_given = prediction_error(windows, Eigen::Matrix3d::Identity());
  // Turns that are small, or about the vertical alone, tell nothing of the axes.
  if (still < 3.0 * radians_per_degree || as_given < 1.1 * still) return std::nullopt;
  const std::string finding =
      "the rotation by the angular velocities contradicts the direction of gravity in the accelerations by " +
      short_number(as_given / radians_per_degree) +
      " degrees from one quarter of a second to the next, where no rotation at all would by " +
      short_number(still / radians_per_degree) + "; ";
  const double in_degrees = prediction_error(windows, Eigen::Matrix3d::Identity() * radians_per_degree);
  if (in_degrees < 0.5 * as_given && in_degrees < 0.8 * still) return finding + degrees;
  // Without a change that fits, other accelerations hide gravity: that of a multirotor is always along its axis.
  const RateChange* best = nullptr;
  double best_error = 0.6 * still;
  static const std::vector<RateChange> changes = axis_changes();
  for (const RateChange& change : changes)
    if (const double error = prediction_error(windows, change.matrix); error < best_error)
      best = &change, best_error = error;
  if (best == nullptr) return std::nullopt;
  return finding + "gyroscope and accelerometer have other axes, and " + best->remedy +
         ": give both in the axes of one body, x, y and z in this order";
}

std::optional<std::string> suspected_gaps(std::span<const ImuSample> samples, double interval) {
  std::size_t gaps = 0;
  double longest = 0.0, at = 0.0;
  for (std::size_t i = 1; i < samples.size(); ++i) {
    const double pause = samples[i].timestamp - samples[i - 1].timestamp;
    if (pause < std::max(5.0 * interval, 0.02)) continue;
    ++gaps;
    if (pause > longest) longest = pause, at = samples[i - 1].timestamp;
  }
  if (gaps == 0) return std::nullopt;
  char stamp[32];
  std::snprintf(stamp, sizeof stamp, "%.6f", at);
  return "the inertial measurements have " + counted(gaps, "gap") + ", the longest of " + short_number(longest) +
         " s at " + stamp + ", with one each " + short_number(interval) +
         " s elsewhere; motion over a gap is not known: check how they were recorded";
}

std::optional<std::string> suspected_rate(double interval, double expected) {
  const double rate = 1.0 / interval;
  if (!(expected > 0.0) || (rate > 0.8 * expected && rate < 1.25 * expected)) return std::nullopt;
  return "the inertial measurements come " + short_number(rate) + " times a second, and 'rate' says " +
         short_number(expected) + "; correct 'rate' of 'imu'";
}

std::optional<std::string> suspected_saturation(std::span<const ImuSample> samples, const ImuExpectation& expected) {
  const auto count = [&](auto member, double range) {
    if (!(range > 0.0)) return std::ptrdiff_t{0};
    return std::count_if(samples.begin(), samples.end(),
                         [&](const ImuSample& s) { return (s.*member).cwiseAbs().maxCoeff() >= 0.999 * range; });
  };
  const auto rates = count(&ImuSample::angular_velocity, expected.gyroscope_range);
  const auto forces = count(&ImuSample::acceleration, expected.accelerometer_range);
  if (rates + forces == 0) return std::nullopt;
  return std::to_string(rates) + " angular velocities and " + std::to_string(forces) +
         " accelerations are at the end of the sensor's range or beyond; correct 'gyroscope_range' and "
         "'accelerometer_range' of 'imu', or choose a larger range of the sensor";
}

}  // namespace

std::vector<std::string> imu_suspicions(std::span<const ImuSample> samples, const ImuExpectation& expected) {
  constexpr std::size_t fewest = 50;
  if (samples.size() < fewest) return {};
  const double interval = sample_interval(samples);
  std::vector<std::string> suspicions;
  const auto add = [&](std::optional<std::string> suspicion) {
    if (suspicion) suspicions.push_back(std::move(*suspicion));
  };
  const std::optional<std::string> force = suspected_force(samples);
  add(force);
  add(suspected_rates(samples, interval));
  add(suspected_gaps(samples, interval));
  add(suspected_rate(interval, expected.rate));
  if (!force) add(suspected_saturation(samples, expected));
  return suspicions;
}

}  // namespace holdfast
