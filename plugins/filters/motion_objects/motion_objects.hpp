// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <string>
#include <vector>

#include "holdfast/depth_blocks/depth_view.hpp"
#include "holdfast/interfaces/dynamic_filter.hpp"
#include "holdfast/settings/motion_objects.hpp"
#include "object_track.hpp"
#include "regions.hpp"
#include "rigid_alignment.hpp"

namespace holdfast::motion_objects_plugin {

/// Tracks moving objects: regions that earlier filters of the chain classify as moving, and that are connected in
/// depth, become tracks. Each track is aligned with an earlier frame by its own rigid motion, which gives its velocity.
/// A track that has moved for long enough is reported as a MovingObject, and its features get negative evidence; an
/// object that came to rest gets positive evidence.
///
/// After Ruenz and Agapito: Co-Fusion: Real-time Segmentation, Tracking and Fusion of Multiple Objects, ICRA 2017
/// (connected moving regions become models, each of which is tracked like the camera), and Ruenz, Buffier and Agapito:
/// MaskFusion, ISMAR 2018 (mask labels give their class). Where masks have instances, a region belongs to the track of
/// its instance, and none to two instances. Here the model is the surface of the object in an earlier
/// frame; surfaces are not fused. Keeps images and poses of the last frames. The evidence is measurements.
class MotionObjects final : public DynamicFilter {
 public:
  MotionObjects(const MotionObjectsSettings& settings, const CreationContext& context);

  Needs needs() const override { return {.depth = true, .pose_prior = true, .matches = true, .evidence = true}; }
  void apply(const FilterContext& context, StaticEvidence& evidence) override;

  /// Objects and candidates in the order of their first observation.
  const std::vector<ObjectTrack>& tracks() const { return tracks_; }

 private:
  /// The observation of a track in one frame.
  struct TrackObservation {
    std::uint32_t track;
    Eigen::Vector3d centroid;   // world [m]
    Eigen::Vector3d deviation;  // by axis of the camera [m]
    float surface;              // [m^2]
  };
  struct View {
    depth_blocks::DepthView image;
    Eigen::Isometry3d T_view_world = Eigen::Isometry3d::Identity();
    std::vector<std::uint32_t> owner;  // of each block: track id, 0 = none
    std::vector<TrackObservation> observations;
  };
  /// All regions of a track in this frame.
  struct Part {
    std::size_t track;
    std::vector<std::size_t> regions;
  };

  bool keep_up(const FilterContext& context);
  void give_hints(const FilterContext& context, const StaticEvidence& evidence);
  std::uint32_t track_before(const Eigen::Vector3f& in_view, const BlockHint& hint) const;
  /// Instance of more than half of a region's blocks, 0 if there is none.
  std::uint16_t instance_of(const Region& region) const;
  bool may_join(int block, std::uint32_t track_id) const;
  void assign_regions();
  void claim(std::size_t track, std::size_t region);
  bool resembles(const ObjectTrack& track, const Region& region) const;
  bool belongs_to(const Region& region, const Part& part) const;
  void follow(const Part& part);
  /// Extent of a part of `size` blocks along the axes of its object, without the outermost points [m].
  Eigen::AlignedBox3f inner_box(const Part& part, const Eigen::Isometry3f& T_object_view, std::size_t size);
  void align(ObjectTrack& track, const Part& part, const TrackObservation& observation);
  const View* reference(const ObjectTrack& track, const TrackObservation& now, const TrackObservation*& then) const;
  void forget();
  void add_evidence(const FilterContext& context, StaticEvidence& evidence);
  ObjectTrack* find(std::uint32_t track_id);
  const ObjectTrack* find(std::uint32_t track_id) const { return const_cast<MotionObjects*>(this)->find(track_id); }
  Eigen::Vector3f point(int block) const;

  MotionObjectsSettings settings_;
  depth_blocks::ViewMaker maker_;
  depth_blocks::DepthNoise noise_;
  RigidAlignment alignment_;
  Regions regions_;
  std::vector<ObjectTrack> tracks_;
  std::uint32_t next_track_id_ = 1, next_object_id_ = 1;
  std::deque<View> views_;  // oldest first, the last one is that of this frame
  double interval_ = 0.0;   // since the previous frame [s]

  std::vector<BlockHint> hints_;
  std::vector<Part> parts_;
  std::vector<std::size_t> order_;
  std::vector<int> label_counts_;
  std::vector<float> log_odds_;
  std::array<std::vector<float>, 3> along_;
  ObjectPoints points_;
  struct Prediction {
    std::uint32_t track_id;
    Eigen::Vector3f back;  // displacement of its points from this view to the last view, in the frame of the last view
    Eigen::Vector3f centre;
    float radius;
    int label;
    std::uint16_t instance;
  };
  std::vector<Prediction> predictions_;
  Eigen::Isometry3f T_last_now_ = Eigen::Isometry3f::Identity();
};

}  // namespace holdfast::motion_objects_plugin
