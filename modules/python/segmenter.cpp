// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/interfaces/segmenter.hpp"
#include "class_names.hpp"
#include "instance.hpp"
#include "labels.hpp"

namespace holdfast::python {

namespace py = pybind11;

namespace {

class SegmenterOfPython final : public Segmenter {
 public:
  explicit SegmenterOfPython(Instance instance) : instance_(std::move(instance)) {
    const std::string& owner = instance_.class_name();
    classes_ = python_plugin::read_classes(instance_.object(), owner, instance_.file());
    movable_ = python_plugin::read_movable(instance_.object(), owner, classes_, instance_.file());
  }

  const std::vector<std::string>& classes() const override { return classes_; }
  std::vector<std::string> movable() const override { return movable_; }
  Segmentation segment(const SensorFrame& frame) override {
    return instance_.with_lock("segment", [&](const py::object& object) {
      return python_plugin::read_result(object.attr("segment")(frame), frame.colour.size(), classes_.size(),
                                        instance_.class_name(), instance_.file());
    });
  }

 private:
  Instance instance_;
  std::vector<std::string> classes_, movable_;
};

}  // namespace

std::unique_ptr<Module> make_segmenter(Instance instance) {
  return std::make_unique<SegmenterOfPython>(std::move(instance));
}

}  // namespace holdfast::python
