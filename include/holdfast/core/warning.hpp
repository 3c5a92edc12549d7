// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <utility>
#include <vector>

#include "holdfast/core/error.hpp"

namespace holdfast {

/// Warnings: input or results that are probably mistakes, but may be intended. Definite mistakes are errors
/// (core/error.hpp). The message states the finding, its probable cause and the remedy; the location is the file to
/// change, or empty.
///
/// A warning is shown by `holdfast check` if it is known before the first frame, and by `holdfast run` in the terminal,
/// in `warnings` of run.json, in report.html and in RunRecord::warnings. A new warning is added where the information
/// is available:
///
/// - configuration: `result_.warnings` of the resolver (modules/config/configuration.cpp);
/// - recording, calibration file, network, masks: override Module::warnings() of the source, segmenter, filter or
///   observer. Findings of its constructor are shown by `check`, those of frames at the end of the run;
/// - incompatible modules: PipelineBuilder::suspect();
/// - figures of a whole run, such as inliers: find_warnings() of modules/run/run_warnings.cpp;
/// - trajectories: Evaluation::warnings, which `holdfast evaluate` shows, too.
///
/// The text must not change between calls: counts that grow with the frames are reported at the end only.
using Warnings = std::vector<Diagnostic>;

/// Appends a warning, unless one with the same text exists.
inline void add_warning(Warnings& warnings, Diagnostic warning) {
  const auto is_same = [&](const Diagnostic& other) { return other.to_string() == warning.to_string(); };
  if (std::none_of(warnings.begin(), warnings.end(), is_same)) warnings.push_back(std::move(warning));
}
inline void add_warnings(Warnings& warnings, const Warnings& more) {
  for (const Diagnostic& warning : more) add_warning(warnings, warning);
}

}  // namespace holdfast
