// SPDX-License-Identifier: BSD-3-Clause
#include "images.hpp"

#include <pybind11/numpy.h>

#include <opencv2/core.hpp>
#include <string>

#include "gil.hpp"
#include "holdfast/core/error.hpp"

namespace holdfast::python {

namespace py = pybind11;

namespace {

/// Releases the array that an image refers to, when the last image does. It makes no images of its own: a copy of the
/// header that is given a new size gets its memory from OpenCV.
class ArrayRelease final : public cv::MatAllocator {
 public:
  cv::UMatData* allocate(int dimensions, const int* sizes, int type, void* data, std::size_t* step,
                         cv::AccessFlag flags, cv::UMatUsageFlags usage) const override {
    return cv::Mat::getStdAllocator()->allocate(dimensions, sizes, type, data, step, flags, usage);
  }
  bool allocate(cv::UMatData* data, cv::AccessFlag flags, cv::UMatUsageFlags usage) const override {
    return cv::Mat::getStdAllocator()->allocate(data, flags, usage);
  }
  void deallocate(cv::UMatData* data) const override {
    if (data == nullptr) return;
    if (Py_IsInitialized() != 0) {
      const Lock lock;
      Py_DECREF(static_cast<PyObject*>(data->userdata));
    }
    delete data;
  }
};

const ArrayRelease& array_release() {
  static const ArrayRelease* const release = new ArrayRelease;  // images may outlive static objects
  return *release;
}

struct Layout {
  const char* dtype;
  const char* shape;
  char kind;
  py::ssize_t item_size;
  py::ssize_t channels;
  int type;
};

Layout layout_of(ImageKind kind) {
  switch (kind) {
    case ImageKind::colour:
      return {"uint8", "(rows, columns, 3), blue green red as cv2 reads it", 'u', 1, 3, CV_8UC3};
    case ImageKind::depth:
      return {"float32", "(rows, columns) in metres, 0 where there is none", 'f', 4, 1, CV_32FC1};
    case ImageKind::colour_or_grey:  // whichever of the two the array is, see image_of_array
    case ImageKind::label:
      break;
  }
  return {"uint8", "(rows, columns)", 'u', 1, 1, CV_8UC1};
}

std::string remedy(const py::array& array, ImageKind kind) {
  const char found = array.dtype().kind();
  if (kind == ImageKind::depth && (found == 'u' || found == 'i'))
    return "; divide integers by their units per metre, as depth.astype(numpy.float32) / 5000 for TUM's files";
  return std::string("; .astype(numpy.") + layout_of(kind).dtype + ") converts it";
}

py::array checked(const py::object& object, ImageKind kind, const std::string& name) {
  const Layout layout = layout_of(kind);
  const std::string expected =
      std::string("; expected a numpy array of ") + layout.dtype + " with shape " + layout.shape;
  if (!py::isinstance<py::array>(object))
    throw InputError(
        {name}, "found an object of type " + std::string(py::str(py::type::of(object).attr("__name__"))) + expected);
  auto array = py::reinterpret_borrow<py::array>(object);
  const py::dtype dtype = array.dtype();
  if (dtype.kind() != layout.kind || dtype.itemsize() != layout.item_size || !dtype.attr("isnative").cast<bool>())
    throw InputError({name},
                     "found an array of " + std::string(py::str(py::handle(dtype))) + expected + remedy(array, kind));
  const bool has_channels = layout.channels > 1;
  if (array.ndim() != (has_channels ? 3 : 2) || array.size() == 0 ||
      (has_channels && array.shape(2) != layout.channels))
    throw InputError({name}, "found an array of shape " + std::string(py::str(array.attr("shape"))) + expected);
  return array;
}

bool has_contiguous_rows(const py::array& array, const Layout& layout) {
  const py::ssize_t pixel = layout.item_size * layout.channels;
  if (layout.channels > 1 && array.strides(2) != layout.item_size) return false;
  return array.strides(1) == pixel && array.strides(0) >= pixel * array.shape(1) &&
         array.strides(0) % layout.item_size == 0 &&
         reinterpret_cast<std::uintptr_t>(array.data()) % static_cast<std::uintptr_t>(layout.item_size) == 0;
}

}  // namespace

cv::Mat image_of_array(const py::object& object, ImageKind kind, const char* name) {
  if (object.is_none()) return {};
  if (kind == ImageKind::colour_or_grey) {
    const bool is_grey = py::isinstance<py::array>(object) && py::reinterpret_borrow<py::array>(object).ndim() == 2;
    kind = is_grey ? ImageKind::label : ImageKind::colour;
  }
  const Layout layout = layout_of(kind);
  py::array array = checked(object, kind, name);
  if (!has_contiguous_rows(array, layout)) {
    array = py::array::ensure(array.attr("copy")("C"));
    if (!array) throw py::error_already_set();
  }
  cv::Mat image(static_cast<int>(array.shape(0)), static_cast<int>(array.shape(1)), layout.type,
                const_cast<void*>(array.data()), static_cast<std::size_t>(array.strides(0)));
  image.u = new cv::UMatData(&array_release());
  image.u->data = image.u->origdata = image.data;
  image.u->size = image.step[0] * static_cast<std::size_t>(image.rows);
  image.u->refcount = 1;
  image.u->userdata = array.release().ptr();
  return image;
}

py::object array_of_image(const cv::Mat& image) {
  if (image.empty()) return py::none();
  const bool is_float = image.depth() == CV_32F;
  HOLDFAST_CHECK(image.depth() == CV_8U || is_float, "image of type " << image.type());
  const auto item_size = static_cast<py::ssize_t>(image.elemSize1());
  const auto channels = static_cast<py::ssize_t>(image.channels());
  std::vector<py::ssize_t> shape{image.rows, image.cols};
  std::vector<py::ssize_t> strides{static_cast<py::ssize_t>(image.step[0]), item_size * channels};
  if (channels > 1) {
    shape.push_back(channels);
    strides.push_back(item_size);
  }
  const py::capsule owner(new cv::Mat(image), [](void* held) { delete static_cast<cv::Mat*>(held); });
  py::array array(is_float ? py::dtype::of<float>() : py::dtype::of<std::uint8_t>(), shape, strides, image.data, owner);
  array.attr("flags").attr("writeable") = false;
  return array;
}

}  // namespace holdfast::python
