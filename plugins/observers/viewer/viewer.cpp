// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/viewer/viewer.hpp"

#include <utility>

#include "holdfast/core/stage_times.hpp"
#include "holdfast/interfaces/observer.hpp"
#include "holdfast/plugin/plugin.hpp"
#include "holdfast/settings/viewer.hpp"
#include "picture.hpp"
#include "point_classes.hpp"
#include "viewer_description.hpp"

namespace holdfast {

namespace {

/// Shows the run in browsers. Without a browser the cost of a frame is that of copying its result.
class ViewerObserver final : public Observer {
 public:
  ViewerObserver(const ViewerSettings& settings, const CreationContext& context)
      : viewer_(Viewer::start({.listen = settings.listen,
                               .port = settings.port,
                               .speed = settings.speed,
                               .picture_width = settings.picture_width,
                               .picture_rate = settings.picture_rate,
                               .title = context.output_directory.filename().string(),
                               .camera = context.camera})),
        pictures_(context.camera),
        waits_(settings.wait) {}

  void on_start(const std::vector<std::string>& classes) override {
    has_classes_ = !classes.empty();
    viewer_->set_classes(classes);
  }
  void on_frame(const SensorFrame& sensor_frame, const Frame& frame, const FrameResult& result) override {
    viewer_->add_frame(result);
    if (has_classes_)
      if (std::vector<ViewedClass> changes = classes_.add(frame); !changes.empty())
        viewer_->add_point_classes(std::move(changes));
    if (std::exchange(waits_, false)) viewer_->wait_for_browser();
    if (viewer_->wants_picture() && !sensor_frame.colour.empty())
      viewer_->set_picture(pictures_.make(sensor_frame, frame, result));
    viewer_->take_turn(result.timestamp);
  }
  void on_keyframe(KeyFrameId, const ObservedMap& map) override {
    if (viewer_->wants_map()) show(map);
  }
  void on_static_view(const ObservedView& view) override {
    viewer_->add_surface({view.keyframe, view.timestamp, view.T_world_camera, view.points(surface_points)});
  }
  void on_surface(const ObservedSurface& surface) override {
    if (!viewer_->wants_patches()) return;
    const Stopwatch watch;
    const int coarseness = viewer_->patch_coarseness();
    if (std::exchange(coarseness_, coarseness) != coarseness) shown_surface_ = 0;
    std::vector<SurfacePatch> patches = surface.changes(std::exchange(shown_surface_, surface.version), coarseness);
    viewer_->add_patches(std::move(patches), coarseness, watch.seconds());
  }
  void on_loop(KeyFrameId keyframe, KeyFrameId candidate, const ObservedMap& map) override {
    show(map);
    viewer_->add_loop(keyframe, candidate);
  }
  void on_finish(const Map& map) override {
    // From here on what the map says: that is what its file keeps.
    std::vector<ViewedClass> classes;
    if (has_classes_)
      map.points().for_each([&](MapPointId id, const MapPoint& point) {
        if (point.label != CellMask::unknown) classes.push_back({id, point.label});
      });
    viewer_->add_point_classes(std::move(classes));
    viewer_->set_map(make_snapshot(map), 0.0);
  }
  void interrupt() noexcept override { viewer_->stop_waiting(); }

 private:
  /// Of a keyframe for the dense cloud: every fourth pixel of a kept image of 320x240.
  static constexpr std::size_t surface_points = 5000;

  void show(const ObservedMap& map) {
    const Stopwatch watch;
    MapSnapshot snapshot = map.snapshot();
    viewer_->set_map(std::move(snapshot), watch.seconds());
  }

  std::shared_ptr<Viewer> viewer_;
  viewer_plugin::PictureMaker pictures_;
  viewer_plugin::PointClasses classes_;
  std::uint64_t shown_surface_ = 0;  // version of the surface that the viewer has
  int coarseness_ = 0;               // of its patches
  bool has_classes_ = false;
  bool waits_;
};

}  // namespace

HOLDFAST_PLUGIN(viewer, registry) {
  registry.add<Observer, ViewerObserver, ViewerSettings>(viewer_plugin::description());
}

}  // namespace holdfast
