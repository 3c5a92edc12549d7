// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "holdfast/core/camera.hpp"
#include "holdfast/core/sensor_frame.hpp"
#include "holdfast/core/trajectory.hpp"
#include "holdfast/simulation/camera_path.hpp"
#include "holdfast/simulation/renderer.hpp"
#include "holdfast/simulation/scene.hpp"
#include "holdfast/simulation/scene_world.hpp"

namespace holdfast::simulation {

/// Generates the frames of a simulated scene with ground truth. Frames can be requested in any order: each is a
/// deterministic function of scene, camera and index. Used by one thread.
class Simulator {
 public:
  /// Throws ConfigurationError if the sequence has no frame, and as make_scene_world().
  Simulator(const Scene& scene, const Camera& camera);

  std::uint64_t frame_count() const { return frame_count_; }
  double timestamp(std::uint64_t index) const { return static_cast<double>(index) / scene_.frame_rate; }
  Eigen::Isometry3d T_world_camera(std::uint64_t index) const { return path_.pose(timestamp(index)); }
  /// The pose of every frame.
  Trajectory truth() const;

  /// The images of the sensors with ground truth: the pose, object_mask (numbers of numbered_objects()), class_labels
  /// (indices into class_names()) and the numbered objects that move at this time.
  SensorFrame frame(std::uint64_t index);
  /// The same with the image of a second camera, `baseline` [m] to the right of the first, in place of depth. Both
  /// images have noise of their own.
  SensorFrame stereo_frame(std::uint64_t index, double baseline);
  /// The rendered images without sensor effects.
  RenderedFrame render(std::uint64_t index) { return render(index, Eigen::Isometry3d::Identity()); }

  const CameraPath& path() const { return path_; }
  const World& world() const { return scene_world_.world; }
  const Stage& stage() const { return scene_world_.stage; }
  /// The movable objects of this scene, by number.
  const std::vector<NumberedObject>& numbered_objects() const { return scene_world_.numbered; }
  const Object& object(const NumberedObject& numbered) const { return world().objects[numbered.index]; }
  const Camera& camera() const { return camera_; }
  const Scene& scene() const { return scene_; }
  const std::vector<std::string>& class_names() const { return class_names_; }

 private:
  /// Of a camera at the given pose relative to the first.
  RenderedFrame render(std::uint64_t index, const Eigen::Isometry3d& T_first_camera);
  /// The colour image with truth, without depth.
  SensorFrame colour_frame(std::uint64_t index, const RenderedFrame& rendered) const;
  void sense(cv::Mat& colour, std::uint64_t seed, double time) const;
  bool is_dark(double time) const;

  Scene scene_;
  Camera camera_;
  SceneWorld scene_world_;
  CameraPath path_;
  Renderer renderer_;
  std::uint64_t frame_count_ = 0;
  std::uint64_t depth_seed_ = 0, colour_seed_ = 0, right_seed_ = 0;
  std::vector<std::string> class_names_;
  std::vector<std::uint8_t> mask_values_;   // by object id
  std::vector<std::uint8_t> class_values_;  // by object id
};

}  // namespace holdfast::simulation
