// SPDX-License-Identifier: BSD-3-Clause
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <mutex>

#include "arrays.hpp"
#include "bindings.hpp"
#include "gil.hpp"
#include "holdfast/core/error.hpp"
#include "holdfast/simulation/scene_file.hpp"
#include "holdfast/simulation/simulator.hpp"

namespace holdfast::python {

namespace py = pybind11;

namespace {

/// A simulator for any thread: frames are rendered one after another, without Python's lock.
class SharedSimulator {
 public:
  /// A positive `stereo_baseline` [m] renders stereo pairs, 0 frames with depth.
  SharedSimulator(const std::filesystem::path& scene, const std::vector<std::string>& overrides, const Camera& camera,
                  double stereo_baseline)
      : simulator_(seeded(simulation::read_scene(scene, overrides)), camera), stereo_baseline_(stereo_baseline) {
    if (!(stereo_baseline >= 0.0 && stereo_baseline <= 10.0))
      throw InputError({"stereo_baseline"},
                       "is " + std::to_string(stereo_baseline) + "; expected metres from 0 (frames with depth) to 10");
  }

  SensorFrame frame(std::uint64_t index) {
    const std::lock_guard lock(mutex_);
    if (index >= simulator_.frame_count())
      throw InputError({"frame"}, "number " + std::to_string(index) + " is beyond the " +
                                      std::to_string(simulator_.frame_count()) + " frames of the scene");
    return stereo_baseline_ > 0.0 ? simulator_.stereo_frame(index, stereo_baseline_) : simulator_.frame(index);
  }
  Camera camera() const {
    Camera camera = simulator_.camera();
    if (stereo_baseline_ > 0.0) camera.baseline = stereo_baseline_;
    return camera;
  }
  const simulation::Simulator& get() const { return simulator_; }

 private:
  static simulation::Scene seeded(simulation::Scene scene) {
    if (scene.seed == 0) scene.seed = 1;
    return scene;
  }
  std::mutex mutex_;
  simulation::Simulator simulator_;
  double stereo_baseline_;
};

}  // namespace

void bind_simulation(py::module_& module) {
  py::class_<SharedSimulator, std::shared_ptr<SharedSimulator>>(module, "Simulator")
      .def(py::init<const std::filesystem::path&, const std::vector<std::string>&, const Camera&, double>(),
           py::arg("scene"), py::arg("overrides"), py::arg("camera"), py::arg("stereo_baseline"),
           py::call_guard<Unlock>())
      .def("frame", &SharedSimulator::frame, py::arg("index"), py::call_guard<Unlock>())
      .def_property_readonly("frame_count", [](const SharedSimulator& s) { return s.get().frame_count(); })
      .def_property_readonly("camera", &SharedSimulator::camera)
      .def_property_readonly("class_names", [](const SharedSimulator& s) { return s.get().class_names(); })
      .def("truth", [](const SharedSimulator& s) { return trajectory_arrays(s.get().truth()); });
}

}  // namespace holdfast::python
