// SPDX-License-Identifier: BSD-3-Clause
#include <pybind11/stl.h>

#include "arrays.hpp"
#include "bindings.hpp"
#include "holdfast/core/frame_result.hpp"
#include "holdfast/core/health_reason_names.hpp"
#include "ids.hpp"

namespace holdfast::python {

namespace py = pybind11;

namespace {

py::dict stage_times(const FrameResult& result) {
  py::dict times;
  for (const StageTimes::Entry& entry : result.times.entries())
    times[py::str(entry.stage.data(), entry.stage.size())] = entry.seconds;
  return times;
}

/// `trouble`, the earlier name of `failure`.
std::string trouble_of(const FrameResult& result) {
  if (PyErr_WarnEx(PyExc_DeprecationWarning, "FrameResult.trouble is now FrameResult.failure", 1) != 0)
    throw py::error_already_set();
  return to_string(result.failure);
}

std::string result_text(const FrameResult& result) {
  std::string text = "FrameResult(index=" + std::to_string(result.index) + ", " + to_string(result.status);
  if (result.failure != TrackingFailure::none) text += std::string(", ") + to_string(result.failure);
  return text + ", " + std::to_string(result.inliers) + " inliers" + (result.is_keyframe ? ", keyframe)" : ")");
}

py::object covariance_array(const std::optional<Eigen::Matrix<double, 6, 6>>& covariance) {
  if (!covariance) return py::none();
  py::array_t<double> array({6, 6});
  for (int i = 0; i < 36; ++i) array.mutable_at(i / 6, i % 6) = (*covariance)(i / 6, i % 6);
  return array;
}

void bind_health(py::module_& module) {
  py::class_<PipelineHealth>(module, "Health", "Health of the last frame of a pipeline, and whether frames arrive.")
      .def_property_readonly("state", [](const PipelineHealth& h) { return to_string(h.health.state); })
      .def_property_readonly("reasons", [](const PipelineHealth& h) { return names_of(h.health.reasons); })
      .def_property_readonly("jump", [](const PipelineHealth& h) { return h.health.jump; })
      .def_readonly("frame", &PipelineHealth::frame)
      .def_readonly("timestamp", &PipelineHealth::timestamp)
      .def_property_readonly("T_world_camera", [](const PipelineHealth& h) { return pose_array(h.T_world_camera); })
      .def_property_readonly("covariance", [](const PipelineHealth& h) { return covariance_array(h.covariance); })
      .def_readonly("since_frame", &PipelineHealth::since_frame)
      .def_readonly("frame_period", &PipelineHealth::frame_period);
}

void bind_objects(py::module_& module) {
  py::class_<MovingObject>(module, "MovingObject", "A rigid object that moves or has moved; metres, world frame.")
      .def_readonly("id", &MovingObject::id)
      .def_readonly("instance", &MovingObject::instance)
      .def_readonly("class_name", &MovingObject::class_name)
      .def_property_readonly("T_world_object", [](const MovingObject& o) { return pose_array(o.T_world_object); })
      .def_property_readonly("velocity", [](const MovingObject& o) { return vector_array(o.velocity); })
      .def_property_readonly("angular_velocity", [](const MovingObject& o) { return vector_array(o.angular_velocity); })
      .def_property_readonly("box",
                             [](const MovingObject& o) {
                               return py::make_tuple(vector_array(o.box.min().cast<double>()),
                                                     vector_array(o.box.max().cast<double>()));
                             })
      .def_readonly("speed_deviation", &MovingObject::speed_deviation)
      .def_readonly("moving", &MovingObject::moving)
      .def_readonly("first_seen", &MovingObject::first_seen)
      .def_readonly("last_seen", &MovingObject::last_seen)
      .def_property_readonly("speed", &MovingObject::speed);
}

}  // namespace

void bind_results(py::module_& module) {
  bind_objects(module);
  bind_health(module);
  py::class_<FrameResult>(module, "FrameResult", "What tracking found in one frame.")
      .def_readonly("index", &FrameResult::index)
      .def_readonly("timestamp", &FrameResult::timestamp)
      .def_property_readonly("status", [](const FrameResult& r) { return to_string(r.status); })
      .def_property_readonly("method", [](const FrameResult& r) { return to_string(r.method); })
      .def_property_readonly("fallback", [](const FrameResult& r) { return to_string(r.fallback); })
      .def_property_readonly("failure", [](const FrameResult& r) { return to_string(r.failure); })
      .def_property_readonly("trouble", &trouble_of)
      .def_property_readonly("T_world_camera", [](const FrameResult& r) { return pose_array(r.T_world_camera); })
      .def_property_readonly("covariance", [](const FrameResult& r) { return covariance_array(r.covariance); })
      .def_property_readonly("health", [](const FrameResult& r) { return to_string(r.health.state); })
      .def_property_readonly("health_reasons", [](const FrameResult& r) { return names_of(r.health.reasons); })
      .def_property_readonly("jump", [](const FrameResult& r) { return r.health.jump; })
      .def_readonly("features", &FrameResult::features)
      .def_readonly("static_features", &FrameResult::static_features)
      .def_readonly("matches", &FrameResult::matches)
      .def_readonly("inliers", &FrameResult::inliers)
      .def_readonly("is_keyframe", &FrameResult::is_keyframe)
      .def_property_readonly("keyframe", [](const FrameResult& r) { return number_of(r.keyframe); })
      .def_readonly("objects", &FrameResult::objects)
      .def_readonly("tracking_seconds", &FrameResult::tracking_seconds)
      .def_property_readonly("stage_seconds", &stage_times)
      .def("__repr__", &result_text);
}

}  // namespace holdfast::python
