// SPDX-License-Identifier: BSD-3-Clause
#include <pybind11/stl.h>

#include "bindings.hpp"
#include "holdfast/core/camera.hpp"
#include "holdfast/core/error.hpp"
#include "holdfast/plugin/did_you_mean.hpp"

namespace holdfast::python {

namespace py = pybind11;

namespace {

Camera known_camera(const std::string& name) {
  if (const std::optional<Camera> camera = find_camera(name)) return *camera;
  throw InputError({"camera"}, "there is no known camera '" + name + "'; " + did_you_mean(name, camera_names()));
}

std::string camera_text(const Camera& camera) {
  const py::str text =
      py::str("Camera(name={!r}, width={}, height={}, fx={:g}, fy={:g}, cx={:g}, cy={:g})")
          .format(camera.name, camera.width, camera.height, camera.fx, camera.fy, camera.cx, camera.cy);
  return text;
}

}  // namespace

void bind_cameras(py::module_& module) {
  py::class_<Camera>(module, "Camera",
                     "A pinhole camera with lens distortion [px]; baseline [m], frame_rate [1/s], readout [s] of a "
                     "rolling shutter. The coefficients are "
                     "OpenCV's: k1, k2, p1, p2, k3 and, of the rational model, k4, k5, k6 of the lens "
                     "'radial_tangential'; k1, k2, k3, k4 of the lens 'fisheye'.")
      .def(py::init([](int width, int height, double fx, double fy, double cx, double cy, double k1, double k2,
                       double p1, double p2, double k3, double baseline, double frame_rate, const std::string& name,
                       double k4, double k5, double k6, const std::string& lens, double readout) {
             const std::optional<Lens> known = find_lens(lens);
             if (!known)
               throw InputError({"camera"}, "there is no lens '" + lens + "'; " + did_you_mean(lens, lens_names()));
             const Distortion distortion{k1, k2, p1, p2, k3, k4, k5, k6, *known};
             const Camera camera{name, width, height, fx, fy, cx, cy, distortion, baseline, frame_rate, readout};
             if (const std::string trouble = camera.trouble(); !trouble.empty()) throw InputError({"camera"}, trouble);
             return camera;
           }),
           py::kw_only(), py::arg("width"), py::arg("height"), py::arg("fx"), py::arg("fy"), py::arg("cx"),
           py::arg("cy"), py::arg("k1") = 0.0, py::arg("k2") = 0.0, py::arg("p1") = 0.0, py::arg("p2") = 0.0,
           py::arg("k3") = 0.0, py::arg("baseline") = 0.08, py::arg("frame_rate") = 30.0, py::arg("name") = "",
           py::arg("k4") = 0.0, py::arg("k5") = 0.0, py::arg("k6") = 0.0, py::arg("lens") = "radial_tangential",
           py::arg("readout") = 0.0)
      .def_readonly("name", &Camera::name)
      .def_readonly("width", &Camera::width)
      .def_readonly("height", &Camera::height)
      .def_readonly("fx", &Camera::fx)
      .def_readonly("fy", &Camera::fy)
      .def_readonly("cx", &Camera::cx)
      .def_readonly("cy", &Camera::cy)
      .def_property_readonly("distortion",
                             [](const Camera& camera) { return py::tuple(py::cast(camera.distortion.coefficients())); })
      .def_property_readonly("lens", [](const Camera& camera) { return lens_name(camera.distortion.lens); })
      .def_readonly("baseline", &Camera::baseline)
      .def_readonly("frame_rate", &Camera::frame_rate)
      .def_readonly("readout", &Camera::readout)
      .def("__eq__", [](const Camera& a, const Camera& b) { return a == b; })
      .def("__repr__", &camera_text);
  module.def("camera", &known_camera, py::arg("name"),
             "The calibration of a known camera. Raises InputError with the nearest name for another.");
  module.def("camera_names", &camera_names, "The names that camera() knows, sorted.");
}

}  // namespace holdfast::python
