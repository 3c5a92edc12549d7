// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <Eigen/Geometry>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "holdfast/core/trajectory.hpp"

/// Numbers as NumPy arrays, copied. The lock must be held.
namespace holdfast::python {

/// A pose as float64 (4, 4).
pybind11::array_t<double> pose_array(const Eigen::Isometry3d& pose);
/// The same, None for no pose.
pybind11::object pose_array(const std::optional<Eigen::Isometry3d>& pose);
pybind11::array_t<double> vector_array(const Eigen::Vector3d& vector);

/// Throws InputError, which begins with `what`, for anything but a rigid motion as (4, 4).
Eigen::Isometry3d to_pose(const pybind11::object& object, const std::string& what);

/// (stamps, poses): float64 (N,) [s] and float64 (N, 4, 4), T_world_camera.
pybind11::tuple trajectory_arrays(const Trajectory& trajectory);
/// Throws InputError for arrays of other shapes, and for poses that are no rigid motions.
Trajectory to_trajectory(const pybind11::object& stamps, const pybind11::object& poses);

/// A one-dimensional copy.
template <class Number>
pybind11::array_t<Number> number_array(const std::vector<Number>& numbers) {
  return pybind11::array_t<Number>(static_cast<pybind11::ssize_t>(numbers.size()), numbers.data());
}

/// `count` finite numbers of an array of numbers. Throws InputError, which begins with `what`, for another shape, for
/// what are no numbers, and for numbers that are not finite.
std::vector<float> to_numbers(const pybind11::object& object, std::size_t count, const std::string& what);

}  // namespace holdfast::python
