// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

namespace holdfast {

/// Names of errors and of their statistics in JSON, in the order of RunResult::errors.
inline constexpr std::array quantity_keys = {"ate_m", "rpe_translation_m", "rpe_rotation_deg"};
inline constexpr std::array<const char*, 6> statistic_keys = {"rmse", "mean", "median", "standard_deviation",
                                                              "min",  "max"};

}  // namespace holdfast
