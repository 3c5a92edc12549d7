// SPDX-License-Identifier: BSD-3-Clause
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <cstring>
#include <limits>

#include "arrays.hpp"
#include "bindings.hpp"
#include "filter_context.hpp"
#include "ids.hpp"
#include "images.hpp"

namespace holdfast::python {

namespace py = pybind11;

namespace {

py::array_t<std::uint64_t> point_ids(const FeaturesView& view) {
  const std::vector<MapPointId>& ids = view.get().map_points;
  py::array_t<std::uint64_t> array(static_cast<py::ssize_t>(ids.size()));
  for (std::size_t i = 0; i < ids.size(); ++i) array.mutable_data()[i] = number_of(ids[i]);
  return array;
}

template <class Number>
py::array descriptor_rows(const DescriptorView& all) {
  const std::size_t columns = all.type().bytes() / sizeof(Number);
  py::array_t<Number> array({static_cast<py::ssize_t>(all.size()), static_cast<py::ssize_t>(columns)});
  for (std::size_t i = 0; i < all.size(); ++i)
    std::memcpy(array.mutable_data(static_cast<py::ssize_t>(i)), all.row(i), all.type().bytes());
  return array;
}

/// Bytes of binary descriptors, numbers of the others.
py::array descriptors(const FeaturesView& view) {
  const DescriptorView all = view.get().features.descriptors;
  switch (all.type().kind) {
    case DescriptorKind::float32:
      return descriptor_rows<float>(all);
    case DescriptorKind::int8:
      return descriptor_rows<std::int8_t>(all);
    case DescriptorKind::binary:
      break;
  }
  return descriptor_rows<std::uint8_t>(all);
}

/// An array of the coarse view's cells as (rows, columns); None where there are none.
template <class Number>
py::object cell_array(const CoarseGrid& grid, const std::vector<Number>& cells) {
  if (cells.empty()) return py::none();
  return py::array_t<Number>({static_cast<py::ssize_t>(grid.rows), static_cast<py::ssize_t>(grid.columns)},
                             cells.data());
}

/// The label of the mask at each feature; None without a mask.
py::object labels_at_features(const FeaturesView& view) {
  const Frame& frame = view.get();
  const CellMask& mask = frame.coarse.mask;
  if (mask.empty()) return py::none();
  py::array_t<std::uint8_t> labels(static_cast<py::ssize_t>(frame.size()));
  for (std::size_t i = 0; i < frame.size(); ++i) {
    const int cell = frame.coarse.grid.cell_of(frame.x[i], frame.y[i]);
    labels.mutable_data()[i] = cell < 0 ? CellMask::unknown : mask.labels[static_cast<std::size_t>(cell)];
  }
  return py::object(std::move(labels));
}

void bind_features_view(py::module_& module) {
  const auto numbers = [](std::vector<float> Frame::*member) {
    return [member](const FeaturesView& view) { return number_array(view.get().*member); };
  };
  py::class_<FeaturesView, std::shared_ptr<FeaturesView>>(module, "FrameFeatures",
                                                          "The features of a frame; arrays of one entry per feature.")
      .def("__len__", [](const FeaturesView& view) { return view.get().size(); })
      .def_property_readonly("timestamp", [](const FeaturesView& view) { return view.get().timestamp; })
      .def_property_readonly("x", numbers(&Frame::x))
      .def_property_readonly("y", numbers(&Frame::y))
      .def_property_readonly("depth", numbers(&Frame::depth))
      .def_property_readonly("right_x", numbers(&Frame::right_x))
      .def_property_readonly("static_probability", numbers(&Frame::static_probability))
      .def_property_readonly("measured_log_odds", numbers(&Frame::measured_log_odds))
      .def_property_readonly("raw_x", [](const FeaturesView& view) { return number_array(view.get().features.x); })
      .def_property_readonly("raw_y", [](const FeaturesView& view) { return number_array(view.get().features.y); })
      .def_property_readonly("angle", [](const FeaturesView& view) { return number_array(view.get().features.angle); })
      .def_property_readonly("octave",
                             [](const FeaturesView& view) { return number_array(view.get().features.octave); })
      .def_property_readonly("descriptors", &descriptors)
      .def_property_readonly("point_ids", &point_ids)
      .def_property_readonly("labels", &labels_at_features)
      .def_property_readonly("T_world_camera",
                             [](const FeaturesView& view) { return pose_array(view.get().T_world_camera()); })
      .def_property_readonly(
          "cell_depth",
          [](const FeaturesView& view) { return cell_array(view.get().coarse.grid, view.get().coarse.depth); })
      .def_property_readonly(
          "cell_labels",
          [](const FeaturesView& view) { return cell_array(view.get().coarse.grid, view.get().coarse.mask.labels); })
      .def_property_readonly(
          "cell_instances",
          [](const FeaturesView& view) { return cell_array(view.get().coarse.grid, view.get().coarse.mask.instances); })
      .def_property_readonly("cell_confidence", [](const FeaturesView& view) {
        return cell_array(view.get().coarse.grid, view.get().coarse.mask.confidence);
      });
}

/// Positions of the matched map points (n, 3), NaN for features without one.
py::array_t<double> matched_points(const ContextView& view) {
  const FilterContext& context = view.get();
  py::array_t<double> array({static_cast<py::ssize_t>(context.frame.size()), py::ssize_t{3}});
  double* next = array.mutable_data();
  for (const MapPointId id : context.frame.map_points) {
    const MapPoint* point = id.valid() ? context.map.find_point(id) : nullptr;
    for (int axis = 0; axis < 3; ++axis)
      *next++ = point != nullptr ? point->position[axis] : std::numeric_limits<double>::quiet_NaN();
  }
  return array;
}

py::object names_of(const std::vector<std::string>* names) {
  return py::cast(names != nullptr ? *names : std::vector<std::string>{});
}

py::object own_segmentation(const ContextView& view) {
  const Segmentation* segmentation = view.get().segmentation;
  return segmentation != nullptr ? array_of_image(segmentation->labels) : py::none();
}

void bind_context_view(py::module_& module) {
  py::class_<ContextView, std::shared_ptr<ContextView>>(module, "FilterContext", "What a filter decides on.",
                                                        py::dynamic_attr())
      .def_property_readonly("frame", [](const ContextView& view) { return view.get().sensor_frame; })
      .def_property_readonly("camera", [](const ContextView& view) { return *view.get().frame.camera; })
      .def_property_readonly("points", &matched_points)
      .def_property_readonly("T_world_camera",
                             [](const ContextView& view) -> py::object {
                               const Eigen::Isometry3d* pose = view.get().T_camera_world;
                               if (pose == nullptr) return py::none();
                               return pose_array(pose->inverse());
                             })
      .def_property_readonly("classes", [](const ContextView& view) { return names_of(view.get().classes); })
      .def_property_readonly("movable", [](const ContextView& view) { return names_of(view.get().movable); })
      .def_property_readonly("segmentation", &own_segmentation);
}

void add_evidence(const EvidenceView& view, const py::object& log_odds, const std::string& kind) {
  StaticEvidence& evidence = view.get();
  if (kind != "measurement" && kind != "prior")
    throw InputError({"kind"}, "found '" + kind + "'; expected 'measurement' (this moved) or 'prior' (these can move)");
  const std::vector<float> numbers = to_numbers(log_odds, evidence.size(), "log_odds");
  for (std::size_t i = 0; i < numbers.size(); ++i)
    if (numbers[i] != 0.0F)
      evidence.add(i, numbers[i], kind == "prior" ? StaticEvidence::Kind::prior : StaticEvidence::Kind::measurement);
}

void add_point_evidence(const EvidenceView& view, const std::vector<std::uint64_t>& ids, const py::object& log_odds) {
  StaticEvidence& evidence = view.get();
  const std::vector<float> numbers = to_numbers(log_odds, ids.size(), "log_odds");
  for (std::size_t i = 0; i < ids.size(); ++i) {
    const auto id = id_of<MapPointTag>(ids[i]);
    if (!id.valid()) throw InputError({"ids"}, "number " + std::to_string(i) + " is the id of no map point");
    if (numbers[i] != 0.0F) evidence.add_point(id, numbers[i]);
  }
}

void add_cell_evidence(const EvidenceView& view, const py::object& log_odds) {
  StaticEvidence& evidence = view.get();
  const py::object flat = py::module_::import("numpy").attr("ravel")(log_odds);
  const std::vector<float> numbers = to_numbers(flat, evidence.cells().size(), "log_odds of cells");
  for (std::size_t i = 0; i < numbers.size(); ++i)
    if (numbers[i] != 0.0F) evidence.add_cell(i, numbers[i]);
}

}  // namespace

py::object shown_snapshot(const MapSnapshot& snapshot) {
  return py::module_::import("holdfast.maps").attr("MapSnapshot")(snapshot);
}

void bind_filter_context(py::module_& module) {
  bind_features_view(module);
  bind_context_view(module);
  py::class_<EvidenceView, std::shared_ptr<EvidenceView>>(
      module, "StaticEvidence", "Takes log-odds of standing still: 0 = unknown, above = static.")
      .def("__len__", [](const EvidenceView& view) { return view.get().size(); })
      .def("add", &add_evidence, py::arg("log_odds"), py::arg("kind") = "measurement")
      .def("add_points", &add_point_evidence, py::arg("ids"), py::arg("log_odds"))
      .def("add_cells", &add_cell_evidence, py::arg("log_odds"))
      .def_property_readonly("log_odds", [](const EvidenceView& view) {
        const StaticEvidence& evidence = view.get();
        py::array_t<float> array(static_cast<py::ssize_t>(evidence.size()));
        for (std::size_t i = 0; i < evidence.size(); ++i) array.mutable_data()[i] = evidence.log_odds(i);
        return array;
      });
  py::class_<MapView, std::shared_ptr<MapView>>(module, "ObservedMap", "The map of a run in progress.")
      .def("snapshot", [](const MapView& view) { return shown_snapshot(view.get().snapshot()); });
}

}  // namespace holdfast::python
