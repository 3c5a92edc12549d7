// SPDX-License-Identifier: BSD-3-Clause
#include "dataset_command.hpp"

#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>

#include "holdfast/bench/dataset_check.hpp"
#include "holdfast/bench/dataset_recipe.hpp"
#include "holdfast/bench/external_system.hpp"
#include "holdfast/core/error.hpp"
#include "holdfast/core/size_text.hpp"
#include "holdfast/core/trajectory.hpp"
#include "holdfast/evaluation/number_text.hpp"
#include "output_file.hpp"
#include "terminal.hpp"

namespace holdfast {

namespace {

namespace fs = std::filesystem;

struct DatasetArguments {
  std::string name;  ///< of a recipe
  fs::path folder, output;
  double max_time_difference = 0.02;
  bool overwrite = false;
};

const DatasetRecipe& required_recipe(const std::string& name) {
  const DatasetRecipe* recipe = find_recipe(name);
  if (recipe == nullptr) throw ConfigurationError(SourceLocation{"holdfast dataset"}, no_such_recipe(name));
  return *recipe;
}

/// The recipe that was named, or the one of the folder; nullptr when neither.
const DatasetRecipe* chosen_recipe(const DatasetArguments& arguments) {
  return arguments.name.empty() ? recipe_of_folder(arguments.folder) : &required_recipe(arguments.name);
}

std::string count_text(const std::optional<std::size_t>& count) { return count ? std::to_string(*count) : "unknown"; }

std::string camera_text(const Camera& camera) {
  const Distortion& d = camera.distortion;
  std::string text = camera.name + ", " + size_text(camera.width, camera.height) + ", fx " + shortest_text(camera.fx) +
                     " fy " + shortest_text(camera.fy) + " cx " + shortest_text(camera.cx) + " cy " +
                     shortest_text(camera.cy);
  if (d.is_zero()) return text;
  const bool is_fisheye = d.lens == Lens::fisheye;
  std::vector<const char*> names = {"k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"};
  if (is_fisheye) names = {"k1", "k2", "k3", "k4"};
  text += is_fisheye ? ", fisheye" : ",";
  const std::vector<double> coefficients = d.coefficients();
  for (std::size_t i = 0; i < coefficients.size(); ++i)
    text += std::string(" ") + names[i] + " " + shortest_text(coefficients[i]);
  return text;
}

/// Of a recording that contains the calibration of its camera.
bool has_depth(const DatasetRecipe& recipe) {
  return recipe.layout == DatasetLayout::openloris || recipe.layout == DatasetLayout::phone;
}

std::string files_text(const DatasetRecipe& recipe) {
  if (recipe.layout == DatasetLayout::kitti && recipe.dataset == "KITTI raw")
    return "image_00/ and image_01/ (grey) or image_02/ and image_03/ (colour), oxts/, ../calib_cam_to_cam.txt, "
           "../calib_velo_to_cam.txt, ../calib_imu_to_velo.txt";
  if (recipe.layout == DatasetLayout::kitti)
    return "calib.txt, times.txt, image_0/ and image_1/ (grey) or image_2/ and image_3/ (colour), ../../poses/" +
           recipe.folder + ".txt";
  if (recipe.layout == DatasetLayout::euroc && recipe.dataset == "TUM VI")
    return "mav0/cam0/, mav0/cam1/, mav0/mocap0/, dso/camchain.yaml";
  if (recipe.layout == DatasetLayout::four_seasons)
    return "times.txt, undistorted_images/cam0/, undistorted_images/cam1/, GNSSPoses.txt, ../calibration/";
  if (recipe.layout == DatasetLayout::euroc) return "mav0/cam0/, mav0/cam1/, mav0/state_groundtruth_estimate0/";
  if (recipe.layout == DatasetLayout::phone)
    return "metadata.json, rgb/, depth/ (Record3D), transforms.json (NeRFCapture) or odometry.csv, rgb.mp4 (Stray "
           "Scanner)";
  if (recipe.layout == DatasetLayout::openloris)
    return "color.txt, aligned_depth.txt, fisheye1.txt, fisheye2.txt, sensors.yaml, trans_matrix.yaml, groundtruth.txt";
  std::string text = recipe.layout == DatasetLayout::tum ? "rgb.txt, depth.txt" : "associations.txt";
  text += ", " + recipe.truth + ", rgb/, depth/";
  return recipe.has_masks ? text + ", mask.txt, mask/" : text;
}

void show_all() {
  const std::string* dataset = nullptr;
  for (const DatasetRecipe& recipe : dataset_recipes()) {
    if (dataset == nullptr || *dataset != recipe.dataset) {
      std::printf("%s%s\n  licence: %s\n  %s\n", dataset == nullptr ? "" : "\n",
                  green(recipe.dataset, STDOUT_FILENO).c_str(), recipe.licence.c_str(), recipe.address.c_str());
      if (!recipe.make.empty())
        std::printf("  to be made on your machine; `holdfast dataset list NAME` says by which command\n");
      dataset = &recipe.dataset;
    }
    std::printf("    %-42s %-9s %s\n", recipe.name.c_str(),
                brings_camera(recipe.layout) ? (has_depth(recipe) ? "depth" : "stereo") : recipe.camera.name.c_str(),
                recipe.pairs ? (std::to_string(*recipe.pairs) + " pairs").c_str() : "unknown number of pairs");
  }
}

void show(const DatasetRecipe& recipe) {
  std::printf("%s: %s\n", recipe.name.c_str(), recipe.dataset.c_str());
  const auto line = [](const char* what, const std::string& text) {
    if (!text.empty()) std::printf("  %-9s %s\n", what, text.c_str());
  };
  line("folder", recipe.folder);
  line("files", files_text(recipe));
  if (brings_camera(recipe.layout)) {
    line("camera", "of its own files");
    line("images", count_text(recipe.pairs) + (has_depth(recipe) ? " pairs" : " stereo pairs"));
    line("source", layout_name(recipe.layout));
  } else {
    const bool is_numbered = recipe.layout == DatasetLayout::icl_nuim;
    line("camera", camera_text(recipe.camera));
    line("images", count_text(recipe.colour) + " colour, " + count_text(recipe.depth) + " depth, " +
                       count_text(recipe.pairs) + (is_numbered ? " pairs" : " pairs within 0.02 s"));
    line("source", layout_name(recipe.layout));
  }
  if (recipe.truth_left || recipe.truth_right)
    line("truth", "of markers; a matrix with this recipe transforms it to the camera");
  line("licence", recipe.licence);
  line("cite", recipe.citation);
  line("from", recipe.address);
  line("make", recipe.make);
  line("remark", recipe.about);
}

void check(const DatasetArguments& arguments, int& exit_code) {
  const DatasetRecipe* recipe = chosen_recipe(arguments);
  const DatasetCheck result = check_dataset(arguments.folder, recipe);
  for (const std::string& fact : result.facts) std::printf("  %s\n", printable(fact).c_str());
  if (recipe == nullptr)
    std::printf(
        "  no recipe has a folder of this name: checked as a recording in the layout '%s'; --recipe names one\n",
        layout_name(layout_of(arguments.folder)));
  for (const std::string& problem : result.problems)
    std::printf("  %s %s\n", red("wrong:", STDOUT_FILENO).c_str(), printable(problem).c_str());
  const bool is_good = result.problems.empty();
  std::printf("%s %s\n", is_good ? green("ok", STDOUT_FILENO).c_str() : red("not usable", STDOUT_FILENO).c_str(),
              arguments.folder.c_str());
  exit_code = is_good ? 0 : 1;
}

void associate(const DatasetArguments& arguments, int& exit_code) {
  const DatasetRecipe* recipe = chosen_recipe(arguments);
  const fs::path output = arguments.output.empty() ? arguments.folder / "associations.txt" : arguments.output;
  require_new_files({output}, arguments.overwrite);
  RecordedSequence sequence;
  sequence.frames = dataset_pairs(arguments.folder, recipe ? recipe->layout : layout_of(arguments.folder),
                                  arguments.max_time_difference);
  write_file_atomically(output, associations_text(sequence));
  std::printf("%s: %s\n", counted(sequence.frames.size(), "pair").c_str(), printable(output.string()).c_str());
  exit_code = 0;
}

}  // namespace

void add_dataset_command(CLI::App& app, int& exit_code) {
  auto arguments = std::make_shared<DatasetArguments>();
  CLI::App* command = app.add_subcommand("dataset", "What recordings there are, and whether a folder holds one");
  command->require_subcommand(1);
  command->footer(
      "\nNothing is ever downloaded: addresses and commands are printed, for you to use.\n\n"
      "Examples\n"
      "  holdfast dataset list\n"
      "  holdfast dataset list fr3_walking_xyz\n"
      "  holdfast dataset check /data/rgbd_dataset_freiburg3_walking_xyz");

  CLI::App* list = command->add_subcommand("list", "Known recordings: camera, files, licence, where to get them");
  list->footer(
      "\nExamples\n"
      "  holdfast dataset list\n"
      "  holdfast dataset list w21          how to compose this sequence");
  list->add_option("NAME", arguments->name, "All that is known of one recording");
  list->callback([arguments, &exit_code] {
    arguments->name.empty() ? show_all() : show(required_recipe(arguments->name));
    exit_code = 0;
  });

  CLI::App* check_app = command->add_subcommand("check", "Does a folder hold a recording, whole?");
  check_app->footer(
      "\nAre the lists there, is every image that they list, has each its end and the size of the camera, do some of\n"
      "them decode, does the truth cover them, are there as many as there should be, has every image of a composed\n"
      "sequence its mask. Exits 1 when something is wrong.\n\n"
      "Examples\n"
      "  holdfast dataset check /data/rgbd_dataset_freiburg1_xyz\n"
      "  holdfast dataset check /data/my_copy --recipe fr1_xyz");
  CLI::App* associate_app = command->add_subcommand("associate", "Write the pairs of a recording for other programs");
  associate_app->footer(
      "\nLines 'colour_stamp colour_file depth_stamp depth_file': the frames that `source: tum` gives.\n\n"
      "Examples\n"
      "  holdfast dataset associate /data/rgbd_dataset_freiburg1_xyz\n"
      "  holdfast dataset associate /data/living_room_traj0_frei_png --output "
      "/data/living_room_traj0_frei_png/pairs.txt");
  for (CLI::App* each : {check_app, associate_app}) {
    each->add_option("FOLDER", arguments->folder, "Folder of the recording")->required();
    each->add_option("--recipe", arguments->name, "What it should be; else the recipe with this folder's name")
        ->type_name("NAME");
  }
  check_app->callback([arguments, &exit_code] { check(*arguments, exit_code); });
  associate_app->add_option("-o,--output", arguments->output, "File to write instead of FOLDER/associations.txt")
      ->type_name("FILE");
  associate_app
      ->add_option("--max-time-difference", arguments->max_time_difference,
                   "Images whose stamps differ by less may make a pair [s]")
      ->check(CLI::Range(1e-6, 1.0))
      ->capture_default_str();
  add_overwrite_option(*associate_app, arguments->overwrite);
  associate_app->callback([arguments, &exit_code] { associate(*arguments, exit_code); });
}

}  // namespace holdfast
