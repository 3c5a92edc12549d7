// SPDX-License-Identifier: BSD-3-Clause
// Times of feature extraction and of descriptor distances, on one thread. Images: 40 frames spread over the TUM
// sequence in $HOLDFAST_DATA/tum_fr1_xyz, or synthetic ones when HOLDFAST_DATA is unset. The counter `to_cv_orb` of an
// extractor is its median time divided by that of cv::ORB(1000), image by image in turn with it, so that a busy machine
// slows both.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <iostream>
#include <memory>
#include <numeric>
#include <string>
#include <vector>

#include <opencv2/core/utility.hpp>
#include <opencv2/features2d.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "holdfast/core/random.hpp"
#include "holdfast/core/simd.hpp"
#include "holdfast/matching/descriptors.hpp"
#include "opencv_orb/opencv_orb.hpp"
#include "orb/orb.hpp"

namespace {

using namespace holdfast;
using Clock = std::chrono::steady_clock;

cv::Mat synthetic_image(std::uint64_t seed) {
  Random random(seed);
  cv::Mat image(480, 640, CV_8UC1, cv::Scalar(128));
  for (int i = 0; i < 400; ++i) {
    const cv::Point corner{static_cast<int>(random.below(640)), static_cast<int>(random.below(480))};
    const cv::Size size{4 + static_cast<int>(random.below(80)), 4 + static_cast<int>(random.below(80))};
    cv::rectangle(image, cv::Rect(corner, size), cv::Scalar(random.below(256)), cv::FILLED);
  }
  cv::GaussianBlur(image, image, cv::Size(3, 3), 0.8);
  return image;
}

std::vector<cv::Mat> load_images() {
  std::vector<cv::Mat> images;
  if (const char* data = std::getenv("HOLDFAST_DATA")) {
    const std::filesystem::path folder = std::filesystem::path(data) / "tum_fr1_xyz" / "rgb";
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    for (std::size_t i = 0; i < files.size(); i += std::max<std::size_t>(1, files.size() / 40))
      images.push_back(cv::imread(files[i].string(), cv::IMREAD_GRAYSCALE));
  }
  if (images.empty())
    for (std::uint64_t seed = 1; seed <= 10; ++seed) images.push_back(synthetic_image(seed));
  return images;
}

const std::vector<cv::Mat>& images() {
  static const std::vector<cv::Mat> loaded = load_images();
  return loaded;
}

double median(std::vector<double>& values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
  return values[values.size() / 2];
}

template <class Function>
double seconds(const Function& function) {
  const auto begin = Clock::now();
  function();
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

void run_extractor(benchmark::State& state, FeatureExtractor& extractor) {
  const cv::Ptr<cv::ORB> reference = cv::ORB::create(1000);
  std::vector<cv::KeyPoint> keypoints;
  cv::Mat descriptors;
  Features features;
  extractor.extract(images()[0], cv::Mat(), features);  // buffers are made once
  std::vector<double> times, reference_times;
  std::size_t next = 0, count = 0;
  for (auto _ : state) {
    const cv::Mat& image = images()[next++ % images().size()];
    reference_times.push_back(
        seconds([&] { reference->detectAndCompute(image, cv::noArray(), keypoints, descriptors); }));
    times.push_back(seconds([&] { extractor.extract(image, cv::Mat(), features); }));
    state.SetIterationTime(times.back());
    count += features.size();
  }
  const double typical = median(times), typical_reference = median(reference_times);
  state.counters["median_ms"] = 1e3 * typical;
  state.counters["cv_orb_ms"] = 1e3 * typical_reference;
  state.counters["to_cv_orb"] = typical / typical_reference;
  state.counters["features"] = static_cast<double>(count) / static_cast<double>(times.size());
}

void opencv_orb(benchmark::State& state) {
  opencv_orb_plugin::OpencvOrb extractor({});
  run_extractor(state, extractor);
}
BENCHMARK(opencv_orb)->UseManualTime()->Iterations(120)->Unit(benchmark::kMillisecond);

void orb(benchmark::State& state) {
  const SimdLevel level = simd_levels.at(static_cast<std::size_t>(state.range(0)));
  if (!has_simd_level(level)) return state.SkipWithError("this processor lacks the SIMD level");
  state.SetLabel(to_string(level));
  OrbExtractor extractor({}, {}, level);
  run_extractor(state, extractor);
}
BENCHMARK(orb)
    ->DenseRange(0, static_cast<std::int64_t>(simd_levels.size()) - 1)
    ->UseManualTime()
    ->Iterations(120)
    ->Unit(benchmark::kMillisecond);

std::vector<Descriptor256> random_descriptors(std::size_t count) {
  Random random(7);
  std::vector<Descriptor256> descriptors(count);
  for (Descriptor256& descriptor : descriptors)
    for (std::uint64_t& word : descriptor.words) word = random.next();
  return descriptors;
}

/// One query against many candidates, as the matchers ask.
void nearest(benchmark::State& state) {
  const std::vector<Descriptor256> descriptors = random_descriptors(1000);
  std::vector<std::uint32_t> candidates(descriptors.size());
  std::iota(candidates.begin(), candidates.end(), 0U);
  const DescriptorView block = descriptors;
  std::vector<float> distances;
  for (auto _ : state)
    benchmark::DoNotOptimize(
        matching::nearest_two(block, 500, block, std::span<const std::uint32_t>(candidates), distances));
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(candidates.size()));
}
BENCHMARK(nearest);

/// The same without the kernels, for comparison.
void nearest_plain(benchmark::State& state) {
  const std::vector<Descriptor256> descriptors = random_descriptors(1000);
  for (auto _ : state) {
    int best = 257;
    for (std::size_t i = 0; i < descriptors.size(); ++i)
      if (i != 500) best = std::min(best, hamming_distance(descriptors[500], descriptors[i]));
    benchmark::DoNotOptimize(best);
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(descriptors.size()));
}
BENCHMARK(nearest_plain);

}  // namespace

int main(int argc, char** argv) {
  cv::setNumThreads(1);
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  std::cerr << images().size() << (std::getenv("HOLDFAST_DATA") ? " recorded" : " synthetic") << " images\n";
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
