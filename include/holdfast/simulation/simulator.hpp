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

/// A sequence from a simulated scene with all its truth. Frames can be asked for in any order: each depends on scene,
/// camera and index alone, to the byte. Used by one thread.
class Simulator {
 public:
  /// Throws ConfigurationError when there would be no frame, and as SceneWorld does.
  Simulator(const Scene& scene, const Camera& camera);

  std::uint64_t frame_count() const { return frame_count_; }
  double timestamp(std::uint64_t index) const { return static_cast<double>(index) / scene_.frame_rate; }
  Eigen::Isometry3d T_world_camera(std::uint64_t index) const { return path_.pose(timestamp(index)); }
  /// The pose of every frame.
  Trajectory truth() const;

  /// The images as the sensors report them, with truth: the pose, object_mask (numbers of numbered_objects()),
  /// class_labels (into class_names()) and which of the numbered objects move at that moment.
  SensorFrame frame(std::uint64_t index);
  /// The same without sensor effects.
  RenderedFrame render(std::uint64_t index);

  const World& world() const { return scene_world_.world; }
  const Stage& stage() const { return scene_world_.stage; }
  /// What may move in this scene, by number.
  const std::vector<NumberedObject>& numbered_objects() const { return scene_world_.numbered; }
  const Object& object(const NumberedObject& numbered) const { return world().objects[numbered.index]; }
  const Camera& camera() const { return camera_; }
  const Scene& scene() const { return scene_; }
  const std::vector<std::string>& class_names() const { return class_names_; }

 private:
  bool is_dark(double time) const;

  Scene scene_;
  Camera camera_;
  SceneWorld scene_world_;
  CameraPath path_;
  Renderer renderer_;
  std::uint64_t frame_count_ = 0;
  std::vector<std::string> class_names_;
  std::vector<std::uint8_t> mask_values_;   // by object id
  std::vector<std::uint8_t> class_values_;  // by object id
};

}  // namespace holdfast::simulation
