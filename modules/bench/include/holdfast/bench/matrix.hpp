// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "holdfast/config/configuration_node.hpp"
#include "holdfast/core/error.hpp"

namespace holdfast {

/// A text of the matrix with its location.
struct PlacedText {
  std::string text;
  SourceLocation location;
};

/// Override of a configuration by a matrix: key path, as after `--set`, and value.
struct KeyValue {
  std::string key;
  SourceLocation location;
  ConfigurationNode value;
};

/// One value of an axis: its name and overrides.
struct AxisValue {
  std::string name;  ///< fit for the name of a folder
  SourceLocation location;
  std::optional<PlacedText> configuration;  ///< a file in place of the matrix's base, absolute
  std::vector<KeyValue> overrides;
  bool timing = false;  ///< its runs are executed alone
  /// Of a value of the axis `perturbation` that was listed by strength: what is made worse, and how much.
  std::optional<std::pair<std::string, double>> perturbation;
};

/// The axis that is written as { motion_blur: [4, 8], noise: [10, 20] }. Its first value is `none`, and one value for
/// every strength follows, named such as motion_blur-8.
inline constexpr const char* perturbation_axis = "perturbation";
inline constexpr const char* unperturbed = "none";

/// An axis and its values. The variants are all combinations of the values of all axes.
struct Axis {
  std::string name;
  SourceLocation location;
  std::vector<AxisValue> values;
};

/// A sequence: the source of frames, given by a `source:` section or a dataset recipe.
struct MatrixSequence {
  std::string name;  ///< fit for the name of a folder
  SourceLocation location;
  ConfigurationNode source;                 ///< as the section `source` of a configuration
  std::optional<ConfigurationNode> camera;  ///< as the section `camera`; nothing: the configuration's
  bool brings_camera = false;               ///< its source knows the camera, so that the configuration's does not count
  /// Overrides of configurations on this sequence. A key of a module (segmenter.precomputed.path) applies only if the
  /// configuration selects that module.
  std::vector<KeyValue> overrides;
  std::string about;      ///< its origin, reported if it is missing
  std::string published;  ///< its name in the file of published figures; empty = its own name
};

/// An external system that runs on the same frames. Its texts may contain placeholders: {sequence} {associations}
/// {settings} {output} {name}, see external_system.hpp.
struct ExternalSystem {
  std::string name;  ///< fit for the name of a folder
  SourceLocation location;
  std::vector<std::string> command;                              ///< program and arguments; no shell
  std::string folder = "{output}";                               ///< to run in
  std::vector<std::pair<std::string, std::string>> environment;  ///< added to ours
  std::vector<std::pair<std::string, std::string>> settings;     ///< added to, or in place of, the generated ones
  std::string trajectory = "{output}/trajectory.txt";            ///< where it leaves its poses, TUM format
  std::optional<double> time_limit;                              ///< [s]
  std::optional<int> repeats;
  bool timing = false;
};

/// Excluded runs: those that meet all conditions. Keys are axes, `sequence` and `system`.
struct Exclusion {
  SourceLocation location;
  /// Condition on the value of an axis, the sequence or the system.
  struct Condition {
    PlacedText key;
    std::vector<PlacedText> values;  ///< one of them
  };
  std::vector<Condition> conditions;
};

/// Analysis of the results in addition to the report.
struct MatrixAnalysis {
  std::vector<std::string> tables;  ///< of paper_table_names(), each once
  int decimals = 4;                 ///< of errors in these tables
  std::vector<std::size_t>
      statistics;  ///< rows of these tables: places in statistic_keys; empty = all, as papers print them
  std::vector<std::pair<PlacedText, std::string>>
      columns;  ///< names of variants, and what the tables call them instead
};

/// The key `executor`: where runs are executed.
struct MatrixExecutor {
  std::string name = "local";                                ///< or slurm
  std::vector<std::pair<std::string, PlacedText>> settings;  ///< of slurm, by name
};

/// A benchmark matrix: systems, sequences, repeats and comparisons.
struct Matrix {
  std::filesystem::path file;
  std::string title;
  std::string about;
  std::optional<PlacedText> base;  ///< a configuration, absolute
  std::optional<PlacedText> mode;  ///< sequential or threaded; nothing: as the configurations say
  int repeats = 1;                 ///< of every seed
  std::vector<std::uint64_t> seeds = {1};
  double time_limit = 3600.0;     ///< of a run [s]
  double minimum_coverage = 0.9;  ///< below it a comparison is marked, 0 to 1
  bool timing = false;            ///< all runs are executed alone
  std::vector<Axis> axes;
  std::vector<MatrixSequence> sequences;
  std::vector<ExternalSystem> systems;
  std::vector<Exclusion> exclusions;
  std::vector<PlacedText> baseline;                            ///< a variant, or some values of axes; see run_plan.hpp
  bool baseline_is_variant = false;                            ///< `baseline` holds one text: a variant's name
  std::vector<std::string> baseline_axes;                      ///< otherwise: the axes of those values
  std::vector<std::pair<PlacedText, PlacedText>> comparisons;  ///< variants, the second measured against the first
  std::optional<PlacedText> published;                         ///< file of published figures, absolute
  MatrixAnalysis analysis;
  MatrixExecutor executor;
};

/// Values of ${NAME} in a matrix: those given here, then the environment's.
using Variables = std::map<std::string, std::string>;

/// Reads a matrix. Appends to `diagnostics` everything that is wrong with the file itself; names that refer to each
/// other are checked by make_run_plan(). ${NAME} is replaced everywhere; where no such variable is set the text stays
/// as it is, for missing_variable() to find: an error everywhere but in sequences and systems, which may be missing in
/// a listing. Throws ConfigurationError when the file cannot be read as YAML.
Matrix read_matrix(const std::filesystem::path& file, const Variables& variables, std::vector<Diagnostic>& diagnostics);

/// Name of an undefined variable in the tree, if there is one.
std::optional<PlacedText> missing_variable(const ConfigurationNode& node);
/// The same for one text.
std::optional<std::string> missing_variable(const std::string& text);

/// Whether a text can be the name of a folder, of a variant and of a column: letters, digits, '.', '_' and '-', no '.'
/// at its begin.
bool is_plain_name(const std::string& name);

}  // namespace holdfast
