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

namespace holdfast::object_plugin {

/// Follows what moves: parts of the frame that earlier filters of the chain suspect, and that hang together in depth,
/// become tracks; each is aligned with an earlier frame by a rigid motion of its own, which gives its velocity. What
/// has moved for long enough is reported as a MovingObject, and is not static; what came to rest is again.
///
/// After Ruenz and Agapito: Co-Fusion: Real-time Segmentation, Tracking and Fusion of Multiple Objects, ICRA 2017
/// (connected parts that move become models of their own, which are tracked like the camera), and Ruenz, Buffier and
/// Agapito: MaskFusion, ISMAR 2018 (labels of masks name them). Here a model is what an earlier frame showed of the
/// thing; nothing is fused. Keeps images and poses of the last frames. Statements are measurements.
class MotionObjects final : public DynamicFilter {
 public:
  MotionObjects(const MotionObjectsSettings& settings, const CreationContext& context);

  Needs needs() const override { return {.depth = true, .pose_prior = true, .matches = true}; }
  void apply(const FilterContext& context, StaticEvidence& evidence) override;

  /// Objects and candidates, in the order in which they were first seen.
  const std::vector<ObjectTrack>& tracks() const { return tracks_; }

 private:
  /// What an earlier frame, or this one, showed of a track.
  struct Sight {
    std::uint32_t track;
    Eigen::Vector3d middle;     // world [m]
    Eigen::Vector3d deviation;  // by axis of the camera [m]
    float surface;              // [m^2]
  };
  struct View {
    depth_blocks::DepthView image;
    Eigen::Isometry3d T_view_world = Eigen::Isometry3d::Identity();
    std::vector<std::uint32_t> owner;  // of each block: name of a track, 0 = none
    std::vector<Sight> sights;
  };
  /// The regions of a track in this frame, together.
  struct Part {
    std::size_t track;
    std::vector<std::size_t> regions;
  };

  bool keep_up(const FilterContext& context);
  void give_hints(const FilterContext& context, const StaticEvidence& evidence);
  std::uint32_t track_before(const Eigen::Vector3f& in_view, std::uint8_t label) const;
  bool may_join(int block, std::uint32_t name) const;
  void assign_regions();
  void claim(std::size_t track, std::size_t region);
  bool resembles(const ObjectTrack& track, const Region& region) const;
  bool belongs_to(const Region& region, const Part& part) const;
  void follow(const Part& part);
  void align(ObjectTrack& track, const Part& part, const Sight& sight);
  const View* reference(const ObjectTrack& track, const Sight& now, const Sight*& then) const;
  void forget();
  void say(const FilterContext& context, StaticEvidence& evidence);
  ObjectTrack* find(std::uint32_t name);
  const ObjectTrack* find(std::uint32_t name) const { return const_cast<MotionObjects*>(this)->find(name); }
  Eigen::Vector3f point(int block) const;

  MotionObjectsSettings settings_;
  depth_blocks::ViewMaker maker_;
  depth_blocks::DepthNoise noise_;
  RigidAlignment alignment_;
  Regions regions_;
  std::vector<ObjectTrack> tracks_;
  std::uint32_t next_name_ = 1, next_id_ = 1;
  std::deque<View> views_;  // oldest first, the last one is this frame's
  double interval_ = 0.0;   // since the frame before [s]

  std::vector<BlockHint> hints_;
  std::vector<Part> parts_;
  std::vector<std::size_t> order_;
  std::vector<int> label_counts_;
  std::vector<float> said_;
  std::array<std::vector<float>, 3> along_;
  ObjectPoints points_;
  struct Prediction {
    std::uint32_t name;
    Eigen::Vector3f back;  // from where a point of it is now to where it was in the last view, in that view's frame
    Eigen::Vector3f centre;
    float radius;
    int label;
  };
  std::vector<Prediction> predictions_;
  Eigen::Isometry3f T_last_now_ = Eigen::Isometry3f::Identity();
};

}  // namespace holdfast::object_plugin
