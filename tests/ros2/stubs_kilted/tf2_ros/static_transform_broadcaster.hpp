// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <tf2_ros/declarations.hpp>
