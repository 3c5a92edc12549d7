// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/simulation/scene_file.hpp"

#include <algorithm>
#include <numbers>
#include <tuple>

#include "holdfast/config/missing_file.hpp"
#include "holdfast/config/parameter_reader.hpp"
#include "holdfast/core/counted.hpp"
#include "holdfast/plugin/did_you_mean.hpp"
#include "scene_records.hpp"

namespace holdfast::simulation {

namespace {

using Kind = ConfigurationNode::Kind;
using Names = std::vector<std::string>;

class SceneReader {
 public:
  explicit SceneReader(const ConfigurationNode& root) : root_(root) {}

  Scene read() {
    const SceneRecord record = read_record<SceneRecord>(
        root_, "a scene", {"road", "camera", "people", "doors", "lights_out", "colour_sensor", "depth_sensor"});
    scene_.room = room_kind(record.room);
    scene_.duration = record.duration;
    scene_.frame_rate = record.frame_rate;
    scene_.seed = record.seed;
    scene_.visit = record.visit;
    scene_.camera = read_camera(at("camera"));
    if (root_.find("road") != nullptr) read_road(at("road"));
    scene_.colour_sensor = read_record<ColourSensorSettings>(at("colour_sensor"), "the colour sensor");
    scene_.depth_sensor = read_record<DepthSensorSettings>(at("depth_sensor"), "the depth sensor");
    for_each("people", [&](const ConfigurationNode& node) { scene_.people.push_back(read_person(node)); });
    for_each("doors",
             [&](const ConfigurationNode& node) { scene_.doors.push_back(read_record<SwingPlan>(node, "a door")); });
    for_each("lights_out", [&](const ConfigurationNode& node) { scene_.lights_out.push_back(read_lights_out(node)); });
    // As a reader goes through the file; what has no line comes last.
    std::stable_sort(diagnostics_.begin(), diagnostics_.end(), [](const Diagnostic& a, const Diagnostic& b) {
      const auto key = [](const SourceLocation& l) { return std::tuple(l.line == 0, l.line, l.column); };
      return key(a.location) < key(b.location);
    });
    if (!diagnostics_.empty()) throw ConfigurationError(diagnostics_);
    return std::move(scene_);
  }

 private:
  void complain(const SourceLocation& location, const std::string& message) {
    diagnostics_.push_back({location, message});
  }

  const ConfigurationNode& at(const std::string& key) const {
    static const ConfigurationNode nothing;
    const ConfigurationNode* node = root_.find(key);
    return node ? *node : nothing;
  }

  /// Reads what the table of a record knows. `others` are keys that somebody else reads.
  template <class Record>
  Record read_record(const ConfigurationNode& node, const std::string& owner, const Names& others = {}) {
    ParameterTable<Record> table;
    std::vector<Parameter> parameters = table.parameters();
    ConfigurationNode own = node;
    std::erase_if(own.entries, [&](const ConfigurationNode::Entry& entry) {
      return std::find(others.begin(), others.end(), entry.key) != others.end();
    });
    for (const std::string& name : others) parameters.emplace_back().name = name;  // so that it is suggested
    return table.settings(read_parameters(own, parameters, owner, diagnostics_));
  }

  template <class Function>
  void for_each(const std::string& key, Function&& read) {
    const ConfigurationNode& list = at(key);
    if (list.kind == Kind::nothing) return;
    if (list.kind != Kind::list) {
      complain(list.location, "found " + list.found() + " for '" + key + "'; expected a list, each item with '- '");
      return;
    }
    for (const ConfigurationNode& item : list.items) read(item);
  }

  /// A place that stands under a key; zero with a complaint when it has not the right number of coordinates.
  template <int dimension>
  Eigen::Matrix<double, dimension, 1> place(const std::vector<double>& numbers, const ConfigurationNode& node) {
    if (numbers.size() == dimension) return Eigen::Map<const Eigen::Matrix<double, dimension, 1>>(numbers.data());
    complain(node.location, "found " + counted(numbers.size(), "number") + "; expected a place of " +
                                std::to_string(dimension) +
                                (dimension == 2 ? ": [x, y] in metres" : ": [x, y, z] in metres"));
    return Eigen::Matrix<double, dimension, 1>::Zero();
  }

  template <int dimension>
  Eigen::Matrix<double, dimension, 1> place(const ConfigurationNode& map, const std::string& key,
                                            const std::vector<double>& numbers) {
    const ConfigurationNode* node = map.find(key);
    // Without the key, or with one of the wrong type, the table has complained.
    if (node == nullptr || node->items.size() != numbers.size()) return Eigen::Matrix<double, dimension, 1>::Zero();
    return place<dimension>(numbers, *node);
  }

  template <int dimension>
  std::vector<Eigen::Matrix<double, dimension, 1>> places(const ConfigurationNode& map, const std::string& key,
                                                          const RealTable& rows) {
    std::vector<Eigen::Matrix<double, dimension, 1>> result;
    const ConfigurationNode* node = map.find(key);
    if (node == nullptr || node->items.size() != rows.size()) return result;
    if (rows.empty()) complain(node->location, "found an empty list for '" + key + "'; expected at least one place");
    for (std::size_t i = 0; i < rows.size(); ++i) result.push_back(place<dimension>(rows[i], node->items[i]));
    return result;
  }

  std::optional<Eigen::Vector2d> facing(const ConfigurationNode& map, const std::vector<double>& numbers) {
    if (map.find("facing") == nullptr) return std::nullopt;
    return place<2>(map, "facing", numbers);
  }

  std::vector<Turn> turns(const ConfigurationNode& camera, const RealTable& rows) {
    constexpr double degree = std::numbers::pi / 180.0;
    std::vector<Turn> result;
    const ConfigurationNode* node = camera.find("turns");
    if (node == nullptr || node->items.size() != rows.size()) return result;  // the table has complained
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const std::vector<double>& row = rows[i];
      if (row.size() != 3 || row[0] < 0.0 || row[2] <= 0.0)
        complain(node->items[i].location,
                 "found no turn; expected [begin [s], angle [degrees], rate above 0 "
                 "[degrees/s]]");
      else
        result.push_back({row[0], row[1] * degree, row[2] * degree});
    }
    return result;
  }

  CameraPlan read_camera(const ConfigurationNode& node) {
    const CameraRecord record = read_record<CameraRecord>(node, "the camera");
    CameraPlan plan;
    plan.path = path_kind(record.path);
    plan.style = {record.speed, record.shake, turns(node, record.turns)};
    plan.waypoints.places = places<3>(node, "along", record.along);
    plan.waypoints.closed = record.closed;
    plan.waypoints.speed = record.walking_speed;
    if (node.find("look_at") != nullptr) plan.waypoints.target = place<3>(node, "look_at", record.look_at);
    const std::size_t least = record.closed ? 3 : 2;
    if (plan.path == PathKind::waypoints && node.find("along") == nullptr)
      complain(node.location, "the camera path waypoints needs 'along: [[x, y, z], ...]'");
    else if (plan.path == PathKind::waypoints && !record.along.empty() && record.along.size() < least)
      complain(node.find("along")->location,
               "found " + counted(record.along.size(), "place") + "; expected at least " + std::to_string(least));
    // A path from the command line leaves the waypoints of the file unused.
    const ConfigurationNode* path = node.find("path");
    const bool overridden = path != nullptr && path->location.file != node.location.file;
    for (const char* key : {"along", "closed", "walking_speed", "look_at"})
      if (plan.path != PathKind::waypoints && !overridden && node.find(key) != nullptr && root_.find("road") == nullptr)
        complain(node.find(key)->location,
                 "'" + std::string(key) + "' belongs to the path waypoints, not to '" + record.path + "'");
    return plan;
  }

  void read_road(const ConfigurationNode& node) {
    const RoadRecord record = read_record<RoadRecord>(node, "a road");
    scene_.camera.path = PathKind::drive;
    scene_.road = RoadPlan{RoadKind::street, record.speed, record.traffic, record.bends};
    // Of another kind, the table has complained.
    if (const auto names = road_names(); std::find(names.begin(), names.end(), record.kind) != names.end())
      scene_.road->kind = road_kind(record.kind);
    for (const char* key : {"room", "people", "doors"})
      if (const ConfigurationNode* other = root_.find(key))
        complain(other->location, "'" + std::string(key) + "' has no meaning beside 'road'; expected one of the two");
    for (const char* key : {"path", "along", "closed", "walking_speed", "look_at"})
      if (const ConfigurationNode* other = at("camera").find(key))
        complain(other->location,
                 "'" + std::string(key) +
                     "' has no meaning beside 'road', along which a car with the camera drives; expected "
                     "none");
  }

  PersonPlan read_person(const ConfigurationNode& node) {
    const PersonRecord record = read_record<PersonRecord>(node, "a person", {"do"});
    PersonPlan plan;
    plan.name = record.name;
    plan.at = place<2>(node, "at", record.at);
    plan.facing = facing(node, record.facing);
    if (record.height > 0.0) plan.height = record.height;
    if (record.girth > 0.0) plan.girth = record.girth;
    if ((record.height > 0.0 && record.height < 1.0) || (record.girth > 0.0 && record.girth < 0.5))
      complain(node.location, "people are at least 1 m tall and have a girth of at least 0.5");
    plan.start = record.start;
    plan.repeat = record.repeat;
    const ConfigurationNode* actions = node.find("do");
    if (actions == nullptr || actions->kind == Kind::nothing) return plan;
    if (actions->kind != Kind::list) {
      complain(actions->location, "found " + actions->found() +
                                      " for 'do'; expected a list of actions, such as "
                                      "[{ walk: { to: [[2, 3]] } }]");
      return plan;
    }
    for (const ConfigurationNode& item : actions->items) read_action(item, plan.actions);
    return plan;
  }

  void read_action(const ConfigurationNode& item, std::vector<Action>& actions) {
    static const Names known = {"walk", "stand", "sit", "push", "carry"};
    const bool named = item.kind == Kind::scalar, chosen = item.kind == Kind::map && item.entries.size() == 1;
    if (!named && !chosen) {
      complain(item.location, "found " + item.found() + (item.kind == Kind::map ? " of several keys" : "") +
                                  " for an action; expected one of walk, stand, sit, push, carry with its parameters");
      return;
    }
    const std::string& name = named ? item.text : item.entries[0].key;
    const ConfigurationNode node =
        named ? ConfigurationNode{.location = item.location, .entries = {}} : item.entries[0].value;
    const std::string owner = "the action '" + name + "'";
    if (name == "walk") {
      const auto record = read_record<WalkRecord>(node, owner);
      actions.emplace_back(Walk{places<2>(node, "to", record.to), record.speed});
    } else if (name == "stand") {
      const auto record = read_record<StandRecord>(node, owner);
      actions.emplace_back(Stand{record.duration, record.gesture, facing(node, record.facing)});
    } else if (name == "sit") {
      const auto record = read_record<SitRecord>(node, owner);
      actions.emplace_back(Sit{record.on, record.duration, record.gesture});
    } else if (name == "push") {
      const auto record = read_record<PushRecord>(node, owner);
      actions.emplace_back(Push{record.thing, places<2>(node, "to", record.to), record.speed});
    } else if (name == "carry") {
      const auto record = read_record<CarryRecord>(node, owner);
      actions.emplace_back(
          Carry{record.thing, places<2>(node, "to", record.to), place<3>(node, "put_at", record.put_at), record.speed});
    } else {
      complain(named ? item.location : item.entries[0].location,
               "there is no action '" + name + "'; " + did_you_mean(name, known));
    }
  }

  LightsOut read_lights_out(const ConfigurationNode& node) {
    const auto record = read_record<LightsOutRecord>(node, "a time without light");
    if (node.find("from") && node.find("to") && record.to <= record.from)
      complain(node.location, "the light comes back before it goes out; expected 'to' to be later than 'from'");
    return {record.from, record.to};
  }

  const ConfigurationNode& root_;
  Scene scene_;
  std::vector<Diagnostic> diagnostics_;
};

template <class Record>
void add_section(std::vector<SectionDescription>& sections, const std::string& name, const std::string& help) {
  sections.push_back({name, help, ParameterTable<Record>().parameters(), "scene"});
}

}  // namespace

Scene read_scene(const std::filesystem::path& file, const std::vector<std::string>& overrides) {
  std::error_code trouble;
  if (!file.empty() && !std::filesystem::exists(file, trouble))
    throw ConfigurationError({file.string()}, missing_file_text(file, "scene file") +
                                                  " expected a file with room, camera, people, ...; without a file "
                                                  "the scene is an empty office");
  ConfigurationNode root = file.empty() ? ConfigurationNode{} : read_yaml(file);
  if (root.kind != Kind::map && root.kind != Kind::nothing)
    throw ConfigurationError({file.string()},
                             "found " + root.found() + "; expected a map with room or road, camera, people, ...");
  for (const std::string& text : overrides) apply_override(root, text, {});
  Scene scene = SceneReader(root).read();
  if (!file.empty()) scene.name = file.stem().string(), scene.file = file.string();
  scene.overrides = overrides;
  return scene;
}

std::vector<SectionDescription> scene_sections() {
  std::vector<SectionDescription> sections;
  add_section<SceneRecord>(sections, "scene", "The top of a scene file, beside the sections that follow.");
  add_section<RoadRecord>(sections, "scene.road",
                          "In place of a room: a road with traffic, along which a car with the camera drives.");
  add_section<CameraRecord>(sections, "scene.camera", "The camera's way.");
  add_section<PersonRecord>(sections, "scene.people",
                            "A list of people. What each one does stands under `do`, a list of the actions below.");
  add_section<WalkRecord>(sections, "scene.people.do.walk", "Walks somewhere, rounding corners.");
  add_section<StandRecord>(sections, "scene.people.do.stand", "Stands for a while.");
  add_section<SitRecord>(sections, "scene.people.do.sit", "Goes to a chair, sits down, and stands up again.");
  add_section<PushRecord>(sections, "scene.people.do.push", "Goes behind a thing on the floor and pushes it.");
  add_section<CarryRecord>(sections, "scene.people.do.carry", "Goes to a thing, lifts it, carries it, puts it down.");
  add_section<SwingPlan>(sections, "scene.doors", "A list of doors that open and shut, again and again.");
  add_section<LightsOutRecord>(sections, "scene.lights_out", "A list of times without light.");
  add_section<ColourSensorSettings>(sections, "scene.colour_sensor", "What the colour camera adds.");
  add_section<DepthSensorSettings>(sections, "scene.depth_sensor", "What a Kinect does to depth.");
  return sections;
}

}  // namespace holdfast::simulation
