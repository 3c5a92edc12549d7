// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "holdfast/evaluation/evaluation.hpp"

namespace holdfast {

/// See ScaleDrift. `poses`: the pairs, whose estimates are aligned, with scale.
std::optional<ScaleDrift> scale_drift(const std::vector<EvaluatedPose>& poses);

}  // namespace holdfast
