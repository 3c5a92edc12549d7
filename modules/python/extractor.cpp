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

/// What an attribute of the class says, or `otherwise` where it is missing or None.
template <class Value>
Value attribute(const Instance& instance, const char* name, Value otherwise) {
  if (!instance.has(name)) return otherwise;
  const py::object value = instance.object().attr(name);
  return value.is_none() ? otherwise : value.template cast<Value>();
}

DescriptorType read_descriptor_type(const Instance& instance) {
  DescriptorType type;
  const auto name = attribute<std::string>(instance, "descriptors", "binary");
  const auto metric = attribute<std::string>(instance, "metric", name == "binary" ? "hamming" : "euclidean");
  const auto choose = [&](const char* of, const std::string& found, auto& value, auto... choices) {
    bool known = false;
    for (const auto choice : {choices...})
      if (found == to_string(choice)) value = choice, known = true;
    std::string expected;
    for (const auto choice : {choices...}) expected += (expected.empty() ? "" : ", ") + std::string(to_string(choice));
    if (!known) instance.refuse(of, "is '" + found + "'", "one of " + expected);
  };
  using Kind = DescriptorKind;
  using Metric = DescriptorMetric;
  choose("descriptors", name, type.kind, Kind::binary, Kind::float32, Kind::int8);
  choose("metric", metric, type.metric, Metric::hamming, Metric::euclidean, Metric::cosine);
  type.length = static_cast<std::uint32_t>(attribute<int>(instance, "length", 256));
  type.strict_distance = attribute<float>(instance, "strict_distance", type.strict_distance);
  type.loose_distance = attribute<float>(instance, "loose_distance", type.loose_distance);
  if (type.kind == Kind::binary && type.length % 8 != 0)
    instance.refuse("length", "is " + std::to_string(type.length), "a multiple of 8 bits");
  if (const std::string trouble = trouble_of(type); !trouble.empty())
    instance.refuse("descriptors", "are impossible: " + trouble, "what holdfast.FeatureExtractor describes");
  return type;
}

/// The arrays that fit a type: dtype, numbers per feature.
std::string expected_arrays(const DescriptorType& type) {
  const bool is_binary = type.kind == DescriptorKind::binary;
  return "a numpy array of " + std::string(is_binary ? "uint8" : to_string(type.kind)) + " with shape (n, " +
         std::to_string(is_binary ? type.bytes() : type.length) + "), " + to_string(type) + " per feature";
}

ScalePyramid read_pyramid(const Instance& instance) {
  const int levels = instance.has("levels") ? instance.object().attr("levels").cast<int>() : 1;
  const double factor = instance.has("factor") ? instance.object().attr("factor").cast<double>() : 1.2;
  if (levels < 1 || levels > 255) instance.refuse("levels", "is " + std::to_string(levels), "1 to 255 pyramid levels");
  if (!(factor > 1.0)) instance.refuse("factor", "is " + std::to_string(factor), "a number above 1 between two levels");
  return ScalePyramid(levels, factor);
}

class ExtractorOfPython final : public FeatureExtractor {
 public:
  explicit ExtractorOfPython(Instance instance)
      : instance_(std::move(instance)), pyramid_(read_pyramid(instance_)), type_(read_descriptor_type(instance_)) {}

  DescriptorType descriptor_type() const override { return type_; }

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
    const std::string expected = expected_arrays(type_);
    if (!py::isinstance<py::array>(object))
      instance_.refuse("extract", "returned descriptors of type " + type_name(object), expected);
    const auto array = py::reinterpret_borrow<py::array>(object);
    const char kind = type_.kind == DescriptorKind::binary ? 'u' : type_.kind == DescriptorKind::int8 ? 'i' : 'f';
    const std::size_t bytes_each = type_.bytes();
    const std::size_t item = type_.kind == DescriptorKind::float32 ? sizeof(float) : 1;
    if (array.dtype().kind() != kind || static_cast<std::size_t>(array.itemsize()) != item || array.ndim() != 2 ||
        static_cast<std::size_t>(array.shape(0)) != count ||
        static_cast<std::size_t>(array.shape(1)) * item != bytes_each)
      instance_.refuse("extract",
                       "returned descriptors of " + std::string(py::str(py::handle(array.dtype()))) + " with shape " +
                           std::string(py::str(array.attr("shape"))) + " for " + std::to_string(count) + " features",
                       expected);
    const auto rows = py::array::ensure(array, py::array::c_style);
    if (!rows) throw py::error_already_set();
    found.descriptors.reset(type_, count);
    const auto* from = static_cast<const std::byte*>(rows.data());
    for (std::size_t i = 0; i < count; ++i)
      std::memcpy(found.descriptors.bytes(i).data(), from + i * bytes_each, bytes_each);
    if (type_.kind != DescriptorKind::float32) return;
    for (std::size_t i = 0; i < count; ++i)
      for (const float number : found.descriptors.numbers(i))
        if (!std::isfinite(number))
          instance_.refuse("extract",
                           "returned a descriptor with a number that is not finite for feature " + std::to_string(i),
                           "finite numbers");
  }

  Instance instance_;
  ScalePyramid pyramid_;
  DescriptorType type_;
};

}  // namespace

std::unique_ptr<Module> make_extractor(Instance instance) {
  return std::make_unique<ExtractorOfPython>(std::move(instance));
}

}  // namespace holdfast::python
