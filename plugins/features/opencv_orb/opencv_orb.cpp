// SPDX-License-Identifier: BSD-3-Clause
#include "opencv_orb.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>

#include <opencv2/features2d.hpp>

#include "holdfast/core/error.hpp"
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
    : pyramid_(settings.levels, settings.scale_factor),
      orb_(std::make_unique<cv::Ptr<cv::ORB>>(cv::ORB::create(
          settings.count, static_cast<float>(settings.scale_factor), settings.levels, border, /*firstLevel=*/0,
          /*WTA_K=*/2, cv::ORB::HARRIS_SCORE, /*patchSize=*/border, settings.fast_threshold))) {}

OpencvOrb::~OpencvOrb() = default;

int OpencvOrb::usable_levels(const cv::Mat& grey) const {
  const int size = std::min(grey.cols, grey.rows);
  int levels = 0;
  while (levels < pyramid_.levels() &&
         std::lround(static_cast<float>(size) * pyramid_.inverse_scale[levels]) > 2 * border)
    ++levels;
  return levels;
}

void OpencvOrb::extract(const cv::Mat& grey, const cv::Mat& ignore, Features& out) {
  HOLDFAST_CHECK(grey.empty() || grey.type() == CV_8UC1, "image type " << grey.type() << ", expected 8UC1");
  HOLDFAST_CHECK(ignore.empty() || (ignore.type() == CV_8UC1 && ignore.size() == grey.size()),
                 "mask " << ignore.cols << " x " << ignore.rows << " type " << ignore.type() << ", image " << grey.cols
                         << " x " << grey.rows);
  out.clear();
  const int levels = usable_levels(grey);
  if (levels == 0) return;
  cv::ORB& orb = **orb_;
  if (orb.getNLevels() != levels) orb.setNLevels(levels);

  mask_.release();
  if (!ignore.empty()) cv::compare(ignore, 0, mask_, cv::CMP_EQ);
  orb.detectAndCompute(grey, mask_, keypoints_, descriptors_);

  out.resize(keypoints_.size());
  for (std::size_t i = 0; i < keypoints_.size(); ++i) {
    const cv::KeyPoint& keypoint = keypoints_[i];
    out.x[i] = keypoint.pt.x;
    out.y[i] = keypoint.pt.y;
    out.angle[i] = keypoint.angle >= 360.0F ? 0.0F : keypoint.angle * (std::numbers::pi_v<float> / 180.0F);
    out.response[i] = keypoint.response;
    out.octave[i] = static_cast<std::uint8_t>(keypoint.octave);
    std::memcpy(out.descriptors[i].words.data(), descriptors_.ptr(static_cast<int>(i)), sizeof(Descriptor));
  }
}

}  // namespace holdfast::opencv_orb_plugin
