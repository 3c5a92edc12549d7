// SPDX-License-Identifier: BSD-3-Clause
#include <pybind11/numpy.h>

#include <cmath>
#include <cstring>
#include <numbers>

#include "arrays.hpp"
#include "holdfast/interfaces/feature_extractor.hpp"
#include "images.hpp"
#include "instance.hpp"

namespace holdfast::python {

namespace py = pybind11;

namespace {

constexpr const char* descriptors_expected = "a numpy array of uint8 with shape (n, 32), 256 bits per feature";

ScalePyramid read_pyramid(const Instance& instance) {
  const int levels = instance.has("levels") ? instance.object().attr("levels").cast<int>() : 1;
  const double factor = instance.has("factor") ? instance.object().attr("factor").cast<double>() : 1.2;
  if (levels < 1 || levels > 255) instance.refuse("levels", "is " + std::to_string(levels), "1 to 255 pyramid levels");
  if (!(factor > 1.0)) instance.refuse("factor", "is " + std::to_string(factor), "a number above 1 between two levels");
  return ScalePyramid(levels, factor);
}

class ExtractorOfPython final : public FeatureExtractor {
 public:
  explicit ExtractorOfPython(Instance instance) : instance_(std::move(instance)), pyramid_(read_pyramid(instance_)) {}

  const ScalePyramid& pyramid() const override { return pyramid_; }
  void extract(const cv::Mat& grey, const cv::Mat& ignore, Features& out) override {
    out.clear();
    if (grey.empty()) return;
    instance_.with_lock("extract", [&](const py::object& object) {
      const py::object features = object.attr("extract")(array_of_image(grey), array_of_image(ignore));
      if (!features.is_none()) read(features, grey.size(), out);
    });
  }

 private:
  void read(const py::object& features, const cv::Size& size, Features& out) const {
    if (!py::isinstance(features, py::module_::import("holdfast.plugins").attr("Features")))
      instance_.refuse("extract", "returned an object of type " + type_name(features), "holdfast.Features, or None");
    const auto count = static_cast<std::size_t>(py::len(features.attr("x")));
    const auto numbers = [&](const char* name) {
      return to_numbers(features.attr(name), count, instance_.class_name() + ".extract: " + name);
    };
    Features found;
    found.x = numbers("x"), found.y = numbers("y");
    found.angle = numbers("angle"), found.response = numbers("response");
    const std::vector<float> octaves = numbers("octave");
    for (std::size_t i = 0; i < count; ++i) {
      const std::string feature = "returned feature " + std::to_string(i) + " with ";
      if (found.x[i] < 0.0F || found.y[i] < 0.0F || found.x[i] > static_cast<float>(size.width - 1) ||
          found.y[i] > static_cast<float>(size.height - 1))
        instance_.refuse("extract", feature + "x, y outside the image", "pixels of the full image");
      if (octaves[i] < 0.0F || octaves[i] >= static_cast<float>(pyramid_.levels()) ||
          octaves[i] != std::floor(octaves[i]))
        instance_.refuse("extract", feature + "octave " + std::to_string(octaves[i]),
                         "a level from 0 to " + std::to_string(pyramid_.levels() - 1) + ", below `levels`");
      if (found.angle[i] < 0.0F || found.angle[i] >= 2.0F * std::numbers::pi_v<float>)
        instance_.refuse("extract", feature + "angle " + std::to_string(found.angle[i]),
                         "radians from 0 to below 2 pi");
      found.octave.push_back(static_cast<std::uint8_t>(octaves[i]));
    }
    read_descriptors(features.attr("descriptors"), count, found);
    out = std::move(found);
  }
  void read_descriptors(const py::object& object, std::size_t count, Features& found) const {
    if (!py::isinstance<py::array>(object))
      instance_.refuse("extract", "returned descriptors of type " + type_name(object), descriptors_expected);
    const auto array = py::reinterpret_borrow<py::array>(object);
    if (array.dtype().kind() != 'u' || array.itemsize() != 1 || array.ndim() != 2 ||
        static_cast<std::size_t>(array.shape(0)) != count || array.shape(1) != 32)
      instance_.refuse("extract",
                       "returned descriptors of " + std::string(py::str(py::handle(array.dtype()))) + " with shape " +
                           std::string(py::str(array.attr("shape"))) + " for " + std::to_string(count) + " features",
                       descriptors_expected);
    const auto bytes = py::array_t<std::uint8_t, py::array::c_style | py::array::forcecast>::ensure(array);
    if (!bytes) throw py::error_already_set();
    found.descriptors.resize(count);
    if (count > 0) std::memcpy(found.descriptors.data(), bytes.data(), count * sizeof(Descriptor));
  }

  Instance instance_;
  ScalePyramid pyramid_;
};

}  // namespace

std::unique_ptr<Module> make_extractor(Instance instance) {
  return std::make_unique<ExtractorOfPython>(std::move(instance));
}

}  // namespace holdfast::python
