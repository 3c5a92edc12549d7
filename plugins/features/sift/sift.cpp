// SPDX-License-Identifier: BSD-3-Clause
#include "sift.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <opencv2/core.hpp>

#include "holdfast/core/error.hpp"
#include "holdfast/keypoints/keypoints.hpp"
#include "holdfast/plugin/parameter_table.hpp"

namespace holdfast {

void SiftSettings::describe(ParameterTable<SiftSettings>& table) {
  using S = SiftSettings;
  table.add("count", &S::count, "number of features to extract per image, the strongest").range(10, 50000);
  table.add("octave_layers", &S::octave_layers, "layers per octave of the scale space").range(1, 8);
  table.add("contrast_threshold", &S::contrast_threshold, "minimum contrast of a feature").range(0, 1);
  table.add("edge_threshold", &S::edge_threshold, "maximum ratio of the principal curvatures of a feature")
      .range(1, 1000);
  table
      .add("strict_distance", &S::strict_distance,
           "recommended largest distance of descriptors of a match without a prediction")
      .range(1, 1000);
  table
      .add("loose_distance", &S::loose_distance,
           "recommended largest distance of descriptors of a match near its prediction, not below strict_distance")
      .range(1, 1000);
}

}  // namespace holdfast

namespace holdfast::sift_plugin {

namespace {

constexpr int octaves = 5;             // of the pyramid; larger features count as of the coarsest level
constexpr double sigma = 1.6;          // of the finest layer, in the image of twice the size, as in Lowe 2004
constexpr double finest_size = sigma;  // OpenCV's diameter of a feature of the finest scale [px of the full image]
constexpr std::uint32_t length = 128;

}  // namespace

SiftExtractor::SiftExtractor(const SiftSettings& settings, const CreationContext&)
    : pyramid_(octaves * settings.octave_layers, std::pow(2.0, 1.0 / settings.octave_layers)),
      type_{DescriptorKind::float32, DescriptorMetric::euclidean, length, static_cast<float>(settings.strict_distance),
            static_cast<float>(std::max(settings.strict_distance, settings.loose_distance))},
      octave_layers_(settings.octave_layers),
      sift_(cv::SIFT::create(settings.count, settings.octave_layers, settings.contrast_threshold,
                             settings.edge_threshold, sigma)) {}

void SiftExtractor::extract(const cv::Mat& grey, const cv::Mat& ignore, Features& out) {
  out.resize(0, type_);
  if (!keypoints::find_keypoints(*sift_, grey, ignore, mask_, keypoints_, descriptors_)) return;
  keypoints::copy_keypoints(keypoints_, out);
  for (std::size_t i = 0; i < keypoints_.size(); ++i) {
    const double scale = octave_layers_ * std::log2(keypoints_[i].size / finest_size);
    out.octave[i] = static_cast<std::uint8_t>(std::clamp<long>(std::lround(scale), 0, pyramid_.levels() - 1));
    std::memcpy(out.descriptors.bytes(i).data(), descriptors_.ptr(static_cast<int>(i)), type_.bytes());
  }
}

}  // namespace holdfast::sift_plugin
