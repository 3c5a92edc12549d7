// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <utility>
#include <vector>

#include "holdfast/core/error.hpp"

namespace holdfast {

/// Suspicions: input or results that are plausible mistakes and may still be intended. What is certainly wrong is an
/// error (core/error.hpp). The message of a warning states what was found, what it may be and how to correct it; the
/// location is the file that has to be changed, and is empty for what no file says.
///
/// A warning is shown by `holdfast check` if it is known before the first frame, and by `holdfast run` in the terminal,
/// in `warnings` of run.json, in report.html and in RunRecord::warnings. To add one, choose the place that has the
/// knowledge; nothing else is needed:
///
/// - configuration: `result_.warnings` of the resolver (modules/config/configuration.cpp);
/// - recording, calibration file, network, masks: override Module::warnings() of the source, segmenter, filter or
///   observer. What its constructor finds is shown by `check`, what its frames show at the end of the run;
/// - parts that fit together badly: PipelineBuilder::suspect();
/// - figures of a whole run, such as inliers: find_warnings() of modules/run/run_warnings.cpp;
/// - trajectories: Evaluation::warnings, which `holdfast evaluate` shows, too.
///
/// The text is constant once it was given: text with counts that grow with the frames is given at the end only.
using Warnings = std::vector<Diagnostic>;

/// Appends a warning, unless the same text is there.
inline void add_warning(Warnings& warnings, Diagnostic warning) {
  const auto is_same = [&](const Diagnostic& other) { return other.to_string() == warning.to_string(); };
  if (std::none_of(warnings.begin(), warnings.end(), is_same)) warnings.push_back(std::move(warning));
}
inline void add_warnings(Warnings& warnings, const Warnings& more) {
  for (const Diagnostic& warning : more) add_warning(warnings, warning);
}

}  // namespace holdfast
