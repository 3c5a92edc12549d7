// SPDX-License-Identifier: BSD-3-Clause
#include "akaze.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <opencv2/core.hpp>

#include "holdfast/core/error.hpp"
#include "holdfast/keypoints/keypoints.hpp"
#include "holdfast/plugin/parameter_table.hpp"

namespace holdfast {

void AkazeSettings::describe(ParameterTable<AkazeSettings>& table) {
  using S = AkazeSettings;
  table.add("count", &S::count, "number of features to extract per image, the strongest").range(10, 50000);
  table.add("octaves", &S::octaves, "octaves of the scale space").range(1, 8);
  table.add("octave_layers", &S::octave_layers, "layers per octave of the scale space").range(1, 8);
  table.add("threshold", &S::threshold, "minimum response of a feature").range(0, 1);
  table
      .add("strict_distance", &S::strict_distance,
           "recommended largest distance of descriptors of a match without a prediction")
      .range(1, 486)
      .unit("bits");
  table
      .add("loose_distance", &S::loose_distance,
           "recommended largest distance of descriptors of a match near its prediction, not below strict_distance")
      .range(1, 486)
      .unit("bits");
}

}  // namespace holdfast

namespace holdfast::akaze_plugin {

namespace {
constexpr std::uint32_t length = 486;  // [bits] of MLDB with three channels
}  // namespace

AkazeExtractor::AkazeExtractor(const AkazeSettings& settings, const CreationContext&)
    : count_(static_cast<std::size_t>(settings.count)),
      pyramid_(settings.octaves * settings.octave_layers, std::pow(2.0, 1.0 / settings.octave_layers)),
      type_{DescriptorKind::binary, DescriptorMetric::hamming, length, static_cast<float>(settings.strict_distance),
            static_cast<float>(std::max(settings.strict_distance, settings.loose_distance))},
      akaze_(cv::AKAZE::create(cv::AKAZE::DESCRIPTOR_MLDB, 0, 3, static_cast<float>(settings.threshold),
                               settings.octaves, settings.octave_layers)) {}

void AkazeExtractor::extract(const cv::Mat& grey, const cv::Mat& ignore, Features& out) {
  out.resize(0, type_);
  if (!keypoints::find_keypoints(*akaze_, grey, ignore, mask_, keypoints_, descriptors_)) return;
  const std::vector<std::uint32_t> strongest = keypoints::strongest_keypoints(
      keypoints_, static_cast<std::size_t>(std::lround(static_cast<double>(count_) * budget_)));
  std::vector<cv::KeyPoint> kept;
  for (const std::uint32_t i : strongest) kept.push_back(keypoints_[i]);
  keypoints::copy_keypoints(kept, out);
  for (std::size_t i = 0; i < kept.size(); ++i) {
    // OpenCV puts the layer of the scale space, from the finest, into class_id.
    out.octave[i] = static_cast<std::uint8_t>(std::clamp(kept[i].class_id, 0, pyramid_.levels() - 1));
    std::memcpy(out.descriptors.bytes(i).data(), descriptors_.ptr(static_cast<int>(strongest[i])), type_.bytes());
  }
}

}  // namespace holdfast::akaze_plugin
