// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/segmentation/mask_propagator.hpp"

#include <algorithm>
#include <cmath>

namespace holdfast {

namespace {

constexpr std::uint8_t unknown = 255;
constexpr int bucket = 6;  // cells: one followed point in each, where there is something to follow
bool is_object(std::uint8_t label) { return label != 0 && label != unknown; }

}  // namespace

MaskPropagator::MaskPropagator(const Camera& camera, const CoarseSampler& sampler, double memory)
    : camera_(camera), sampler_(sampler), memory_(memory), carrier_(camera) {}

void MaskPropagator::advance(const cv::Mat& grey, const Frame& frame, const Eigen::Isometry3d& T_frame_previous) {
  std::swap(current_, previous_);
  follower_.advance(grey, frame);
  frame_ = &frame;
  take_view(frame, current_);
  if (labels_.labels.empty()) return;
  pair_with(previous_, labels_.labels);
  carrier_.carry(previous_.coarse, labels_, current_.coarse, T_frame_previous, pairs_, next_labels_);
  std::swap(labels_, next_labels_);
  renew_points(frame);
  take_view(frame, current_);
  publish();
}

void MaskPropagator::take_view(const Frame& frame, View& view) const {
  const PointFollower::Points& points = follower_.points();
  view.frame_index = frame.index;
  view.timestamp = frame.timestamp;
  view.coarse.grid = frame.coarse.grid;
  view.coarse.depth = frame.coarse.depth;
  view.T_camera_world.reset();
  view.ids = points.id;
  view.x = points.x, view.y = points.y, view.depth = points.depth;
}

void MaskPropagator::pair_with(const View& view, const std::vector<std::uint8_t>& labels_there) {
  // Points that were on an object there, and not at its border: those may follow what is behind.
  pairs_.clear();
  const PointFollower::Points& points = follower_.points();
  const CoarseGrid& grid = view.coarse.grid;
  std::size_t there = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    while (there < view.ids.size() && view.ids[there] < points.id[i]) ++there;
    if (there == view.ids.size()) break;
    if (view.ids[there] != points.id[i]) continue;
    const int column = grid.column_of(view.x[there]), row = grid.row_of(view.y[there]);
    if (column < 1 || row < 1 || column + 1 >= grid.columns || row + 1 >= grid.rows) continue;
    const std::size_t cell = static_cast<std::size_t>(row * grid.columns + column);
    const auto width = static_cast<std::size_t>(grid.columns);
    const std::uint8_t label = labels_there[cell];
    if (!is_object(label) || labels_there[cell - 1] != label || labels_there[cell + 1] != label ||
        labels_there[cell - width] != label || labels_there[cell + width] != label)
      continue;
    pairs_.from_x.push_back(view.x[there]), pairs_.from_y.push_back(view.y[there]);
    pairs_.from_depth.push_back(view.depth[there]);
    pairs_.to_x.push_back(points.x[i]), pairs_.to_y.push_back(points.y[i]);
    pairs_.to_depth.push_back(points.depth[i]);
  }
}

void MaskPropagator::located(const std::optional<Eigen::Isometry3d>& T_camera_world) {
  current_.T_camera_world = T_camera_world;
}

void MaskPropagator::renew_points(const Frame& frame) {
  // While no segmentation is awaited, only points of objects are worth following; every part of an object has one.
  const CoarseGrid& grid = frame.coarse.grid;
  const PointFollower::Points& points = follower_.points();
  const int columns = (grid.columns + bucket - 1) / bucket, rows = (grid.rows + bucket - 1) / bucket;
  const auto bucket_of = [&](float x, float y) {
    const int cell = grid.cell_of(x, y);
    if (cell < 0) return -1;
    return (cell / grid.columns / bucket) * columns + cell % grid.columns / bucket;
  };
  if (remembered_.empty())
    follower_.filter([&](std::size_t i) {
      const int cell = grid.cell_of(points.x[i], points.y[i]);
      return cell >= 0 && is_object(labels_.labels[static_cast<std::size_t>(cell)]);
    });
  bucket_feature_.assign(static_cast<std::size_t>(columns * rows), -1);
  bucket_response_.assign(static_cast<std::size_t>(columns * rows), -1.0F);
  for (std::size_t i = 0; i < frame.size(); ++i) {
    const int cell = grid.cell_of(frame.x[i], frame.y[i]);
    if (cell < 0) continue;
    if (remembered_.empty() && !is_object(labels_.labels[static_cast<std::size_t>(cell)])) continue;
    const int place = bucket_of(frame.x[i], frame.y[i]);
    const float response = frame.features.response[i];
    if (place < 0 || response <= bucket_response_[static_cast<std::size_t>(place)]) continue;
    bucket_response_[static_cast<std::size_t>(place)] = response;
    bucket_feature_[static_cast<std::size_t>(place)] = static_cast<std::int32_t>(i);
  }
  for (std::size_t i = 0; i < points.size(); ++i)
    if (const int place = bucket_of(points.x[i], points.y[i]); place >= 0)
      bucket_feature_[static_cast<std::size_t>(place)] = -1;
  for (const std::int32_t feature : bucket_feature_)
    if (feature >= 0)
      follower_.add(frame, frame.features.x[static_cast<std::size_t>(feature)],
                    frame.features.y[static_cast<std::size_t>(feature)], 0);
}

void MaskPropagator::remember() {
  if (frame_ == nullptr) return;
  const std::optional<Eigen::Isometry3d> pose = current_.T_camera_world;
  remembered_.push_back({});
  if (labels_.labels.empty()) {
    labels_.labels.assign(current_.coarse.depth.size(), unknown);
    labels_.quality.assign(labels_.labels.size(), 0);
  }
  renew_points(*frame_);
  take_view(*frame_, current_);
  current_.T_camera_world = pose;
  remembered_.back() = current_;
}

void MaskPropagator::apply(std::uint64_t frame_index, const Segmentation& segmentation) {
  while (!remembered_.empty() && remembered_.front().frame_index < frame_index) remembered_.pop_front();
  if (remembered_.empty() || remembered_.front().frame_index != frame_index) return;
  const View there = std::move(remembered_.front());
  remembered_.pop_front();
  if (segmentation.empty()) return;

  CellLabels exact;
  sampler_.sample_labels(segmentation.labels, 0, exact.labels);
  if (segmentation.confidence.empty())
    exact.quality.assign(exact.labels.size(), 255);
  else
    sampler_.sample_labels(segmentation.confidence, 0, exact.quality);
  labels_from_ = there.timestamp;
  if (current_.frame_index == frame_index) {
    labels_ = std::move(exact);
  } else {
    Eigen::Isometry3d T_current_there = Eigen::Isometry3d::Identity();
    if (there.T_camera_world && current_.T_camera_world)
      T_current_there = *current_.T_camera_world * there.T_camera_world->inverse();
    pair_with(there, exact.labels);
    carrier_.carry(there.coarse, exact, current_.coarse, T_current_there, pairs_, labels_);
  }
  publish();
}

void MaskPropagator::publish() {
  const double age = current_.timestamp - labels_from_;
  const double share = std::exp2(-std::max(0.0, age) / memory_);
  mask_.age = age;
  mask_.labels = labels_.labels;
  mask_.confidence.resize(labels_.quality.size());
  for (std::size_t i = 0; i < mask_.confidence.size(); ++i)
    mask_.confidence[i] = static_cast<std::uint8_t>(labels_.quality[i] * share);
}

}  // namespace holdfast
