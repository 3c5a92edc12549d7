// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/perturbation/perturbed_source.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "holdfast/core/imu_timeline.hpp"
#include "holdfast/perturbation/image_faults.hpp"

namespace holdfast {

namespace {

/// Streams of random numbers, one for each thing that is drawn. Append only: a new one must not change the others.
enum Stream : std::uint64_t {
  blur_stream = 1,
  noise_stream,
  exposure_stream,
  shutter_stream,
  drop_stream,
  repeat_stream,
  late_stream,
  hole_stream,
  offset_stream,
  calibration_stream,
  occluder_stream,
  right_noise_stream,
};

constexpr std::uint64_t frames_of_an_exposure = 15;
constexpr double frames_of_a_swing = 30.0;
constexpr double occluder_distance = 0.5;  // [m]
constexpr double least_step = 1e-4;        // between two time stamps [s]
constexpr std::uint8_t occluder_object = 255;

std::uint64_t seed_of(const PerturbationSettings& settings, std::uint64_t seed_of_run) {
  return settings.seed != 0 ? static_cast<std::uint64_t>(settings.seed) : seed_of_run;
}

Random random_of(std::uint64_t seed, std::uint64_t stream, std::uint64_t index) {
  return Random(seed).fork(0x7065727475726221ULL).fork(stream).fork(index);
}

void make_black(cv::Mat& image) {
  if (!image.empty()) image = cv::Mat::zeros(image.size(), image.type());
}

/// Leaves nothing to see, also of the objects of the ground truth.
void cover(SensorFrame& frame) {
  for (cv::Mat* image : {&frame.colour, &frame.depth, &frame.right}) make_black(*image);
  if (frame.truth == nullptr) return;
  auto truth = std::make_shared<FrameTruth>(*frame.truth);
  for (cv::Mat* image : {&truth->object_mask, &truth->class_labels}) make_black(*image);
  frame.truth = std::move(truth);
}

}  // namespace

Camera perturbed_camera(Camera camera, const PerturbationSettings& settings, std::uint64_t seed_of_run) {
  Random random = random_of(seed_of(settings, seed_of_run), calibration_stream, 0);
  const auto signed_error = [&] { return random.below(2) == 0 ? settings.calibration : -settings.calibration; };
  const double focal = 1.0 + signed_error();
  camera.fx *= focal;
  camera.fy *= focal;
  camera.cx += signed_error() * camera.width / 2.0;
  camera.cy += signed_error() * camera.height / 2.0;
  return camera;
}

PerturbedSource::PerturbedSource(std::unique_ptr<FrameSource> source, const PerturbationSettings& settings,
                                 const Camera& camera, std::uint64_t seed_of_run)
    : source_(std::move(source)), settings_(settings), camera_(camera), seed_(seed_of(settings, seed_of_run)) {}

SourceDescription PerturbedSource::describe() const {
  SourceDescription description = source_->describe();
  if (description.camera) description.camera = perturbed_camera(*description.camera, settings_, seed_);
  if (description.frame_count && settings_.dropped > 0.0) {
    std::uint64_t kept = 0;
    for (std::uint64_t i = 0; i < *description.frame_count; ++i) kept += is_dropped(i) ? 0 : 1;
    description.frame_count = kept;
  }
  std::vector<double>& stamps = description.frame_timestamps;
  if (settings_.late > 0.0) stamps.clear();
  std::size_t kept = 0;
  for (std::size_t i = 0; i < stamps.size(); ++i)
    if (!is_dropped(i)) stamps[kept++] = stamps[i];
  stamps.resize(kept);
  return description;
}

double PerturbedSource::draw(std::uint64_t stream, std::uint64_t index) const {
  return random_of(seed_, stream, index).uniform();
}

bool PerturbedSource::is_dropped(std::uint64_t index) const {
  return index > 0 && settings_.dropped > 0.0 && draw(drop_stream, index) < settings_.dropped;
}

std::optional<SensorFrame> PerturbedSource::next() {
  std::optional<SensorFrame> frame = source_->next();
  std::vector<ImuSample> of_dropped;
  while (frame && is_dropped(frame->index)) {
    append_imu(of_dropped, frame->imu);
    frame = source_->next();
  }
  if (!frame) return frame;
  if (!of_dropped.empty()) {
    append_imu(of_dropped, frame->imu);
    frame->imu = std::move(of_dropped);
  }
  if (last_ && settings_.repeated > 0.0 && draw(repeat_stream, frame->index) < settings_.repeated) {
    frame->colour = last_->colour;
    frame->depth = last_->depth;
    frame->right = last_->right;
    frame->truth = last_->truth;
  } else {
    if (settings_.occluder > 0.0) occlude(*frame);
    if (settings_.rolling_shutter > 0.0) shear(*frame);
    if (!frame->depth.empty()) spoil_depth(*frame);
    if (is_covered(frame->index)) cover(*frame);
    spoil_images(*frame);
  }
  frame->timestamp = delayed(frame->timestamp, frame->index, last_timestamp_);
  last_timestamp_ = frame->timestamp;
  next_index_ = frame->index + 1;
  last_ = frame;
  return frame;
}

/// A delay may not move a frame behind the next one's place: stamps still increase, by the least step if they must.
double PerturbedSource::delayed(double timestamp, std::uint64_t index, const std::optional<double>& previous) const {
  if (settings_.late == 0.0) return timestamp;
  timestamp += settings_.late * draw(late_stream, index);
  return previous ? std::max(timestamp, *previous + least_step) : timestamp;
}

std::vector<double> PerturbedSource::pass_over(double timestamp) {
  if (settings_.late == 0.0 && settings_.dropped == 0.0) return source_->pass_over(timestamp);
  if (!stamps_) stamps_ = source_->describe().frame_timestamps;
  struct DueFrame {
    double source_stamp, stamp;
  };
  std::vector<DueFrame> due;
  for (std::uint64_t i = next_index_; i < stamps_->size(); ++i) {
    if (is_dropped(i)) continue;
    const double stamp = delayed((*stamps_)[i], i, due.empty() ? last_timestamp_ : due.back().stamp);
    if (stamp > timestamp) break;
    due.push_back({(*stamps_)[i], stamp});
  }
  if (due.size() < 2) return {};  // the last one is given
  const std::vector<double> passed = source_->pass_over(due.back().source_stamp);
  std::vector<double> stamps;
  for (const DueFrame& frame : due)
    if (!passed.empty() && frame.source_stamp <= passed.back()) stamps.push_back(frame.stamp);
  if (!passed.empty())
    next_index_ = static_cast<std::uint64_t>(std::upper_bound(stamps_->begin(), stamps_->end(), passed.back()) -
                                             stamps_->begin());
  if (!stamps.empty()) last_timestamp_ = stamps.back();
  return stamps;
}

double PerturbedSource::brightness(std::uint64_t index) const {
  const std::uint64_t block = index / frames_of_an_exposure;
  return std::exp2(settings_.exposure * (2.0 * draw(exposure_stream, block) - 1.0));
}

PerturbedSource::Rectangle PerturbedSource::occluder_place(const SensorFrame& frame) const {
  Random random = random_of(seed_, occluder_stream, 0);
  const auto swing = [&](double frames, int room) {
    const double phase = random.uniform();
    const double turn = std::fmod(static_cast<double>(frame.index) / frames + phase, 1.0);
    return static_cast<int>(std::lround(room * 0.5 * (1.0 + std::sin(2.0 * std::numbers::pi * turn))));
  };
  const int x = swing(4.0 * frames_of_a_swing, frame.colour.cols - occluder_.cols);
  const int y = swing(7.0 * frames_of_a_swing, frame.colour.rows - occluder_.rows);
  return {x, y};
}

void PerturbedSource::occlude(SensorFrame& frame) {
  if (occluder_.empty()) {
    const double side = std::sqrt(settings_.occluder);
    occluder_ = block_texture(std::max(1, static_cast<int>(std::lround(side * frame.colour.cols))),
                              std::max(1, static_cast<int>(std::lround(side * frame.colour.rows))), 8,
                              random_of(seed_, occluder_stream, 1));
  }
  const Rectangle place = occluder_place(frame);
  const cv::Rect area(place.x, place.y, occluder_.cols, occluder_.rows);
  frame.colour = frame.colour.clone();
  occluder_.copyTo(frame.colour(area));
  if (!frame.depth.empty()) {
    frame.depth = frame.depth.clone();
    frame.depth(area).setTo(occluder_distance);
  }
  if (!frame.right.empty()) {
    // The near object lies further left in the right image; what leaves the image is cut off.
    const int disparity = static_cast<int>(std::lround(camera_.baseline * camera_.fx / occluder_distance));
    const cv::Rect moved(area.x - disparity, area.y, area.width, area.height);
    const cv::Rect visible = moved & cv::Rect(0, 0, frame.right.cols, frame.right.rows);
    frame.right = frame.right.clone();
    for (int y = visible.y; y < visible.y + visible.height; ++y)
      for (int x = visible.x; x < visible.x + visible.width; ++x) {
        const auto colour = occluder_.at<cv::Vec3b>(y - moved.y, x - moved.x);
        if (frame.right.channels() == 3)
          frame.right.at<cv::Vec3b>(y, x) = colour;
        else
          frame.right.at<std::uint8_t>(y, x) =
              static_cast<std::uint8_t>((29 * colour[0] + 150 * colour[1] + 77 * colour[2]) >> 8);
      }
  }
  if (frame.truth == nullptr) return;
  auto truth = std::make_shared<FrameTruth>(*frame.truth);
  if (!truth->object_mask.empty()) {
    truth->object_mask = truth->object_mask.clone();
    truth->object_mask(area).setTo(occluder_object);
    if (truth->moving_objects.empty() || truth->moving_objects.back() != occluder_object)
      truth->moving_objects.push_back(occluder_object);
  }
  if (!truth->class_labels.empty()) {
    truth->class_labels = truth->class_labels.clone();
    truth->class_labels(area).setTo(0);
  }
  frame.truth = std::move(truth);
}

bool PerturbedSource::is_covered(std::uint64_t index) const {
  constexpr double usual_rate = 30.0;  // frames per second
  const double rate = camera_.frame_rate > 0.0 ? camera_.frame_rate : usual_rate;
  const double time = static_cast<double>(index) / rate - static_cast<double>(settings_.covered_after);
  return time >= 0.0 && time < settings_.covered;
}

void PerturbedSource::shear(SensorFrame& frame) const {
  const double phase = draw(shutter_stream, 0);
  const double turn = std::fmod(static_cast<double>(frame.index) / frames_of_a_swing + phase, 1.0);
  const double shift = settings_.rolling_shutter * std::sin(2.0 * std::numbers::pi * turn);
  frame.colour = sheared(frame.colour, shift);
  if (!frame.right.empty()) frame.right = sheared(frame.right, shift);
  if (!frame.depth.empty()) frame.depth = sheared_values(frame.depth, shift);
  if (frame.truth == nullptr) return;
  auto truth = std::make_shared<FrameTruth>(*frame.truth);
  if (!truth->object_mask.empty()) truth->object_mask = sheared_values(truth->object_mask, shift);
  if (!truth->class_labels.empty()) truth->class_labels = sheared_values(truth->class_labels, shift);
  frame.truth = std::move(truth);
}

void PerturbedSource::spoil_depth(SensorFrame& frame) const {
  if (settings_.depth_bias != 0.0) frame.depth = scaled_depth(frame.depth, 1.0 + settings_.depth_bias);
  if (settings_.depth_offset > 0.0) {
    const double direction = 2.0 * std::numbers::pi * draw(offset_stream, 0);
    frame.depth = shifted(frame.depth, static_cast<int>(std::lround(settings_.depth_offset * std::cos(direction))),
                          static_cast<int>(std::lround(settings_.depth_offset * std::sin(direction))));
  }
  if (settings_.depth_holes > 0.0)
    frame.depth = with_holes(frame.depth, settings_.depth_holes, random_of(seed_, hole_stream, frame.index));
}

void PerturbedSource::spoil_images(SensorFrame& frame) const {
  const double direction = std::numbers::pi * draw(blur_stream, frame.index);
  for (cv::Mat* image : {&frame.colour, &frame.right}) {
    if (image->empty()) continue;
    if (settings_.motion_blur > 0.0) *image = blurred(*image, settings_.motion_blur, direction);
    if (settings_.exposure > 0.0) *image = scaled_brightness(*image, brightness(frame.index));
    if (settings_.noise > 0.0)
      *image = with_noise(*image, settings_.noise,
                          random_of(seed_, image == &frame.right ? right_noise_stream : noise_stream, frame.index));
  }
}

}  // namespace holdfast
