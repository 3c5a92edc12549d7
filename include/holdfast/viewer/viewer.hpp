// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <string>
#include <utility>
#include <vector>

#include "holdfast/core/camera.hpp"
#include "holdfast/core/cloud_point.hpp"
#include "holdfast/core/frame_result.hpp"
#include "holdfast/core/id.hpp"
#include "holdfast/core/map_snapshot.hpp"
#include "holdfast/core/surface_patch.hpp"
#include "holdfast/core/trajectory.hpp"

namespace holdfast {

/// Settings of a Viewer.
struct ViewerOptions {
  std::string listen = "127.0.0.1";  ///< numeric address to listen at; anything else than loopback opens it to others
  int port = 0;                      ///< 0 = any free port
  double speed = 0.0;                ///< of a recording: 1 = at its time stamps; 0 = as fast as it goes
  int picture_width = 480;           ///< larger pictures are scaled down before they are sent [px]
  double picture_rate = 12.0;        ///< most pictures per second
  std::string title = {};            ///< shown at the top of the page
  Camera camera = {};                ///< for the frustum, and for the size of the pictures
};

/// Colour image of a frame and its overlay. Pixels are raw.
struct ViewedPicture {
  /// A feature that is drawn, in pixels of the picture.
  struct Feature {
    float x = 0.0F, y = 0.0F;
    float static_probability = 1.0F;  ///< 0 to 1
    bool shows_point = false;         ///< matched to a map point
  };
  std::uint64_t index = 0;  ///< SensorFrame::index
  cv::Mat colour;           ///< 8UC3 or 8UC1; owned, nobody else writes to it
  std::vector<Feature> features;
  std::vector<MapPointId> points;                ///< map points that the frame observes
  std::vector<Eigen::Vector3f> moving_features;  ///< positions of features that are probably moving, world frame [m]
  /// Cells of a grid over the image, row by row: in the lower three bits the class, or the instance where the mask has
  /// instances (0 = none, 1 to 6 in turn, 7 = unknown), in
  /// the upper four how certainly it moves (0 to 15). Empty = no mask.
  std::vector<std::uint8_t> mask;
  int mask_columns = 0;
};

/// The class that a map point belongs to.
struct ViewedClass {
  MapPointId point;
  std::uint8_t label = 0;  ///< index into the names of Viewer::set_classes()
};

/// Surfaces observed by a keyframe; they move with the keyframe when the map is corrected.
struct ViewedSurface {
  KeyFrameId keyframe;
  double timestamp = 0.0;  ///< of the keyframe [s]
  Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();
  std::vector<CloudPoint> points;  ///< in the frame of the keyframe's camera
};

/// Result of a run that has ended. The path is in the world frame of the map.
struct ViewedRun {
  std::string title;
  Camera camera;
  Trajectory path;
  std::vector<float> errors;  ///< of the poses of `path` [m], NaN = unknown; empty = no truth
  /// True positions, in the world frame of the map by the alignment of the evaluation; empty = unknown.
  std::vector<std::pair<double, Eigen::Vector3d>> truth;
  std::vector<std::pair<std::string, std::string>> figures;  ///< name and value, for the summary beside the map
  /// Dense cloud in the world frame of the map; empty = none, and earlier surfaces stay.
  std::vector<CloudPoint> cloud;
  /// Mesh in the world frame of the map, in patches of any kind (patches_of()); empty = none, and earlier ones stay.
  std::vector<SurfacePatch> mesh;
};

/// Shows a run in browsers: an HTTP and WebSocket server in a separate thread, which serves one self-contained page and
/// sends changes to it.
///
/// Every request needs the token of address(), 128 random bits; others get 403. Only the page and the socket are
/// served, no file. Only the messages of modules/viewer/README.md are accepted from browsers; any other message ends
/// the connection.
///
/// No method waits for a browser except take_turn() and wait_for_browser(): data are kept until the server thread takes
/// them, and a slow browser gets fewer and larger changes. Any thread may call any method.
class Viewer {
 public:
  /// Starts serving. Throws InputError when the address cannot be listened at.
  static std::shared_ptr<Viewer> start(const ViewerOptions& options);
  /// Closes all connections.
  ~Viewer();
  Viewer(const Viewer&) = delete;
  Viewer& operator=(const Viewer&) = delete;

  /// "http://127.0.0.1:40123/?token=0f..."
  const std::string& address() const;
  /// Whether a browser is connected.
  bool is_watched() const;

  /// The result of the next frame.
  void add_frame(const FrameResult& result);
  /// True when a browser can show another picture now, limited by ViewerOptions::picture_rate and the rates of the
  /// browsers.
  bool wants_picture() const;
  void set_picture(ViewedPicture picture);
  /// True when another snapshot is due: at most five times a second, at the rate of the browsers, and for at most a
  /// fiftieth of the time; without a browser every two seconds and for a thousandth of the time.
  bool wants_map() const;
  /// `seconds`: duration of making the snapshot.
  void set_map(MapSnapshot map, double seconds);
  /// Names of classes by label; label 0 is the background. Empty = no classes.
  void set_classes(std::vector<std::string> names);
  /// Map points whose class is new or has changed; they need not be in a snapshot yet.
  void add_point_classes(std::vector<ViewedClass> classes);
  /// Adds to the dense cloud, of which browsers get at most 100,000 points: the larger the scene, the coarser.
  void add_surface(ViewedSurface surface);
  /// True when changes of the mesh can be shown now: somebody watches, at most once a second, at the rate of the
  /// browsers, and for at most a twentieth of the time.
  bool wants_patches() const;
  /// Coarseness of the patches that are wanted (ObservedSurface::changes). It grows with the mesh, of which browsers
  /// get at most 300,000 triangles; patches of all the surface are wanted then.
  int patch_coarseness() const;
  /// Adds patches of the mesh, or replaces those of the same cubes. `seconds`: duration of making them.
  void add_patches(std::vector<SurfacePatch> patches, int coarseness, double seconds);
  /// Reports a loop that was closed between two keyframes.
  void add_loop(KeyFrameId keyframe, KeyFrameId candidate);
  /// Replaces path and figures by those of a run that has ended.
  void set_run(ViewedRun run);

  /// Waits while a browser has paused the run, and for the time stamp of a frame at the chosen speed [s]. Returns at
  /// once without a browser, when the last one leaves, and when the thread handles a signal, so that signals stop a
  /// program as without the viewer.
  void take_turn(double timestamp);
  /// Waits for the first browser, or until the thread handles a signal.
  void wait_for_browser();
  /// Ends both for good: calls in progress and later ones return at once.
  void stop_waiting();

 private:
  struct State;
  explicit Viewer(const ViewerOptions& options);
  std::unique_ptr<State> state_;
};

/// The viewers of this process, oldest first, for instance to print their addresses, or to keep a viewer of an observer
/// beyond the end of the run.
std::vector<std::shared_ptr<Viewer>> running_viewers();

}  // namespace holdfast
