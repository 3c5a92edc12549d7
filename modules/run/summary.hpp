// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "holdfast/run/run_record.hpp"

namespace holdfast {

/// A share (0 to 1) in percent with two decimals: "97.50 %".
std::string percent_text(double share);

/// Processor, number of cores and SIMD level of this machine.
std::string machine_text();

/// Names and strengths of the perturbations that the frames had; the seed is part of the configuration.
std::vector<std::pair<std::string, double>> perturbation_strengths(const Configuration& configuration);

/// Name and value of every figure that the terminal and the report show.
std::vector<std::pair<std::string, std::string>> summary_rows(const RunRecord& record);

}  // namespace holdfast
