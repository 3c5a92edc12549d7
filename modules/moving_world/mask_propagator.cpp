// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/moving_world/mask_propagator.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace holdfast {

namespace {

constexpr int bucket = 6;  // cells: one followed point per bucket with a corner

std::vector<std::uint16_t> sample_instances(const CoarseSampler& sampler, const cv::Mat& instances) {
  std::vector<std::uint16_t> cells(static_cast<std::size_t>(sampler.grid().size()), 0);
  for (std::size_t i = 0; i < cells.size(); ++i)
    if (const std::int32_t raw = sampler.raw_pixel(static_cast<int>(i)); raw >= 0)
      cells[i] = instances.ptr<std::uint16_t>(raw / instances.cols)[raw % instances.cols];
  return cells;
}

}  // namespace

CellMask sample_mask(const CoarseSampler& sampler, const Segmentation& segmentation) {
  CellMask mask;
  if (segmentation.empty()) return mask;
  sampler.sample_labels(segmentation.labels, CellMask::background, mask.labels);
  if (segmentation.confidence.empty())
    mask.confidence.assign(mask.labels.size(), 255);
  else
    sampler.sample_labels(segmentation.confidence, 0, mask.confidence);
  if (!segmentation.instances.empty()) mask.instances = sample_instances(sampler, segmentation.instances);
  return mask;
}

MaskPropagator::MaskPropagator(const Camera& camera, const CoarseSampler& sampler, double memory, bool has_depth)
    : camera_(camera), sampler_(sampler), memory_(memory), transfer_(camera, has_depth) {}

void MaskPropagator::advance(const cv::Mat& grey, const Frame& frame, const Eigen::Isometry3d& T_frame_previous) {
  std::swap(current_, previous_);
  follower_.advance(grey, frame);
  frame_ = &frame;
  take_view(frame, current_);
  if (labels_.empty()) return;
  pair_with(previous_, labels_);
  transfer_.transfer(previous_.coarse, labels_, current_.coarse, T_frame_previous, pairs_, next_labels_);
  std::swap(labels_, next_labels_);
  renew_points(frame);
  take_points(current_);
  publish();
}

void MaskPropagator::take_view(const Frame& frame, View& view) const {
  view.frame_index = frame.index;
  view.timestamp = frame.timestamp;
  view.coarse.grid = frame.coarse.grid;
  view.coarse.depth = frame.coarse.depth;
  view.T_camera_world.reset();
  take_points(view);
}

void MaskPropagator::take_points(View& view) const {
  const PointFollower::Points& points = follower_.points();
  view.ids = points.id;
  view.x = points.x, view.y = points.y, view.depth = points.depth;
}

void MaskPropagator::pair_with(const View& view, const CellMask& mask_there) {
  // Points on an object of that view, but not at its border, where a point may follow the background.
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
    const auto is_inside = [&](const auto& values) {
      const auto value = values[cell];
      return values[cell - 1] == value && values[cell + 1] == value && values[cell - width] == value &&
             values[cell + width] == value;
    };
    const bool has_instances = !mask_there.instances.empty();
    if (!CellMask::is_object(mask_there.labels[cell]) || !is_inside(mask_there.labels) ||
        (has_instances && !is_inside(mask_there.instances)))
      continue;
    if (has_instances) pairs_.instance.push_back(mask_there.instances[cell]);
    pairs_.from_x.push_back(view.x[there]), pairs_.from_y.push_back(view.y[there]);
    pairs_.from_depth.push_back(view.depth[there]);
    pairs_.to_x.push_back(points.x[i]), pairs_.to_y.push_back(points.y[i]);
    pairs_.to_depth.push_back(points.depth[i]);
  }
}

void MaskPropagator::set_pose(const std::optional<Eigen::Isometry3d>& T_camera_world, const CoarseView& evaluated,
                              float moving) {
  current_.T_camera_world = T_camera_world;
  if (!T_camera_world || labels_.empty() || evaluated.static_log_odds.size() != labels_.labels.size()) return;
  for (std::size_t i = 0; i < labels_.labels.size(); ++i)
    labels_.moving[i] = CellMask::is_object(labels_.labels[i]) && evaluated.static_log_odds[i] < moving ? 1 : 0;
}

template <class IsWanted>
int MaskPropagator::strongest_corner(const CoarseGrid& grid, int first_column, int first_row,
                                     const IsWanted& is_wanted) const {
  int strongest = 200;  // corner threshold, of Scharr derivatives
  int best = -1;
  for (int row = first_row; row < std::min(first_row + bucket, grid.rows); ++row)
    for (int column = first_column; column < std::min(first_column + bucket, grid.columns); ++column) {
      const int cell = row * grid.columns + column;
      if (!is_wanted(cell)) continue;
      const cv::Point pixel = raw_pixel(cell);
      const int strength = follower_.corner_strength(pixel.x, pixel.y);
      if (strength <= strongest) continue;
      strongest = strength;
      best = cell;
    }
  return best;
}

void MaskPropagator::renew_points(const Frame& frame) {
  // Unless a segmentation is pending, only points on objects are followed, one per bucket.
  const CoarseGrid& grid = frame.coarse.grid;
  const PointFollower::Points& points = follower_.points();
  const int columns = (grid.columns + bucket - 1) / bucket, rows = (grid.rows + bucket - 1) / bucket;
  const auto is_wanted = [wants_all = !remembered_.empty(), labels = labels_.labels.data()](int cell) {
    return wants_all || CellMask::is_object(labels[cell]);
  };
  follower_.filter([&](std::size_t i) {
    const int cell = grid.cell_of(points.x[i], points.y[i]);
    return cell >= 0 && is_wanted(cell);
  });
  has_point_.assign(static_cast<std::size_t>(columns * rows), 0);
  for (std::size_t i = 0; i < points.size(); ++i)
    has_point_[static_cast<std::size_t>((grid.row_of(points.y[i]) / bucket) * columns +
                                        grid.column_of(points.x[i]) / bucket)] = 1;
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column) {
      if (has_point_[static_cast<std::size_t>(row * columns + column)] != 0) continue;
      const int cell = strongest_corner(grid, column * bucket, row * bucket, is_wanted);
      if (cell < 0) continue;
      const cv::Point pixel = raw_pixel(cell);
      follower_.add(frame, static_cast<float>(pixel.x), static_cast<float>(pixel.y), 0);
    }
}

void MaskPropagator::remember() {
  if (frame_ == nullptr) return;
  remembered_.push_back({});
  if (labels_.empty()) labels_.assign(current_.coarse.depth.size(), CellMask::unknown, 0);
  renew_points(*frame_);
  take_points(current_);
  remembered_.back() = current_;
}

void MaskPropagator::name_instances(const View& there, const CellMask& held, CellMask& mask) {
  if (mask.instances.empty()) return;
  const std::vector<std::uint16_t> ids =
      ids_.assign({camera_, there.coarse, mask, there.T_camera_world, there.timestamp}, labels_, held);
  for (std::vector<std::uint16_t>* instances : {&mask.instances, &labels_.instances})
    for (std::uint16_t& instance : *instances) instance = ids[instance];
}

CellMask MaskPropagator::apply(std::uint64_t frame_index, CellMask mask) {
  while (!remembered_.empty() && remembered_.front().frame_index < frame_index) remembered_.pop_front();
  if (remembered_.empty() || remembered_.front().frame_index != frame_index) {
    mask.instances.clear();
    return mask;
  }
  const View there = std::move(remembered_.front());
  remembered_.pop_front();
  if (mask.empty()) return mask;

  const CellMask held = mask.instances.empty() ? CellMask() : labels_;
  CellMask exact = mask;
  exact.moving.assign(exact.labels.size(), 0);
  labels_from_ = there.timestamp;
  segmented_ = true;
  if (current_.frame_index == frame_index) {
    labels_ = std::move(exact);
  } else {
    Eigen::Isometry3d T_current_there = Eigen::Isometry3d::Identity();
    if (there.T_camera_world && current_.T_camera_world)
      T_current_there = *current_.T_camera_world * there.T_camera_world->inverse();
    pair_with(there, exact);
    transfer_.transfer(there.coarse, exact, current_.coarse, T_current_there, pairs_, labels_);
  }
  name_instances(there, held, mask);
  publish();
  return mask;
}

void MaskPropagator::publish() {
  if (!segmented_) return;
  const double age = current_.timestamp - labels_from_;
  const double share = std::exp2(-std::max(0.0, age) / memory_);
  mask_.age = age;
  mask_.labels = labels_.labels;
  mask_.instances = labels_.instances;
  std::array<std::uint8_t, 256> faded;  // by confidence
  for (std::size_t i = 0; i < faded.size(); ++i) faded[i] = static_cast<std::uint8_t>(static_cast<double>(i) * share);
  mask_.confidence.resize(labels_.confidence.size());
  for (std::size_t i = 0; i < mask_.confidence.size(); ++i) mask_.confidence[i] = faded[labels_.confidence[i]];
}

}  // namespace holdfast
