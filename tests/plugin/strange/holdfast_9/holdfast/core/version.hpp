// SPDX-License-Identifier: BSD-3-Clause
// As a version to come might have it.
#pragma once
#define HOLDFAST_VERSION "9.1.0"
