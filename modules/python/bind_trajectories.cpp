// SPDX-License-Identifier: BSD-3-Clause
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "arrays.hpp"
#include "bindings.hpp"
#include "gil.hpp"
#include "holdfast/core/error.hpp"
#include "holdfast/evaluation/evaluation.hpp"
#include "holdfast/plugin/did_you_mean.hpp"

namespace holdfast::python {

namespace py = pybind11;

namespace {

EvaluationOptions options_of(const std::string& alignment, double max_time_difference, double time_step,
                             double path_step) {
  EvaluationOptions options;
  const std::optional<AlignmentKind> kind = parse_alignment(alignment);
  if (!kind)
    throw InputError({"alignment"},
                     "there is no alignment '" + alignment + "'; " + did_you_mean(alignment, {"se3", "sim3", "none"}));
  options.alignment = *kind;
  options.max_time_difference = max_time_difference;
  options.time_step = time_step;
  options.path_step = path_step;
  return options;
}

}  // namespace

void bind_trajectories(py::module_& module) {
  module.def(
      "read_trajectory",
      [](const std::filesystem::path& file) {
        Trajectory trajectory;
        {
          const Unlock unlock;
          trajectory = read_trajectory(file);
        }
        return trajectory_arrays(trajectory);
      },
      py::arg("file"));
  module.def(
      "write_trajectory",
      [](const std::filesystem::path& file, const py::object& stamps, const py::object& poses) {
        const Trajectory trajectory = to_trajectory(stamps, poses);
        const Unlock unlock;
        write_trajectory(file, trajectory);
      },
      py::arg("file"), py::arg("timestamps"), py::arg("poses"));
  module.def(
      "trajectory_text",
      [](const py::object& stamps, const py::object& poses) { return trajectory_text(to_trajectory(stamps, poses)); },
      py::arg("timestamps"), py::arg("poses"));
  module.def(
      "check_trajectory", [](const py::object& stamps, const py::object& poses) { to_trajectory(stamps, poses); },
      py::arg("timestamps"), py::arg("poses"));

  py::class_<Evaluation, std::shared_ptr<Evaluation>>(module, "Evaluation")
      .def("to_json", [](const Evaluation& evaluation) { return to_json(evaluation); })
      .def("to_tracks_json", [](const Evaluation& evaluation) { return to_tracks_json(evaluation); })
      .def("to_text", [](const Evaluation& evaluation) { return to_text(evaluation); })
      .def("to_csv", [](const Evaluation& evaluation) { return to_csv(evaluation); })
      .def("top_view_svg", &top_view_svg)
      .def("error_svg", &error_over_time_svg);
  module.def(
      "evaluate",
      [](const py::tuple& truth, const py::tuple& estimate, const std::string& alignment, double max_time_difference,
         double time_step, double path_step, const std::optional<std::vector<double>>& frame_stamps) {
        const Trajectory true_poses = to_trajectory(truth[0], truth[1]);
        const Trajectory poses = to_trajectory(estimate[0], estimate[1]);
        const EvaluationOptions options = options_of(alignment, max_time_difference, time_step, path_step);
        const Unlock unlock;
        return evaluate(true_poses, poses, options, frame_stamps);
      },
      py::arg("truth"), py::arg("estimate"), py::arg("alignment"), py::arg("max_time_difference"), py::arg("time_step"),
      py::arg("path_step"), py::arg("frame_stamps"));
}

}  // namespace holdfast::python
