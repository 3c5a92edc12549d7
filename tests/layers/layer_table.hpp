// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <vector>

namespace holdfast::layers {

/// A row of the table: who may include whom.
struct Layer {
  std::string name;
  std::vector<std::filesystem::path> folders;  ///< relative to the source tree; a single file may stand for itself
  std::set<std::string> may_include;           ///< itself too
};

/// Reads the table whose header begins with the cell "Layer" from a Markdown page. Folders and layers stand between
/// backquotes; `all` in the third column means every row above. Throws std::runtime_error, naming the row, for a page
/// without the table, a layer that is named twice, or a row that names a layer which does not stand above it.
std::vector<Layer> read_layer_table(const std::filesystem::path& page);

/// What was found in a source tree.
struct LayerReport {
  std::vector<std::string> problems;  ///< "file:line: what is wrong", sorted
  int files = 0;
  int includes = 0;  ///< of holdfast headers
};

/// Reads the includes of every C++ file in include/, modules/, plugins/ and integrations/ of a source tree. A file
/// belongs to the layer with the longest folder that holds it. Problems: an include of a layer that the file's layer
/// may not know, or that the table does not have; an include that climbs out of its folder (".."); a file that belongs
/// to no layer.
LayerReport check_layers(const std::filesystem::path& tree, const std::vector<Layer>& layers);

}  // namespace holdfast::layers
