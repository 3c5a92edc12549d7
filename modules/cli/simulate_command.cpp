// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/cli/simulate_command.hpp"

#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <sstream>

#include "holdfast/cli/output_folder.hpp"
#include "holdfast/cli/terminal.hpp"
#include "holdfast/core/error.hpp"
#include "holdfast/core/version.hpp"
#include "holdfast/simulation/simulator.hpp"

namespace holdfast {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

namespace {

struct SimulateOptions {
  fs::path output;
  std::string room = "office";
  std::string path = "xyz";
  std::string camera = "tum_fr1";
  std::string colour_format = "png";
  bool overwrite = false;
  bool no_sensor_effects = false;
  simulation::SimulationSettings settings;
};

constexpr double depth_units_per_metre = 5000.0;  // of the TUM benchmark

void write_image(const fs::path& file, const cv::Mat& image, const std::vector<int>& parameters) {
  std::vector<std::uint8_t> bytes;
  if (!cv::imencode(file.extension().string(), image, bytes, parameters))
    throw InputError({file.string(), 0, 0}, "the image cannot be encoded");
  write_file_atomically(file, std::string(bytes.begin(), bytes.end()));
}

cv::Mat to_depth_units(const cv::Mat& depth) {
  cv::Mat units(depth.size(), CV_16UC1);
  for (int y = 0; y < depth.rows; ++y)
    for (int x = 0; x < depth.cols; ++x) {
      const double value = std::round(depth.at<float>(y, x) * depth_units_per_metre);
      units.at<std::uint16_t>(y, x) = value <= 65535.0 ? static_cast<std::uint16_t>(value) : 0;  // farther than 13 m
    }
  return units;
}

Json to_json(const Eigen::Isometry3d& pose) {
  const Eigen::Vector3d t = pose.translation();
  const Eigen::Quaterniond q(pose.linear());
  return {{"translation", {t.x(), t.y(), t.z()}}, {"quaternion_xyzw", {q.x(), q.y(), q.z(), q.w()}}};
}

Json to_json(const Camera& camera) {
  const Distortion& d = camera.distortion;
  return {{"name", camera.name},     {"width", camera.width},
          {"height", camera.height}, {"fx", camera.fx},
          {"fy", camera.fy},         {"cx", camera.cx},
          {"cy", camera.cy},         {"distortion_k1_k2_p1_p2_k3", {d.k1, d.k2, d.p1, d.p2, d.k3}}};
}

Json describe_scene(const simulation::Simulator& simulator) {
  const simulation::SimulationSettings& settings = simulator.settings();
  const simulation::DepthSensorSettings& depth = settings.depth_sensor;
  Json scene = {{"generator", "holdfast " HOLDFAST_VERSION},
                {"seed", settings.seed},
                {"room", simulation::to_string(settings.room)},
                {"path", simulation::to_string(settings.path)},
                {"duration_s", settings.duration},
                {"frame_rate_hz", settings.frame_rate},
                {"frames", simulator.frame_count()},
                {"depth_units_per_metre", depth_units_per_metre},
                {"camera", to_json(simulator.camera())},
                {"colour_noise", settings.colour_sensor.noise},
                {"depth_sensor",
                 {{"noise", depth.noise},
                  {"quantisation", depth.quantisation},
                  {"holes", depth.holes},
                  {"minimum_depth_m", depth.minimum_depth},
                  {"maximum_depth_m", depth.maximum_depth}}},
                {"classes", simulator.class_names()}};
  const simulation::World& world = simulator.world();
  Json& lamps = scene["lamps"] = Json::array();
  for (const simulation::Lamp& lamp : world.lamps)
    lamps.push_back(
        {{"position", {lamp.position.x(), lamp.position.y(), lamp.position.z()}}, {"brightness", lamp.brightness}});
  Json& objects = scene["objects"] = Json::array();
  for (std::size_t i = 0; i < world.objects.size(); ++i) {
    const simulation::Object& object = world.objects[i];
    Eigen::AlignedBox3f box;
    for (const simulation::Vertex& vertex : object.mesh.vertices) box.extend(vertex.position);
    objects.push_back({{"id", i + 1},
                       {"name", object.name},
                       {"class", object.class_name},
                       {"moves", object.moves()},
                       {"T_world_object", to_json(object.pose(0.0))},
                       {"box_minimum", {box.min().x(), box.min().y(), box.min().z()}},
                       {"box_maximum", {box.max().x(), box.max().y(), box.max().z()}},
                       {"triangles", object.mesh.triangles.size()}});
  }
  return scene;
}

void simulate(const SimulateOptions& options) {
  simulation::SimulationSettings settings = options.settings;
  settings.room = simulation::room_kind(options.room);
  settings.path = simulation::path_kind(options.path);
  if (options.no_sensor_effects) {
    settings.colour_sensor.noise = 0.0;
    settings.depth_sensor = {0.0, false, false, 0.0, 13.0};
  }
  const std::optional<Camera> camera = find_camera(options.camera);
  if (!camera) {
    std::string known;
    for (const std::string& name : camera_names()) known += (known.empty() ? "" : ", ") + name;
    throw Error("camera '" + options.camera + "' is not known; expected one of: " + known);
  }
  simulation::Simulator simulator(settings, *camera);
  // Lists first: what is left after an interruption names nothing that is gone.
  prepare_output_folder(options.output, options.overwrite,
                        {"rgb.txt", "depth.txt", "associations.txt", "groundtruth.txt", "scene.json", "rgb", "depth"});
  fs::create_directories(options.output / "rgb");
  fs::create_directories(options.output / "depth");

  std::ostringstream colour_list, depth_list, associations;
  colour_list << "# color images\n# timestamp filename\n";
  depth_list << "# depth maps\n# timestamp filename\n";
  {
    Progress progress(simulator.frame_count());
    for (std::uint64_t i = 0; i < simulator.frame_count(); ++i) {
      const SensorFrame frame = simulator.frame(i);
      char stamp[32];
      std::snprintf(stamp, sizeof(stamp), "%.6f", frame.timestamp);
      const std::string colour_name = "rgb/" + std::string(stamp) + "." + options.colour_format;
      const std::string depth_name = "depth/" + std::string(stamp) + ".png";
      write_image(options.output / colour_name, frame.colour,
                  options.colour_format == "png" ? std::vector<int>{cv::IMWRITE_PNG_COMPRESSION, 1}
                                                 : std::vector<int>{cv::IMWRITE_JPEG_QUALITY, 95});
      write_image(options.output / depth_name, to_depth_units(frame.depth), {cv::IMWRITE_PNG_COMPRESSION, 3});
      colour_list << stamp << ' ' << colour_name << '\n';
      depth_list << stamp << ' ' << depth_name << '\n';
      associations << stamp << ' ' << colour_name << ' ' << stamp << ' ' << depth_name << '\n';
      progress.update(i + 1);
    }
  }
  write_trajectory(options.output / "groundtruth.txt", simulator.truth());
  write_file_atomically(options.output / "scene.json", describe_scene(simulator).dump(2) + "\n");
  write_file_atomically(options.output / "associations.txt", associations.str());
  write_file_atomically(options.output / "depth.txt", depth_list.str());
  write_file_atomically(options.output / "rgb.txt", colour_list.str());
  std::cout << simulator.frame_count() << " frames written to " << options.output.string() << '\n';
}

}  // namespace

void add_simulate_command(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<SimulateOptions>();
  simulation::SimulationSettings& settings = options->settings;
  CLI::App* command =
      app.add_subcommand("simulate", "Write a sequence from the simulated room, in TUM layout with truth");
  command->add_option("--output", options->output, "folder to write to")->required();
  command->add_option("--room", options->room, "where the camera moves")
      ->check(CLI::IsMember(simulation::room_names()))
      ->capture_default_str();
  command->add_option("--path", options->path, "how the camera moves")
      ->check(CLI::IsMember(simulation::path_names()))
      ->capture_default_str();
  command->add_option("--duration", settings.duration, "length [s]")->check(CLI::PositiveNumber)->capture_default_str();
  command->add_option("--frame-rate", settings.frame_rate, "frames per second")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command->add_option("--seed", settings.seed, "of room, path and noise")->capture_default_str();
  command->add_option("--camera", options->camera, "name of a known camera")
      ->check(CLI::IsMember(camera_names()))
      ->capture_default_str();
  command->add_option("--colour-noise", settings.colour_sensor.noise, "standard deviation [grey levels]")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  command->add_option("--depth-noise", settings.depth_sensor.noise, "factor on a Kinect's depth noise")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  command->add_flag("--no-sensor-effects", options->no_sensor_effects,
                    "exact depth without holes, colour without noise");
  command->add_option("--colour-format", options->colour_format, "of the colour images")
      ->check(CLI::IsMember({"png", "jpg"}))
      ->capture_default_str();
  command->add_flag("--overwrite", options->overwrite, "replace a sequence in a folder that is not empty");
  command->callback([options, &exit_code] {
    simulate(*options);
    exit_code = 0;
  });
}

}  // namespace holdfast
