// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace holdfast::orb_plugin {

/// Direction of (x, y) from the x axis towards the y axis [rad, 0 to 2 pi), 0 for (0, 0). The error is below 1e-6; made
/// of basic operations only, so that it is the same on every processor and mathematical library. The orientation of a
/// feature is that of its patch's moments (m10, m01) (Rublee et al. 2011, equations 1 to 3).
float direction(int x, int y);

}  // namespace holdfast::orb_plugin
