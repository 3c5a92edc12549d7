// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "holdfast/interfaces/dynamic_filter.hpp"
#include "scene.hpp"

namespace holdfast::conformance {

/// One frame as filters get it, with everything that any of them may need.
struct Moment {
  SensorFrame sensor;
  Frame frame;
  Segmentation segmentation;
};

/// What of a moment a filter is shown.
struct Shown {
  bool previous = true, pose = true, masks = true, inertia = true;
};

/// The scene as filters see it: features with depth, descriptors and map points, a map of two keyframes, masks.
class FilterScene {
 public:
  explicit FilterScene(const Camera& camera, std::size_t count = 8);

  const Map& map() const { return map_; }
  std::vector<Moment>& moments() { return moments_; }
  /// Makes it what one camera sees: no frame and no keyframe has depth.
  void remove_depth();

  /// Applies a filter to every frame in turn, after a stage "earlier" that adds evidence against the moving block.
  std::vector<StaticEvidence> judge(DynamicFilter& filter, const Shown& shown = {}) const;
  /// The same for one moment with evidence that is there already.
  void judge(DynamicFilter& filter, std::size_t moment, const Shown& shown, StaticEvidence& evidence) const;
  /// The evidence of the stage "earlier" for a frame.
  StaticEvidence earlier(std::size_t moment) const;

 private:
  struct Point {
    Eigen::Vector3d position;  // at frame 0
    bool moves;
    std::uint8_t octave;
    Descriptor256 descriptor;
    MapPointId id;
  };
  Moment moment_at(std::uint64_t index);
  void choose_points();
  void make_map();

  Scene scene_;
  CoarseSampler sampler_;
  std::shared_ptr<const Camera> camera_;
  std::shared_ptr<const ScalePyramid> pyramid_ = std::make_shared<ScalePyramid>();
  std::vector<Point> points_;
  std::vector<std::size_t> point_of_feature_;  // of the last frame
  Map map_;
  std::vector<Moment> moments_;
};

/// A frame without a single feature, otherwise as it was.
void remove_features(Frame& frame);
/// No depth: neither in the image, nor of the features, nor in the coarse view.
void remove_depth(Moment& moment);

}  // namespace holdfast::conformance
