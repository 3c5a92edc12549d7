// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/moving_world/moving_world.hpp"

#include <algorithm>
#include <utility>

namespace holdfast {

MovingWorld::MovingWorld(MovingWorldParts parts, Map& map)
    : map_(map),
      filters_(std::move(parts.filters)),
      has_depth_(parts.has_depth),
      depth_agreement_(filters_.settings()),
      sampler_(parts.camera) {
  if (parts.segmenter == nullptr) return;
  classes_ = parts.segmenter->classes();
  movable_ = parts.segmenter->movable();
  const std::vector<std::string> movable = filters_.movable_classes(movable_);
  for (std::size_t label = 0; label < std::min(classes_.size(), is_movable_.size()); ++label)
    is_movable_[label] = std::find(movable.begin(), movable.end(), classes_[label]) != movable.end();
  propagator_.emplace(parts.camera, sampler_, parts.segmentation.memory, parts.has_depth);
  queue_.emplace(*parts.segmenter, parts.segmentation, parts.threaded);
}

cv::Mat MovingWorld::begin_frame(const cv::Mat& grey, const Eigen::Isometry3d& T_frame_previous, Frame& frame,
                                 StageTimes& times) {
  if (!propagator_) return {};
  const StageTimer timer(times, "masks");
  propagator_->advance(grey, frame, T_frame_previous);
  frame.coarse.mask = propagator_->mask();
  return filters_.settings().skip_moving ? propagator_->moving_pixels() : cv::Mat();
}

FilterContext MovingWorld::context(const SensorFrame& sensor_frame, const Frame& frame) const {
  const bool has_classes = propagator_.has_value();
  return {.sensor_frame = sensor_frame,
          .frame = frame,
          .map = map_,
          .classes = has_classes ? &classes_ : nullptr,
          .movable = &movable_};
}

bool MovingWorld::evaluate(FilterStage stage, const TrackedView& view, StageTimes& times) {
  if (stage == FilterStage::before_matching) filters_.begin(view.frame);
  if (!filters_.has(stage)) return false;
  const StageTimer timer(times, "filters");
  FilterContext inputs = context(view.sensor_frame, view.frame);
  inputs.previous = view.previous;
  inputs.submap = view.submap;
  inputs.inertial_prediction = view.inertial_prediction;
  if (stage != FilterStage::before_matching) inputs.T_camera_world = &view.frame.T_camera_world;
  filters_.evaluate(stage, inputs);
  return true;
}

void MovingWorld::check_pose(const PosePrediction& prediction, KeyFrameId reference, Frame& frame, StageTimes& times) {
  const StageTimer timer(times, "filters");
  if (!has_depth_ || !depth_agreement_.choose(map_, reference, frame.timestamp)) return;
  double share = depth_agreement_.agreeing_share(frame, frame.T_camera_world);
  const double predicted_share = depth_agreement_.agreeing_share(frame, prediction.T_camera_world);
  if (predicted_share > share + filters_.settings().prediction_lead) {
    frame.T_camera_world = prediction.T_camera_world;
    share = predicted_share;
  }
  frame.coarse.T_view_camera = depth_agreement_.find_view(frame, frame.T_camera_world, share,
                                                          frame.T_camera_world * prediction.T_world_previous);
}

bool MovingWorld::contradicts_depth(const Frame& frame, int inliers, bool was_lost, KeyFrameId reference) {
  const EvidenceSettings& limits = filters_.settings();
  if (!has_depth_) return false;
  if (filters_.discounts_priors())
    return !depth_agreement_.choose(map_, reference, frame.timestamp) ||
           depth_agreement_.unoccluded_share(frame, frame.T_view_world()) < limits.fallback_share;
  if (filters_.empty() || inliers >= (was_lost ? limits.depth_check_inliers_lost : limits.depth_check_inliers))
    return false;
  if (!depth_agreement_.choose(map_, reference, frame.timestamp)) return false;
  return depth_agreement_.agreeing_share(frame, frame.T_view_world()) <
         (was_lost ? limits.depth_check_share_lost : limits.depth_check_share);
}

bool MovingWorld::is_view_filled(const Frame& frame, KeyFrameId reference) {
  if (!has_depth_ || filters_.empty() || !depth_agreement_.choose(map_, reference, frame.timestamp)) return false;
  return depth_agreement_.disagrees(frame, frame.T_view_world(), filters_.settings().depth_check_share);
}

std::optional<Eigen::Isometry3d> MovingWorld::align_depth(const Frame& frame, const Eigen::Isometry3d& predicted,
                                                          KeyFrameId reference, StageTimes& times) {
  const EvidenceSettings& limits = filters_.settings();
  if (!limits.fallback || !has_depth_) return std::nullopt;
  const StageTimer timer(times, "depth alignment");
  if (!depth_agreement_.choose(map_, reference, frame.timestamp)) return std::nullopt;
  const Eigen::Isometry3d aligned = depth_agreement_.align(frame, frame.coarse.T_view_world(predicted));
  if (depth_agreement_.unoccluded_share(frame, aligned) < limits.fallback_share) return std::nullopt;
  return frame.coarse.T_view_camera.inverse() * aligned;
}

void MovingWorld::end_frame(const Frame& frame, bool has_pose) {
  if (!propagator_) return;
  // Threshold of motion: evidence exceeds the prior by a factor of e, so that one filter suffices.
  const float moving = -static_cast<float>(filters_.settings().static_log_odds) - 1.0F;
  propagator_->set_pose(has_pose ? std::optional(frame.T_camera_world) : std::nullopt, frame.coarse, moving);
}

cv::Mat MovingWorld::moving_pixels(const CoarseView& view, std::span<const std::uint8_t> left_out) const {
  const auto cells = static_cast<std::size_t>(sampler_.grid().size());
  const bool has_evidence = view.static_log_odds.size() == cells;
  const bool has_labels = !left_out.empty() && view.mask.labels.size() == cells;
  if (!has_evidence && !has_labels) return {};
  std::vector<std::uint8_t> moving(cells, 0);
  if (has_evidence)
    for (std::size_t i = 0; i < cells; ++i) moving[i] = view.static_log_odds[i] < 0.0F ? 1 : 0;
  if (has_labels)
    for (std::size_t i = 0; i < cells; ++i)
      if (left_out[view.mask.labels[i]] != 0) moving[i] = 1;
  return sampler_.pixels_of(moving);
}

bool MovingWorld::hides_most(const CoarseView& view) const {
  const auto cells = static_cast<std::size_t>(view.grid.size());
  std::size_t hidden = 0;
  for (std::size_t i = 0; i < cells; ++i) {
    const bool can_move = i < view.mask.labels.size() && is_movable_[view.mask.labels[i]];
    hidden += can_move || (i < view.static_log_odds.size() && view.static_log_odds[i] < 0.0F) ? 1 : 0;
  }
  return 2 * hidden > cells;
}

void MovingWorld::next_frame(double timestamp) {
  ++next_frame_number_;
  timestamp_ = timestamp;
  if (queue_) queue_->wait_for_due(next_frame_number_ - 1);
}

std::optional<ArrivedMask> MovingWorld::take_mask(StageTimes& times) {
  if (!queue_ || next_frame_number_ == 0) return std::nullopt;
  std::optional<SegmentedFrame> segmented = queue_->pop(next_frame_number_ - 1);
  if (!segmented) return std::nullopt;
  const StageTimer timer(times, "masks");
  ArrivedMask arrived{.frame = std::move(segmented->frame),
                      .keyframe = segmented->keyframe,
                      .segmentation = std::move(segmented->segmentation),
                      .mask = {}};
  arrived.mask = propagator_->apply(arrived.frame.index, sample_mask(sampler_, arrived.segmentation));
  count_mask(arrived.mask);
  if (!arrived.mask.empty()) mask_latencies_.push_back(timestamp_ - arrived.frame.timestamp);
  return arrived;
}

void MovingWorld::count_mask(const CellMask& mask) {
  ++mask_counts_.segmented;
  if (mask.empty()) return;
  ++mask_counts_.found;
  std::size_t known = 0, movable = 0;
  for (const std::uint8_t label : mask.labels) {
    if (label == CellMask::unknown) continue;
    ++known;
    movable += is_movable_[label] ? 1 : 0;
  }
  if (2 * movable <= known) return;
  ++mask_counts_.mostly_movable;
  if (covers_upper_edge(mask)) ++mask_counts_.upper_edge_movable;
}

/// The upper edge is the first cell of each column that shows the image and has a label.
bool MovingWorld::covers_upper_edge(const CellMask& mask) const {
  const int columns = sampler_.grid().columns;
  std::size_t known = 0, movable = 0;
  for (int column = 0; column < columns; ++column) {
    for (int cell = column; cell < sampler_.grid().size(); cell += columns) {
      const std::uint8_t label = mask.labels[static_cast<std::size_t>(cell)];
      if (sampler_.raw_pixel(cell) < 0 || label == CellMask::unknown) continue;
      ++known;
      movable += is_movable_[label] ? 1 : 0;
      break;
    }
  }
  return 10 * movable > 9 * known;
}

void MovingWorld::evaluate_keyframe(const MapAccess& map, const ArrivedMask& arrived, StageTimes& times) {
  KeyFrame* keyframe = map->find_keyframe(arrived.keyframe);
  if (keyframe == nullptr || arrived.mask.empty()) return;
  const StageTimer timer(times, "masks");
  keyframe->frame.coarse.mask = arrived.mask;
  FilterContext inputs = context(arrived.frame, keyframe->frame);
  inputs.submap = keyframe->submap;
  inputs.T_camera_world = &keyframe->frame.T_camera_world;
  inputs.segmentation = &arrived.segmentation;
  filters_.evaluate_keyframe(inputs, keyframe->frame);
}

bool MovingWorld::request_mask(const SensorFrame& sensor_frame, KeyFrameId keyframe, StageTimes& times,
                               bool is_needed) {
  if (!queue_ || !queue_->has_room()) return false;
  if (!keyframe.valid() && !is_needed && !queue_->wants(next_frame_number_ - 1)) return false;
  propagator_->remember();
  queue_->push(sensor_frame, keyframe, times);
  return true;
}

void MovingWorld::finish() {
  if (!queue_) return;
  queue_->finish();
  queue_->rethrow();
}

void MovingWorld::rethrow() {
  if (queue_) queue_->rethrow();
}

std::vector<StageTimes> MovingWorld::take_times() { return queue_ ? queue_->take_times() : std::vector<StageTimes>(); }

std::optional<WorkerCounts> MovingWorld::worker_counts() const {
  return queue_ ? queue_->worker_counts() : std::nullopt;
}

}  // namespace holdfast
