// SPDX-License-Identifier: BSD-3-Clause
#include "loop_correction.hpp"

#include <algorithm>

#include "holdfast/geometry/upright_motion.hpp"
#include "holdfast/matching/point_fusion.hpp"
#include "map_motion.hpp"
#include "piece_set.hpp"
#include "place_points.hpp"

namespace holdfast {
namespace {

std::vector<KeyFrameId> with_neighbours(const Map& map, KeyFrameId keyframe, int max_count) {
  std::vector<KeyFrameId> side = {keyframe};
  for (const KeyFrameId neighbour : map.best_covisible(keyframe, max_count)) side.push_back(neighbour);
  return side;
}

}  // namespace

bool LoopCorrection::run(const std::lock_guard<std::mutex>&) {
  {
    const std::lock_guard lock(map_mutex_);
    current_side_ = with_neighbours(map_, loop_.keyframe, settings_.neighbours);
    place_side_ = with_neighbours(map_, loop_.candidate, settings_.neighbours);
    keyframe_submap_ = map_.keyframe(loop_.keyframe).submap;
    place_submap_ = map_.keyframe(loop_.candidate).submap;
    build_graph();
    add_loop_edges();
    fix_submaps();
    bring_pieces_together();
    make_upright();
  }
  const GraphSummary summary =
      loop_.scale_is_free ? optimizer_.optimize_similarity_graph(graph_) : optimizer_.optimize_pose_graph(graph_);
  if (!summary.usable) return false;
  {
    const std::lock_guard lock(map_mutex_);
    move_map();
    map_.join_submaps(keyframe_submap_, place_submap_);
    fuse_matches();
    // Tracking may have added neighbouring keyframes while the graph was solved; they observe the same points.
    current_side_ = with_neighbours(map_, loop_.keyframe, 2 * settings_.neighbours);
  }
  for (const KeyFrameId target : current_side_) {
    const std::lock_guard lock(map_mutex_);
    fuse_into(target);
  }
  for (const KeyFrameId target : current_side_) {
    const std::lock_guard lock(map_mutex_);
    map_.update_covisibility(target);
  }
  const std::lock_guard lock(map_mutex_);
  map_.add_loop_edge(loop_.keyframe, loop_.candidate);
  map_.invalidate_copies();
  return true;
}

void LoopCorrection::build_graph() {
  nodes_ = map_.keyframes_by_age();
  node_of_slot_.assign(map_.keyframes().slot_count(), 0);
  for (std::uint32_t i = 0; i < nodes_.size(); ++i) {
    node_of_slot_[nodes_[i].slot] = i;
    graph_.nodes.push_back({map_.keyframe(nodes_[i]).frame.T_camera_world, false});
  }
  graph_.iterations = settings_.graph_iterations;

  // Relative pose measurements from the current poses; each pair once, from the younger keyframe to the older one.
  std::vector<std::uint32_t> linked;
  for (std::uint32_t i = 0; i < nodes_.size(); ++i) {
    const KeyFrame& keyframe = map_.keyframe(nodes_[i]);
    linked.clear();
    if (keyframe.parent.valid()) linked.push_back(node_of_slot_[keyframe.parent.slot]);
    for (const CovisibilityEdge& edge : keyframe.covisible)
      if (edge.weight >= settings_.essential_weight) linked.push_back(node_of_slot_[edge.keyframe.slot]);
    for (const KeyFrameId other : keyframe.loop_edges) linked.push_back(node_of_slot_[other.slot]);
    std::sort(linked.begin(), linked.end());
    linked.erase(std::unique(linked.begin(), linked.end()), linked.end());
    for (const std::uint32_t other : linked)
      if (other < i)
        graph_.edges.push_back(
            {i, other, graph_.nodes[other].T_camera_world * graph_.nodes[i].T_camera_world.inverse(), 1.0});
  }
}

void LoopCorrection::add_loop_edges() {
  // Edges from the keyframe to its neighbours, which move with it rigidly, and to the candidate and its neighbours
  // weight the loop against the many edges along the path.
  const auto node = [&](KeyFrameId id) { return node_of_slot_[id.slot]; };
  const auto pose = [&](KeyFrameId id) -> const Eigen::Isometry3d& { return graph_.nodes[node(id)].T_camera_world; };
  const Eigen::Isometry3d motion = loop_.T_camera_world.inverse() * pose(loop_.keyframe);  // new world from old
  const auto add = [&](KeyFrameId current, KeyFrameId place) {
    const bool is_same = std::find(current_side_.begin(), current_side_.end(), place) != current_side_.end();
    if (is_same || current == place) return;
    Eigen::Isometry3d T_place_current = pose(place) * motion * pose(current).inverse();
    if (loop_.scale_is_free) {
      // Camera centre, transformed by the similarity between the neighbourhoods of keyframe and candidate.
      const Eigen::Vector3d centre = pose(current).inverse().translation();
      T_place_current.translation() =
          pose(place) * (loop_.T_camera_world.inverse() * (loop_.scale * (pose(loop_.keyframe) * centre)));
    }
    graph_.edges.push_back({node(current), node(place), T_place_current, 1.0, loop_.scale});
  };
  for (const KeyFrameId place : place_side_) add(loop_.keyframe, place);
  for (std::size_t i = 1; i < current_side_.size(); ++i) add(current_side_[i], loop_.candidate);
}

void LoopCorrection::fix_submaps() {
  SubmapSet done;
  if (keyframe_submap_ != place_submap_) done.add(std::max(keyframe_submap_, place_submap_));
  for (std::size_t i = 0; i < nodes_.size(); ++i) graph_.nodes[i].fixed = done.add(map_.keyframe(nodes_[i]).submap);
}

void LoopCorrection::bring_pieces_together() {
  if (keyframe_submap_ == place_submap_) return;
  const Eigen::Isometry3d& T_camera_old = graph_.nodes[node_of_slot_[loop_.keyframe.slot]].T_camera_world;
  Eigen::Isometry3d T_old_new = T_camera_old.inverse() * loop_.T_camera_world;
  if (place_submap_ > keyframe_submap_) T_old_new = T_old_new.inverse();
  const std::uint32_t moving = std::max(keyframe_submap_, place_submap_);
  for (std::size_t i = 0; i < nodes_.size(); ++i)
    if (map_.keyframe(nodes_[i]).submap == moving)
      graph_.nodes[i].T_camera_world = graph_.nodes[i].T_camera_world * T_old_new;
}

void LoopCorrection::make_upright() {
  if (!settings_.keep_vertical || !optimizer_.keeps_vertical()) return;
  const std::uint32_t older = std::min(keyframe_submap_, place_submap_);
  if (!has_verticals(older) || !has_verticals(std::max(keyframe_submap_, place_submap_))) return;
  for (std::size_t i = 0; i < nodes_.size() && !graph_.vertical; ++i) {
    const KeyFrame& keyframe = map_.keyframe(nodes_[i]);
    if (keyframe.submap == older && keyframe.vertical)
      graph_.vertical = graph_.nodes[i].T_camera_world.linear().transpose() * *keyframe.vertical;
  }
  if (!graph_.vertical) return;
  turn_upright(older);
  if (keyframe_submap_ != place_submap_) turn_upright(std::max(keyframe_submap_, place_submap_));
}

/// Whether most keyframes of the submap know their vertical: others could not be turned upright by the graph.
bool LoopCorrection::has_verticals(std::uint32_t submap) const {
  constexpr double least_share = 0.8;
  std::size_t count = 0, known = 0;
  for (const KeyFrameId id : nodes_) {
    const KeyFrame& keyframe = map_.keyframe(id);
    if (keyframe.submap != submap) continue;
    ++count;
    known += keyframe.vertical ? 1 : 0;
  }
  return static_cast<double>(known) >= least_share * static_cast<double>(count);
}

/// Keyframes without a vertical of their own turn as the one before them, or as the first that has one.
void LoopCorrection::turn_upright(std::uint32_t submap) {
  std::optional<Eigen::Matrix3d> turn;  // new world from old
  std::vector<std::size_t> waiting;
  const auto apply = [&](std::size_t i) {
    if (graph_.nodes[i].fixed) return;
    Eigen::Isometry3d& pose = graph_.nodes[i].T_camera_world;
    const Eigen::Vector3d centre = -pose.linear().transpose() * pose.translation();
    pose.linear() = pose.linear() * turn->transpose();
    pose.translation() = -pose.linear() * centre;
  };
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    const KeyFrame& keyframe = map_.keyframe(nodes_[i]);
    if (keyframe.submap != submap) continue;
    const Eigen::Matrix3d& R_camera_world = graph_.nodes[i].T_camera_world.linear();
    if (keyframe.vertical)
      turn = Eigen::Quaterniond::FromTwoVectors(R_camera_world.transpose() * *keyframe.vertical, *graph_.vertical)
                 .toRotationMatrix();
    if (!turn) {
      waiting.push_back(i);
      continue;
    }
    for (const std::size_t earlier : waiting) apply(earlier);
    waiting.clear();
    apply(i);
  }
}

void LoopCorrection::move_map() {
  std::vector<Eigen::Isometry3d> poses;
  std::vector<double> scales;
  for (const PoseGraphProblem::Node& node : graph_.nodes) {
    poses.push_back(node.T_camera_world);
    scales.push_back(node.scale);
  }
  const MapMotion motion(map_, nodes_, poses, scales);
  motion.move_keyframes(map_);
  for (const MapPointId id : map_.points().ids()) {
    motion.move_point(map_.point(id));
    if (loop_.scale_is_free) map_.update_point_geometry(id);  // its distance range has changed
  }
}

void LoopCorrection::fuse_matches() {
  for (const auto& [point, feature] : loop_.points) fuse(point, loop_.keyframe, feature);
}

void LoopCorrection::fuse_into(KeyFrameId target) {
  const Frame& frame = map_.keyframe(target).frame;
  PointBlock points;
  for (const MapPointId id : points_seen_by(map_, place_side_)) points.add(id, map_.point(id));
  const double radius = 0.5 * settings_.search_radius;
  for (const matching::FeatureMatch& match :
       find_points(matcher_, points, frame, frame.T_camera_world, radius, settings_.match_distance).matches)
    fuse(points.ids[match.source], target, match.feature);
}

void LoopCorrection::fuse(MapPointId place_point, KeyFrameId keyframe, std::uint32_t feature) {
  if (add_or_fuse(map_, place_point, keyframe, feature, FusionSurvivor::searched_point) == FusionOutcome::points_fused)
    ++points_fused_;
}

}  // namespace holdfast
