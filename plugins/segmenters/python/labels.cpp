// SPDX-License-Identifier: BSD-3-Clause
#include "labels.hpp"

#include <pybind11/numpy.h>

#include <cstring>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "holdfast/core/cell_mask.hpp"
#include "holdfast/core/error.hpp"

namespace holdfast::python_plugin {

namespace py = pybind11;

namespace {

std::string text_of(const py::handle& object) { return py::str(object); }

std::string type_of(const py::handle& object) { return text_of(py::type::of(object).attr("__name__")); }

/// HxW uint8 of the frame's size, copied.
cv::Mat read_image(const py::object& object, const cv::Size& size, const std::string& what, const std::string& owner,
                   const std::filesystem::path& file) {
  const std::string expected = "; expected " + what + " as a numpy array of uint8 with shape (" +
                               std::to_string(size.height) + ", " + std::to_string(size.width) +
                               "), rows and columns of the image";
  const auto refuse = [&](const std::string& found, const std::string& remedy = "") {
    throw InputError({file.string()}, owner + ".segment returned " + found + expected + remedy);
  };
  if (!py::isinstance<py::array>(object)) refuse("an object of type " + type_of(object));
  const auto array = py::reinterpret_borrow<py::array>(object);
  if (array.dtype().kind() != 'u' || array.itemsize() != 1)
    refuse(what + " of dtype " + text_of(array.dtype()), "; .astype(numpy.uint8) converts it");
  if (array.ndim() != 2 || array.shape(0) != size.height || array.shape(1) != size.width)
    refuse(what + " of shape " + text_of(object.attr("shape")));
  const auto rows = py::array_t<std::uint8_t, py::array::c_style | py::array::forcecast>::ensure(array);
  if (!rows) throw py::error_already_set();
  cv::Mat image(size, CV_8UC1);
  for (int y = 0; y < size.height; ++y)
    std::memcpy(image.ptr(y), rows.data(y, 0), static_cast<std::size_t>(size.width));
  return image;
}

void check_labels(const cv::Mat& labels, std::size_t classes, const std::string& owner,
                  const std::filesystem::path& file) {
  for (int y = 0; y < labels.rows; ++y)
    for (int x = 0; x < labels.cols; ++x) {
      const std::uint8_t label = labels.at<std::uint8_t>(y, x);
      if (label < classes || label == CellMask::unknown) continue;
      throw InputError({file.string()}, owner + ".segment returned the label " + std::to_string(label) + " at row " +
                                            std::to_string(y) + ", column " + std::to_string(x) +
                                            "; expected an index into `classes`, 0 to " + std::to_string(classes - 1) +
                                            ", or 255 for unknown");
    }
}

/// Takes the values of an image but 0 as instances: one for each value and class.
void add_instances(const cv::Mat& values, Segmentation& segmentation) {
  segmentation.instances = cv::Mat::zeros(values.size(), CV_16UC1);
  std::map<std::pair<std::uint8_t, std::uint8_t>, std::size_t> number;  // by value and label
  std::vector<cv::Rect> boxes;
  for (int y = 0; y < values.rows; ++y)
    for (int x = 0; x < values.cols; ++x) {
      const std::uint8_t value = values.at<std::uint8_t>(y, x), label = segmentation.labels.at<std::uint8_t>(y, x);
      if (value == 0 || !CellMask::is_object(label)) continue;
      const auto [known, is_new] = number.emplace(std::pair(value, label), boxes.size());
      const cv::Rect pixel(x, y, 1, 1);
      if (is_new) {
        boxes.push_back(pixel);
        segmentation.found.push_back({label, 1.0F, {}});
      }
      boxes[known->second] |= pixel;
      segmentation.instances.at<std::uint16_t>(y, x) = static_cast<std::uint16_t>(known->second + 1);
    }
  for (std::size_t i = 0; i < boxes.size(); ++i) segmentation.found[i].box = boxes[i];
}

}  // namespace

Segmentation read_result(const py::object& result, const cv::Size& size, std::size_t classes, const std::string& owner,
                         const std::filesystem::path& file) {
  if (result.is_none()) return {};
  Segmentation segmentation;
  if (py::isinstance<py::tuple>(result)) {
    const auto parts = py::reinterpret_borrow<py::tuple>(result);
    if (parts.size() != 2 && parts.size() != 3)
      throw InputError({file.string()}, owner + ".segment returned a tuple of " + std::to_string(parts.size()) +
                                            "; expected labels, (labels, confidence), (labels, confidence, instances), "
                                            "or None");
    segmentation.labels = read_image(parts[0], size, "labels", owner, file);
    if (!parts[1].is_none()) segmentation.confidence = read_image(parts[1], size, "confidence", owner, file);
    if (parts.size() == 3 && !parts[2].is_none()) {
      check_labels(segmentation.labels, classes, owner, file);
      add_instances(read_image(parts[2], size, "instances", owner, file), segmentation);
    }
  } else {
    segmentation.labels = read_image(result, size, "labels", owner, file);
  }
  check_labels(segmentation.labels, classes, owner, file);
  return segmentation;
}

}  // namespace holdfast::python_plugin
