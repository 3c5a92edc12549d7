// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/plugin/parameter.hpp"
