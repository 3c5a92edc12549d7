// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "holdfast/core/frame.hpp"
#include "holdfast/core/map.hpp"
#include "holdfast/core/module.hpp"
#include "holdfast/core/moving_object.hpp"
#include "holdfast/core/predicted_pose.hpp"
#include "holdfast/core/sensor_frame.hpp"
#include "holdfast/interfaces/segmenter.hpp"

namespace holdfast {

/// The inputs without which a filter cannot work. They are checked against the source and the pipeline before the first
/// frame and do not change. In a single frame, an input may be missing all the same: the frame has no depth, no mask
/// has arrived yet, or there is no pose.
///
/// Filters that need neither pose_prior nor matches run before matching, so that features that they suspect cannot bias
/// the pose. Filters that need pose_prior run after the first pose estimate; filters that need matches run after the
/// local map was matched.
struct Needs {
  bool depth = false;         ///< without it, a filter works on the frames of one camera, which have none
  bool segmentation = false;  ///< a segmenter other than `none`
  bool pose_prior = false;    ///< FilterContext::T_camera_world
  bool matches = false;       ///< features matched with the local map, and the pose estimated from them
  bool evidence = false;      ///< evidence of an earlier filter; a warning if there is none
  bool inertia = false;       ///< FilterContext::inertial_prediction; a warning if tracking uses no inertia
};

/// The inputs of one call of a filter. References are valid during apply() only.
struct FilterContext {
  const SensorFrame& sensor_frame;
  const Frame& frame;               ///< features, coarse view with its mask, and map points where they are matched
  const Frame* previous = nullptr;  ///< the previous frame with its pose; nullptr when it has none
  const Map& map;
  /// Submap in which the frame is tracked (KeyFrame::submap): poses of keyframes of other submaps are not comparable.
  std::uint32_t submap = 0;
  /// The current estimate of the frame's pose; nullptr when there is none.
  const Eigen::Isometry3d* T_camera_world = nullptr;
  /// The frame's pose by inertial measurements since earlier frames; nullptr when inertial estimation does not run or
  /// is not yet reliable.
  const PredictedPose* inertial_prediction = nullptr;
  /// The segmentation of this very frame; set only when a keyframe is evaluated again because its mask has arrived.
  /// The mask on cells, propagated or sampled from this segmentation, is frame.coarse.mask.
  const Segmentation* segmentation = nullptr;
  const std::vector<std::string>* classes = nullptr;  ///< of the segmenter; never nullptr when there is a mask
  /// Segmenter::movable(): the classes that can move; nullptr or empty when the segmenter does not name them.
  const std::vector<std::string>* movable = nullptr;

  /// Pose of the frame's depth image (Frame::T_view_world) by the current estimate; T_camera_world must not be nullptr.
  /// To compare depth with a keyframe, use this pose and the keyframe's frame.T_view_world().
  Eigen::Isometry3d T_view_world() const { return frame.coarse.T_view_world(*T_camera_world); }
};

/// Evidence that each feature of a frame belongs to the static world, as log-odds: 0 = unknown, positive = static.
/// Class priors ("people can move") and measurements ("this moved") are kept apart, and each contribution names the
/// stage that added it.
class StaticEvidence {
 public:
  enum class Kind : std::uint8_t { prior, measurement };

  /// Log-odds that a stage added to a feature.
  struct Contribution {
    std::uint32_t feature;
    float log_odds;
    std::uint16_t stage;  ///< index into stages()
    Kind kind;
  };
  /// Log-odds that a stage measured for a map point, matched or not.
  struct PointContribution {
    MapPointId point;
    float log_odds;
    std::uint16_t stage;
  };

  explicit StaticEvidence(std::size_t feature_count = 0, std::size_t cell_count = 0) {
    reset(feature_count, cell_count);
  }
  void reset(std::size_t feature_count, std::size_t cell_count = 0) {
    prior_.assign(feature_count, 0.0F);
    measurement_.assign(feature_count, 0.0F);
    cells_.assign(cell_count, 0.0F);
    contributions_.clear();
    point_contributions_.clear();
    stages_.clear();
    objects_.clear();
  }

  /// Names the stage of the contributions that follow; the chain calls it before each filter.
  void begin_stage(std::string_view name) { stages_.emplace_back(name); }
  /// Adds evidence about a feature. Evidence is never removed: filters do not delete.
  void add(std::size_t feature, float log_odds, Kind kind = Kind::measurement) {
    (kind == Kind::prior ? prior_ : measurement_)[feature] += log_odds;
    contributions_.push_back({static_cast<std::uint32_t>(feature), log_odds, stage(), kind});
  }
  /// Adds a measurement of a map point: negative when the point is no longer at its position, positive when it is.
  void add_point(MapPointId point, float log_odds) { point_contributions_.push_back({point, log_odds, stage()}); }
  /// Adds evidence about the surface in a cell of the frame's coarse view. It serves dense results and the propagation
  /// of masks, not the pose.
  void add_cell(std::size_t cell, float log_odds) { cells_[cell] += log_odds; }
  /// Adds a tracked object to the frame's result, by which observers see it. It is not evidence by itself.
  void add_object(const MovingObject& object) { objects_.push_back(object); }

  std::size_t size() const { return prior_.size(); }
  float log_odds(std::size_t feature) const { return prior_[feature] + measurement_[feature]; }
  float prior(std::size_t feature) const { return prior_[feature]; }
  float measurement(std::size_t feature) const { return measurement_[feature]; }
  const std::vector<float>& cells() const { return cells_; }
  const std::vector<Contribution>& contributions() const { return contributions_; }
  const std::vector<PointContribution>& point_contributions() const { return point_contributions_; }
  const std::vector<MovingObject>& objects() const { return objects_; }
  const std::vector<std::string>& stages() const { return stages_; }

 private:
  std::uint16_t stage() const { return static_cast<std::uint16_t>(stages_.empty() ? 0 : stages_.size() - 1); }

  std::vector<float> prior_, measurement_, cells_;
  std::vector<Contribution> contributions_;
  std::vector<PointContribution> point_contributions_;
  std::vector<std::string> stages_;
  std::vector<MovingObject> objects_;
};

/// Evaluates which features belong to the static world by adding evidence. With an empty chain of filters every feature
/// counts as static. Used by one thread.
class DynamicFilter : public Module {
 public:
  static constexpr const char* kind = "filters";

  virtual Needs needs() const = 0;
  /// The classes of the segmenter whose pixels count as movable, by name; `specified` is Segmenter::movable(). Names
  /// that the segmenter does not have are an error before the first frame, and the run counts masks in which these
  /// classes cover most of the image. Empty for a filter that uses no classes. Constant after construction.
  virtual std::vector<std::string> movable_classes(const std::vector<std::string>& /*specified*/) const { return {}; }
  /// Further classes of the segmenter that the settings name, such as those that move seldom. Names that the segmenter
  /// does not have are an error before the first frame. Constant after construction.
  virtual std::vector<std::string> named_classes() const { return {}; }
  /// Adds evidence about the features of context.frame in finite numbers; adds nothing where it cannot decide. The same
  /// contexts in the same order give the same evidence. Throws InputError for a context that it cannot use, for example
  /// when the segmenter lacks a class that its settings name.
  virtual void apply(const FilterContext& context, StaticEvidence& evidence) = 0;
};

}  // namespace holdfast
