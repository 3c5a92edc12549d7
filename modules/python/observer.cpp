// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/interfaces/observer.hpp"

#include "filter_context.hpp"
#include "ids.hpp"
#include "instance.hpp"

namespace holdfast::python {

namespace py = pybind11;

namespace {

/// Calls only what the class defines: the others cost neither a call nor the lock.
class ObserverOfPython final : public Observer {
 public:
  explicit ObserverOfPython(Instance instance)
      : instance_(std::move(instance)),
        sees_frames_(defines("on_frame")),
        sees_keyframes_(defines("on_keyframe")),
        sees_loops_(defines("on_loop")),
        sees_end_(defines("on_finish")) {
    if (!sees_frames_ && !sees_keyframes_ && !sees_loops_ && !sees_end_)
      throw InputError({instance_.file().string()}, instance_.class_name() +
                                                        " observes nothing; expected one of on_frame, on_keyframe, "
                                                        "on_loop and on_finish");
  }

  void on_frame(const SensorFrame& sensor_frame, const Frame& frame, const FrameResult& result) override {
    if (!sees_frames_) return;
    instance_.with_lock("on_frame", [&](const py::object& object) {
      const Shown<const Frame> features(frame, "features");
      object.attr("on_frame")(sensor_frame, features.view(), result);
    });
  }
  void on_keyframe(KeyFrameId keyframe, const ObservedMap& map) override {
    if (!sees_keyframes_) return;
    instance_.with_lock("on_keyframe", [&](const py::object& object) {
      const Shown<const ObservedMap> shown(map, "map");
      object.attr("on_keyframe")(number_of(keyframe), shown.view());
    });
  }
  void on_loop(KeyFrameId older, KeyFrameId newer, const ObservedMap& map) override {
    if (!sees_loops_) return;
    instance_.with_lock("on_loop", [&](const py::object& object) {
      const Shown<const ObservedMap> shown(map, "map");
      object.attr("on_loop")(number_of(older), number_of(newer), shown.view());
    });
  }
  void on_finish(const Map& map) override {
    if (!sees_end_) return;
    instance_.with_lock(
        "on_finish", [&](const py::object& object) { object.attr("on_finish")(shown_snapshot(make_snapshot(map))); });
  }

 private:
  /// Whether the class has a method of its own in place of the empty one of holdfast.Observer.
  bool defines(const char* method) const {
    const py::object own = py::type::of(instance_.object());
    if (!py::hasattr(own, method)) return false;
    const py::object base = py::module_::import("holdfast.plugins").attr("Observer");
    return !own.attr(method).is(base.attr(method));
  }

  Instance instance_;
  bool sees_frames_, sees_keyframes_, sees_loops_, sees_end_;
};

}  // namespace

std::unique_ptr<Module> make_observer(Instance instance) {
  return std::make_unique<ObserverOfPython>(std::move(instance));
}

}  // namespace holdfast::python
