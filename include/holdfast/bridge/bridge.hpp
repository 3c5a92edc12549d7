// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "holdfast/bridge/messages.hpp"

namespace holdfast::bridge {

/// Parameters of a node. Those of the pipeline are in its configuration.
struct Parameters {
  std::string configuration;           ///< YAML file; its source is replaced by the images of the bridge
  std::vector<std::string> overrides;  ///< "key.path=value", as of `holdfast run --set`
  bool has_depth = true;               ///< depth images come with the colour images
  bool has_right = false;              ///< right images of a rectified pair come with the colour images
  /// The images are rectified: P of camera_info counts, and there is no distortion.
  bool is_rectified = false;
  double tolerance = 0.02;     ///< largest time between the images of a frame [s]
  double depth_factor = 1000;  ///< value of one metre in depth images of whole numbers
  int queue = 2;               ///< frames that may wait; the oldest one is dropped for a newer one
  double map_interval = 1.0;   ///< least time between two map outputs [s]
  double grid_interval = 2.0;  ///< the same of grids, which exist with surface.enabled [s]
  std::string map_file;        ///< map to begin with; empty = a new map
  bool localise_only = false;  ///< localise in map_file without changing it
  /// Sequential mode: every frame is processed wholly before the next one, none is dropped, and the results are
  /// deterministic. Otherwise the pipeline is threaded and paced, whatever the configuration says.
  bool is_sequential = false;
};

/// Receives what the bridge finds. Calls come from threads of the bridge, one at a time for each function, and must not
/// call functions of the bridge that wait (see there).
class Listener {
 public:
  virtual ~Listener() = default;
  virtual void on_frame(const FrameOutput& frame) = 0;
  virtual void on_map(const MapOutput&) {}
  virtual void on_grid(const GridOutput&) {}
  /// A sentence for the log of the node.
  virtual void on_message(Diagnostics::Level level, const std::string& text) = 0;
  /// T_odom_base at a time, of wheels for instance. Without it (nothing), the bridge makes an odometry of its own.
  virtual std::optional<Eigen::Isometry3d> odometry(Stamp) { return std::nullopt; }
};

/// Everything of a robot's node but the middleware: images in, poses, maps and diagnostics out.
///
/// Images are converted in the calling thread and paired by their stamps; a thread of the bridge feeds frames to the
/// pipeline and calls Listener::on_frame, another one makes maps. The pipeline begins with the first frame, or before
/// it when the camera is known.
///
/// `map` begins where the robot is at the first frame, x ahead and z up, if the pose of the camera on the robot is
/// known; a map of a file keeps its frame. A time stamp more than a second before the last one, as of a bag that is
/// played again, begins a new map.
///
/// Functions may be called by any thread. Errors are exceptions (std::exception) with the cause and the remedy.
class Bridge {
 public:
  /// Throws ConfigurationError with all errors of the configuration, and InputError for an unusable map or a parameter
  /// that cannot be, such as a depth factor of 0. The listener
  /// must outlive the bridge.
  Bridge(const Parameters& parameters, Listener& listener);
  /// Discards frames that wait.
  ~Bridge();

  /// Images that are not usable are reported by Listener::on_message and counted.
  /// @{
  void add_colour(const RawImage& image);
  void add_colour(const CompressedImage& image);
  void add_depth(const RawImage& image);
  void add_depth(const CompressedImage& image);
  void add_right(const RawImage& image);
  void add_right(const CompressedImage& image);
  /// @}
  /// Ignored if the configuration has no section `imu`.
  void add_inertia(const InertialSample& sample);
  /// Calibration of the colour camera. Ignored after the first one, and if the configuration gives a camera, except for
  /// a warning where they differ.
  void set_camera(const CameraInfo& info);
  /// Calibration of the right camera, for the baseline of the pair.
  void set_right_camera(const CameraInfo& info);
  /// Pose of the optical frame of the camera (z forward) on the robot, before the first frame. Default: at its origin,
  /// looking ahead.
  void set_camera_pose(const Eigen::Isometry3d& T_base_camera);

  /// While paused, images are ignored.
  void pause(bool is_paused);
  bool is_paused() const;
  /// Begins a new map. Waits for the frame in progress.
  void reset();
  /// Writes the map while the run continues (Pipeline::save_map()).
  void save_map(const std::string& file);
  /// Continues with the map of a file, or localises in it without changing it. Waits for the frame in progress.
  void load_map(const std::string& file, bool localise_only);
  /// Waits until all frames that were added are processed, and gives out map and grid once more.
  void finish();

  Diagnostics diagnostics() const;
  /// Names and numbers of the warnings of the configuration and the modules, as sentences.
  std::vector<std::string> warnings() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace holdfast::bridge
