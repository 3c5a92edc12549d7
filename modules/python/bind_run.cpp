// SPDX-License-Identifier: BSD-3-Clause
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <exception>
#include <opencv2/core/utility.hpp>
#include <optional>

#include "arrays.hpp"
#include "bindings.hpp"
#include "errors.hpp"
#include "gil.hpp"
#include "holdfast/run/configured_pipeline.hpp"
#include "holdfast/run/results.hpp"
#include "holdfast/run/run.hpp"
#include "holdfast/run/trajectory_journal.hpp"
#include "output_folder.hpp"
#include "registry.hpp"

namespace holdfast::python {

namespace py = pybind11;

namespace {

/// OpenCV with one thread, as the program has it, until the last run ends; then as it was.
class OneThread {
 public:
  OneThread() {
    const std::lock_guard lock(mutex());
    if (users()++ == 0) {
      before() = cv::getNumThreads();
      cv::setNumThreads(1);
    }
  }
  ~OneThread() {
    const std::lock_guard lock(mutex());
    if (--users() == 0) cv::setNumThreads(before());
  }
  OneThread(const OneThread&) = delete;
  OneThread& operator=(const OneThread&) = delete;

 private:
  static std::mutex& mutex() {
    static std::mutex instance;
    return instance;
  }
  static int& users() {
    static int count = 0;
    return count;
  }
  static int& before() {
    static int threads = 0;
    return threads;
  }
};

/// Asks Python now and then whether the run shall go on: after Ctrl-C, or an exception of a callback, it shall not. The
/// exception is kept until the run has written its results.
class Supervisor {
 public:
  Supervisor(py::object on_frame, double interval) : on_frame_(std::move(on_frame)), interval_(interval) {}
  ~Supervisor() {
    const Lock lock;
    raised_.reset();
    on_frame_ = py::object();
  }
  Supervisor(const Supervisor&) = delete;
  Supervisor& operator=(const Supervisor&) = delete;

  bool stop() {
    if (raised_) return true;
    if (since_signals_.seconds() < 0.05) return false;
    since_signals_.restart();
    const Lock lock;
    check_signals();
    return raised_.has_value();
  }
  void on_frame(const RunProgress& progress) {
    if (raised_ || !on_frame_ || on_frame_.is_none()) return;
    const bool is_last = progress.frame_count && progress.frames_done == *progress.frame_count;
    if (progress.frames_done > 1 && !is_last && since_frame_.seconds() < interval_) return;
    since_frame_.restart();
    const Lock lock;
    try {
      on_frame_(progress.frames_done, progress.frame_count, progress.result);
    } catch (py::error_already_set& raised) {
      raised_.emplace(raised);
    }
  }
  /// The lock must be held.
  void raise_if_any() {
    check_signals();
    if (!raised_) return;
    py::error_already_set raised = *raised_;
    raised_.reset();
    throw raised;
  }

 private:
  void check_signals() {
    if (!raised_ && PyErr_CheckSignals() != 0) raised_.emplace();
  }

  py::object on_frame_;
  double interval_;
  Stopwatch since_signals_, since_frame_;
  std::optional<py::error_already_set> raised_;
};

/// What is written while the frames are read.
struct Written {
  std::optional<FolderLock> lock;
  std::optional<TrajectoryJournal> journal;
};

RunOptions options_of(const PipelineOptions& pipeline, bool overwrite, Supervisor& supervisor, Written& written) {
  RunOptions options;
  options.pipeline = pipeline;
  options.stop = [&supervisor] { return supervisor.stop(); };
  const std::filesystem::path output = pipeline.output_directory;
  if (!output.empty())
    options.on_start = [&written, output, overwrite](const RunRecord& record) {
      written.lock.emplace(prepare_output_folder(output, overwrite, result_names()));
      write_file_atomically(output / "config.yaml", to_yaml(record.configuration));
      written.journal.emplace(output);
    };
  options.on_frame = [&supervisor, &written](const RunProgress& progress) {
    if (written.journal && progress.result.T_world_camera)
      written.journal->add({progress.result.timestamp, *progress.result.T_world_camera});
    supervisor.on_frame(progress);
  };
  return options;
}

/// Results would take the place of the map that the run begins with.
void keep_map(const PipelineOptions& options) {
  std::error_code ignored;
  if (options.map_file.empty() || !std::filesystem::exists(options.map_file, ignored)) return;
  if (std::filesystem::equivalent(std::filesystem::absolute(options.map_file).parent_path(), options.output_directory,
                                  ignored))
    throw InputError({options.map_file.string()},
                     "lies in the output folder, where this run's results would replace it; choose another output");
}

std::shared_ptr<RunRecord> run_configuration(const Configuration& configuration, PipelineOptions options,
                                             bool overwrite, const py::object& on_frame, double interval,
                                             const py::list& modules) {
  Registry registry = make_registry(modules);
  Supervisor supervisor(on_frame, interval);
  auto record = std::make_shared<RunRecord>();
  {
    const Unlock unlock;
    const OneThread one_thread;
    keep_map(options);
    load_plugins(configuration, registry);
    Written written;
    *record = run(configuration, registry, options_of(options, overwrite, supervisor, written));
    written.journal.reset();
    if (!options.output_directory.empty()) write_results(*record, options.output_directory);
  }
  supervisor.raise_if_any();
  return record;
}

std::shared_ptr<Evaluation> evaluation_of(const RunRecord& record) {
  return record.evaluation ? std::make_shared<Evaluation>(*record.evaluation) : nullptr;
}

py::object dense_map_of(const RunRecord& record) {
  if (!record.dense_map) return py::none();
  const auto count = static_cast<py::ssize_t>(record.dense_map->size());
  py::array_t<float> positions({count, py::ssize_t{3}});
  py::array_t<std::uint8_t> colours({count, py::ssize_t{3}});
  float* position = positions.mutable_data();
  std::uint8_t* colour = colours.mutable_data();
  for (const CloudPoint& point : *record.dense_map) {
    for (const float value : {point.x, point.y, point.z}) *position++ = value;
    for (const std::uint8_t value : {point.red, point.green, point.blue}) *colour++ = value;
  }
  return py::make_tuple(positions, colours);
}

}  // namespace

void bind_run(py::module_& module) {
  py::class_<RunRecord, std::shared_ptr<RunRecord>>(module, "RunRecord")
      .def("trajectory", [](const RunRecord& record) { return trajectory_arrays(record.trajectory); })
      .def("keyframes", [](const RunRecord& record) { return trajectory_arrays(record.keyframes); })
      .def_readonly("frame_stamps", &RunRecord::frame_stamps)
      .def_property_readonly("tracking_seconds",
                             [](const RunRecord& record) { return number_array(record.summary.tracking_seconds()); })
      .def_readonly("configuration", &RunRecord::configuration)
      .def_readonly("failure", &RunRecord::failure)
      .def_readonly("no_evaluation", &RunRecord::no_evaluation)
      .def_readonly("camera", &RunRecord::camera)
      .def_property_readonly("evaluation", &evaluation_of)
      .def_property_readonly("dense_map", &dense_map_of)
      .def("map", [](std::shared_ptr<RunRecord> record) { return std::shared_ptr<Map>(record, &record->map); })
      .def("run_json", &run_json)
      .def("report_html", [](const RunRecord& record) { return report_html(record); })
      .def("summary_text", &summary_text)
      .def("coverage_warning", &coverage_warning)
      .def(
          "write",
          [](const RunRecord& record, const std::filesystem::path& folder, bool overwrite) {
            const Unlock unlock;
            const FolderLock lock = prepare_output_folder(folder, overwrite, result_names());
            write_results(record, folder);
          },
          py::arg("folder"), py::arg("overwrite"));
  module.def(
      "run",
      [](const Configuration& configuration, const std::filesystem::path& output, const std::filesystem::path& map,
         bool localise_only, bool overwrite, const py::object& on_frame, double interval, const py::list& modules) {
        return run_configuration(configuration,
                                 {.output_directory = output, .map_file = map, .localise_only = localise_only},
                                 overwrite, on_frame, interval, modules);
      },
      py::arg("configuration"), py::arg("output"), py::arg("map"), py::arg("localise_only"), py::arg("overwrite"),
      py::arg("on_frame"), py::arg("interval"), py::arg("modules"));
}

}  // namespace holdfast::python
