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
#include "holdfast/core/sensor_frame.hpp"
#include "holdfast/interfaces/carried_mask.hpp"
#include "holdfast/interfaces/segmenter.hpp"

namespace holdfast {

/// What a filter cannot work without. Checked against the source and the pipeline before the first frame; does not
/// change. What is needed may still be missing in one frame: no depth in it, no mask yet, no pose.
struct Needs {
  bool depth = false;
  bool segmentation = false;  ///< a segmenter other than none
  /// FilterContext::T_camera_world. Filters without this need and the next speak before features are matched, so that
  /// what they suspect cannot lead the pose astray.
  bool pose_prior = false;
  bool map = false;
  bool matches = false;  ///< features matched with the local map, and the pose that they gave
};

/// What filters may look at when a frame is judged. References are valid during apply() only.
struct FilterContext {
  const SensorFrame& sensor_frame;
  const Frame& frame;               ///< its features, coarse view, and map points where they were matched
  const Frame* previous = nullptr;  ///< the frame before, nullptr for the first
  const Map& map;
  /// Best guess of the frame's pose so far, nullptr when there is none.
  const Eigen::Isometry3d* T_camera_world = nullptr;
  /// Of this very frame: set when a keyframe is judged again because its segmentation has come.
  const Segmentation* segmentation = nullptr;
  /// Carried to this frame from an earlier one, or its own segmentation on its cells when it is judged again; nullptr =
  /// none.
  const CarriedMask* carried_mask = nullptr;
  const std::vector<std::string>* classes = nullptr;  ///< of the segmenter; never nullptr when one of the masks is set
  /// Segmenter::movable(): of the classes, those that can move; nullptr or empty when the segmenter does not
  /// say.
  const std::vector<std::string>* movable = nullptr;
};

/// Log-odds of being part of the static world for every feature of a frame, with which stage said what. 0 = unknown;
/// positive = static. "Movable" (a prior of the class) and "moving" (a measurement) are kept apart.
class StaticEvidence {
 public:
  enum class Sort : std::uint8_t { prior, measurement };

  /// One thing said about one feature.
  struct Statement {
    std::uint32_t feature;
    float log_odds;
    std::uint16_t stage;  ///< index into stages()
    Sort sort;
  };
  /// One thing measured of a map point, whether or not the frame shows it.
  struct PointStatement {
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
    statements_.clear();
    point_statements_.clear();
    stages_.clear();
    objects_.clear();
  }

  /// Names the stage whose statements follow; the chain calls it before each filter.
  void begin_stage(std::string_view name) { stages_.emplace_back(name); }
  /// Adds evidence about a feature. Never takes anything away: filters do not delete.
  void add(std::size_t feature, float log_odds, Sort sort = Sort::measurement) {
    (sort == Sort::prior ? prior_ : measurement_)[feature] += log_odds;
    statements_.push_back({static_cast<std::uint32_t>(feature), log_odds, stage(), sort});
  }
  /// Adds a measurement of a map point: that it is not where it was, or that it is.
  void add_point(MapPointId point, float log_odds) { point_statements_.push_back({point, log_odds, stage()}); }
  /// Adds evidence about what a cell of the frame's coarse view shows; it serves the dense results, not the pose.
  void add_cell(std::size_t cell, float log_odds) { cells_[cell] += log_odds; }

  /// Tells of a thing that moves; it reaches the observers with the frame's result and is no evidence by itself.
  void report(const MovingObject& object) { objects_.push_back(object); }

  std::size_t size() const { return prior_.size(); }
  float log_odds(std::size_t feature) const { return prior_[feature] + measurement_[feature]; }
  float prior(std::size_t feature) const { return prior_[feature]; }
  float measurement(std::size_t feature) const { return measurement_[feature]; }
  const std::vector<float>& cells() const { return cells_; }
  const std::vector<Statement>& statements() const { return statements_; }
  const std::vector<PointStatement>& point_statements() const { return point_statements_; }
  const std::vector<MovingObject>& objects() const { return objects_; }
  const std::vector<std::string>& stages() const { return stages_; }

 private:
  std::uint16_t stage() const { return static_cast<std::uint16_t>(stages_.empty() ? 0 : stages_.size() - 1); }

  std::vector<float> prior_, measurement_, cells_;
  std::vector<Statement> statements_;
  std::vector<PointStatement> point_statements_;
  std::vector<std::string> stages_;
  std::vector<MovingObject> objects_;
};

/// Judges which features belong to the static world by adding evidence. An empty chain says nothing, so every feature
/// counts as static. Used by one thread.
class DynamicFilter : public Module {
 public:
  static constexpr const char* kind = "filters";

  virtual Needs needs() const = 0;
  /// Adds evidence about the features of context.frame, in finite numbers; says nothing where it cannot judge. The same
  /// contexts in the same order give the same evidence. Throws InputError for a context that it cannot use, such as
  /// classes without one that it was told of.
  virtual void apply(const FilterContext& context, StaticEvidence& evidence) = 0;
};

}  // namespace holdfast
