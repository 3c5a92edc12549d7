// SPDX-License-Identifier: BSD-3-Clause
// Time of the U-Net for one 640x480 frame, by size, engine and precision, on one thread, resizing and labels included.
// Images: 40 frames spread over the TUM sequence in $HOLDFAST_DATA/tum_fr1_xyz, or synthetic ones when HOLDFAST_DATA is
// unset. The counter `to_cv_orb` is the median time divided by that of cv::ORB(1000), image by image in turn with it,
// so that a busy machine slows both.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <opencv2/core/utility.hpp>
#include <opencv2/features2d.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "holdfast/core/error.hpp"
#include "holdfast/inference/network.hpp"
#include "holdfast/interfaces/segmenter.hpp"
#include "holdfast/plugin/builtin.hpp"
#include "holdfast/plugin/registry.hpp"
#include "processor_time.hpp"

namespace {

using namespace holdfast;
using Clock = std::chrono::steady_clock;

std::vector<cv::Mat> load_images() {
  std::vector<cv::Mat> images;
  if (const char* data = std::getenv("HOLDFAST_DATA")) {
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::directory_iterator(std::filesystem::path(data) / "tum_fr1_xyz" / "rgb"))
      files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    for (std::size_t i = 0; i < files.size(); i += std::max<std::size_t>(1, files.size() / 40))
      images.push_back(cv::imread(files[i].string()));
  }
  for (std::uint64_t seed = 1; images.empty() || (images.size() < 10 && seed < 10); ++seed) {
    cv::Mat image(480, 640, CV_8UC3);
    cv::RNG random(seed);
    random.fill(image, cv::RNG::UNIFORM, 0, 256);
    cv::GaussianBlur(image, image, {0, 0}, 3.0);
    images.push_back(image);
  }
  return images;
}

template <class Function>
double seconds(const Function& function) {
  const auto begin = Clock::now();
  function();
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
  return values[values.size() / 2];
}

void unet(benchmark::State& state, const ParameterValues& settings) {
  static const std::vector<cv::Mat> images = load_images();
  Registry registry;
  register_builtin_plugins(registry);
  const auto segmenter = registry.create<Segmenter>("unet", settings, CreationContext{});
  const cv::Ptr<cv::ORB> reference = cv::ORB::create(1000);
  std::vector<cv::KeyPoint> keypoints;
  cv::Mat descriptors, grey;
  std::vector<double> times, reference_times;
  std::size_t next = 0;
  for (auto _ : state) {
    SensorFrame frame;
    frame.colour = images[next++ % images.size()];
    cv::cvtColor(frame.colour, grey, cv::COLOR_BGR2GRAY);
    reference_times.push_back(
        seconds([&] { reference->detectAndCompute(grey, cv::noArray(), keypoints, descriptors); }));
    times.push_back(seconds([&] { benchmark::DoNotOptimize(segmenter->segment(frame)); }));
    state.SetIterationTime(times.back());
  }
  state.counters["median_ms"] = 1e3 * median(times);
  state.counters["cv_orb_ms"] = 1e3 * median(reference_times);
  state.counters["to_cv_orb"] = median(times) / median(reference_times);
}

/// Processor time of the U-Net by ONNX Runtime, relative to oneDNN, image by image in turn: the counter `to_onednn` is
/// the median of the ratios, which other programs hardly disturb.
void onnxruntime_to_onednn(benchmark::State& state) {
  const std::vector<cv::Mat> images = load_images();
  Registry registry;
  register_builtin_plugins(registry);
  const auto make = [&](const char* engine) {
    return registry.create<Segmenter>("unet", {{"engine", std::string(engine)}}, CreationContext{});
  };
  const std::unique_ptr<Segmenter> segmenters[] = {make("onednn"), make("onnxruntime")};
  std::vector<double> ratios, times[2];
  for (auto _ : state) {
    SensorFrame frame;
    frame.colour = images[ratios.size() % images.size()];
    for (const std::size_t turn : {0, 1}) {
      const std::size_t engine = (turn + ratios.size()) % 2;
      const double begin = processor_seconds();
      benchmark::DoNotOptimize(segmenters[engine]->segment(frame));
      times[engine].push_back(processor_seconds() - begin);
    }
    ratios.push_back(times[1].back() / times[0].back());
  }
  state.counters["onednn_ms"] = 1e3 * median(times[0]);
  state.counters["onnxruntime_ms"] = 1e3 * median(times[1]);
  state.counters["to_onednn"] = median(ratios);
}

/// With every engine and precision that this build and this processor have.
void register_benchmarks() {
  Registry registry;
  register_builtin_plugins(registry);
  for (const char* size : {"small", "base", "large"})
    for (const bool mirror : {false, true})
      for (const auto& [engine, precision] :
           {std::pair("opencv", "fp32"), {"onednn", "fp32"}, {"onednn", "bf16"}, {"onnxruntime", "fp32"}}) {
        const ParameterValues settings = {{"size", std::string(size)},
                                          {"mirror", mirror},
                                          {"engine", std::string(engine)},
                                          {"precision", std::string(precision)}};
        try {
          registry.create<Segmenter>("unet", settings, CreationContext{});
        } catch (const ConfigurationError&) {
          continue;
        }
        const std::string name = std::string("unet/") + size + (mirror ? "_mirror/" : "/") + engine + "/" + precision;
        benchmark::RegisterBenchmark(name.c_str(), unet, settings)
            ->UseManualTime()
            ->Iterations(40)
            ->Unit(benchmark::kMillisecond);
      }
  if (has_onednn() && has_onnxruntime())
    benchmark::RegisterBenchmark("unet/onnxruntime_to_onednn", onnxruntime_to_onednn)
        ->Iterations(60)
        ->Unit(benchmark::kMillisecond);
}

}  // namespace

int main(int argc, char** argv) {
  cv::setNumThreads(1);
  register_benchmarks();
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
