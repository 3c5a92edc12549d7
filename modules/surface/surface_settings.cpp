// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/surface/surface_settings.hpp"

#include <algorithm>

#include "holdfast/plugin/parameter_table.hpp"
#include "holdfast/surface/mesh_files.hpp"

namespace holdfast {

void SurfaceSettings::describe(ParameterTable<SurfaceSettings>& table) {
  using S = SurfaceSettings;
  table.add(
      "enabled", &S::enabled,
      "fuse the depth of keyframes into a surface and write it as a mesh; needs a build with OpenVDB. Which images "
      "and pixels count is said by the section `dense_map`");
  table.add("voxel", &S::voxel, "side of a voxel").range(0.002, 0.5).unit("m");
  table.add("truncation", &S::truncation, "largest distance to the surface that a voxel stores")
      .range(2, 20)
      .unit("voxels");
  table.add("maximum_depth", &S::maximum_depth, "larger depths are not fused; they are too noisy")
      .range(0.1, 16)
      .unit("m");
  table.add("minimum_views", &S::minimum_views, "minimum number of fused views that observe the surface at a voxel")
      .range(1, 100);
  table.add("smallest_part", &S::smallest_part, "connected parts of the mesh with a smaller area are left out")
      .range(0, 100)
      .unit("m^2");
  table
      .add("carving_interval", &S::carving_interval,
           "time between frames whose coarse depth carves free space, beside the keyframes; 0: keyframes alone carve")
      .range(0, 60)
      .unit("s");
  table
      .add("interval", &S::interval,
           "minimum time between frames that are fused beside the keyframes, with the masks that were propagated to "
           "them, where fewer than 8 views observed the surface: they see more and average the sensor's noise. Not "
           "without a segmenter. At most `dense_map.keyframes` of them are kept; 0: keyframes alone are fused")
      .range(0, 60)
      .unit("s");
  table
      .add("frames_per_keyframe", &S::frames_per_keyframe,
           "maximum number of these frames for each keyframe, on average; bounds time and memory")
      .range(0, 1000);
  table
      .add("resting_time", &S::resting_time,
           "time after which something that moved and stands still, such as a chair that was moved, counts as part of "
           "the room, although filters call it moving because old keyframes looked through it; 0: never")
      .range(0, 60)
      .unit("s");
  table
      .add("moves_per_keyframe", &S::moves_per_keyframe,
           "maximum number of keyframes that are fused again at their adjusted pose with each new keyframe; at the end "
           "of a run all are")
      .range(0, 1000);
  table.add("poses", &S::poses,
            "align the depth of frames that cannot be tracked by features with the surface; used for at most "
            "`tracking.depth_only_time` without features, and not while the surface waits for corrections of the map");
  table.add("formats", &S::formats, "files to write: ply (surface.ply), obj, glb (binary glTF 2.0)");
  table
      .add("triangles", &S::triangles,
           "largest number of triangles of the files, to which edges are collapsed by their quadric error; 0: all")
      .at_least(0);
  table.add(
      "classes", &S::classes,
      "voxels collect the classes that the segmenter gives to pixels of keyframes, and surface.ply has the label of "
      "each vertex");
  table.add("class_colours", &S::class_colours,
            "the files have the colours of classes in place of those of the images; needs `classes`");
  table.add("keep_depth", &S::keep_depth,
            "keep the fused depth and colour in the folder surface_views beside map.hfm, about 0.3 MB per fused view, "
            "from which `holdfast map export --mesh` makes meshes later");
  table.add("navigation", &S::navigation,
            "also write maps for navigation: map.pgm and map.yaml for ROS's map_server, octomap.bt, octomap.ot");
  table.add("cell", &S::cell, "side of a cell of these maps").range(0.01, 1).unit("m");
  table.add("robot_lowest", &S::robot_lowest, "surface below this height over the floor is no obstacle")
      .range(0, 1)
      .unit("m");
  table.add("robot_highest", &S::robot_highest, "surface above this height over the floor is no obstacle")
      .range(0.01, 10)
      .unit("m");
}

std::string SurfaceSettings::trouble() const {
  const std::vector<std::string>& known = mesh_formats();
  for (const std::string& format : formats)
    if (std::find(known.begin(), known.end(), format) == known.end())
      return "surface.formats: '" + format + "' is no format of meshes; expected ply, obj or glb";
  if (class_colours && !classes) return "surface.class_colours needs surface.classes: true";
  if (robot_lowest >= robot_highest)
    return "surface.robot_lowest is not below surface.robot_highest; between them surface is an obstacle";
  return {};
}

}  // namespace holdfast
