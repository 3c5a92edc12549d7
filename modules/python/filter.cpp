// SPDX-License-Identifier: BSD-3-Clause
#include "filter_context.hpp"
#include "holdfast/interfaces/dynamic_filter.hpp"
#include "instance.hpp"

namespace holdfast::python {

namespace py = pybind11;

namespace {

constexpr const char* needs_expected =
    "a list of 'depth', 'segmentation', 'pose_prior', 'matches' and 'evidence', empty for a filter that needs none of "
    "them";

Needs read_needs(const Instance& instance) {
  if (!instance.has("needs")) return {};
  const py::object given = instance.object().attr("needs");
  if (py::isinstance<py::str>(given) || !py::hasattr(given, "__iter__"))
    instance.refuse("needs", "is " + std::string(py::repr(given)), needs_expected);
  Needs needs;
  for (const py::handle& name : given) {
    const std::string text = py::str(name);
    if (text == "depth")
      needs.depth = true;
    else if (text == "segmentation")
      needs.segmentation = true;
    else if (text == "pose_prior")
      needs.pose_prior = true;
    else if (text == "matches")
      needs.matches = true;
    else if (text == "evidence")
      needs.evidence = true;
    else
      instance.refuse("needs", "names '" + text + "'", needs_expected);
  }
  return needs;
}

class FilterOfPython final : public DynamicFilter {
 public:
  explicit FilterOfPython(Instance instance) : instance_(std::move(instance)), needs_(read_needs(instance_)) {}

  Needs needs() const override { return needs_; }
  void apply(const FilterContext& context, StaticEvidence& evidence) override {
    const auto apply = [&](const py::object& object) {
      const Shown<const FilterContext> shown_context(context, "FilterContext");
      const Shown<StaticEvidence> shown_evidence(evidence, "StaticEvidence");
      const Shown<const Frame> features(context.frame, "FilterContext.features");
      const py::object view = py::cast(shown_context.view());
      view.attr("features") = features.view();
      std::optional<Shown<const Frame>> previous;
      if (context.previous != nullptr) previous.emplace(*context.previous, "FilterContext.previous");
      view.attr("previous") = previous ? py::cast(previous->view()) : py::object(py::none());
      const py::object result = object.attr("apply")(view, shown_evidence.view());
      if (!result.is_none())
        instance_.refuse("apply", "returned an object of type " + type_name(result),
                         "None; evidence is added by evidence.add(log_odds)");
    };
    instance_.with_lock("apply", apply, MapLock::held);
  }

 private:
  Instance instance_;
  Needs needs_;
};

}  // namespace

std::unique_ptr<Module> make_filter(Instance instance) { return std::make_unique<FilterOfPython>(std::move(instance)); }

}  // namespace holdfast::python
