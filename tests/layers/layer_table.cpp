// SPDX-License-Identifier: BSD-3-Clause
#include "layers/layer_table.hpp"

#include <algorithm>
#include <fstream>
#include <regex>
#include <stdexcept>

namespace holdfast::layers {

namespace fs = std::filesystem;

namespace {

std::vector<std::string> cells_of(const std::string& row) {
  std::vector<std::string> cells;
  std::size_t begin = row.find('|');
  for (std::size_t end; (end = row.find('|', begin + 1)) != std::string::npos; begin = end) {
    const std::string cell = row.substr(begin + 1, end - begin - 1);
    const std::size_t first = cell.find_first_not_of(' ');
    cells.push_back(first == std::string::npos ? "" : cell.substr(first, cell.find_last_not_of(' ') - first + 1));
  }
  return cells;
}

/// The words between backquotes.
std::vector<std::string> quoted_words(const std::string& cell) {
  static const std::regex word("`([^`]+)`");
  std::vector<std::string> words;
  for (std::sregex_iterator match(cell.begin(), cell.end(), word), end; match != end; ++match)
    words.push_back((*match)[1]);
  return words;
}

Layer read_row(const std::string& row, const std::vector<Layer>& above) {
  const auto fail = [&](const std::string& what) {
    throw std::runtime_error("layer table: " + what + " in row: " + row);
  };
  const auto is_above = [&](const std::string& name) {
    return std::any_of(above.begin(), above.end(), [&](const Layer& layer) { return layer.name == name; });
  };
  const std::vector<std::string> cells = cells_of(row);
  if (cells.size() < 3 || quoted_words(cells[0]).size() != 1) fail("expected `name` | `folders` | layers");

  Layer layer;
  layer.name = quoted_words(cells[0]).front();
  if (is_above(layer.name)) fail("a layer that stands above already");
  for (const std::string& folder : quoted_words(cells[1])) layer.folders.emplace_back(folder);
  if (layer.folders.empty()) fail("no folder");
  layer.may_include.insert(layer.name);
  if (cells[2] == "all") {
    for (const Layer& other : above) layer.may_include.insert(other.name);
    return layer;
  }
  const std::vector<std::string> others = quoted_words(cells[2]);
  if (others.empty() && cells[2] != "none") fail("expected `layers`, all or none");
  for (const std::string& other : others) {
    if (!is_above(other)) fail("'" + other + "', which does not stand above it,");
    layer.may_include.insert(other);
  }
  return layer;
}

bool holds(const fs::path& folder, const fs::path& file) {
  return std::mismatch(folder.begin(), folder.end(), file.begin(), file.end()).first == folder.end();
}

const Layer* layer_of(const fs::path& file, const std::vector<Layer>& layers) {
  const Layer* best = nullptr;
  std::size_t best_length = 0;
  for (const Layer& layer : layers)
    for (const fs::path& folder : layer.folders)
      if (holds(folder, file) && folder.native().size() > best_length) {
        best = &layer;
        best_length = folder.native().size();
      }
  return best;
}

bool is_source(const fs::path& file) {
  static const std::set<std::string> endings{".hpp", ".h", ".cpp", ".cc", ".inl", ".in"};
  return endings.count(file.extension().string()) > 0;
}

void check_file(const fs::path& tree, const fs::path& file, const std::vector<Layer>& layers, LayerReport& report) {
  static const std::regex include(R"re(^\s*#\s*include\s*["<]([^">]+)[">])re");
  const std::string name = file.generic_string();
  const Layer* layer = layer_of(file, layers);
  if (layer == nullptr) {
    report.problems.push_back(name + ": belongs to no layer of the table");
    return;
  }
  std::ifstream stream(tree / file);
  if (!stream) throw std::runtime_error("cannot read " + (tree / file).string());
  std::string text;
  for (int line = 1; std::getline(stream, text); ++line) {
    std::smatch match;
    if (!std::regex_search(text, match, include)) continue;
    const fs::path path = match[1].str();
    const auto problem = [&](const std::string& what) {
      report.problems.push_back(name + ":" + std::to_string(line) + ": " + what + ": " + text);
    };
    if (std::find(path.begin(), path.end(), "..") != path.end()) problem("an include climbs out of its folder");
    if (*path.begin() != "holdfast") continue;
    ++report.includes;
    const std::string target = std::distance(path.begin(), path.end()) < 3 ? "" : std::next(path.begin())->string();
    const bool known =
        std::any_of(layers.begin(), layers.end(), [&](const Layer& other) { return other.name == target; });
    if (!known)
      problem("'" + target + "' is no layer of the table");
    else if (layer->may_include.count(target) == 0)
      problem("layer '" + layer->name + "' may not include '" + target + "'");
  }
}

}  // namespace

std::vector<Layer> read_layer_table(const fs::path& page) {
  std::ifstream stream(page);
  if (!stream) throw std::runtime_error("cannot read " + page.string());
  std::vector<Layer> layers;
  bool inside = false;
  for (std::string row; std::getline(stream, row);) {
    if (!inside) {
      inside = row.rfind("| Layer |", 0) == 0;
      if (inside) std::getline(stream, row);  // the line of dashes
    } else if (row.rfind('|', 0) == 0) {
      layers.push_back(read_row(row, layers));
    } else {
      break;
    }
  }
  if (layers.empty()) throw std::runtime_error("no layer table in " + page.string());
  return layers;
}

LayerReport check_layers(const fs::path& tree, const std::vector<Layer>& layers) {
  LayerReport report;
  for (const char* top : {"include", "modules", "plugins", "integrations"}) {
    if (!fs::exists(tree / top)) continue;
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(tree / top))
      if (entry.is_regular_file() && is_source(entry.path())) {
        ++report.files;
        check_file(tree, fs::relative(entry.path(), tree), layers, report);
      }
  }
  std::sort(report.problems.begin(), report.problems.end());
  return report;
}

}  // namespace holdfast::layers
