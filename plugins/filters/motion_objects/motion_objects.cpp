// SPDX-License-Identifier: BSD-3-Clause
#include "motion_objects.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "holdfast/core/depth_noise.hpp"
#include "holdfast/geometry/so3.hpp"

namespace holdfast::motion_objects_plugin {

namespace {

constexpr float depth_noise = 0.008F, depth_noise_growth = 0.004F;  // as in depth_clusters
constexpr double candidate_memory = 0.15;                           // s
constexpr std::size_t max_tracks = 24;
constexpr std::size_t max_points = 250;  // per object for the alignment

}  // namespace

MotionObjects::MotionObjects(const MotionObjectsSettings& settings, const CreationContext& context)
    : settings_(settings),
      maker_(context.camera),
      noise_{depth_noise, depth_noise_growth},
      alignment_(maker_.grid(), noise_) {}

ObjectTrack* MotionObjects::find(std::uint32_t track_id) {
  const auto found = std::lower_bound(tracks_.begin(), tracks_.end(), track_id,
                                      [](const ObjectTrack& track, std::uint32_t n) { return track.track_id() < n; });
  return found != tracks_.end() && found->track_id() == track_id ? &*found : nullptr;
}

Eigen::Vector3f MotionObjects::point(int block) const {
  const BlockGrid& grid = maker_.grid();
  const float z = views_.back().image.depth[static_cast<std::size_t>(block)];
  return {z * grid.ray_x[static_cast<std::size_t>(block % grid.columns)],
          z * grid.ray_y[static_cast<std::size_t>(block / grid.columns)], z};
}

bool MotionObjects::keep_up(const FilterContext& context) {
  interval_ = 0.0;
  if (!views_.empty()) {
    const View& last = views_.back();
    interval_ = context.frame.timestamp - last.image.timestamp;
    if (interval_ <= 0.0) return false;
    if (context.previous == nullptr || context.previous->index != last.image.frame_index) {
      views_.clear();  // tracking was lost in between, and poses before and after are inconsistent
    } else {
      // The pose was refined after this filter ran, or the whole map was corrected.
      const Eigen::Isometry3d T_view_world = context.previous->T_view_world();
      const Eigen::Isometry3d T_new_old = T_view_world.inverse() * last.T_view_world;
      constexpr double whole_map = 0.02;  // m
      if (T_new_old.translation().norm() > whole_map) {
        for (View& view : views_) {
          view.T_view_world = view.T_view_world * T_new_old.inverse();
          for (TrackObservation& observation : view.observations)
            observation.centroid = T_new_old * observation.centroid;
        }
        for (ObjectTrack& track : tracks_) track.transform(T_new_old);
      }
      views_.back().T_view_world = T_view_world;
    }
  }
  View view;
  while (!views_.empty() &&
         (views_.size() > 16 || views_.front().image.timestamp < context.frame.timestamp - settings_.interval - 1e-3)) {
    if (views_.size() == 1) break;
    view = std::move(views_.front());  // reuse its memory
    views_.pop_front();
  }
  maker_.make(context.frame, context.sensor_frame.colour, view.image);
  view.T_view_world = context.T_view_world();
  view.owner.assign(view.image.depth.size(), 0);
  view.observations.clear();
  for (ObjectTrack& track : tracks_) track.predict(interval_);
  predictions_.clear();
  if (!views_.empty()) {
    const View& last = views_.back();
    T_last_now_ = (last.T_view_world * view.T_view_world.inverse()).cast<float>();
    for (const TrackObservation& observation : last.observations) {
      const ObjectTrack& track = *find(observation.track);
      const Eigen::Vector3d step = -interval_ * track.velocity();
      predictions_.push_back({observation.track, (last.T_view_world.linear() * step).cast<float>(),
                              (last.T_view_world * (track.position() + step)).cast<float>(),
                              track.box().isEmpty() ? 0.0F : 0.5F * track.box().diagonal().norm() + 0.1F, track.label(),
                              track.instance()});
    }
  }
  views_.push_back(std::move(view));
  return true;
}

std::uint32_t MotionObjects::track_before(const Eigen::Vector3f& in_view, const BlockHint& hint) const {
  if (hint.instance != 0)
    for (const Prediction& prediction : predictions_)
      if (prediction.instance == hint.instance) return prediction.track_id;
  const BlockGrid& grid = maker_.grid();
  const View& last = views_[views_.size() - 2];
  const Eigen::Vector3f stood = T_last_now_ * in_view;
  std::uint32_t best = BlockHint::unknown;
  float min_difference = 1e3F;
  for (const Prediction& prediction : predictions_) {
    if (hint.label != CellMask::unknown && prediction.label >= 0 && prediction.label != hint.label) continue;
    if (hint.instance != 0 && prediction.instance != 0) continue;
    const Eigen::Vector3f p = stood + prediction.back;
    if (p.z() < 0.1F || (p - prediction.centre).squaredNorm() > prediction.radius * prediction.radius) continue;
    const float x = grid.column_of(grid.fx * p.x() / p.z() + grid.cx) + 0.5F;
    const float y = grid.row_of(grid.fy * p.y() / p.z() + grid.cy) + 0.5F;
    if (!(x >= 0.0F) || !(y >= 0.0F)) continue;
    const int column = static_cast<int>(x), row = static_cast<int>(y);
    if (column >= grid.columns || row >= grid.rows) continue;
    const std::size_t there = static_cast<std::size_t>(row * grid.columns + column);
    if (last.owner[there] != prediction.track_id) continue;
    const float difference = std::abs(last.image.depth[there] - p.z());
    if (difference < depth_noise::continues_region(p.z()) && difference < min_difference)
      min_difference = difference, best = prediction.track_id;
  }
  return best;
}

void MotionObjects::give_hints(const FilterContext& context, const StaticEvidence& evidence) {
  const BlockGrid& grid = maker_.grid();
  const View& now = views_.back();
  const int coarse_columns = context.frame.coarse.grid.columns;
  const bool has_evidence = evidence.cells().size() == context.frame.coarse.depth.size();
  const bool has_mask = context.frame.coarse.mask.labels.size() == evidence.cells().size();
  const bool has_instances = context.frame.coarse.mask.instances.size() == evidence.cells().size();
  hints_.assign(now.image.depth.size(), {});
  if (!has_evidence) return;
  for (int row = 0; row < grid.rows; ++row)
    for (int column = 0; column < grid.columns; ++column) {
      const int block = row * grid.columns + column;
      const std::size_t cell = static_cast<std::size_t>((row * coarse_columns + column) * BlockGrid::stride);
      const float said = evidence.cells()[cell];
      if (said >= 0.0F || now.image.depth[static_cast<std::size_t>(block)] <= 0.0F) continue;
      BlockHint& hint = hints_[static_cast<std::size_t>(block)];
      if (has_mask) hint.label = context.frame.coarse.mask.labels[cell];
      if (has_instances) hint.instance = context.frame.coarse.mask.instances[cell];
      if (!predictions_.empty()) hint.track = track_before(point(block), hint);
      // A block that belonged to a track stays with it at a weaker threshold.
      if (predictions_.empty() || hint.track == BlockHint::unknown)
        hint.track = said <= static_cast<float>(settings_.suspicion) ? BlockHint::unknown : BlockHint::background;
    }
}

bool MotionObjects::may_join(int block, std::uint32_t track_id) const {
  const ObjectTrack& track = *find(track_id);
  if (track.box().isEmpty()) return true;
  constexpr float margin = 0.15F;  // m
  const Eigen::Vector3d world = views_.back().T_view_world.inverse() * point(block).cast<double>();
  const Eigen::Vector3f p = (track.object().T_world_object.inverse() * world).cast<float>();
  return track.box().exteriorDistance(p) < margin;
}

bool MotionObjects::belongs_to(const Region& region, const Part& part) const {
  constexpr float gap = 0.3F;  // m, occluded by an arm or a table
  for (const std::size_t other : part.regions)
    if (regions_.regions()[other].box.exteriorDistance(region.box) < gap) return true;
  return false;
}

void MotionObjects::claim(std::size_t track, std::size_t region) {
  for (Part& part : parts_)
    if (part.track == track) {
      part.regions.push_back(region);
      return;
    }
  parts_.push_back({track, {region}});
}

std::uint16_t MotionObjects::instance_of(const Region& region) const {
  // The only one with a majority (Boyer and Moore), if there is one.
  std::uint16_t candidate = 0;
  int lead = 0, count = 0;
  for (const int block : regions_.blocks(region)) {
    const std::uint16_t instance = hints_[static_cast<std::size_t>(block)].instance;
    if (lead == 0) candidate = instance;
    lead += instance == candidate ? 1 : -1;
  }
  for (const int block : regions_.blocks(region))
    count += hints_[static_cast<std::size_t>(block)].instance == candidate ? 1 : 0;
  return 2 * count > region.size ? candidate : std::uint16_t{0};
}

bool MotionObjects::resembles(const ObjectTrack& track, const Region& region) const {
  if (track.box().isEmpty()) return true;
  const float before = track.box().diagonal().norm(), now = region.box.diagonal().norm();
  constexpr float max_ratio = 1.6F;
  if (now > max_ratio * before || before > max_ratio * now) return false;
  // Mask labels, if known.
  int named = 0, same = 0;
  const int label = track.label();
  for (const int block : regions_.blocks(region)) {
    const std::uint8_t other = hints_[static_cast<std::size_t>(block)].label;
    named += other != CellMask::unknown ? 1 : 0;
    same += other == label ? 1 : 0;
  }
  return label < 0 || 2 * named < region.size || 2 * same >= named;
}

void MotionObjects::assign_regions() {
  const std::vector<Region>& regions = regions_.regions();
  const Eigen::Isometry3d T_world_view = views_.back().T_view_world.inverse();
  // Large regions first: the largest part of a divided track keeps the track id.
  order_.resize(regions.size());
  for (std::size_t i = 0; i < order_.size(); ++i) order_[i] = i;
  std::stable_sort(order_.begin(), order_.end(),
                   [&](std::size_t a, std::size_t b) { return regions[a].surface > regions[b].surface; });
  parts_.clear();
  const auto part_of = [&](std::size_t track) -> Part* {
    for (Part& part : parts_)
      if (part.track == track) return &part;
    return nullptr;
  };
  std::vector<std::uint8_t> taken(regions.size(), 0);
  for (const std::size_t i : order_) {
    if (regions[i].track == BlockHint::unknown) continue;
    const std::size_t track = static_cast<std::size_t>(find(regions[i].track) - tracks_.data());
    const Part* part = part_of(track);
    if (part == nullptr ? regions[i].surface < 0.3F * static_cast<float>(settings_.surface)
                        : !belongs_to(regions[i], *part))
      continue;
    claim(track, i);
    taken[i] = 1;
  }
  // The remaining regions belong to tracks that were occluded, or to new tracks.
  const double timestamp = views_.back().image.timestamp;
  const std::size_t known = tracks_.size();
  for (const std::size_t i : order_) {
    const Region& region = regions[i];
    if (taken[i] != 0 || region.surface < static_cast<float>(settings_.surface)) continue;
    constexpr int min_inner = 4;
    if (region.inner < min_inner || 5 * region.inner < region.size) continue;
    const std::uint16_t instance = instance_of(region);
    const auto same = std::find_if(tracks_.begin(), tracks_.end(), [&](const ObjectTrack& track) {
      return instance != 0 && track.instance() == instance;
    });
    if (same != tracks_.end()) {
      claim(static_cast<std::size_t>(same - tracks_.begin()), i);
      continue;
    }
    const Eigen::Vector3d centroid = T_world_view * region.centroid.cast<double>();
    std::size_t nearest = known;
    double min_distance = 1.0;
    for (std::size_t k = 0; k < known; ++k) {
      if (part_of(k) != nullptr) continue;
      const ObjectTrack& track = tracks_[k];
      if ((instance != 0 && track.instance() != 0) || !resembles(track, region)) continue;
      const double reach = 0.25 + 0.25 * (timestamp - track.last_seen());  // m
      const double away = (track.position() - centroid).norm() / reach;
      if (away < min_distance) min_distance = away, nearest = k;
    }
    if (nearest == known) {
      if (tracks_.size() >= max_tracks) continue;
      tracks_.emplace_back(next_track_id_++, timestamp,
                           ObjectObservation{centroid, Eigen::Vector3d::Ones(), T_world_view.linear()});
      tracks_.back().set_instance(instance);
      claim(tracks_.size() - 1, i);
    } else {
      claim(nearest, i);
    }
  }
  std::sort(parts_.begin(), parts_.end(), [](const Part& a, const Part& b) { return a.track < b.track; });
}

const MotionObjects::View* MotionObjects::reference(const ObjectTrack& track, const TrackObservation& now,
                                                    const TrackObservation*& then) const {
  // The oldest view in which the object has not moved far across the image, otherwise the most recent one.
  const View* best = nullptr;
  const View& current = views_.back();
  const Eigen::Vector3d in_view = current.T_view_world * now.centroid;
  const Eigen::Vector3d velocity = current.T_view_world.linear() * track.velocity();
  const double across = std::hypot(velocity.x(), velocity.y()) / std::max(in_view.z(), 0.1);
  for (std::size_t i = views_.size() - 1; i-- > 0;) {
    const View& view = views_[i];
    const auto observation = std::find_if(view.observations.begin(), view.observations.end(),
                                          [&](const TrackObservation& each) { return each.track == track.track_id(); });
    if (observation == view.observations.end()) break;
    constexpr double max_angle = 0.05;  // rad
    if (best != nullptr && across * (current.image.timestamp - view.image.timestamp) > max_angle) break;
    best = &view;
    then = &*observation;
  }
  return best;
}

void MotionObjects::align(ObjectTrack& track, const Part& part, const TrackObservation& observation) {
  const TrackObservation* then = nullptr;
  const View* view = reference(track, observation, then);
  if (view == nullptr) return;
  const View& now = views_.back();
  const Eigen::Isometry3d T_then_now = view->T_view_world * now.T_view_world.inverse();
  const Eigen::Isometry3f moved = T_then_now.cast<float>();
  std::size_t size = 0;
  for (const std::size_t region : part.regions) size += static_cast<std::size_t>(regions_.regions()[region].size);
  const std::size_t stride = 1 + size / max_points;
  points_.points.clear();
  points_.grey.clear();
  std::size_t count = 0;
  for (const std::size_t region : part.regions)
    for (const int block : regions_.blocks(regions_.regions()[region])) {
      if (count++ % stride != 0) continue;
      points_.points.push_back(moved * point(block));
      points_.grey.push_back(now.image.grey[static_cast<std::size_t>(block)]);
    }
  const double interval = now.image.timestamp - view->image.timestamp;
  const Eigen::Matrix3d R_then_world = view->T_view_world.linear();
  points_.centre = (view->T_view_world * observation.centroid).cast<float>();

  // Prior: the displacement of the centroids, if the same part of the object is visible; the optimization starts at the
  // prediction of the track.
  RigidAlignment::Prior prior;
  prior.translation = (R_then_world * (then->centroid - observation.centroid)).cast<float>();
  const float change = std::abs(std::log(observation.surface / then->surface));
  const Eigen::Vector3f extent =
      track.box().isEmpty() ? Eigen::Vector3f(0.5F, 0.5F, 0.5F) : Eigen::Vector3f(track.box().sizes());
  const double differs = 0.3 * change * extent.maxCoeff();
  for (int axis = 0; axis < 3; ++axis)
    prior.deviation[axis] = static_cast<float>(std::hypot(observation.deviation[axis], then->deviation[axis], differs));
  RigidMotion start;
  start.translation = track.is_object() || track.moving()
                          ? (R_then_world * (-interval * track.velocity())).cast<float>()
                          : prior.translation.cwiseMin(0.1F).cwiseMax(-0.1F).eval();
  const AlignmentResult result = alignment_.align(points_, view->image, {view->owner, track.track_id()}, start, prior);
  constexpr float farthest = 0.6F;  // m
  if (!(result.motion.translation.norm() < farthest)) return;
  const Eigen::Matrix3d R_world_then = R_then_world.transpose();
  ObjectTrack::Motion motion;
  motion.displacement = R_world_then * -result.motion.translation.cast<double>();
  motion.turned = R_world_then * -geometry::log_so3(Eigen::Matrix3d(result.motion.rotation.cast<double>()));
  motion.covariance = R_world_then * result.covariance.cast<double>() * R_then_world;
  motion.rotation_covariance = R_world_then * result.rotation_covariance.cast<double>() * R_then_world;
  motion.pose_noise = 0.006;
  motion.turning_noise = 0.01;
  motion.interval = interval;
  motion.repeats = std::max(1.0, interval / interval_);
  track.measure_motion(motion);
}

void MotionObjects::follow(const Part& part) {
  ObjectTrack& track = tracks_[part.track];
  View& now = views_.back();
  const Eigen::Isometry3d T_world_view = now.T_view_world.inverse();
  TrackObservation observation{track.track_id(), Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(), 0.0F};
  Eigen::AlignedBox3f box;
  Eigen::Vector2f cut(0, 0);
  float size = 0.0F;
  std::fill(label_counts_.begin(), label_counts_.end(), 0);
  for (const std::size_t i : part.regions) {
    const Region& region = regions_.regions()[i];
    if (const std::uint16_t instance = instance_of(region); instance != 0) track.set_instance(instance);
    const float blocks = static_cast<float>(region.size);
    observation.centroid += (blocks * region.centroid).cast<double>();
    observation.surface += region.surface;
    cut += blocks * region.cut;
    size += blocks;
    box.extend(region.box);
    for (const int block : regions_.blocks(region)) {
      now.owner[static_cast<std::size_t>(block)] = track.track_id();
      const std::uint8_t label = hints_[static_cast<std::size_t>(block)].label;
      if (label == CellMask::unknown) continue;
      if (label >= label_counts_.size()) label_counts_.resize(label + 1U, 0);
      ++label_counts_[label];
    }
  }
  observation.centroid = T_world_view * (observation.centroid / size);
  cut /= size;
  const Eigen::Vector3f extent = box.sizes();
  // Deviation of the centroid of blocks; larger if the object is cut, because another part is visible in every frame.
  const double coarse = 0.004 * (T_world_view.inverse() * observation.centroid).z();
  observation.deviation = Eigen::Vector3d(coarse + 2.0 * cut.x() * extent.x(), coarse + 2.0 * cut.y() * extent.y(),
                                          coarse + 0.2 * (cut.x() + cut.y()) * extent.z());
  if (interval_ > 0.0) align(track, part, observation);
  track.update(now.image.timestamp, {observation.centroid, observation.deviation, T_world_view.linear()});
  track.count_labels(label_counts_);

  const Eigen::Isometry3f T_object_view = (track.object().T_world_object.inverse() * T_world_view).cast<float>();
  track.measure_box(inner_box(part, T_object_view, static_cast<std::size_t>(size)));
  track.classify({settings_.speed, settings_.moving_time}, interval_, next_object_id_);
  now.observations.push_back(observation);
}

Eigen::AlignedBox3f MotionObjects::inner_box(const Part& part, const Eigen::Isometry3f& T_object_view,
                                             std::size_t size) {
  std::array<std::vector<float>, 3>& along = along_;
  for (auto& values : along) values.clear();
  const std::size_t stride = 1 + size / max_points;
  std::size_t count = 0;
  for (const std::size_t i : part.regions)
    for (const int block : regions_.blocks(regions_.regions()[i])) {
      if (count++ % stride != 0) continue;
      const Eigen::Vector3f p = T_object_view * point(block);
      for (int axis = 0; axis < 3; ++axis) along[static_cast<std::size_t>(axis)].push_back(p[axis]);
    }
  Eigen::AlignedBox3f inner;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<float>& values = along[static_cast<std::size_t>(axis)];
    const auto outer = static_cast<std::ptrdiff_t>(values.size() / 50);
    std::nth_element(values.begin(), values.begin() + outer, values.end());
    inner.min()[axis] = values[static_cast<std::size_t>(outer)];
    std::nth_element(values.begin(), values.end() - 1 - outer, values.end());
    inner.max()[axis] = *(values.end() - 1 - outer);
  }
  return inner;
}

void MotionObjects::forget() {
  const double timestamp = views_.back().image.timestamp;
  std::erase_if(tracks_, [&](const ObjectTrack& track) {
    return timestamp - track.last_seen() > (track.is_object() ? settings_.memory : candidate_memory);
  });
}

void MotionObjects::add_evidence(const FilterContext& context, StaticEvidence& evidence) {
  const BlockGrid& grid = maker_.grid();
  const View& now = views_.back();
  log_odds_.assign(now.owner.size(), 0.0F);
  bool anything = false;
  for (const TrackObservation& observation : now.observations) {
    const ObjectTrack& track = *find(observation.track);
    if (!track.is_object()) continue;
    const double log_odds = track.moving()                               ? settings_.moving_log_odds
                            : track.resting_for() >= settings_.rest_time ? settings_.static_log_odds
                                                                         : 0.0;
    if (log_odds == 0.0) continue;
    anything = true;
    for (std::size_t i = 0; i < now.owner.size(); ++i)
      if (now.owner[i] == observation.track) log_odds_[i] = static_cast<float>(log_odds);
  }
  if (!anything) return;
  for (std::size_t i = 0; i < context.frame.size(); ++i) {
    const int block = depth_blocks::block_of(grid, now.image, context.frame, i);
    if (block >= 0 && log_odds_[static_cast<std::size_t>(block)] != 0.0F)
      evidence.add(i, log_odds_[static_cast<std::size_t>(block)]);
  }
  const int coarse_columns = context.frame.coarse.grid.columns;
  for (int row = 0; row < grid.rows * BlockGrid::stride; ++row)
    for (int column = 0; column < grid.columns * BlockGrid::stride; ++column) {
      const float said =
          log_odds_[static_cast<std::size_t>((row / BlockGrid::stride) * grid.columns + column / BlockGrid::stride)];
      if (said != 0.0F) evidence.add_cell(static_cast<std::size_t>(row * coarse_columns + column), said);
    }
}

void MotionObjects::apply(const FilterContext& context, StaticEvidence& evidence) {
  if (context.T_camera_world == nullptr || context.frame.coarse.empty()) return;
  if (!keep_up(context)) return;
  give_hints(context, evidence);
  constexpr int growth = 3;  // blocks
  regions_.divide(maker_.grid(), views_.back().image.depth, hints_, growth,
                  [&](int block, std::uint32_t track_id) { return may_join(block, track_id); });
  assign_regions();
  for (const Part& part : parts_) follow(part);
  forget();
  add_evidence(context, evidence);
  for (const ObjectTrack& track : tracks_) {
    if (!track.is_object()) continue;
    MovingObject object = track.object();
    const int label = track.label();
    if (context.classes != nullptr && label > 0 && static_cast<std::size_t>(label) < context.classes->size())
      object.class_name = (*context.classes)[static_cast<std::size_t>(label)];
    evidence.add_object(object);
  }
}

}  // namespace holdfast::motion_objects_plugin
