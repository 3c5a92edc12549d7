// SPDX-License-Identifier: BSD-3-Clause
#include "simulate_command.hpp"

#include <unistd.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "holdfast/core/error.hpp"
#include "holdfast/simulation/scene_file.hpp"
#include "holdfast/simulation/simulator.hpp"
#include "holdfast/surface/mesh_files.hpp"
#include "installed_files.hpp"
#include "output_file.hpp"
#include "output_folder.hpp"
#include "positive_number.hpp"
#include "scene_preview.hpp"
#include "sequence_writer.hpp"
#include "simulated_surface.hpp"
#include "terminal.hpp"
#include "usage_error.hpp"

namespace holdfast {

namespace {

struct SimulateArguments {
  std::filesystem::path scene;
  std::filesystem::path output;
  std::filesystem::path preview;
  std::filesystem::path surface, seen_surface;
  double surface_depth = 4.0;
  std::optional<double> surface_time;
  std::vector<std::string> overrides;
  std::string camera = "tum_fr1";
  std::string colour_format = "png";
  std::optional<std::string> path, duration, frame_rate, seed;
  bool overwrite = false;
  bool no_sensor_effects = false;
  bool quiet = false;
};

/// What the options say, as overrides of the scene: those with a name of their own first.
std::vector<std::string> all_overrides(const SimulateArguments& arguments) {
  std::vector<std::string> overrides;
  const auto add = [&](const char* key, const std::optional<std::string>& value) {
    if (value) overrides.push_back(std::string(key) + "=" + *value);
  };
  add("camera.path", arguments.path);
  add("duration", arguments.duration);
  add("frame_rate", arguments.frame_rate);
  add("seed", arguments.seed);
  if (arguments.no_sensor_effects) {
    overrides.emplace_back("colour_sensor={ noise: 0 }");
    overrides.emplace_back(
        "depth_sensor={ noise: 0, quantisation: false, holes: false, edge_holes: 0, minimum_depth: 0, "
        "maximum_depth: 13 }");
  }
  overrides.insert(overrides.end(), arguments.overrides.begin(), arguments.overrides.end());
  return overrides;
}

void write_surfaces(const SimulateArguments& arguments, simulation::Simulator& simulator) {
  const SimulatedSurface surface = simulated_surface(simulator, arguments.surface_depth, arguments.surface_time);
  if (!arguments.surface.empty()) write_mesh(arguments.surface, surface.all);
  if (!arguments.seen_surface.empty()) write_mesh(arguments.seen_surface, surface.seen);
}

int simulate(const SimulateArguments& arguments) {
  const bool has_surface = !arguments.surface.empty() || !arguments.seen_surface.empty();
  if (arguments.output.empty() && arguments.preview.empty() && !has_surface)
    throw UsageError(
        "nothing to write; expected --output FOLDER, --preview FILE.png, --surface FILE.ply, or several of them");
  for (const std::filesystem::path& file : {arguments.surface, arguments.seen_surface})
    if (!file.empty()) require_mesh_name(file);
  require_new_files({arguments.surface, arguments.seen_surface}, arguments.overwrite);
  const std::optional<Camera> camera = find_camera(arguments.camera);
  if (!camera) {
    std::string known;
    for (const std::string& name : camera_names()) known += (known.empty() ? "" : ", ") + name;
    throw UsageError("camera '" + arguments.camera + "' is not known; expected one of: " + known);
  }
  simulation::Scene scene =
      simulation::read_scene(find_file(arguments.scene.string(), InstalledFolder::scenes), all_overrides(arguments));
  if (scene.seed == 0) scene.seed = 1;
  simulation::Simulator simulator(scene, *camera);
  if (!arguments.preview.empty())
    write_image_atomically(arguments.preview, scene_preview(simulator), {}, Durability::now);
  if (has_surface) write_surfaces(arguments, simulator);
  if (arguments.output.empty()) return 0;
  const FolderLock lock = prepare_output_folder(arguments.output, arguments.overwrite, SequenceWriter::entries());
  SequenceWriter writer(simulator, arguments.output, arguments.colour_format);
  catch_interrupts();
  {
    Progress progress(simulator.frame_count(), arguments.quiet);
    for (std::uint64_t i = 0; i < simulator.frame_count() && !interrupted(); ++i) {
      writer.write(simulator.frame(i));
      progress.update(i + 1);
    }
  }
  writer.finish();
  if (!arguments.quiet || interrupted())
    std::cout << (interrupted() ? "interrupted: " : "") << writer.frame_count() << " of " << simulator.frame_count()
              << " frames written to " << arguments.output.string() << '\n';
  return interrupted() ? interrupted_exit_code() : 0;
}

}  // namespace

void add_simulate_command(CLI::App& app, int& exit_code) {
  auto arguments = std::make_shared<SimulateArguments>();
  CLI::App* command =
      app.add_subcommand("simulate", "Write a sequence from a simulated scene, in TUM layout with exact truth");
  command->footer(
      "\nScenes are short YAML files; docs/scenes.md explains them, 'holdfast modules scene' lists all they can say.\n"
      "Without a scene: the empty office.\n\n"
      "Examples\n"
      "  holdfast simulate examples/scenes/walking_xyz.yaml --output out/walking_xyz\n"
      "  holdfast simulate examples/scenes/crowd.yaml --preview crowd.png\n"
      "  holdfast simulate examples/scenes/crowd.yaml --seed 7 --camera tum_fr3 --output out/crowd\n"
      "  holdfast simulate examples/scenes/walking_xyz.yaml --set people.0.do.0.walk.speed=0.6 --output out/slow\n"
      "  holdfast simulate examples/scenes/crowd.yaml --surface room.ply --seen-surface seen.ply\n"
      "  holdfast simulate --path halfsphere --duration 10 --no-sensor-effects --output out/empty");
  command->add_option("SCENE", arguments->scene,
                      "scene file (YAML), or the name of an installed one, such as crowd; '-': standard input");
  command->add_option("-o,--output", arguments->output, "folder to write to");
  command->add_option("--preview", arguments->preview,
                      "image file (PNG) with frames of the scene and its floor plan; without --output nothing else");
  command
      ->add_option("--surface", arguments->surface,
                   "mesh of the room without people (.ply, .obj, .glb), moved objects where they are at the end")
      ->type_name("FILE");
  command->add_option("--seen-surface", arguments->seen_surface, "the part of it that the camera sees")
      ->type_name("FILE");
  command->add_option("--surface-depth", arguments->surface_depth, "largest depth at which it is seen [m]")
      ->check(positive_number())
      ->capture_default_str();
  command
      ->add_option("--surface-time", arguments->surface_time,
                   "time of both surfaces [s], for what moves and what was seen by then (default: the end)")
      ->check(CLI::NonNegativeNumber);
  command->add_option("--set", arguments->overrides, "override a value of the scene: key.path=value; may be repeated")
      ->allow_extra_args(false);
  command->add_option("--seed", arguments->seed, "of textures, small things, people, path and noise (default 1)");
  command->add_option("--path", arguments->path, "how the camera moves (default: as the scene says)")
      ->check(CLI::IsMember(simulation::path_names()));
  command->add_option("--duration", arguments->duration, "length [s] (default: as the scene says)")
      ->check(positive_number());
  command->add_option("--frame-rate", arguments->frame_rate, "frames per second (default: as the scene says)")
      ->check(positive_number());
  command->add_option("--camera", arguments->camera, "name of a known camera")
      ->check(CLI::IsMember(camera_names()))
      ->capture_default_str();
  command->add_flag("--no-sensor-effects", arguments->no_sensor_effects,
                    "exact depth without holes, colour without noise; depth files end at 13 m");
  command->add_option("--colour-format", arguments->colour_format, "of the colour images")
      ->check(CLI::IsMember({"png", "jpg"}))
      ->capture_default_str();
  command->add_flag("--overwrite", arguments->overwrite, "replace a sequence in a folder that is not empty");
  command->add_flag("-q,--quiet", arguments->quiet, "no progress, no summary");
  command->callback([arguments, &exit_code] { exit_code = simulate(*arguments); });
}

}  // namespace holdfast
