// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/bench/published.hpp"

#include <algorithm>
#include <cmath>

#include "error_keys.hpp"
#include "holdfast/plugin/did_you_mean.hpp"
#include "strict_map.hpp"

namespace holdfast {

namespace {

using Kind = ConfigurationNode::Kind;

class PublishedReader {
 public:
  PublishedReader(const ConfigurationNode& root, std::vector<Diagnostic>& diagnostics)
      : diagnostics_(diagnostics),
        map_(root, "the file of published figures", {"sources", "results", "time_ratios"}, diagnostics) {}

  PublishedResults read() {
    if (const auto* sources = map_.require("sources", "a map { name: { citation: ..., protocol: ... } }"))
      for (const ConfigurationNode::Entry& entry : sources->entries) read_source(entry);
    for_each("results", [&](const ConfigurationNode& item) {
      StrictMap row(item, "a published result", {"system", "source", "protocol", "alignment", "input", "values"},
                    diagnostics_);
      PublishedResult result;
      row.require("system", "a name");
      result.system = row.text("system", "");
      take_source(row, result.citation, result.protocol);
      take_kind(row, result);
      if (const auto* values = row.require("values", "a map { sequence: metres }")) read_values(*values, row, result);
      published_.results.push_back(std::move(result));
    });
    for_each("time_ratios", [&](const ConfigurationNode& item) {
      StrictMap row(item, "published times", {"source", "protocol", "values"}, diagnostics_);
      PublishedTimes times;
      take_source(row, times.citation, times.protocol);
      if (const auto* values = row.require("values", "a map { system: ratio }")) times.ratios = numbers(*values, row);
      published_.times.push_back(std::move(times));
    });
    return std::move(published_);
  }

 private:
  struct Source {
    std::string citation, protocol, alignment, input;
  };

  void read_source(const ConfigurationNode::Entry& entry) {
    StrictMap source(entry.value, "source '" + entry.key + "'", {"citation", "protocol", "alignment", "input"},
                     diagnostics_);
    source.require("citation", "where the figures are printed");
    source.require("protocol", "how they were measured");
    sources_[entry.key] = {source.text("citation", ""), source.text("protocol", ""),
                           chosen(source, "alignment", {{"se3", "SE(3)"}, {"sim3", "Sim(3)"}}, "SE(3)"),
                           chosen(source, "input", {{"rgbd", "RGB-D"}, {"mono", "monocular"}}, "RGB-D")};
  }

  /// The text that stands for a name in the file.
  static std::string chosen(StrictMap& map, const std::string& key,
                            const std::vector<std::pair<std::string, std::string>>& choices,
                            const std::string& otherwise) {
    const ConfigurationNode* node = map.find(key);
    if (node == nullptr) return otherwise;
    for (const auto& [name, text] : choices)
      if (node->text == name) return text;
    map.mismatch(*node, key, choices[0].first + " or " + choices[1].first);
    return otherwise;
  }

  /// A row says what differs from its source.
  void take_kind(StrictMap& row, PublishedResult& result) {
    Source source;
    if (const ConfigurationNode* node = row.find("source"); node != nullptr && sources_.contains(node->text))
      source = sources_[node->text];
    else
      source = {{}, {}, result.alignment, result.input};
    result.alignment = chosen(row, "alignment", {{"se3", "SE(3)"}, {"sim3", "Sim(3)"}}, source.alignment);
    result.input = chosen(row, "input", {{"rgbd", "RGB-D"}, {"mono", "monocular"}}, source.input);
  }

  void read_values(const ConfigurationNode& node, StrictMap& row, PublishedResult& result) {
    std::vector<std::string> names;
    for (const ConfigurationNode::Entry& entry : node.entries) names.push_back(entry.key);
    StrictMap map(node, "the values of " + row.owner(), names, diagnostics_);
    const std::vector<std::string> statistics(statistic_keys.begin(), statistic_keys.end());
    for (const ConfigurationNode::Entry& entry : node.entries) {
      SixStatistics six;
      six.fill(Statistics::none);
      if (entry.value.kind == Kind::map) {
        StrictMap printed(entry.value, "the statistics of '" + entry.key + "'", statistics, diagnostics_);
        for (std::size_t i = 0; i < six.size(); ++i) {
          six[i] = printed.number(statistics[i], 0.0, 1e6).value_or(six[i]);
          if (std::isfinite(six[i])) result.printed[entry.key][i] = printed.text(statistics[i], "");
        }
      } else {
        six[0] = map.number(entry.key, 0.0, 1e6).value_or(six[0]);
        if (std::isfinite(six[0])) result.printed[entry.key][0] = entry.value.text;
      }
      if (std::isfinite(six[0])) result.values[entry.key] = six[0];
      result.statistics[entry.key] = six;
    }
  }

  template <class Read>
  void for_each(const std::string& key, const Read& read_item) {
    const ConfigurationNode* node = map_.find(key);
    if (node == nullptr) return;
    if (node->kind != Kind::list) map_.mismatch(*node, key, "a list of maps");
    for (const ConfigurationNode& item : node->items) read_item(item);
  }

  void take_source(StrictMap& row, std::string& citation, std::string& protocol) {
    const ConfigurationNode* node = row.require("source", "the name of a source");
    if (node == nullptr) return;
    const auto source = sources_.find(node->text);
    if (source == sources_.end()) {
      std::vector<std::string> known;
      for (const auto& [name, value] : sources_) known.push_back(name);
      row.complain(node->location, "there is no source '" + node->text + "'; " + did_you_mean(node->text, known));
      return;
    }
    citation = source->second.citation;
    protocol = row.text("protocol", source->second.protocol);
  }

  std::vector<std::pair<std::string, double>> numbers(const ConfigurationNode& node, StrictMap& row) {
    std::vector<std::string> names;
    for (const ConfigurationNode::Entry& entry : node.entries) names.push_back(entry.key);
    StrictMap map(node, "the values of " + row.owner(), names, diagnostics_);
    std::vector<std::pair<std::string, double>> values;
    for (const std::string& name : names)
      if (const auto value = map.number(name, 0.0, 1e6)) values.emplace_back(name, *value);
    return values;
  }

  std::vector<Diagnostic>& diagnostics_;
  StrictMap map_;
  std::map<std::string, Source> sources_;
  PublishedResults published_;
};

}  // namespace

bool PublishedResult::has_more_than_rmse() const {
  return std::any_of(statistics.begin(), statistics.end(), [](const auto& each) {
    return std::any_of(each.second.begin() + 1, each.second.end(), [](double value) { return std::isfinite(value); });
  });
}

std::string PublishedResult::marked_system() const {
  std::string mark = input == "monocular" ? input : "";
  if (alignment != "SE(3)") mark += (mark.empty() ? "" : ", ") + alignment;
  return mark.empty() ? system : system + " (" + mark + ")";
}

PublishedResults read_published(const std::filesystem::path& file, std::vector<Diagnostic>& diagnostics) {
  try {
    const ConfigurationNode root = read_yaml(file);
    return PublishedReader(root, diagnostics).read();
  } catch (const ConfigurationError& error) {
    diagnostics.insert(diagnostics.end(), error.diagnostics().begin(), error.diagnostics().end());
    return {};
  }
}

}  // namespace holdfast
