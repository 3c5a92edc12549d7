// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/core/imu_timeline.hpp"

#include <algorithm>
#include <utility>

namespace holdfast {

void append_imu(std::vector<ImuSample>& samples, const std::vector<ImuSample>& later) {
  for (const ImuSample& sample : later)
    if (samples.empty() || samples.back().timestamp < sample.timestamp) samples.push_back(sample);
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
