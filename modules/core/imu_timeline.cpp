// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/core/imu_timeline.hpp"

#include <algorithm>
#include <utility>

namespace holdfast {

void append_imu(std::vector<ImuSample>& samples, const std::vector<ImuSample>& later) {
  for (const ImuSample& sample : later)
    if (samples.empty() || samples.back().timestamp < sample.timestamp) samples.push_back(sample);
}

std::vector<ImuSample> covering(std::vector<ImuSample> samples, double begin, double end, const ImuCalibration& imu) {
  const double tolerance = 2.0 / imu.rate;
  if (samples.empty()) return samples;
  if (samples.back().timestamp < end && end - samples.back().timestamp <= tolerance) {
    samples.push_back(samples.back());
    samples.back().timestamp = end;
  }
  if (samples.front().timestamp > begin && samples.front().timestamp - begin <= tolerance) {
    samples.insert(samples.begin(), samples.front());
    samples.front().timestamp = begin;
  }
  return samples;
}

bool has_saturated(std::span<const ImuSample> samples, const ImuCalibration& imu) {
  constexpr double share = 0.999;
  return std::any_of(samples.begin(), samples.end(), [&](const ImuSample& sample) {
    return sample.angular_velocity.cwiseAbs().maxCoeff() >= share * imu.gyroscope_range ||
           sample.acceleration.cwiseAbs().maxCoeff() >= share * imu.accelerometer_range;
  });
}

ImuTimeline::ImuTimeline(std::vector<ImuSample> samples, double time_offset) : samples_(std::move(samples)) {
  for (ImuSample& sample : samples_) sample.timestamp -= time_offset;
}

std::vector<ImuSample> ImuTimeline::take(double timestamp) {
  const double begin = last_.value_or(timestamp);
  last_ = timestamp;
  const auto is_earlier = [](double time, const ImuSample& sample) { return time < sample.timestamp; };
  const auto is_before = [](const ImuSample& sample, double time) { return sample.timestamp < time; };
  auto first = std::upper_bound(samples_.begin(), samples_.end(), begin, is_earlier);
  if (first != samples_.begin()) --first;
  auto last = std::lower_bound(first, samples_.end(), timestamp, is_before);
  if (last != samples_.end()) ++last;
  return {first, last};
}

}  // namespace holdfast
