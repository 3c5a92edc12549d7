// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate_surface_command.hpp"

#include <unistd.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <functional>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "holdfast/core/association.hpp"
#include "holdfast/core/error.hpp"
#include "holdfast/core/nearest_rotation.hpp"
#include "holdfast/core/trajectory.hpp"
#include "holdfast/map_io/map_file.hpp"
#include "holdfast/surface/mesh_files.hpp"
#include "holdfast/surface/observed_space.hpp"
#include "holdfast/surface/surface_evaluation.hpp"
#include "holdfast/surface/surface_views.hpp"
#include "output_file.hpp"
#include "positive_number.hpp"
#include "terminal.hpp"
#include "usage_error.hpp"

namespace holdfast {

namespace {

struct EvaluateSurfaceArguments {
  std::string truth, mesh, seen, truth_run;
  std::string truth_trajectory, trajectory;
  std::string json, csv, errors_to;
  double error_scale = 0.05;
  bool overwrite = false;
  SurfaceEvaluationOptions options;
};

constexpr const char* evaluate_surface_explanation = R"(
Meshes are PLY files of any program, in metres. Of a simulated scene `holdfast simulate SCENE --surface TRUTH
--seen-surface SEEN` writes the truth.

Definitions
  accuracy          mean distance from the estimate to the truth
  completion        mean distance from the truth (of --seen if given) to the estimate
  precision         share of the estimate within --threshold of the truth
  completion ratio  share of the truth within --threshold of the estimate
  F-score           harmonic mean of both
  Chamfer           mean of accuracy and completion
  ghosts            share of the estimate farther than --ghost-distance from the truth
  thickness         with --thickness: distance between the outermost estimated surfaces along the normal of the truth,
                    searched up to that distance on both sides; above 0 where drift doubled a wall. Of the places at
                    which one true surface and an estimated one face the same side
  unobserved        with --truth-run, the folder of the run with surface.keep_depth that made TRUTH: share of the estimate
                    that is not compared, because it lies beyond a border of TRUTH, where that run did not look. Its
                    nearest place is on the border, farther than --threshold, and no view of the run looked through it
Distances are exact, from points with a distance of --spacing on one surface to the triangles of the other.

Both meshes must be in one world frame, unless the trajectories in both frames are given: the rigid motion that
aligns their poses, rotations included, is then applied to MESH.

Examples
  holdfast evaluate-surface room.ply out/surface.ply --seen seen.ply \
    --truth-trajectory groundtruth.txt --trajectory out/trajectory.txt
  holdfast evaluate-surface without/surface.ply with/surface.ply --threshold 0.02 --truth-run without \
    --truth-trajectory without/trajectory.txt --trajectory with/trajectory.txt
  holdfast evaluate-surface room.ply out/surface.ply --errors errors.ply
)";

/// The rigid motion from the frame of one trajectory to that of the other, from their rotations (chordal mean) and,
/// given it, from their positions.
Eigen::Isometry3d alignment_of(const Trajectory& truth, const Trajectory& estimate) {
  constexpr double max_difference = 0.02;  // [s]
  std::vector<double> truth_stamps, stamps;
  for (const TimedPose& pose : truth) truth_stamps.push_back(pose.timestamp);
  for (const TimedPose& pose : estimate) stamps.push_back(pose.timestamp);
  const auto pairs = associate_stamps(truth_stamps, stamps, max_difference);
  if (pairs.empty()) throw Error("the trajectories share no time stamp within 0.02 s; expected those of one recording");
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (const auto& [i, j] : pairs)
    sum += truth[i].T_world_camera.linear() * estimate[j].T_world_camera.linear().transpose();
  Eigen::Isometry3d alignment = Eigen::Isometry3d::Identity();
  alignment.linear() = nearest_rotation(sum);
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();
  for (const auto& [i, j] : pairs)
    offset += truth[i].T_world_camera.translation() - alignment.linear() * estimate[j].T_world_camera.translation();
  alignment.translation() = offset / static_cast<double>(pairs.size());
  return alignment;
}

void transform(TriangleMesh& mesh, const Eigen::Isometry3d& motion) {
  const Eigen::Isometry3f single = motion.cast<float>();
  for (MeshVertex& vertex : mesh.vertices) {
    vertex.position = single * vertex.position;
    vertex.normal = single.linear() * vertex.normal;
  }
}

ObservedSpace observed_space_of(const std::filesystem::path& run) {
  const Map map = read_map(run / "map.hfm");
  return ObservedSpace(read_views(run / "surface_views", map), map);
}

void evaluate(const EvaluateSurfaceArguments& arguments) {
  if (arguments.truth_trajectory.empty() != arguments.trajectory.empty())
    throw UsageError("--truth-trajectory and --trajectory belong together; give both, or none");
  if (arguments.json == "-" && arguments.csv == "-")
    throw UsageError("--json and --csv cannot both go to standard output; give one of them a file");
  if (!arguments.errors_to.empty()) require_mesh_name(arguments.errors_to);
  require_new_files({arguments.json, arguments.csv, arguments.errors_to}, arguments.overwrite);
  const TriangleMesh truth = read_mesh(arguments.truth);
  const TriangleMesh seen = arguments.seen.empty() ? TriangleMesh() : read_mesh(arguments.seen);
  TriangleMesh mesh = read_mesh(arguments.mesh);
  if (!arguments.trajectory.empty())
    transform(mesh, alignment_of(read_trajectory(arguments.truth_trajectory), read_trajectory(arguments.trajectory)));
  std::optional<ObservedSpace> space;
  if (!arguments.truth_run.empty()) space.emplace(observed_space_of(arguments.truth_run));
  const auto is_free = [&](const Eigen::Vector3d& point) { return space->is_free(point); };
  const SurfaceEvaluation result =
      evaluate_surface(truth, arguments.seen.empty() ? truth : seen, mesh, arguments.options,
                       space ? std::function<bool(const Eigen::Vector3d&)>(is_free) : nullptr);
  if (arguments.json != "-" && arguments.csv != "-") std::cout << bold_labels(to_text(result), STDOUT_FILENO);
  if (!arguments.json.empty()) write_output(arguments.json, to_json(result));
  if (!arguments.csv.empty()) write_output(arguments.csv, to_csv(result));
  if (arguments.errors_to.empty()) return;
  colour_by_error(mesh, truth, arguments.error_scale);
  write_mesh(arguments.errors_to, mesh);
}

}  // namespace

void add_evaluate_surface_command(CLI::App& app, int& exit_code) {
  const auto arguments = std::make_shared<EvaluateSurfaceArguments>();
  CLI::App* command = app.add_subcommand("evaluate-surface", "Compare a mesh of the room with the true one");
  command->footer(evaluate_surface_explanation);
  command->add_option("TRUTH", arguments->truth, "The true surface (PLY)")->required();
  command->add_option("MESH", arguments->mesh, "The estimated surface (PLY)")->required();
  command->add_option("--seen", arguments->seen, "The part of the truth that can be complete (PLY); otherwise all")
      ->type_name("FILE");
  command
      ->add_option("--truth-run", arguments->truth_run,
                   "Folder of the run that made TRUTH; the estimate beyond what it observed is not compared")
      ->type_name("FOLDER");
  command->add_option("--truth-trajectory", arguments->truth_trajectory, "Poses in the frame of TRUTH, TUM format")
      ->type_name("FILE");
  command->add_option("--trajectory", arguments->trajectory, "The same poses in the frame of MESH")->type_name("FILE");
  command->add_option("--threshold", arguments->options.threshold, "Distance that counts as right [m]")
      ->check(positive_number())
      ->capture_default_str();
  command->add_option("--ghost-distance", arguments->options.ghost_distance, "Beyond it surface is a ghost [m]")
      ->check(positive_number())
      ->capture_default_str();
  command
      ->add_option("--thickness", arguments->options.thickness_reach,
                   "Also measure how thick surfaces are, up to this distance from the truth [m]")
      ->type_name("DISTANCE")
      ->check(positive_number());
  command->add_option("--spacing", arguments->options.spacing, "Of the points that are compared [m]")
      ->check(CLI::Range(0.001, 10.0))
      ->capture_default_str();
  command->add_option("--errors", arguments->errors_to, "Also write MESH, coloured by its error (.ply, .obj, .glb)")
      ->type_name("FILE");
  command->add_option("--error-scale", arguments->error_scale, "Error that is red in it [m]; 0 is blue")
      ->check(positive_number())
      ->capture_default_str();
  command->add_option("--json", arguments->json, "Also write the figures as JSON; '-': to standard output, no table")
      ->type_name("FILE");
  command->add_option("--csv", arguments->csv, "Also write the figures as CSV; '-': to standard output, no table")
      ->type_name("FILE");
  add_overwrite_option(*command, arguments->overwrite);
  command->callback([arguments, &exit_code] {
    evaluate(*arguments);
    exit_code = 0;
  });
}

}  // namespace holdfast
