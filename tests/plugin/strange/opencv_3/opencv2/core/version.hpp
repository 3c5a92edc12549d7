// SPDX-License-Identifier: BSD-3-Clause
// The installed OpenCV, called otherwise.
#include_next <opencv2/core/version.hpp>
#undef CV_VERSION_MAJOR
#define CV_VERSION_MAJOR 3
