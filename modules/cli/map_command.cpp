// SPDX-License-Identifier: BSD-3-Clause
#include "map_command.hpp"

#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "holdfast/core/error.hpp"
#include "holdfast/map_io/map_export.hpp"
#include "holdfast/map_io/map_file.hpp"
#include "holdfast/map_io/map_info.hpp"
#include "holdfast/surface/class_colours.hpp"
#include "holdfast/surface/decimation.hpp"
#include "holdfast/surface/mesh_files.hpp"
#include "holdfast/surface/surface_field.hpp"
#include "holdfast/surface/surface_views.hpp"
#include "output_file.hpp"
#include "terminal.hpp"
#include "usage_error.hpp"

namespace holdfast {

namespace {

struct MapArguments {
  std::string file;
  bool json = false, overwrite = false;
  std::string points_to, trajectory_to, json_to, mesh_to;
  std::vector<std::string> views;  // folders; empty = beside the map
  double voxel = 0.0;              // [m]; 0 = as in the run
  int triangles = 0;               // most of the mesh; 0 = all
  bool class_colours = false;
  std::optional<double> until;  // time stamp of the last view of the mesh
};

constexpr const char* map_explanation = R"(
A map (.hfm) is written by `holdfast run` into its results folder. Its layout and the members of
the JSON are described in docs/map_format.md.

Examples
  holdfast map info out/map.hfm
  holdfast map export out/map.hfm --points points.ply --trajectory keyframes.txt
)";

constexpr const char* info_explanation = R"(
Every checksum in the file is verified; a file that is cut off, damaged or of a newer format is an
error that says so.

Examples
  holdfast map info out/map.hfm
  holdfast map info out/map.hfm --json
)";

constexpr const char* export_explanation = R"(
  points      binary PLY: x y z [m], nx ny nz towards the cameras, observations, static_log_odds
  trajectory  poses of the keyframes in TUM format: timestamp tx ty tz qx qy qz qw
  json        cameras, keyframes, covisibility edges, loops, points with their observations
  mesh        surface of the static scene, as the ending says: .ply, .obj or .glb (glTF 2.0), from the depth that a
              run with surface.keep_depth=true leaves beside its map; see docs/surface.md

'-' in place of a file other than the mesh: to standard output; at most one of them.

Examples
  holdfast map export out/map.hfm --points points.ply
  holdfast map export out/map.hfm --trajectory keyframes.txt --json map.json
  holdfast map export out/map.hfm --json - | jq '.points | length'
  holdfast map export out/map.hfm --mesh room.glb --voxel 0.01
)";

void show_info(const MapArguments& arguments) {
  const MapInfo info = read_map_info(arguments.file);
  std::cout << (arguments.json ? to_json(info) : printable(to_text(info)));
}

TriangleMesh mesh_of(const Map& map, const MapArguments& arguments) {
  if (!SurfaceField::is_available())
    throw Error("this program was built without OpenVDB, which meshes need; see docs/surface.md");
  const std::filesystem::path beside = std::filesystem::path(arguments.file).parent_path() / "surface_views";
  SurfaceViews views =
      read_views(arguments.views.empty() ? beside : std::filesystem::path(arguments.views.front()), map);
  for (std::size_t i = 1; i < arguments.views.size(); ++i) views.append(read_views(arguments.views[i], map));
  if (views.left_out > 0)
    print_warning(std::to_string(views.left_out) + " of " + std::to_string(views.left_out + views.views.size()) +
                  " views are left out, because their keyframes are not in the map; are they of another run?");
  if (arguments.until)
    std::erase_if(views.views, [&](const KeptView& view) { return view.timestamp > *arguments.until; });
  if (views.views.empty()) throw Error("no view is as old as --until; expected a time stamp of the recording [s]");
  if (arguments.class_colours && views.classes.empty())
    throw Error("the views have no classes, which --class-colours needs; run again with surface.classes=true");
  if (arguments.voxel > 0.0) views.settings.voxel = arguments.voxel;
  Progress progress(views.views.size());
  TriangleMesh mesh = fuse(views, map, [&](std::size_t done) { progress.update(done, "fused"); });
  if (mesh.empty()) throw Error("the views show no surface up to surface.maximum_depth; no mesh is written");
  if (arguments.triangles > 0) decimate(mesh, static_cast<std::size_t>(arguments.triangles));
  if (arguments.class_colours) colour_by_class(mesh);
  return mesh;
}

void export_map(const MapArguments& arguments) {
  int given = 0, to_output = 0;
  for (const std::string* target :
       {&arguments.points_to, &arguments.trajectory_to, &arguments.json_to, &arguments.mesh_to}) {
    given += target->empty() ? 0 : 1;
    to_output += *target == "-" ? 1 : 0;
  }
  if (given == 0) throw UsageError("nothing to export; name at least one of --points, --trajectory, --json, --mesh");
  if (to_output > 1) throw UsageError("only one export can go to standard output; give the others a file");
  if (!arguments.mesh_to.empty()) require_mesh_name(arguments.mesh_to);
  require_new_files({arguments.points_to, arguments.trajectory_to, arguments.json_to, arguments.mesh_to},
                    arguments.overwrite);
  const Map map = read_map(arguments.file);
  if (!arguments.points_to.empty()) write_output(arguments.points_to, points_ply(map));
  if (!arguments.trajectory_to.empty())
    write_output(arguments.trajectory_to, trajectory_text(keyframe_trajectory(map)));
  if (!arguments.json_to.empty()) write_output(arguments.json_to, map_json(map));
  if (!arguments.mesh_to.empty()) write_mesh(arguments.mesh_to, mesh_of(map, arguments));
}

template <class Function>
void answer(CLI::App* command, const std::shared_ptr<MapArguments>& arguments, int& exit_code, Function function) {
  command->add_option("FILE", arguments->file, "The map")->required();
  command->callback([arguments, &exit_code, function] {
    function(*arguments);
    exit_code = 0;
  });
}

}  // namespace

void add_map_command(CLI::App& app, int& exit_code) {
  const auto arguments = std::make_shared<MapArguments>();
  CLI::App* command = app.add_subcommand("map", "Show what a saved map holds, or export it for other programs");
  command->require_subcommand(1);
  command->footer(map_explanation);

  CLI::App* info = command->add_subcommand("info", "Print cameras, counts, time span and extent of a map");
  info->footer(info_explanation);
  info->add_flag("--json", arguments->json, "Print them as JSON");
  answer(info, arguments, exit_code, show_info);

  CLI::App* exporting =
      command->add_subcommand("export", "Write points, keyframes or a mesh for other programs, or all as JSON");
  exporting->footer(export_explanation);
  exporting->add_option("--points", arguments->points_to, "Points as PLY")->type_name("FILE");
  exporting->add_option("--trajectory", arguments->trajectory_to, "Poses of the keyframes")->type_name("FILE");
  exporting->add_option("--json", arguments->json_to, "Keyframes, edges and points")->type_name("FILE");
  CLI::Option* mesh = exporting->add_option("--mesh", arguments->mesh_to, "Surface of the static scene");
  mesh->type_name("FILE");
  exporting->add_option("--voxel", arguments->voxel, "Side of a voxel of the mesh [m]; otherwise that of the run")
      ->type_name("METRES")
      ->check(CLI::Range(0.002, 0.5))
      ->needs(mesh);
  exporting->add_option("--triangles", arguments->triangles, "Largest number of triangles of the mesh; otherwise all")
      ->check(CLI::Range(1, 1'000'000'000))
      ->needs(mesh);
  exporting->add_flag("--class-colours", arguments->class_colours, "Colour the mesh by the classes of surface.classes")
      ->needs(mesh);
  exporting
      ->add_option("--until", arguments->until,
                   "Time stamp of the last view: the surface as it was then; otherwise all")
      ->type_name("SECONDS")
      ->needs(mesh);
  exporting
      ->add_option("--views", arguments->views,
                   "Kept depth of the mesh, once for each run that the map was made by, oldest first; "
                   "otherwise surface_views beside FILE")
      ->type_name("FOLDER")
      ->allow_extra_args(false)
      ->needs(mesh);
  add_overwrite_option(*exporting, arguments->overwrite);
  answer(exporting, arguments, exit_code, export_map);
}

}  // namespace holdfast
