// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "holdfast/bench/matrix.hpp"
#include "holdfast/config/configuration.hpp"

namespace holdfast {

/// Builds the configuration of a variant on a sequence: the file, the sequence's source and camera, the axes' values,
/// then what the sequence overrides. What is wrong goes to the diagnostics.
class CellConfigurations {
 public:
  CellConfigurations(const Matrix& matrix, Registry& registry, const std::vector<SectionDescription>& sections,
                     std::vector<Diagnostic>& diagnostics)
      : matrix_(matrix), registry_(registry), sections_(sections), diagnostics_(diagnostics) {}

  /// `values`: one of each axis. Nothing when something is wrong.
  std::optional<Configuration> build(const std::vector<const AxisValue*>& values, const MatrixSequence& sequence);

  /// What `holdfast record` gets to write the frames of a sequence: its source and camera, and a value of the axis
  /// `perturbation`, which may be nullptr. Nothing when something is wrong.
  std::optional<Configuration> build_recording(const MatrixSequence& sequence, const AxisValue* perturbation);

 private:
  const ConfigurationNode* file(const PlacedText& path);
  void override_for_sequence(ConfigurationNode& root, const MatrixSequence& sequence,
                             const std::vector<const AxisValue*>& values);
  /// Without the file nothing can be built, but what the matrix itself says can still be wrong.
  void check_without_file(const PlacedText& path, const std::vector<const AxisValue*>& values,
                          const MatrixSequence& sequence);
  bool set(ConfigurationNode& root, const KeyValue& change);

  const Matrix& matrix_;
  Registry& registry_;
  const std::vector<SectionDescription>& sections_;
  std::vector<Diagnostic>& diagnostics_;
  std::map<std::string, std::optional<ConfigurationNode>> files_;
};

}  // namespace holdfast
