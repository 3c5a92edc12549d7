// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>

#include "holdfast/bench/external_system.hpp"
#include "holdfast/bench/matrix.hpp"
#include "holdfast/config/configuration.hpp"

namespace holdfast {

/// Why a sequence cannot be run with this configuration on this machine: a variable that is not set, a folder or file
/// that is not there, a recording without truth. Nothing when all is there.
std::optional<Diagnostic> missing_data(const MatrixSequence& sequence, const Configuration& configuration,
                                       const Registry& registry);
/// Whether a folder of PATH has an executable of this name.
bool is_program_in_path(const std::string& name);
/// Why a system cannot be started.
std::optional<Diagnostic> missing_program(const ExternalSystem& system);

/// Complains of a camera whose lens the settings file of external systems cannot say.
void require_plain_lens(const Camera& camera, const MatrixSequence& sequence, std::vector<Diagnostic>& diagnostics);

/// The recording in TUM layout of a sequence as external systems get it. `camera_by_folder` is the camera of a sequence
/// with `camera: auto`. Nothing when it is missing (then `missing` says why) or unfit (then `diagnostics` do).
std::optional<RecordedSequence> recorded_sequence(const MatrixSequence& sequence, const Registry& registry,
                                                  const std::optional<Camera>& camera_by_folder,
                                                  std::vector<Diagnostic>& diagnostics,
                                                  std::vector<Diagnostic>& missing);

}  // namespace holdfast
