// SPDX-License-Identifier: BSD-3-Clause
#include <pybind11/stl.h>

#include <limits>

#include "arrays.hpp"
#include "frames.hpp"
#include "holdfast/interfaces/frame_source.hpp"
#include "instance.hpp"

namespace holdfast::python {

namespace py = pybind11;

namespace {

/// An attribute of the object, `otherwise` where it has none or it is None.
template <class Value>
Value attribute(const Instance& instance, const char* name, Value otherwise, const char* expected) {
  if (!instance.has(name)) return otherwise;
  const py::object value = instance.object().attr(name);
  if (value.is_none()) return otherwise;
  try {
    return value.cast<Value>();
  } catch (const py::cast_error&) {
    instance.refuse(name, "is " + std::string(py::repr(value)), expected);
  }
}

SourceDescription describe(const Instance& instance) {
  SourceDescription description;
  description.name = attribute<std::string>(instance, "name", instance.class_name(), "a text");
  description.has_depth = attribute(instance, "has_depth", true, "True or False");
  description.has_right = attribute(instance, "has_right", false, "True or False");
  description.class_names = attribute<std::vector<std::string>>(instance, "class_names", {}, "a list of names");
  description.frame_count = attribute<std::optional<std::uint64_t>>(
      instance, "frame_count", std::nullopt, "a number of frames, or None for an endless source");
  description.camera = attribute<std::optional<Camera>>(instance, "camera", std::nullopt,
                                                        "a holdfast.Camera, such as holdfast.camera('tum_fr1')");
  return description;
}

/// Iterates over an object of Python. It is asked for its iterator with the first frame.
class SourceOfPython final : public FrameSource {
 public:
  explicit SourceOfPython(Instance instance)
      : instance_(std::move(instance)), description_(python::describe(instance_)), truth_(read_truth()) {
    if (!instance_.has("__iter__"))
      throw InputError({instance_.file().string()},
                       instance_.class_name() + " cannot be iterated over; expected __iter__(self) that yields frames");
  }

  SourceDescription describe() const override { return description_; }
  std::optional<SensorFrame> next() override {
    return instance_.with_lock("__iter__", [&](const py::object& object) -> std::optional<SensorFrame> {
      if (!iterator_) iterator_ = SharedObject(py::iter(object));
      const auto item = py::reinterpret_steal<py::object>(PyIter_Next(iterator_.get().ptr()));
      if (PyErr_Occurred() != nullptr) throw py::error_already_set();
      if (!item) return std::nullopt;
      SensorFrame frame = frame_of(item);
      if (frame.timestamp <= last_)
        instance_.refuse("__iter__",
                         "yielded the time stamp " + std::string(py::str(py::float_(frame.timestamp))) + " after " +
                             std::string(py::str(py::float_(last_))),
                         "time stamps in seconds that rise strictly");
      last_ = frame.timestamp;
      frame.index = index_++;
      return frame;
    });
  }
  Trajectory truth() const override { return truth_; }

 private:
  SensorFrame frame_of(const py::object& item) const {
    if (py::isinstance<SensorFrame>(item)) return item.cast<SensorFrame>();
    if (py::isinstance<py::tuple>(item)) {
      const auto parts = py::reinterpret_borrow<py::tuple>(item);
      const auto part = [&](std::size_t index) { return parts.size() > index ? py::object(parts[index]) : py::none(); };
      if (parts.size() >= 2 && parts.size() <= 4) return make_frame(parts[0].cast<double>(), part(1), part(2), part(3));
    }
    instance_.refuse("__iter__", "yielded an object of type " + type_name(item),
                     "holdfast.Frame, or (timestamp, colour, depth) or (timestamp, colour, depth, right)");
  }
  Trajectory read_truth() const {
    if (!instance_.has("truth")) return {};
    const py::object truth = instance_.object().attr("truth")();
    if (truth.is_none()) return {};
    return to_trajectory(truth.attr("timestamps"), truth.attr("poses"));
  }

  Instance instance_;
  SourceDescription description_;
  Trajectory truth_;
  SharedObject iterator_;
  double last_ = -std::numeric_limits<double>::infinity();
  std::uint64_t index_ = 0;
};

}  // namespace

std::unique_ptr<Module> make_source(Instance instance) { return std::make_unique<SourceOfPython>(std::move(instance)); }

}  // namespace holdfast::python
