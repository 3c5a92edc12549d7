// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "holdfast/evaluation/evaluation.hpp"

namespace holdfast {

/// One of several estimates that are compared with the same ground truth.
struct ComparedEstimate {
  std::string name;
  std::optional<Evaluation> evaluation;
  std::string failure;  ///< the reason, if there is no evaluation
};

/// Formats the estimates as a table for a terminal, one row each in the order given, under the association and the
/// alignment that they share; ends with a newline.
std::string comparison_text(const std::vector<ComparedEstimate>& estimates);
/// Formats the estimates as a JSON array of the objects of to_json(); an estimate without an evaluation has its name
/// and "error".
std::string comparison_json(const std::vector<ComparedEstimate>& estimates);
/// Formats the estimates as the rows of to_csv() with the name of the estimate before each; those without an evaluation
/// are left out.
std::string comparison_csv(const std::vector<ComparedEstimate>& estimates);

}  // namespace holdfast
