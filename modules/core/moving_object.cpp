// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/core/moving_object.hpp"

namespace holdfast {

double MovingObject::speed() const { return velocity.norm(); }

}  // namespace holdfast
