// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "holdfast/core/camera.hpp"
#include "holdfast/core/map.hpp"
#include "holdfast/dense_map/kept_view.hpp"
#include "holdfast/surface/surface_settings.hpp"
#include "holdfast/surface/triangle_mesh.hpp"

namespace holdfast {

class SurfaceMap;

/// What a surface is fused from, apart from the poses: those are of the keyframes in a map. A run keeps it beside its
/// map with SurfaceSettings::keep_depth.
struct SurfaceViews {
  Camera camera;                          ///< pinhole camera of the views of keyframes
  SurfaceSettings settings;               ///< those of the fusion
  std::vector<KeptView> views;            ///< by increasing frame index
  std::size_t left_out = 0;               ///< number of views that were read, and whose keyframes are not in the map
  std::vector<std::string> classes = {};  ///< names of the classes in KeptView::labels; empty = there are none

  /// The views of a surface; images are shared.
  static SurfaceViews of(const SurfaceMap& surface);
  /// Adds the views of a later run on the same map; its frames are numbered on. The settings stay. Throws Error if the
  /// runs had different cameras or values of dense_map.step.
  void append(SurfaceViews later);
};

/// Writes views into a folder: views.json, and images as PNG without loss, colour/FRAME.png, depth/FRAME.png (16 bits:
/// KeptView::depth) and, where there are labels, labels/FRAME.png, about 0.3 MB per keyframe of 640x480 at step 2 and
/// 4 kB per frame that carves. A view of a keyframe that is no longer in the map refers to the keyframe of its submap
/// that is nearest in time. Throws InputError if a file cannot be written.
void write_views(const std::filesystem::path& folder, const SurfaceViews& views, const Map& map);

/// Reads views whose keyframes, known by sequence number and time stamp, are in the map; others are left out. Throws
/// InputError for a folder without views, for a damaged file, and if no keyframe is in the map.
SurfaceViews read_views(const std::filesystem::path& folder, const Map& map);

/// Fuses views at the poses of the map. `on_progress` gets the number of views fused so far. Throws Error without
/// OpenVDB.
TriangleMesh fuse(
    const SurfaceViews& views, const Map& map,
    const std::function<void(std::size_t)>& on_progress = [](std::size_t) {});

}  // namespace holdfast
