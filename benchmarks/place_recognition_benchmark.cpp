// SPDX-License-Identifier: BSD-3-Clause
// Place recognition with `flann` on a map of 100, 1,000 and 10,000 keyframes of 1000 descriptors: time of a query and
// the insertion after it, for the last tenth of the keyframes (at least 50), and memory of the detector per keyframe,
// as the allocator counts it. The descriptors are drawn (place_tour.hpp says how), not seen; real ones: place_recall.
#include <benchmark/benchmark.h>
#include <malloc.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <vector>

#include "flann_detector.hpp"
#include "place_tour.hpp"

namespace holdfast {
namespace {

using Clock = std::chrono::steady_clock;

double milliseconds(Clock::time_point begin) {
  return std::chrono::duration<double, std::milli>(Clock::now() - begin).count();
}

double allocated_bytes() {
  const struct mallinfo2 information = mallinfo2();
  return static_cast<double>(information.uordblks + information.hblkhd);
}

double quantile(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
}

void place_recognition(benchmark::State& state) {
  const PlaceTour tour;
  const auto keyframes = static_cast<std::uint32_t>(state.range(0));
  for (auto _ : state) {
    const double bytes_before = allocated_bytes();
    auto detector = std::make_unique<flann_plugin::FlannDetector>(FlannSettings{});
    std::vector<double> query_times, times, all_times;
    const std::uint32_t measured = std::max(50U, keyframes / 10);
    int revisits = 0, found = 0;
    for (std::uint32_t i = 0; i < keyframes; ++i) {
      const auto descriptors = tour.keyframe(i);
      const auto begin = Clock::now();
      const auto matches = detector->query(descriptors, 30);
      const double query_time = milliseconds(begin);
      detector->add({i, 0}, descriptors);
      all_times.push_back(milliseconds(begin));
      if (i + measured < keyframes) continue;
      times.push_back(all_times.back());
      query_times.push_back(query_time);
      if (i / 50 % 2 == 0) continue;
      ++revisits;
      // The neighbours in time are alike, too: right is any keyframe of an earlier stretch that stands near.
      found += std::any_of(matches.begin(), matches.end(), [&](const PlaceMatch& match) {
        return match.keyframe.slot / 50 < i / 50 && std::abs(tour.place(match.keyframe.slot) - tour.place(i)) <= 1;
      });
    }
    state.SetIterationTime(1e-3 * quantile(times, 0.5));
    state.counters["median_ms"] = quantile(times, 0.5);
    state.counters["query_median_ms"] = quantile(query_times, 0.5);
    state.counters["p99_ms"] = quantile(times, 0.99);
    state.counters["worst_ms"] = quantile(all_times, 1.0);
    state.counters["bytes_per_keyframe"] = (allocated_bytes() - bytes_before) / keyframes;
    state.counters["words_per_keyframe"] = static_cast<double>(detector->words()) / keyframes;
    state.counters["revisits_found"] = revisits > 0 ? static_cast<double>(found) / revisits : 0.0;
  }
}

BENCHMARK(place_recognition)
    ->Arg(100)
    ->Arg(1000)
    ->Arg(10000)
    ->Iterations(1)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace holdfast

BENCHMARK_MAIN();
