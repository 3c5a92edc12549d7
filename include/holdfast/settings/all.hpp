// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// Settings of every built-in module, for those who configure in C++ (pipeline/pipeline_builder.hpp).
#include "holdfast/settings/ceres.hpp"
#include "holdfast/settings/depth_clusters.hpp"
#include "holdfast/settings/epipolar_consistency.hpp"
#include "holdfast/settings/flann.hpp"
#include "holdfast/settings/motion_objects.hpp"
#include "holdfast/settings/multi_view_depth.hpp"
#include "holdfast/settings/objects.hpp"
#include "holdfast/settings/onnx.hpp"
#include "holdfast/settings/opencv_orb.hpp"
#include "holdfast/settings/orb.hpp"
#include "holdfast/settings/overlay.hpp"
#include "holdfast/settings/precomputed.hpp"
#include "holdfast/settings/reprojection_error.hpp"
#include "holdfast/settings/semantic_mask.hpp"
#include "holdfast/settings/truth.hpp"
#include "holdfast/settings/unet.hpp"
