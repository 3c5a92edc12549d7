// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/bench/dataset_recipe.hpp"

#include <algorithm>
#include <map>
#include <span>

#include "holdfast/config/configuration_node.hpp"
#include "holdfast/core/embedded_file.hpp"
#include "holdfast/plugin/did_you_mean.hpp"
#include "strict_map.hpp"

namespace holdfast {

std::span<const EmbeddedFile> embedded_recipes();

namespace {

using Kind = ConfigurationNode::Kind;

const std::map<std::string, DatasetLayout> layouts = {{"euroc", DatasetLayout::euroc},
                                                      {"four_seasons", DatasetLayout::four_seasons},
                                                      {"icl_nuim", DatasetLayout::icl_nuim},
                                                      {"kitti", DatasetLayout::kitti},
                                                      {"openloris", DatasetLayout::openloris},
                                                      {"phone", DatasetLayout::phone},
                                                      {"tum", DatasetLayout::tum}};
constexpr const char* expected_layout = "tum, icl_nuim, kitti, euroc, four_seasons, openloris or phone";

/// A text that must be there.
std::string required_text(StrictMap& map, const std::string& key, const std::string& expected) {
  return map.require(key, expected) == nullptr ? "" : map.text(key, "");
}

/// A count, or `unknown`: that nobody knows is to be said.
std::optional<std::size_t> read_count(StrictMap& map, const std::string& key) {
  const ConfigurationNode* node = map.require(key, "a number, or unknown");
  if (node == nullptr || (node->kind == Kind::scalar && node->text == "unknown")) return std::nullopt;
  if (const auto count = whole_number(*node); count && *count > 0) return static_cast<std::size_t>(*count);
  map.mismatch(*node, key, "a number above 0, or unknown");
  return std::nullopt;
}

DatasetRecipe read_sequence(const ConfigurationNode::Entry& entry, DatasetRecipe recipe,
                            std::vector<Diagnostic>& diagnostics) {
  recipe.name = entry.key;
  StrictMap map(entry.value, "recipe '" + entry.key + "'",
                {"folder", "camera", "colour", "depth", "pairs", "truth", "make"}, diagnostics);
  recipe.folder = required_text(map, "folder", "the folder that the archive unpacks to");
  recipe.truth = map.text("truth", recipe.truth);
  recipe.make = map.text("make", "");
  recipe.pairs = read_count(map, "pairs");
  if (brings_camera(recipe.layout)) return recipe;
  recipe.colour = read_count(map, "colour");
  recipe.depth = read_count(map, "depth");
  if (const ConfigurationNode* camera = map.require("camera", "the name of a known camera")) {
    if (const auto known = find_camera(camera->text))
      recipe.camera = *known;
    else
      map.complain(camera->location,
                   "there is no camera '" + camera->text + "'; " + did_you_mean(camera->text, camera_names()));
  }
  return recipe;
}

std::vector<DatasetRecipe> read_embedded() {
  std::vector<DatasetRecipe> recipes;
  std::vector<Diagnostic> diagnostics;
  for (const EmbeddedFile& file : embedded_recipes()) {
    std::vector<DatasetRecipe> more = read_recipes(std::string(file.content), std::string(file.name), diagnostics);
    recipes.insert(recipes.end(), more.begin(), more.end());
  }
  if (!diagnostics.empty()) throw ConfigurationError(diagnostics);
  return recipes;
}

}  // namespace

const char* layout_name(DatasetLayout layout) {
  for (const auto& [name, each] : layouts)
    if (each == layout) return name.c_str();
  return "unknown";
}

std::string DatasetRecipe::how_to_get() const {
  if (!make.empty()) return "make it: " + make + " (recordings and people: " + address + ")";
  return "get it from " + address + " and unpack it to a folder " + folder;
}

const std::vector<DatasetRecipe>& dataset_recipes() {
  static const std::vector<DatasetRecipe> recipes = read_embedded();
  return recipes;
}

const DatasetRecipe* find_recipe(const std::string& name) {
  for (const DatasetRecipe& recipe : dataset_recipes())
    if (recipe.name == name) return &recipe;
  return nullptr;
}

std::string no_such_recipe(const std::string& name) {
  std::vector<std::string> names;
  for (const DatasetRecipe& recipe : dataset_recipes()) names.push_back(recipe.name);
  const auto nearest = nearest_name(name, names);
  return "there is no recipe '" + name + "'; " + (nearest ? "did you mean '" + *nearest + "'? " : "") +
         "`holdfast dataset list` shows all";
}

std::vector<DatasetRecipe> read_recipes(const std::string& yaml, const std::string& file_name,
                                        std::vector<Diagnostic>& diagnostics) {
  const ConfigurationNode root = parse_yaml(yaml, file_name, {});
  StrictMap map(root, "a file of recipes",
                {"dataset", "layout", "licence", "citation", "address", "about", "masks", "truth_left", "truth_right",
                 "lists_absent_depth", "sequences"},
                diagnostics);
  DatasetRecipe common;
  common.dataset = required_text(map, "dataset", "the name of the dataset");
  common.licence = required_text(map, "licence", "its licence, or unknown");
  common.citation = required_text(map, "citation", "the paper to name");
  common.address = required_text(map, "address", "where people get it");
  common.about = map.text("about", "");
  common.has_masks = map.boolean("masks", false);
  if (const auto* left = map.find("truth_left")) common.truth_left = *left;
  if (const auto* right = map.find("truth_right")) common.truth_right = *right;
  common.lists_absent_depth = map.boolean("lists_absent_depth", false);
  if (const ConfigurationNode* layout = map.require("layout", expected_layout)) {
    if (const auto known = layouts.find(layout->text); known != layouts.end())
      common.layout = known->second;
    else
      map.mismatch(*layout, "layout", expected_layout);
  }
  std::vector<DatasetRecipe> recipes;
  if (const ConfigurationNode* sequences = map.require("sequences", "a map of recipes"))
    for (const ConfigurationNode::Entry& entry : sequences->entries)
      recipes.push_back(read_sequence(entry, common, diagnostics));
  return recipes;
}

}  // namespace holdfast
