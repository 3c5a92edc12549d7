// SPDX-License-Identifier: BSD-3-Clause
#include "epipolar_consistency.hpp"

#include <algorithm>

namespace holdfast::epipolar_consistency_plugin {

namespace {
double focal_length(const Camera& camera) { return 0.5 * (camera.fx + camera.fy); }

TwoViewOptions two_view_options(const EpipolarConsistencySettings& settings, const Camera& camera) {
  TwoViewOptions options;
  options.threshold = settings.threshold / focal_length(camera);
  options.parallax = settings.parallax / focal_length(camera);
  options.parallax_share = settings.parallax_share;
  options.support = settings.support;
  return options;
}

/// Undistorted pixel of a raw position with a known approximation: fixed-point iteration from there, whose error is
/// below 0.01 px for the few pixels that a feature moves.
Eigen::Vector2d undistorted_near(const Camera& camera, const Eigen::Vector2d& raw, const Eigen::Vector2d& guess) {
  if (camera.distortion.is_zero()) return raw;
  // A fisheye lens moves a pixel by much more than the difference, and its inverse is quick.
  if (camera.distortion.lens == Lens::fisheye) return camera.undistort(raw);
  Eigen::Vector2d pixel = guess;
  for (int i = 0; i < 4; ++i) pixel += raw - camera.distort(pixel);
  return pixel;
}
}  // namespace

EpipolarConsistency::EpipolarConsistency(const EpipolarConsistencySettings& settings, const CreationContext& context)
    : settings_(settings),
      camera_(context.camera),
      seed_(context.seed),
      flow_(settings.gap),
      two_views_(two_view_options(settings, context.camera)) {}

void EpipolarConsistency::choose_features(const Frame& frame) {
  const std::size_t wanted = std::min(frame.size(), static_cast<std::size_t>(settings_.features));
  chosen_.clear();
  for (std::size_t k = 0; k < wanted; ++k) chosen_.push_back(static_cast<std::uint32_t>(k * frame.size() / wanted));
}

void EpipolarConsistency::collect_pairs(const Frame& frame, const StaticEvidence& evidence) {
  const auto inverse_focal = static_cast<float>(1.0 / focal_length(camera_));
  const auto cx = static_cast<float>(camera_.cx), cy = static_cast<float>(camera_.cy);
  pairs_.clear();
  places_.clear();
  for (std::size_t k = 0; k < chosen_.size(); ++k) {
    if (flow_.found()[k] == 0) continue;
    const std::uint32_t i = chosen_[k];
    const Eigen::Vector2d raw_before(flow_.before_x()[k], flow_.before_y()[k]), now(frame.x[i], frame.y[i]);
    const Eigen::Vector2d moved(raw_before.x() - frame.features.x[i], raw_before.y() - frame.features.y[i]);
    const Eigen::Vector2f before = undistorted_near(camera_, raw_before, now + moved).cast<float>();
    const bool is_trusted = frame.static_probability[i] >= 0.5F && evidence.log_odds(i) >= 0.0F;
    pairs_.add((before.x() - cx) * inverse_focal, (before.y() - cy) * inverse_focal, (frame.x[i] - cx) * inverse_focal,
               (frame.y[i] - cy) * inverse_focal, is_trusted);
    places_.push_back(static_cast<std::uint32_t>(k));
  }
}

void EpipolarConsistency::apply(const FilterContext& context, StaticEvidence& evidence) {
  const Frame& frame = context.frame;
  verdict_ = Verdict::few_points;
  if (context.sensor_frame.colour.empty()) return;
  flow_.add_image(context.sensor_frame.colour, context.sensor_frame.timestamp);
  if (!flow_.ready()) return;
  choose_features(frame);
  flow_.follow(frame.features, chosen_);
  collect_pairs(frame, evidence);
  // Seeded by frame, so that the evidence of a frame does not depend on the number of evaluated frames before it.
  Random random = Random(seed_).fork(0xe919).fork(context.sensor_frame.index);
  verdict_ = two_views_.estimate(pairs_, random);
  if (verdict_ != Verdict::usable) return;

  const double threshold = settings_.threshold / focal_length(camera_);
  const auto threshold2 = static_cast<float>(threshold * threshold);
  const std::vector<float>& distance2 = two_views_.distance2();
  suspect_.clear();
  for (std::size_t p = 0; p < places_.size(); ++p)
    if (distance2[p] > threshold2) suspect_.push_back(places_[p]);
  flow_.check_back(suspect_);  // a tracking failure resembles motion
  for (std::size_t p = 0; p < places_.size(); ++p) {
    if (flow_.found()[places_[p]] == 0) continue;
    const bool moves = distance2[p] > threshold2;
    const auto log_odds = static_cast<float>(moves ? -settings_.moving : settings_.fixed);
    if (log_odds != 0.0F) evidence.add(chosen_[places_[p]], log_odds);
  }
}

}  // namespace holdfast::epipolar_consistency_plugin
