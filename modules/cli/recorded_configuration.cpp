// SPDX-License-Identifier: BSD-3-Clause
#include "recorded_configuration.hpp"

#include "holdfast/core/error.hpp"
#include "holdfast/perturbation/perturbed_source.hpp"

namespace holdfast {

Configuration recorded_configuration(const Configuration& original, const Registry& registry,
                                     const SourceDescription& source, const std::string& module) {
  Configuration result = original;
  const auto perturbation = section_settings<PerturbationSettings>(original, "perturbation");
  result.sections.erase("perturbation");  // the recorded frames and the camera below have it already
  result.source = {.kind = FrameSource::kind, .name = module, .values = {}, .location = {}};
  const ModuleEntry* entry = registry.find(result.source.kind, result.source.name);
  if (entry == nullptr)
    throw PluginError("a recording is read by the source '" + module + "', which these modules do not contain");
  for (const Parameter& parameter : entry->parameters) result.source.values[parameter.name] = parameter.default_value;
  // The recorded measurements are by the clock of the camera, and the camera is that of the recorded frames.
  result.imu = source.imu ? source.imu : original.imu;
  if (result.imu) result.imu->time_offset = 0.0;
  const bool source_precedes = original.unknown_camera.has_value();
  if (original.camera && !(source_precedes && source.camera))
    result.camera = perturbed_camera(*original.camera, perturbation, original.run.seed);
  else
    result.camera = source.camera;
  result.unknown_camera.reset();
  return result;
}

}  // namespace holdfast
