// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "holdfast/config/configuration.hpp"
#include "holdfast/interfaces/all.hpp"

namespace holdfast::test {

struct SourceSettings {
  std::filesystem::path path;
  static void describe(ParameterTable<SourceSettings>& table) {
    table.add("path", &SourceSettings::path, "folder of the recording").required();
  }
};

struct FeatureSettings {
  int count = 1000;
  double scale = 1.2;
  bool even = true;
  std::string spread = "tree";
  static void describe(ParameterTable<FeatureSettings>& table) {
    using S = FeatureSettings;
    table.add("count", &S::count, "features to keep").range(50, 20000);
    table.add("scale", &S::scale, "between levels").range(1.01, 2);
    table.add("even", &S::even, "spread over the image");
    table.add("spread", &S::spread, "how").one_of({"tree", "grid"});
  }
};

struct FilterSettings {
  std::vector<std::string> classes{"person"};
  std::vector<double> weights{1};
  TextMap names;
  RealMap shares;
  static void describe(ParameterTable<FilterSettings>& table) {
    using S = FilterSettings;
    table.add("classes", &S::classes, "what moves");
    table.add("weights", &S::weights, "of the classes").range(0, 1);
    table.add("names", &S::names, "from label to class");
    table.add("shares", &S::shares, "of the classes").range(0, 1);
  }
};

struct TrackingSettings {
  double window = 15;
  static void describe(ParameterTable<TrackingSettings>& table) {
    table.add("window", &TrackingSettings::window, "search radius").range(1, 200).unit("px");
  }
};

template <class Interface, class Settings>
void add(Registry& registry, const std::string& name) {
  // These tests never make a module: configurations are checked without any.
  registry.add<Interface, Settings>(
      {.name = name, .summary = "Summary of " + name + ".", .paper = "A paper"},
      [](const Settings&, const CreationContext&) { return std::unique_ptr<Interface>(); });
}

/// tum; orb, opencv_orb; none; semantic_mask; ceres.
inline Registry test_registry() {
  Registry registry;
  add<FrameSource, SourceSettings>(registry, "tum");
  add<FeatureExtractor, FeatureSettings>(registry, "orb");
  add<FeatureExtractor, FeatureSettings>(registry, "opencv_orb");
  add<Segmenter, NoSettings>(registry, "none");
  add<DynamicFilter, FilterSettings>(registry, "semantic_mask");
  add<LoopDetector, NoSettings>(registry, "none");
  add<Optimizer, NoSettings>(registry, "ceres");
  return registry;
}

inline std::vector<SectionDescription> test_sections() {
  return {{"tracking", "How frames are followed.", ParameterTable<TrackingSettings>().parameters()}};
}

/// A configuration of that text, which stands in /data/c.yaml as far as locations and paths go.
inline Configuration resolve(const std::string& text, const std::vector<std::string>& overrides = {}) {
  Registry registry = test_registry();
  ConfigurationNode root = parse_yaml(text, "c.yaml", "/data");
  for (const std::string& override_text : overrides) apply_override(root, override_text, choice_sections());
  return resolve_configuration(root, "c.yaml", registry, test_sections());
}

/// What is wrong with it, one line each.
inline std::vector<std::string> problems(const std::string& text, const std::vector<std::string>& overrides = {}) {
  std::vector<std::string> lines;
  try {
    resolve(text, overrides);
  } catch (const ConfigurationError& error) {
    for (const Diagnostic& diagnostic : error.diagnostics()) lines.push_back(diagnostic.to_string());
  }
  return lines;
}

inline const std::string good = R"(source: { tum: { path: fr1 } }
camera: tum_fr1
features: { orb: { count: 500 } }
optimizer: ceres
)";

}  // namespace holdfast::test
