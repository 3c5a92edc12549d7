// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace holdfast {

template <class Settings>
class ParameterTable;

/// Settings of the fused surface: the section `surface` of a configuration. The images of keyframes are those of the
/// section `dense_map` (DenseMapSettings: step, keyframes, classes, dilate, edge, depth_margin).
struct SurfaceSettings {
  bool enabled = false;         ///< whether the depth of keyframes is fused into a surface
  double voxel = 0.02;          ///< side of a voxel [m]
  double truncation = 3.0;      ///< largest distance to the surface that a voxel stores [voxels]
  double maximum_depth = 4.0;   ///< larger depths are not fused [m]; the noise grows with the square of the depth
  int minimum_views = 2;        ///< number of keyframes that must have observed the surface at a voxel
  double smallest_part = 0.02;  ///< connected parts of the mesh with a smaller area are left out [m^2]
  /// Time between frames whose coarse depth carves free space, beside the keyframes [s]; 0 = keyframes alone carve.
  double carving_interval = 0.2;
  /// Minimum time between frames that are fused beside the keyframes, with the masks that were propagated to them,
  /// where few views observed the surface (FusedFrames) [s]; 0 = keyframes alone are fused.
  double interval = 0.1;
  double frames_per_keyframe = 0.5;  ///< maximum number of these frames for each keyframe, on average
  /// Time after which something that moved and stands still counts as part of the room [s]; 0 = never, if a filter
  /// keeps calling it moving because old keyframes looked through it. Classes of dense_map.classes never count.
  double resting_time = 0.0;
  /// Maximum number of keyframes that are fused again at their adjusted pose when another one is added; at the end of a
  /// run all are.
  int moves_per_keyframe = 2;
  /// Whether frames that features do not hold are aligned with the surface (align_with_surface()), for
  /// TrackingSettings::depth_only_time without features.
  bool poses = false;
  std::vector<std::string> formats = {"ply"};  ///< files that a run writes: surface.ply, surface.obj, surface.glb
  /// Whether a run keeps the fused images in the folder surface_views beside its map, for `holdfast map export --mesh`.
  bool keep_depth = false;
  /// Whether voxels collect votes of the segmenter's classes, and vertices of the mesh have a class.
  bool classes = false;
  bool class_colours = false;  ///< whether these files have the colours of classes in place of those of the images
  int triangles = 0;           ///< largest number of triangles of these files (decimate()); 0 = all
  bool navigation = false;     ///< whether a run writes map.pgm, map.yaml, octomap.bt and octomap.ot
  double cell = 0.05;          ///< side of a cell of these maps [m]
  double robot_lowest = 0.08;  ///< surface below this height over the floor is no obstacle [m]
  double robot_highest = 1.0;  ///< surface above it, neither: the height of the robot [m]

  static void describe(ParameterTable<SurfaceSettings>& table);
  /// Describes settings that the table cannot check: an unknown format, an empty band of heights. Empty if there are
  /// none.
  std::string trouble() const;
};

}  // namespace holdfast
