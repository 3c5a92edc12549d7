// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "holdfast/bench/matrix.hpp"

namespace holdfast {

// The sections of a matrix, each read from the entry that holds it; what is wrong goes to the diagnostics.

Axis read_axis(const ConfigurationNode::Entry& entry, std::vector<Diagnostic>& diagnostics);
MatrixSequence read_sequence(const ConfigurationNode::Entry& entry, std::vector<Diagnostic>& diagnostics);
ExternalSystem read_system(const ConfigurationNode::Entry& entry, std::vector<Diagnostic>& diagnostics);
Exclusion read_exclusion(const ConfigurationNode& node, std::vector<Diagnostic>& diagnostics);

/// The path that a scalar names, absolute: a relative one starts from the folder of its file.
PlacedText placed_path(const ConfigurationNode& node);

}  // namespace holdfast
