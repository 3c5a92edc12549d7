// SPDX-License-Identifier: BSD-3-Clause
#include <pybind11/numpy.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "arrays.hpp"
#include "bindings.hpp"
#include "gil.hpp"
#include "holdfast/core/map.hpp"
#include "holdfast/core/map_snapshot.hpp"
#include "holdfast/map_io/map_export.hpp"
#include "holdfast/map_io/map_file.hpp"
#include "holdfast/map_io/map_info.hpp"
#include "ids.hpp"

namespace holdfast::python {

namespace py = pybind11;

namespace {

/// A one-dimensional array of what `value` says of each entry.
template <class Number, class Entries, class Value>
py::array_t<Number> column(const Entries& entries, Value value) {
  py::array_t<Number> array(static_cast<py::ssize_t>(entries.size()));
  Number* next = array.mutable_data();
  for (const auto& entry : entries) *next++ = value(entry);
  return array;
}

py::tuple keyframe_arrays(const MapSnapshot& snapshot) {
  Trajectory poses;
  for (const MapSnapshot::KeyFrame& keyframe : snapshot.keyframes)
    poses.push_back({keyframe.timestamp, keyframe.T_world_camera});
  return trajectory_arrays(poses);
}

py::array_t<double> positions(const MapSnapshot& snapshot) {
  py::array_t<double> array({static_cast<py::ssize_t>(snapshot.points.size()), py::ssize_t{3}});
  Eigen::Map<Eigen::Matrix<double, 3, Eigen::Dynamic>> columns(array.mutable_data(), 3,
                                                               static_cast<Eigen::Index>(snapshot.points.size()));
  for (std::size_t i = 0; i < snapshot.points.size(); ++i)
    columns.col(static_cast<Eigen::Index>(i)) = snapshot.points[i].position;
  return array;
}

py::array_t<std::uint64_t> loops(const MapSnapshot& snapshot) {
  py::array_t<std::uint64_t> array({static_cast<py::ssize_t>(snapshot.loops.size()), py::ssize_t{2}});
  std::uint64_t* next = array.mutable_data();
  for (const MapSnapshot::Loop& loop : snapshot.loops) {
    *next++ = number_of(loop.older);
    *next++ = number_of(loop.newer);
  }
  return array;
}

void bind_snapshots(py::module_& module) {
  using KeyFrame = MapSnapshot::KeyFrame;
  using Point = MapSnapshot::Point;
  py::class_<MapSnapshot>(module, "MapSnapshot", "Keyframes, points and loops of a map at one time.")
      .def_property_readonly("keyframe_ids",
                             [](const MapSnapshot& s) {
                               return column<std::uint64_t>(s.keyframes,
                                                            [](const KeyFrame& k) { return number_of(k.id); });
                             })
      .def("keyframe_arrays", &keyframe_arrays)
      .def_property_readonly("point_ids",
                             [](const MapSnapshot& s) {
                               return column<std::uint64_t>(s.points, [](const Point& p) { return number_of(p.id); });
                             })
      .def_property_readonly("points", &positions)
      .def_property_readonly("observations",
                             [](const MapSnapshot& s) {
                               return column<std::uint32_t>(s.points, [](const Point& p) { return p.observations; });
                             })
      .def_property_readonly("static_log_odds",
                             [](const MapSnapshot& s) {
                               return column<float>(s.points, [](const Point& p) { return p.static_log_odds; });
                             })
      .def_property_readonly("loops", &loops)
      .def("__repr__", [](const MapSnapshot& s) {
        return "MapSnapshot(" + std::to_string(s.keyframes.size()) + " keyframes, " + std::to_string(s.points.size()) +
               " points, " + std::to_string(s.loops.size()) + " loops)";
      });
}

}  // namespace

void bind_maps(py::module_& module) {
  bind_snapshots(module);
  using Release = py::call_guard<Unlock>;
  py::class_<Map, std::shared_ptr<Map>>(module, "Map", "Keyframes and points of a run, as map.hfm holds them.")
      .def(
          "snapshot", [](const Map& map) { return make_snapshot(map); }, Release())
      .def(
          "write", [](const Map& map, const std::filesystem::path& file) { write_map(file, map); }, py::arg("file"),
          Release())
      .def(
          "write_ply", [](const Map& map, const std::filesystem::path& file) { write_points_ply(file, map); },
          py::arg("file"), Release())
      .def(
          "to_json", [](const Map& map) { return map_json(map); }, Release())
      .def_property_readonly("keyframe_count", [](const Map& map) { return map.keyframes().size(); })
      .def_property_readonly("point_count", [](const Map& map) { return map.points().size(); })
      .def("__repr__", [](const Map& map) {
        return "Map(" + std::to_string(map.keyframes().size()) + " keyframes, " + std::to_string(map.points().size()) +
               " points)";
      });
  module.def(
      "read_map", [](const std::filesystem::path& file) { return std::make_shared<Map>(read_map(file)); },
      py::arg("file"), Release());
  module.def(
      "map_info_json", [](const std::filesystem::path& file) { return to_json(read_map_info(file)); }, py::arg("file"),
      Release());
}

}  // namespace holdfast::python
