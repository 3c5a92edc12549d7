// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/bench/matrix.hpp"

#include <algorithm>

#include "holdfast/bench/known_systems.hpp"
#include "holdfast/bench/paper_tables.hpp"
#include "holdfast/plugin/did_you_mean.hpp"
#include "matrix_parts.hpp"
#include "strict_map.hpp"
#include "variables.hpp"

namespace holdfast {

using Kind = ConfigurationNode::Kind;

namespace {

const std::vector<std::string> matrix_keys = {
    "title",    "about",    "base",    "axes",   "sequences", "systems",     "repeats",    "seeds",
    "mode",     "baseline", "exclude", "timing", "published", "comparisons", "time_limit", "minimum_coverage",
    "analysis", "executor"};

class MatrixReader {
 public:
  MatrixReader(const ConfigurationNode& root, const std::filesystem::path& file, std::vector<Diagnostic>& diagnostics)
      : diagnostics_(diagnostics), map_(root, "the matrix", matrix_keys, diagnostics) {
    matrix_.file = file;
    for (const ConfigurationNode::Entry& entry : root.entries)
      if (entry.key != "sequences" && entry.key != "systems")
        if (const auto name = missing_variable(entry.value))
          map_.complain(name->location, "the variable '" + name->text +
                                            "' is not set; set it in the environment or by --data " + name->text +
                                            "=...");
  }

  Matrix read() {
    matrix_.title = map_.text("title", matrix_.file.stem().string());
    matrix_.about = map_.text("about", "");
    matrix_.base = path("base");
    matrix_.published = path("published");
    matrix_.timing = map_.boolean("timing", false);
    matrix_.time_limit = map_.number("time_limit", 0.001, 1e7).value_or(matrix_.time_limit);
    matrix_.minimum_coverage = map_.number("minimum_coverage", 0.0, 1.0).value_or(matrix_.minimum_coverage);
    matrix_.repeats = static_cast<int>(map_.integer("repeats", 1, 1000).value_or(1));
    read_mode();
    read_seeds();
    read_named("axes", matrix_.axes, read_axis, "a map of axes");
    read_named("systems", matrix_.systems, read_system, "a map of systems");
    read_named("sequences", matrix_.sequences, read_sequence, "a map of sequences");
    if (matrix_.sequences.empty()) map_.require("sequences", "a map of sequences: { name: { source: ... } }");
    if (const auto* exclude = list("exclude", "a list of maps { axis: value, sequence: [a, b] }"))
      for (const ConfigurationNode& item : exclude->items)
        matrix_.exclusions.push_back(read_exclusion(item, diagnostics_));
    read_baseline();
    read_comparisons();
    read_analysis();
    read_executor();
    const bool has_configuration =
        matrix_.base || std::any_of(matrix_.axes.begin(), matrix_.axes.end(), [](const Axis& axis) {
          return std::all_of(axis.values.begin(), axis.values.end(),
                             [](const AxisValue& value) { return value.configuration.has_value(); });
        });
    if (!has_configuration && !(matrix_.axes.empty() && !matrix_.systems.empty()))
      map_.complain({matrix_.file.string()},
                    "there is no configuration to begin with; expected `base: FILE`, or an axis whose values all have "
                    "`configuration: FILE`");
    return std::move(matrix_);
  }

 private:
  std::optional<PlacedText> path(const std::string& key) {
    const ConfigurationNode* node = map_.find(key);
    if (node == nullptr) return std::nullopt;
    if (node->kind == Kind::scalar) return placed_path(*node);
    map_.mismatch(*node, key, "a file");
    return std::nullopt;
  }

  const ConfigurationNode* list(const std::string& key, const std::string& expected) {
    const ConfigurationNode* node = map_.find(key);
    if (node != nullptr && node->kind != Kind::list) map_.mismatch(*node, key, expected);
    return node;
  }

  template <class Part>
  void read_named(const std::string& key, std::vector<Part>& parts,
                  Part (*read_part)(const ConfigurationNode::Entry&, std::vector<Diagnostic>&),
                  const std::string& expected) {
    const ConfigurationNode* node = map_.find(key);
    if (node == nullptr) return;
    if (node->kind != Kind::map) map_.mismatch(*node, key, expected);
    for (const ConfigurationNode::Entry& entry : node->entries) parts.push_back(read_part(entry, diagnostics_));
  }

  void read_mode() {
    const ConfigurationNode* node = map_.find("mode");
    if (node == nullptr) return;
    if (node->text != "sequential" && node->text != "threaded") map_.mismatch(*node, "mode", "sequential or threaded");
    matrix_.mode = PlacedText{node->text, node->location};
  }

  void read_seeds() {
    const ConfigurationNode* node = list("seeds", "a list of whole numbers, such as [1, 2, 3]");
    if (node == nullptr) return;
    matrix_.seeds.clear();
    for (const ConfigurationNode& item : node->items) {
      const auto seed = whole_number(item);
      if (!seed || *seed < 0) map_.mismatch(item, "seeds", "whole numbers of at least 0");
      const auto value = static_cast<std::uint64_t>(seed.value_or(0));
      if (std::find(matrix_.seeds.begin(), matrix_.seeds.end(), value) != matrix_.seeds.end())
        map_.complain(item.location, "the seed " + item.text + " stands twice");
      matrix_.seeds.push_back(value);
    }
    if (matrix_.seeds.empty()) map_.mismatch(*node, "seeds", "a list of whole numbers, such as [1, 2, 3]");
  }

  void read_baseline() {
    const ConfigurationNode* node = map_.find("baseline");
    if (node == nullptr) return;
    matrix_.baseline_is_variant = node->kind == Kind::scalar;
    if (node->kind == Kind::scalar) matrix_.baseline.push_back({node->text, node->location});
    if (node->kind == Kind::list) map_.mismatch(*node, "baseline", "the name of a variant, or a map { axis: value }");
    for (const ConfigurationNode::Entry& entry : node->entries) {
      matrix_.baseline_axes.push_back(entry.key);
      matrix_.baseline.push_back({entry.value.text, entry.value.location});
    }
  }

  void read_comparisons() {
    const std::string expected = "a list of pairs of variants: [[before, after], ...]";
    const ConfigurationNode* node = list("comparisons", expected);
    if (node == nullptr) return;
    for (const ConfigurationNode& item : node->items) {
      if (item.items.size() != 2 || item.items[0].kind != Kind::scalar || item.items[1].kind != Kind::scalar) {
        map_.mismatch(item, "comparisons", expected);
        continue;
      }
      matrix_.comparisons.push_back(
          {{item.items[0].text, item.items[0].location}, {item.items[1].text, item.items[1].location}});
    }
  }

  void read_executor() {
    const ConfigurationNode* node = map_.find("executor");
    if (node == nullptr) return;
    if (node->kind == Kind::scalar && (node->text == "local" || node->text == "slurm")) {
      matrix_.executor.name = node->text;
      return;
    }
    if (node->kind != Kind::map || node->entries.size() != 1 || node->entries.front().key != "slurm" ||
        node->entries.front().value.kind != Kind::map) {
      map_.mismatch(*node, "executor", "local, slurm, or { slurm: { partition: ... } }");
      return;
    }
    matrix_.executor.name = "slurm";
    for (const ConfigurationNode::Entry& entry : node->entries.front().value.entries) {
      if (entry.value.kind == Kind::scalar)
        matrix_.executor.settings.emplace_back(entry.key, PlacedText{entry.value.text, entry.value.location});
      else
        map_.mismatch(entry.value, entry.key, "a text or a number");
    }
  }

  void read_analysis() {
    const ConfigurationNode* node = map_.find("analysis");
    if (node == nullptr) return;
    StrictMap analysis(*node, "'analysis'", {"tables", "decimals", "statistics", "columns"}, diagnostics_);
    matrix_.analysis.decimals =
        static_cast<int>(analysis.integer("decimals", 1, 12).value_or(matrix_.analysis.decimals));
    read_table_rows(analysis);
    read_table_columns(analysis);
    const ConfigurationNode* tables = analysis.find("tables");
    if (tables == nullptr) return;
    if (tables->kind != Kind::list) analysis.mismatch(*tables, "tables", "a list, such as [paper2, paper3]");
    const auto& known = paper_table_names();
    for (const ConfigurationNode& item : tables->items) {
      if (std::find(known.begin(), known.end(), item.text) == known.end())
        analysis.complain(item.location, "there is no table '" + item.text + "'; " + did_you_mean(item.text, known));
      else
        add_paper_table(item.text, matrix_.analysis);
    }
  }

  void read_table_rows(StrictMap& analysis) {
    const ConfigurationNode* statistics = analysis.find("statistics");
    if (statistics == nullptr) return;
    if (statistics->kind != Kind::list)
      analysis.mismatch(*statistics, "statistics", "a list, such as [rmse, standard_deviation]");
    for (const ConfigurationNode& item : statistics->items)
      add_table_statistic({item.text, item.location}, matrix_.analysis, diagnostics_);
  }
  void read_table_columns(StrictMap& analysis) {
    const ConfigurationNode* columns = analysis.find("columns");
    if (columns == nullptr) return;
    if (columns->kind != Kind::map)
      analysis.mismatch(*columns, "columns", "a map of names of variants, such as { full: Ours }");
    for (const ConfigurationNode::Entry& entry : columns->entries) {
      if (entry.value.kind == Kind::scalar)
        matrix_.analysis.columns.emplace_back(PlacedText{entry.key, entry.location}, entry.value.text);
      else
        analysis.mismatch(entry.value, entry.key, "a text");
    }
  }

  std::vector<Diagnostic>& diagnostics_;
  StrictMap map_;
  Matrix matrix_;
};

}  // namespace

bool is_plain_name(const std::string& name) {
  return !name.empty() && name.front() != '.' && std::all_of(name.begin(), name.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '.' || c == '_' ||
           c == '-';
  });
}

Matrix read_matrix(const std::filesystem::path& file, const Variables& variables,
                   std::vector<Diagnostic>& diagnostics) {
  ConfigurationNode root = read_yaml(file);
  follow_wrappers(root, diagnostics);
  expand_variables(root, variables);
  return MatrixReader(root, file, diagnostics).read();
}

}  // namespace holdfast
