// SPDX-License-Identifier: BSD-3-Clause
#include "opencv_orb.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include <opencv2/features2d.hpp>

#include "holdfast/keypoints/keypoints.hpp"
#include "holdfast/plugin/parameter_table.hpp"

namespace holdfast {

void OpencvOrbSettings::describe(ParameterTable<OpencvOrbSettings>& table) {
  using S = OpencvOrbSettings;
  table.add("count", &S::count, "number of features to extract per image").range(10, 50000);
  table.add("scale_factor", &S::scale_factor, "scale between adjacent pyramid levels").range(1.05, 2.0);
  table.add("levels", &S::levels, "number of pyramid levels").range(1, 16);
  table.add("fast_threshold", &S::fast_threshold, "minimum contrast of a FAST corner").range(1, 250).unit("grey level");
}

}  // namespace holdfast

namespace holdfast::opencv_orb_plugin {

namespace {
constexpr int border = 31;  // [px of the level], OpenCV's default edge threshold and patch size
}  // namespace

OpencvOrb::OpencvOrb(const OpencvOrbSettings& settings, const CreationContext&)
    : count_(settings.count),
      pyramid_(settings.levels, settings.scale_factor),
      orb_(std::make_unique<cv::Ptr<cv::ORB>>(cv::ORB::create(
          settings.count, static_cast<float>(settings.scale_factor), settings.levels, border, /*firstLevel=*/0,
          /*WTA_K=*/2, cv::ORB::HARRIS_SCORE, /*patchSize=*/border, settings.fast_threshold))) {}

OpencvOrb::~OpencvOrb() = default;

void OpencvOrb::set_budget(double factor) {
  const int wanted = static_cast<int>(std::lround(count_ * factor));
  if ((*orb_)->getMaxFeatures() != wanted) (*orb_)->setMaxFeatures(wanted);
}

int OpencvOrb::usable_levels(const cv::Mat& grey) const {
  const int size = std::min(grey.cols, grey.rows);
  int levels = 0;
  while (levels < pyramid_.levels() &&
         std::lround(static_cast<float>(size) * pyramid_.inverse_scale[levels]) > 2 * border)
    ++levels;
  return levels;
}

void OpencvOrb::extract(const cv::Mat& grey, const cv::Mat& ignore, Features& out) {
  out.resize(0, DescriptorType());
  const int levels = usable_levels(grey);
  if (levels == 0) return;
  cv::ORB& orb = **orb_;
  if (orb.getNLevels() != levels) orb.setNLevels(levels);
  if (!keypoints::find_keypoints(orb, grey, ignore, mask_, keypoints_, descriptors_)) return;
  keypoints::copy_keypoints(keypoints_, out);
  for (std::size_t i = 0; i < keypoints_.size(); ++i) {
    out.octave[i] = static_cast<std::uint8_t>(keypoints_[i].octave);
    std::memcpy(out.descriptors.bytes(i).data(), descriptors_.ptr(static_cast<int>(i)), sizeof(Descriptor256));
  }
}

}  // namespace holdfast::opencv_orb_plugin
