// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/core/map.hpp"
