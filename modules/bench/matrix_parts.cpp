// SPDX-License-Identifier: BSD-3-Clause
#include "matrix_parts.hpp"

#include <algorithm>

#include "holdfast/bench/dataset_recipe.hpp"
#include "strict_map.hpp"

namespace holdfast {

using Kind = ConfigurationNode::Kind;

namespace {

void check_name(const ConfigurationNode::Entry& entry, const std::string& what, std::vector<Diagnostic>& diagnostics) {
  if (!is_plain_name(entry.key))
    diagnostics.push_back({entry.location, "'" + entry.key + "' cannot be the name of " + what +
                                               ", because it names folders too; expected letters, digits, '.', '_' and "
                                               "'-', and no '.' at the begin"});
}

std::vector<KeyValue> read_overrides(const ConfigurationNode& node) {
  std::vector<KeyValue> overrides;
  for (const ConfigurationNode::Entry& entry : node.entries)
    overrides.push_back({entry.key, entry.location, entry.value});
  return overrides;
}

/// A map of overrides, in which `configuration` names a file in place of the base.
AxisValue read_axis_value(const std::string& axis, const ConfigurationNode::Entry& entry,
                          std::vector<Diagnostic>& diagnostics) {
  AxisValue value;
  value.name = entry.key;
  value.location = entry.location;
  check_name(entry, "a value of the axis '" + axis + "'", diagnostics);
  if (entry.value.kind != Kind::map && entry.value.kind != Kind::nothing) {
    value.overrides.push_back({axis, entry.location, entry.value});
    return value;
  }
  for (const ConfigurationNode::Entry& item : entry.value.entries) {
    if (item.key == "configuration") {
      if (item.value.kind == Kind::scalar)
        value.configuration = placed_path(item.value);
      else
        diagnostics.push_back({item.value.location, "found " + item.value.found() + "; expected a configuration file"});
    } else if (item.key == "timing") {
      value.timing = item.value.text == "true";
      if (item.value.text != "true" && item.value.text != "false")
        diagnostics.push_back({item.value.location, "found " + item.value.found() + "; expected true or false"});
    } else {
      value.overrides.push_back({item.key, item.location, item.value});
    }
  }
  return value;
}

/// `key.path: [a, b]`.
AxisValue plain_axis_value(const ConfigurationNode::Entry& axis, const ConfigurationNode& item,
                           std::vector<Diagnostic>& diagnostics) {
  AxisValue value;
  value.location = item.location;
  value.overrides.push_back({axis.key, axis.location, item});
  if (item.kind != Kind::scalar)
    diagnostics.push_back({item.location, "found " + item.found() + " in the axis '" + axis.key +
                                              "'; expected plain values, or a map of names: { name: { key.path: "
                                              "value } }"});
  else if (!is_plain_name(item.text))
    diagnostics.push_back({item.location, "'" + item.text +
                                              "' cannot be the name of a folder; give the value a name: "
                                              "{ name: { " +
                                              axis.key + ": ... } }"});
  value.name = item.text;
  return value;
}

std::vector<std::pair<std::string, std::string>> read_texts(const StrictMap& map, const std::string& key,
                                                            std::vector<Diagnostic>& diagnostics) {
  std::vector<std::pair<std::string, std::string>> texts;
  const ConfigurationNode* node = map.find(key);
  if (node == nullptr) return texts;
  if (node->kind != Kind::map)
    diagnostics.push_back(
        {node->location, "found " + node->found() + " for '" + key + "' of " + map.owner() + "; expected a map"});
  for (const ConfigurationNode::Entry& entry : node->entries) {
    if (entry.value.kind == Kind::scalar)
      texts.emplace_back(entry.key, entry.value.text);
    else
      diagnostics.push_back({entry.value.location, "found " + entry.value.found() + "; expected a text"});
  }
  return texts;
}

}  // namespace

namespace {

ConfigurationNode map_of(const std::string& key, ConfigurationNode value) {
  ConfigurationNode node;
  node.kind = Kind::map;
  node.location = value.location;
  node.folder = value.folder;
  node.entries.push_back({key, node.location, std::move(value)});
  return node;
}

/// What a recipe knows: the source and the camera, where to get the recording, its name in published figures. Masks are
/// where composed sequences and `holdfast segment` put them.
void follow_recipe(const ConfigurationNode& node, StrictMap& map, MatrixSequence& sequence) {
  if (const auto* source = map.find("source"))
    map.complain(source->location, map.owner() + " has both 'recipe' and 'source'; leave one out");
  const ConfigurationNode* path = map.require("path", "the folder of the recording");
  const DatasetRecipe* recipe = find_recipe(node.text);
  if (recipe == nullptr) {
    map.complain(node.location, no_such_recipe(node.text));
    return;
  }
  if (path != nullptr && brings_camera(recipe->layout)) {  // they bring their cameras
    sequence.source = map_of(layout_name(recipe->layout), map_of("path", *path));
    sequence.brings_camera = true;
    sequence.about = recipe->how_to_get();
    sequence.published = recipe->name;
    return;
  }
  if (path == nullptr) return;
  ConfigurationNode source = map_of("path", *path);
  if (recipe->truth_left) source.entries.push_back({"truth_left", node.location, *recipe->truth_left});
  if (recipe->truth_right) source.entries.push_back({"truth_right", node.location, *recipe->truth_right});
  sequence.source = map_of(layout_name(recipe->layout), std::move(source));
  ConfigurationNode camera = node;
  camera.text = recipe->camera.name;
  sequence.camera = camera;
  ConfigurationNode masks = *path;
  masks.text += "/mask";
  sequence.overrides.push_back({"segmenter.precomputed.path", path->location, std::move(masks)});
  sequence.about = recipe->how_to_get();
  sequence.published = recipe->name;
}

}  // namespace

PlacedText placed_path(const ConfigurationNode& node) {
  const std::filesystem::path path = node.text;
  return {(path.is_absolute() ? path : node.folder / path).lexically_normal().string(), node.location};
}

namespace {

/// `motion_blur: [4, 8]` of the axis `perturbation`.
void add_strengths(Axis& axis, const ConfigurationNode::Entry& kind, std::vector<Diagnostic>& diagnostics) {
  for (const ConfigurationNode& item : kind.value.items) {
    AxisValue value;
    value.location = item.location;
    value.name = kind.key + "-" + item.text;
    const std::optional<double> strength = item.kind == Kind::scalar ? real_number(item) : std::nullopt;
    if (!strength || *strength == 0.0 || !is_plain_name(value.name)) {
      diagnostics.push_back({item.location, "found " + item.found() + " for the strength of '" + kind.key +
                                                "'; expected a number other than 0, because `" + unperturbed +
                                                "` is always a value of this axis"});
      continue;
    }
    value.overrides.push_back({std::string(perturbation_axis) + "." + kind.key, kind.location, item});
    value.perturbation = {kind.key, *strength};
    axis.values.push_back(std::move(value));
  }
}

}  // namespace

Axis read_axis(const ConfigurationNode::Entry& entry, std::vector<Diagnostic>& diagnostics) {
  Axis axis{entry.key, entry.location, {}};
  if (!is_plain_name(entry.key) || entry.key == "sequence" || entry.key == "system")
    diagnostics.push_back({entry.location, "'" + entry.key +
                                               "' cannot be the name of an axis; expected letters, "
                                               "digits, '.', '_' and '-', and neither 'sequence' nor 'system'"});
  if (entry.value.kind == Kind::list) {
    for (const ConfigurationNode& item : entry.value.items)
      axis.values.push_back(plain_axis_value(entry, item, diagnostics));
  } else if (entry.value.kind == Kind::map) {
    if (entry.key == perturbation_axis && entry.value.find(unperturbed) == nullptr) {
      AxisValue none;
      none.name = unperturbed;
      none.location = entry.location;
      axis.values.push_back(std::move(none));
    }
    for (const ConfigurationNode::Entry& item : entry.value.entries) {
      if (entry.key == perturbation_axis && item.value.kind == Kind::list)
        add_strengths(axis, item, diagnostics);
      else
        axis.values.push_back(read_axis_value(axis.name, item, diagnostics));
    }
  }
  if (axis.values.empty())
    diagnostics.push_back({entry.location, "found " + entry.value.found() + " for the axis '" + axis.name +
                                               "'; expected a list of values of the key path that it is named after, "
                                               "or a map { name: { key.path: value } }"});
  for (std::size_t i = 0; i < axis.values.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (axis.values[i].name == axis.values[j].name)
        diagnostics.push_back(
            {axis.values[i].location, "'" + axis.values[i].name + "' stands twice in the axis '" + axis.name + "'"});
  return axis;
}

MatrixSequence read_sequence(const ConfigurationNode::Entry& entry, std::vector<Diagnostic>& diagnostics) {
  MatrixSequence sequence;
  sequence.name = entry.key;
  sequence.location = entry.location;
  check_name(entry, "a sequence", diagnostics);
  StrictMap map(entry.value, "sequence '" + entry.key + "'",
                {"source", "recipe", "path", "camera", "overrides", "about", "published"}, diagnostics);
  const ConfigurationNode* recipe = map.find("recipe");
  if (recipe != nullptr)
    follow_recipe(*recipe, map, sequence);
  else if (const auto* source =
               map.require("source", "a source, as in a configuration: { tum: { path: ... } }, or 'recipe' and 'path'"))
    sequence.source = *source;
  if (const auto* path = map.find("path"); path != nullptr && recipe == nullptr)
    map.complain(path->location,
                 "'path' of " + map.owner() + " goes with 'recipe'; write source: { tum: { path: ... } }");
  if (const auto* camera = map.find("camera")) sequence.camera = *camera;
  if (const auto* overrides = map.find("overrides")) {
    if (overrides->kind != Kind::map) map.mismatch(*overrides, "overrides", "a map { key.path: value }");
    for (KeyValue& change : read_overrides(*overrides)) sequence.overrides.push_back(std::move(change));
  }
  sequence.about = map.text("about", sequence.about);
  sequence.published = map.text("published", sequence.published);
  return sequence;
}

ExternalSystem read_system(const ConfigurationNode::Entry& entry, std::vector<Diagnostic>& diagnostics) {
  ExternalSystem system;
  system.name = entry.key;
  system.location = entry.location;
  check_name(entry, "a system", diagnostics);
  StrictMap map(entry.value, "system '" + entry.key + "'",
                {"command", "folder", "environment", "settings", "trajectory", "time_limit", "repeats", "timing"},
                diagnostics);
  if (const auto* command = map.require("command", "a list: the program and its arguments")) {
    for (const ConfigurationNode& word : command->items) {
      if (word.kind != Kind::scalar) map.mismatch(word, "command", "a list of texts");
      system.command.push_back(word.text);
    }
    if (command->kind != Kind::list || command->items.empty())
      map.mismatch(*command, "command", "a list: the program and its arguments");
  }
  system.folder = map.text("folder", system.folder);
  system.trajectory = map.text("trajectory", system.trajectory);
  system.environment = read_texts(map, "environment", diagnostics);
  system.settings = read_texts(map, "settings", diagnostics);
  system.time_limit = map.number("time_limit", 0.001, 1e7);
  if (const auto repeats = map.integer("repeats", 1, 1000)) system.repeats = static_cast<int>(*repeats);
  system.timing = map.boolean("timing", false);
  return system;
}

Exclusion read_exclusion(const ConfigurationNode& node, std::vector<Diagnostic>& diagnostics) {
  Exclusion exclusion;
  exclusion.location = node.location;
  if (node.kind != Kind::map || node.entries.empty())
    diagnostics.push_back({node.location, "found " + node.found() +
                                              "; expected what is left out, such as { axis: value, "
                                              "sequence: [a, b] }"});
  for (const ConfigurationNode::Entry& entry : node.entries) {
    Exclusion::Condition condition{{entry.key, entry.location}, {}};
    const bool is_list = entry.value.kind == Kind::list;
    for (const ConfigurationNode& item : is_list ? entry.value.items : std::vector{entry.value}) {
      if (item.kind == Kind::scalar)
        condition.values.push_back({item.text, item.location});
      else
        diagnostics.push_back({item.location, "found " + item.found() + "; expected a name or a list of names"});
    }
    exclusion.conditions.push_back(std::move(condition));
  }
  return exclusion;
}

}  // namespace holdfast
