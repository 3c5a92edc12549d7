// SPDX-License-Identifier: BSD-3-Clause
#include "arrays.hpp"

#include <cmath>

#include "holdfast/core/error.hpp"

namespace holdfast::python {

namespace py = pybind11;

namespace {

using Numbers = py::array_t<double, py::array::c_style | py::array::forcecast>;

std::string shape_of(const py::array& array) { return py::str(array.attr("shape")); }

/// As float64 of any shape; refuses what NumPy cannot read as real numbers.
Numbers numbers_of(const py::object& object, const std::string& what) {
  const auto array = py::array::ensure(object);
  if (!array) PyErr_Clear();
  const char kind = array ? array.dtype().kind() : 'O';
  if (kind != 'f' && kind != 'i' && kind != 'u' && kind != 'b')
    throw InputError({what}, "found " + std::string(py::str(py::type::of(object).attr("__name__"))) +
                                 "; expected an array of numbers");
  return Numbers::ensure(array);
}

Eigen::Isometry3d checked_pose(const double* row_major, const std::string& what) {
  const Eigen::Matrix4d matrix = Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(row_major);
  const Eigen::Matrix3d rotation = matrix.topLeftCorner<3, 3>();
  const bool is_rigid = matrix.allFinite() && matrix.row(3) == Eigen::RowVector4d(0, 0, 0, 1) &&
                        (rotation * rotation.transpose() - Eigen::Matrix3d::Identity()).norm() < 1e-4 &&
                        rotation.determinant() > 0.0;
  if (!is_rigid)
    throw InputError({what},
                     "is no rigid motion; expected a rotation matrix and a finite translation [m] above the row "
                     "0 0 0 1");
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.matrix() = matrix;
  return pose;
}

}  // namespace

py::array_t<double> pose_array(const Eigen::Isometry3d& pose) {
  py::array_t<double> array({4, 4});
  Eigen::Map<Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(array.mutable_data()) = pose.matrix();
  return array;
}

py::object pose_array(const std::optional<Eigen::Isometry3d>& pose) {
  if (!pose) return py::none();
  return pose_array(*pose);
}

py::array_t<double> vector_array(const Eigen::Vector3d& vector) { return py::array_t<double>(3, vector.data()); }

Eigen::Isometry3d to_pose(const py::object& object, const std::string& what) {
  const Numbers array = numbers_of(object, what);
  if (array.ndim() != 2 || array.shape(0) != 4 || array.shape(1) != 4)
    throw InputError({what}, "found an array of shape " + shape_of(array) + "; expected a pose of shape (4, 4)");
  return checked_pose(array.data(), what);
}

py::tuple trajectory_arrays(const Trajectory& trajectory) {
  const auto count = static_cast<py::ssize_t>(trajectory.size());
  py::array_t<double> stamps(count);
  py::array_t<double> poses({count, py::ssize_t{4}, py::ssize_t{4}});
  for (py::ssize_t i = 0; i < count; ++i) {
    const TimedPose& pose = trajectory[static_cast<std::size_t>(i)];
    stamps.mutable_at(i) = pose.timestamp;
    Eigen::Map<Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(poses.mutable_data(i, 0, 0)) =
        pose.T_world_camera.matrix();
  }
  return py::make_tuple(stamps, poses);
}

Trajectory to_trajectory(const py::object& stamps, const py::object& poses) {
  const Numbers times = numbers_of(stamps, "timestamps");
  const Numbers matrices = numbers_of(poses, "poses");
  if (times.ndim() != 1 || matrices.ndim() != 3 || matrices.shape(0) != times.shape(0) || matrices.shape(1) != 4 ||
      matrices.shape(2) != 4)
    throw InputError({"trajectory"}, "found timestamps of shape " + shape_of(times) + " and poses of shape " +
                                         shape_of(matrices) + "; expected (N,) [s] and (N, 4, 4)");
  Trajectory trajectory;
  for (py::ssize_t i = 0; i < times.shape(0); ++i) {
    if (!std::isfinite(times.at(i)))
      throw InputError({"timestamps"}, "number " + std::to_string(i) + " is not finite; expected seconds");
    trajectory.push_back({times.at(i), checked_pose(matrices.data(i, 0, 0), "pose " + std::to_string(i))});
  }
  return trajectory;
}

std::vector<float> to_numbers(const py::object& object, std::size_t count, const std::string& what) {
  const Numbers array = numbers_of(object, what);
  if (array.ndim() != 1 || static_cast<std::size_t>(array.shape(0)) != count)
    throw InputError({what},
                     "found an array of shape " + shape_of(array) + "; expected (" + std::to_string(count) + ",)");
  std::vector<float> numbers(count);
  for (std::size_t i = 0; i < count; ++i) {
    numbers[i] = static_cast<float>(array.data()[i]);
    if (!std::isfinite(numbers[i]))
      throw InputError({what}, "number " + std::to_string(i) + " is " + std::string(py::str(py::float_(numbers[i]))) +
                                   "; expected finite numbers");
  }
  return numbers;
}

}  // namespace holdfast::python
