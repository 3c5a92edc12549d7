// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pybind11/pybind11.h>

#include "holdfast/core/sensor_frame.hpp"

namespace holdfast::python {

/// A frame of arrays, which it refers to (images.hpp). Throws InputError for images that are not what Frame promises.
SensorFrame make_frame(double timestamp, const pybind11::object& colour, const pybind11::object& depth,
                       const pybind11::object& right);

}  // namespace holdfast::python
