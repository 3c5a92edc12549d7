// SPDX-License-Identifier: BSD-3-Clause
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <cmath>

#include "arrays.hpp"
#include "bindings.hpp"
#include "frames.hpp"
#include "holdfast/core/error.hpp"
#include "images.hpp"

namespace holdfast::python {

namespace py = pybind11;

namespace {

std::shared_ptr<const FrameTruth> truth_of(const py::object& pose, const py::object& object_mask,
                                           const py::object& class_labels, const py::object& moving_objects) {
  if (pose.is_none() && object_mask.is_none() && class_labels.is_none() && moving_objects.is_none()) return nullptr;
  auto truth = std::make_shared<FrameTruth>();
  if (!pose.is_none()) truth->T_world_camera = to_pose(pose, "true_pose");
  truth->object_mask = image_of_array(object_mask, ImageKind::label, "object_mask");
  truth->class_labels = image_of_array(class_labels, ImageKind::label, "class_labels");
  if (!moving_objects.is_none()) truth->moving_objects = moving_objects.cast<std::vector<std::uint8_t>>();
  return truth;
}

std::vector<ImuSample> imu_of_array(const py::object& rows) {
  std::vector<ImuSample> samples;
  if (rows.is_none()) return samples;
  const auto array = py::array_t<double, py::array::c_style | py::array::forcecast>::ensure(rows);
  if (!array || array.ndim() != 2 || array.shape(1) != 7)
    throw InputError({"imu"},
                     "has another shape; expected one row for each measurement: time stamp [s], angular velocity x, y, "
                     "z [rad/s], specific force x, y, z [m/s^2]");
  for (py::ssize_t i = 0; i < array.shape(0); ++i) {
    const double* row = array.data(i, 0);
    samples.push_back({row[0], {row[1], row[2], row[3]}, {row[4], row[5], row[6]}});
  }
  return samples;
}

py::array_t<double> array_of_imu(const SensorFrame& frame) {
  py::array_t<double> rows({static_cast<py::ssize_t>(frame.imu.size()), py::ssize_t{7}});
  for (std::size_t i = 0; i < frame.imu.size(); ++i) {
    double* row = rows.mutable_data(static_cast<py::ssize_t>(i), 0);
    row[0] = frame.imu[i].timestamp;
    Eigen::Map<Eigen::Vector3d>(row + 1) = frame.imu[i].angular_velocity;
    Eigen::Map<Eigen::Vector3d>(row + 4) = frame.imu[i].acceleration;
  }
  return rows;
}

template <class Value>
py::object of_truth(const SensorFrame& frame, Value value) {
  if (!frame.truth) return py::none();
  return value(*frame.truth);
}

std::string frame_text(const SensorFrame& frame) {
  const py::str text = py::str("Frame(index={}, timestamp={:.6f} s, {} x {} px, {})")
                           .format(frame.index, frame.timestamp, frame.colour.cols, frame.colour.rows,
                                   !frame.depth.empty()   ? "with depth"
                                   : !frame.right.empty() ? "with right image"
                                                          : "no depth");
  return text;
}

/// Throws InputError if the image is there and has another size than the colour image.
void check_size(const char* name, const cv::Mat& image, const cv::Mat& colour) {
  if (image.empty() || image.size() == colour.size()) return;
  const auto text = [](const cv::Mat& of) { return std::to_string(of.cols) + " x " + std::to_string(of.rows) + " px"; };
  throw InputError({name}, "has " + text(image) + "; expected the size of the colour image, " + text(colour));
}

}  // namespace

SensorFrame make_frame(double timestamp, const py::object& colour, const py::object& depth, const py::object& right) {
  SensorFrame frame;
  if (!std::isfinite(timestamp))
    throw InputError({"timestamp"}, "is not finite; expected the time of the colour image in seconds");
  frame.timestamp = timestamp;
  frame.colour = image_of_array(colour, ImageKind::colour_or_grey, "colour");
  frame.depth = image_of_array(depth, ImageKind::depth, "depth");
  frame.right = image_of_array(right, ImageKind::colour_or_grey, "right");
  if (frame.colour.empty())
    throw InputError({"colour"},
                     "is None; expected an image, a numpy array of uint8 with shape (rows, columns, 3) or "
                     "(rows, columns)");
  check_size("depth", frame.depth, frame.colour);
  check_size("right", frame.right, frame.colour);
  return frame;
}

void bind_frames(py::module_& module) {
  py::class_<SensorFrame>(module, "Frame",
                          "A colour image with its time and its depth image, or the right image of a stereo pair.")
      .def(py::init([](double timestamp, const py::object& colour, const py::object& depth, const py::object& right,
                       std::uint64_t index, double depth_delay, const py::object& true_pose,
                       const py::object& object_mask, const py::object& class_labels, const py::object& moving_objects,
                       const py::object& imu) {
             SensorFrame frame = make_frame(timestamp, colour, depth, right);
             frame.index = index;
             frame.depth_delay = depth_delay;
             frame.truth = truth_of(true_pose, object_mask, class_labels, moving_objects);
             frame.imu = imu_of_array(imu);
             return frame;
           }),
           py::arg("timestamp"), py::arg("colour"), py::arg("depth") = py::none(), py::kw_only(),
           py::arg("right") = py::none(), py::arg("index") = 0, py::arg("depth_delay") = 0.0,
           py::arg("true_pose") = py::none(), py::arg("object_mask") = py::none(), py::arg("class_labels") = py::none(),
           py::arg("moving_objects") = py::none(), py::arg("imu") = py::none())
      .def_readonly("index", &SensorFrame::index)
      .def_readonly("timestamp", &SensorFrame::timestamp)
      .def_readonly("depth_delay", &SensorFrame::depth_delay)
      .def_property_readonly("colour", [](const SensorFrame& frame) { return array_of_image(frame.colour); })
      .def_property_readonly("depth", [](const SensorFrame& frame) { return array_of_image(frame.depth); })
      .def_property_readonly("right", [](const SensorFrame& frame) { return array_of_image(frame.right); })
      .def_property_readonly("imu", &array_of_imu)
      .def_property_readonly("true_pose",
                             [](const SensorFrame& frame) {
                               return of_truth(frame, [](const FrameTruth& t) { return pose_array(t.T_world_camera); });
                             })
      .def_property_readonly("object_mask",
                             [](const SensorFrame& frame) {
                               return of_truth(
                                   frame, [](const FrameTruth& truth) { return array_of_image(truth.object_mask); });
                             })
      .def_property_readonly("class_labels",
                             [](const SensorFrame& frame) {
                               return of_truth(
                                   frame, [](const FrameTruth& truth) { return array_of_image(truth.class_labels); });
                             })
      .def_property_readonly("moving_objects",
                             [](const SensorFrame& frame) {
                               return of_truth(frame, [](const FrameTruth& truth) {
                                 py::list objects;
                                 for (const std::uint8_t object : truth.moving_objects) objects.append(object);
                                 return py::object(objects);
                               });
                             })
      .def("__repr__", &frame_text);
}

}  // namespace holdfast::python
