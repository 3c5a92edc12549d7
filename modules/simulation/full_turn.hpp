// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <numbers>

namespace holdfast::simulation {

/// 360 degrees [rad].
template <class Real>
inline constexpr Real full_turn = Real(2) * std::numbers::pi_v<Real>;

}  // namespace holdfast::simulation
