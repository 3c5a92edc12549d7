// SPDX-License-Identifier: BSD-3-Clause
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include "arrays.hpp"
#include "bindings.hpp"
#include "frames.hpp"
#include "gil.hpp"
#include "holdfast/run/configured_pipeline.hpp"
#include "holdfast/surface/free_space.hpp"
#include "module_call.hpp"
#include "registry.hpp"

namespace holdfast::python {

namespace py = pybind11;

namespace {

using Points = py::array_t<double, py::array::c_style | py::array::forcecast>;

/// A pipeline that Python feeds. Any thread may call anything: calls that C++ allows one thread at a time wait for each
/// other, without Python's lock. Inside a call of one of the pipeline's own modules they would wait for ever, and throw
/// Error; interrupt() is allowed there, and map_snapshot() unless the pipeline holds its map's lock.
class FedPipeline {
 public:
  /// `modules` are those of make_registry().
  FedPipeline(const Configuration& configuration, const PipelineOptions& options, const py::list& modules) {
    Registry registry = make_registry(modules);
    const ModuleMaking making(this);
    const Unlock unlock;
    load_plugins(configuration, registry);
    BuiltPipeline built = build_pipeline(configuration, registry, options);
    is_stereo_ = built.source->describe().has_right;
    pipeline_.emplace(std::move(built.pipeline));
    camera_ = pipeline_->camera();
  }
  /// Ending the threads of the pipeline may need Python's lock in them. Garbage collection may run in one of these
  /// threads, which cannot wait for its own end.
  ~FedPipeline() {
    const Unlock unlock;
    if (pipeline_ && ModuleCall::of(this) != nullptr)
      std::thread([ended = std::move(*pipeline_)] {}).detach();
    else
      pipeline_.reset();
  }
  FedPipeline(const FedPipeline&) = delete;
  FedPipeline& operator=(const FedPipeline&) = delete;

  FrameResult feed(const SensorFrame& frame) {
    refuse_modules("feed");
    const Unlock unlock;
    const std::lock_guard lock(calls_);
    SensorFrame numbered = frame;
    numbered.index = fed_;
    FrameResult result = running("feed").feed(numbered);
    ++fed_;
    return result;
  }
  FrameResult feed_arrays(double timestamp, const py::object& colour, const py::object& depth,
                          const py::object& right) {
    if (!is_stereo_ && !right.is_none())
      throw InputError({"right"}, "the pipeline expects depth images; make it with stereo=True for stereo pairs");
    return feed(make_frame(timestamp, colour, depth, right));
  }

  void finish() {
    refuse_modules("finish");
    const Unlock unlock;
    const std::lock_guard lock(calls_);
    Pipeline& pipeline = running("finish");
    finished_ = true;
    pipeline.finish();
  }
  void interrupt() {
    const Unlock unlock;
    const std::lock_guard lock(life_);
    if (pipeline_) pipeline_->interrupt();
  }
  void close() {
    refuse_modules("close");
    const Unlock unlock;
    const std::lock_guard lock(calls_);
    end();
  }

  py::tuple trajectory() {
    return trajectory_arrays(ask([](const Pipeline& p) { return p.trajectory(); }));
  }
  py::tuple keyframes() {
    return trajectory_arrays(ask([](const Pipeline& p) { return p.keyframe_trajectory(); }));
  }
  PipelineHealth health(double patience) {
    const Unlock unlock;
    const std::lock_guard lock(life_);
    return open("health").health(patience);
  }
  MapSnapshot map_snapshot() {
    refuse_modules("map_snapshot", MapLock::held);
    const Unlock unlock;
    const std::lock_guard lock(life_);
    return open("map_snapshot").map_snapshot();
  }
  /// Answers of the free space for points (N, 3).
  template <class Answer>
  py::array_t<Answer> ask_space(const char* call, const Points& points,
                                Answer (FreeSpace::*question)(const Eigen::Vector3d&) const) {
    if (points.ndim() != 2 || points.shape(1) != 3)
      throw InputError({call}, "expected a point as 3 numbers, or points as an array of shape (N, 3) [m]");
    refuse_modules(call, MapLock::held);
    const std::shared_ptr<const FreeSpace> space = [&] {
      const Unlock unlock;
      const std::lock_guard lock(life_);
      return open(call).free_space();
    }();
    if (!space) throw Error(std::string(call) + ": the pipeline has no surface; set surface.enabled");
    py::array_t<Answer> answers(points.shape(0));
    for (py::ssize_t i = 0; i < points.shape(0); ++i)
      answers.mutable_at(i) = (*space.*question)({points.at(i, 0), points.at(i, 1), points.at(i, 2)});
    return answers;
  }
  py::array_t<bool> is_free(const Points& points) { return ask_space("is_free", points, &FreeSpace::is_free); }
  py::array_t<double> distance(const Points& points) { return ask_space("distance", points, &FreeSpace::distance); }
  std::shared_ptr<Map> take_map() {
    refuse_modules("take_map");
    const Unlock unlock;
    const std::lock_guard lock(calls_);
    Pipeline& pipeline = open("take_map");
    if (!finished_) throw Error("take_map: the pipeline is not finished; call finish() first");
    auto map = std::make_shared<Map>(pipeline.take_map());
    end();
    return map;
  }

  const Camera& camera() const { return camera_; }
  std::uint64_t fed() const { return fed_; }
  bool is_finished() const { return finished_; }
  bool is_closed() const { return !pipeline_; }

 private:
  template <class Question>
  Trajectory ask(Question question) {
    refuse_modules("trajectory");
    const Unlock unlock;
    const std::lock_guard lock(calls_);
    return question(open("trajectory"));
  }
  Pipeline& open(const char* call) {
    if (!pipeline_)
      throw Error(std::string(call) + ": the pipeline is closed; make a new one, or ask before it is closed");
    return *pipeline_;
  }
  /// Throws Error inside a call of one of the pipeline's modules; with `only` held in one under the map's lock.
  void refuse_modules(const char* call, MapLock only = MapLock::free) const {
    const ModuleCall* module = ModuleCall::of(this);
    if (module != nullptr && (only == MapLock::free || module->map_lock() == MapLock::held))
      throw Error(std::string(call) + ": was called by " + module->name() +
                  ", a module of this pipeline, which waits until the module returns; call it after that, such as "
                  "from the loop that feeds");
  }
  /// Without life_ while the threads end: one of their modules may be asking for a snapshot.
  void end() {
    std::optional<Pipeline> ended;
    const std::lock_guard lock(life_);
    std::swap(ended, pipeline_);
  }
  Pipeline& running(const char* call) {
    Pipeline& pipeline = open(call);
    if (finished_) throw Error(std::string(call) + ": the pipeline is finished; make a new one for more frames");
    return pipeline;
  }

  std::mutex calls_;  // of everything that one thread at a time may call
  std::mutex life_;   // of the pipeline's existence, for what any thread may call at any time
  std::optional<Pipeline> pipeline_;
  Camera camera_;
  bool is_stereo_ = false;
  std::atomic<std::uint64_t> fed_ = 0;
  std::atomic<bool> finished_ = false;
};

}  // namespace

void bind_pipeline(py::module_& module) {
  py::class_<FedPipeline>(module, "Pipeline")
      .def(py::init([](const Configuration& configuration, const std::filesystem::path& output,
                       const std::filesystem::path& map, bool localise_only, const py::list& modules) {
             return std::make_unique<FedPipeline>(
                 configuration,
                 PipelineOptions{.output_directory = output, .map_file = map, .localise_only = localise_only}, modules);
           }),
           py::arg("configuration"), py::arg("output"), py::arg("map"), py::arg("localise_only"), py::arg("modules"))
      .def("feed", &FedPipeline::feed, py::arg("frame"))
      .def("feed_arrays", &FedPipeline::feed_arrays, py::arg("timestamp"), py::arg("colour"), py::arg("depth"),
           py::arg("right"))
      .def("finish", &FedPipeline::finish)
      .def("interrupt", &FedPipeline::interrupt)
      .def("close", &FedPipeline::close)
      .def("trajectory", &FedPipeline::trajectory)
      .def("keyframes", &FedPipeline::keyframes)
      .def("health", &FedPipeline::health, py::arg("patience"))
      .def("map_snapshot", &FedPipeline::map_snapshot)
      .def("is_free", &FedPipeline::is_free, py::arg("points"))
      .def("distance", &FedPipeline::distance, py::arg("points"))
      .def("take_map", &FedPipeline::take_map)
      .def_property_readonly("camera", &FedPipeline::camera)
      .def_property_readonly("fed", &FedPipeline::fed)
      .def_property_readonly("is_finished", &FedPipeline::is_finished)
      .def_property_readonly("is_closed", &FedPipeline::is_closed);
}

}  // namespace holdfast::python
