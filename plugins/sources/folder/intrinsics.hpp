// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

#include "holdfast/core/camera.hpp"

namespace holdfast::folder_plugin {

/// Reads a camera from a YAML or JSON file: fx, fy, cx, cy, width and height are required; k1, k2, p1, p2, k3 (radial
/// and tangential distortion), baseline [m] and name are optional; `defaults` gives what is left out but for the
/// distortion, which is zero, and the name, which is the file's. Throws InputError (file, line and column) for a key
/// that is missing, unknown or given twice and for a value that cannot be.
Camera read_intrinsics(const std::filesystem::path& file, const Camera& defaults);

}  // namespace holdfast::folder_plugin
