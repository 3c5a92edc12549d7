// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pybind11/pybind11.h>

#include <opencv2/core/mat.hpp>

/// Images between NumPy and OpenCV, which share their memory. The lock must be held.
namespace holdfast::python {

/// Kinds of images, each with its dtype and shape.
enum class ImageKind {
  colour,          ///< uint8 (rows, columns, 3), blue green red
  depth,           ///< float32 (rows, columns) [m], 0 = no value
  label,           ///< uint8 (rows, columns)
  colour_or_grey,  ///< uint8 (rows, columns, 3), blue green red, or (rows, columns)
};

/// The image of an array, empty for None. It refers to the memory of the array and keeps the array alive, in any
/// thread. Only an array whose rows are not contiguous, such as image[:, :, ::-1], is copied. Throws InputError that
/// states dtype and shape found and expected; `name` is that of the argument.
cv::Mat image_of_array(const pybind11::object& array, ImageKind kind, const char* name);

/// A read-only array that refers to the memory of the image and keeps it alive; None for an empty image. The image must
/// be 8UC1, 8UC3 or 32FC1.
pybind11::object array_of_image(const cv::Mat& image);

}  // namespace holdfast::python
