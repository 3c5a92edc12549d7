// SPDX-License-Identifier: BSD-3-Clause
#include "sequence_writer.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <utility>

#include "holdfast/core/error.hpp"
#include "holdfast/core/input_file.hpp"
#include "holdfast/core/version.hpp"

namespace holdfast {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

namespace {

Json to_json(const Eigen::Isometry3d& pose) {
  const Eigen::Vector3d t = pose.translation();
  const Eigen::Quaterniond q(pose.linear());
  return {{"translation", {t.x(), t.y(), t.z()}}, {"quaternion_xyzw", {q.x(), q.y(), q.z(), q.w()}}};
}

Json to_json(const Camera& camera) {
  const Distortion& d = camera.distortion;
  Json json = {{"name", camera.name},     {"width", camera.width},
               {"height", camera.height}, {"fx", camera.fx},
               {"fy", camera.fy},         {"cx", camera.cx},
               {"cy", camera.cy},         {"distortion_k1_k2_p1_p2_k3", {d.k1, d.k2, d.p1, d.p2, d.k3}}};
  if (d.lens == Lens::radial_tangential && !d.is_rational()) return json;
  json["distortion_k4_k5_k6"] = {d.k4, d.k5, d.k6};
  json["lens"] = lens_name(d.lens);
  return json;
}

/// Values of a parameter table, as a scene file would name them.
template <class Settings>
Json to_json(const Settings& settings, const ParameterTable<Settings>& table) {
  Json json = Json::object();
  for (const auto& [name, value] : table.values(settings))
    std::visit(
        [&json, &name = name](const auto& v) {
          if constexpr (!std::is_same_v<std::decay_t<decltype(v)>, TextMap>) json[name] = v;
        },
        value);
  return json;
}

/// A text with its quotes; bytes that are not UTF-8 are replaced.
std::string quoted(const std::string& text) { return Json(text).dump(-1, ' ', false, Json::error_handler_t::replace); }

/// So that the sequence can be made again; "" where there is no file.
std::string content_of(const std::string& file) {
  return file.empty() ? "" : file_content(file, largest_file::configuration, "a scene");
}

}  // namespace

const std::vector<std::string>& SequenceWriter::entries() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all = RecordingWriter::entries();
    for (const char* name : {"mask.txt", "labels.txt", "scene.json", "objects.json", "mask", "labels"})
      all.emplace_back(name);
    return all;
  }();
  return names;
}

SequenceWriter::SequenceWriter(const simulation::Simulator& simulator, fs::path folder, std::string colour_format)
    : simulator_(simulator),
      folder_(std::move(folder)),
      recording_(folder_, {.colour_format = std::move(colour_format),
                           .stamps = RecordingWriter::Stamps::microseconds,
                           .has_global_shutter = true}),
      mask_list_("# object masks: 0 = static world, k = object k of objects.json\n# timestamp filename\n"),
      label_list_("# class labels: index into the classes of scene.json\n# timestamp filename\n") {
  for (const char* name : {"mask", "labels"}) fs::create_directories(folder_ / name);
}

void SequenceWriter::write(const SensorFrame& frame) {
  recording_.add(frame);
  const std::string name = recording_.stamp_name(frame.timestamp), png = name + ".png";
  const FrameTruth& truth = *frame.truth;
  write_image_atomically(folder_ / "mask" / png, truth.object_mask, {cv::IMWRITE_PNG_COMPRESSION, 3});
  write_image_atomically(folder_ / "labels" / png, truth.class_labels, {cv::IMWRITE_PNG_COMPRESSION, 3});
  mask_list_ += name + " mask/" + png + "\n";
  label_list_ += name + " labels/" + png + "\n";
  truth_.push_back({frame.timestamp, *truth.T_world_camera});

  std::array<int, 256> pixels{};
  for (int y = 0; y < truth.object_mask.rows; ++y) {
    const auto* numbers = truth.object_mask.ptr<std::uint8_t>(y);
    for (int x = 0; x < truth.object_mask.cols; ++x) ++pixels[numbers[x]];
  }
  std::vector<ObjectState>& states = states_.emplace_back();
  for (const simulation::NumberedObject& numbered : simulator_.numbered_objects()) {
    const bool moving = std::binary_search(truth.moving_objects.begin(), truth.moving_objects.end(), numbered.number);
    states.push_back({simulator_.object(numbered).pose(frame.timestamp), moving, pixels[numbered.number]});
  }
}

std::string SequenceWriter::objects_json() const {
  // A row of numbers for each frame, on one line: easy to read for people and for programs.
  const std::vector<simulation::NumberedObject>& numbered = simulator_.numbered_objects();
  std::string text =
      "{\n  \"columns\": [\"timestamp\", \"x\", \"y\", \"z\", \"qx\", \"qy\", \"qz\", \"qw\", \"moving\", "
      "\"pixels\"],\n";
  text += "  \"pose\": \"T_world_object [m]; the origin is the middle of the underside (a door: on its hinge)\",\n";
  text += "  \"objects\": [";
  for (std::size_t k = 0; k < numbered.size(); ++k) {
    const simulation::Object& object = simulator_.object(numbered[k]);
    const std::vector<std::string>& names = simulator_.class_names();
    const auto label = std::find(names.begin(), names.end(), object.class_name) - names.begin();
    text += std::string(k == 0 ? "" : ",") + "\n    {\"number\": " + std::to_string(numbered[k].number) +
            ", \"name\": " + quoted(object.name) + ", \"class\": " + quoted(object.class_name) +
            ", \"label\": " + std::to_string(label) + ", \"rows\": [";
    for (std::size_t i = 0; i < states_.size(); ++i) {
      const ObjectState& state = states_[i][k];
      const Eigen::Vector3d t = state.pose.translation();
      const Eigen::Quaterniond q(state.pose.linear());
      char row[256];
      std::snprintf(row, sizeof(row), "%s\n      [%.6f, %.6f, %.6f, %.6f, %.8f, %.8f, %.8f, %.8f, %d, %d]",
                    i == 0 ? "" : ",", truth_[i].timestamp, t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w(),
                    state.moving ? 1 : 0, state.pixels);
      text += row;
    }
    text += "\n    ]}";
  }
  return text + "\n  ]\n}\n";
}

std::string SequenceWriter::scene_json() const {
  const simulation::Scene& scene = simulator_.scene();
  Json json = {{"generator", "holdfast " HOLDFAST_VERSION},
               {"scene", scene.name},
               {"file_content", content_of(scene.file)},
               {"overrides", scene.overrides},
               {"seed", scene.seed},
               {"room", scene.place_name()},
               {"path", simulation::to_string(scene.camera.path)},
               {"duration_s", scene.duration},
               {"frame_rate_hz", scene.frame_rate},
               {"frames", truth_.size()},
               {"depth_units_per_metre", RecordingWriter::depth_units_per_metre},
               {"camera", to_json(simulator_.camera())},
               {"colour_sensor", to_json(scene.colour_sensor, {})},
               {"depth_sensor", to_json(scene.depth_sensor, {})},
               {"classes", simulator_.class_names()}};
  if (scene.visit > 1) json["visit"] = scene.visit;
  Json& dark = json["lights_out"] = Json::array();
  for (const simulation::LightsOut& lights : scene.lights_out)
    dark.push_back({{"from", lights.from}, {"to", lights.to}});
  const simulation::World& world = simulator_.world();
  Json& lamps = json["lamps"] = Json::array();
  for (const simulation::Lamp& lamp : world.lamps)
    lamps.push_back(
        {{"position", {lamp.position.x(), lamp.position.y(), lamp.position.z()}}, {"brightness", lamp.brightness}});
  Json& objects = json["objects"] = Json::array();
  for (std::size_t i = 0; i < world.objects.size(); ++i) {
    const simulation::Object& object = world.objects[i];
    Eigen::AlignedBox3f box;
    for (const simulation::Vertex& vertex : object.mesh.vertices) box.extend(vertex.position);
    const auto numbered =
        std::find_if(simulator_.numbered_objects().begin(), simulator_.numbered_objects().end(),
                     [&](const simulation::NumberedObject& candidate) { return candidate.index == i; });
    objects.push_back({{"name", object.name},
                       {"class", object.class_name},
                       {"number", numbered == simulator_.numbered_objects().end() ? 0 : numbered->number},
                       {"T_world_object", to_json(object.pose(0.0))},
                       {"box_minimum", {box.min().x(), box.min().y(), box.min().z()}},
                       {"box_maximum", {box.max().x(), box.max().y(), box.max().z()}},
                       {"triangles", object.mesh.triangles.size()}});
  }
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

void SequenceWriter::finish() {
  write_file_atomically(folder_ / "scene.json", scene_json());
  write_file_atomically(folder_ / "objects.json", objects_json());
  write_file_atomically(folder_ / "labels.txt", label_list_);
  write_file_atomically(folder_ / "mask.txt", mask_list_);
  recording_.finish(truth_);
}

}  // namespace holdfast
