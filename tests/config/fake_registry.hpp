// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "holdfast/config/configuration.hpp"
#include "holdfast/plugin/registry.hpp"

namespace holdfast::test {

/// One interface per section; the modules below are only chosen, never made.
template <int number>
struct FakeInterface : Module {
  static constexpr const char* kinds[] = {"source",        "features", "segmenter", "optimizer",
                                          "loop_detector", "filters",  "observers"};
  static constexpr const char* kind = kinds[number];
};

/// One parameter of every type.
struct EverySettings {
  bool flag = true;
  int count = 1000;
  std::uint64_t big = 7;
  double scale = 1.2;
  float ratio = 0.1F;
  std::string text = "plain";
  std::string colour = "red";
  std::filesystem::path file;
  std::vector<std::string> words = {"a", "b"};
  std::vector<double> numbers = {0.5, 2};
  TextMap pairs = {{"key", "value"}};

  static void describe(ParameterTable<EverySettings>& table) {
    using S = EverySettings;
    table.add("flag", &S::flag, "a switch");
    table.add("count", &S::count, "a count").range(50, 20000);
    table.add("big", &S::big, "a big number");
    table.add("scale", &S::scale, "a scale").range(1.01, 4).unit("m");
    table.add("ratio", &S::ratio, "a ratio");
    table.add("text", &S::text, "a text with | in its help");
    table.add("colour", &S::colour, "one of some").one_of({"red", "green"});
    table.add("file", &S::file, "a file");
    table.add("words", &S::words, "texts");
    table.add("numbers", &S::numbers, "numbers").at_least(0);
    table.add("pairs", &S::pairs, "texts by text");
  }
};

struct PathSettings {
  std::filesystem::path path;

  static void describe(ParameterTable<PathSettings>& table) {
    table.add("path", &PathSettings::path, "folder of the recording").required();
  }
};

struct ThresholdSettings {
  double threshold = 5.99;

  static void describe(ParameterTable<ThresholdSettings>& table) {
    table.add("threshold", &ThresholdSettings::threshold, "of the test").at_least(0);
  }
};

template <int number, class Settings>
void add_fake(Registry& registry, const std::string& name) {
  using Interface = FakeInterface<number>;
  registry.add<Interface, Settings>(
      {.name = name, .summary = "Fake " + name + ".", .paper = "Nobody 2001"},
      [](const Settings&, const CreationContext&) { return std::unique_ptr<Interface>(); });
}

inline Registry fake_registry() {
  Registry registry;
  add_fake<0, PathSettings>(registry, "tum");
  add_fake<0, NoSettings>(registry, "still");
  add_fake<1, EverySettings>(registry, "orb");
  add_fake<1, NoSettings>(registry, "opencv_orb");
  add_fake<2, NoSettings>(registry, "none");
  add_fake<3, NoSettings>(registry, "ceres");
  add_fake<4, NoSettings>(registry, "none");
  add_fake<5, ThresholdSettings>(registry, "reprojection_error");
  add_fake<5, NoSettings>(registry, "semantic_mask");
  add_fake<6, NoSettings>(registry, "dump");
  return registry;
}

inline std::vector<SectionDescription> fake_sections() {
  return {{"tracking", "How poses are found.", ParameterTable<ThresholdSettings>().parameters()}};
}

/// A folder of its own for every test, gone with it.
class ScratchFolder {
 public:
  ScratchFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "holdfast_config_XXXXXX").string();
    path_ = mkdtemp(name.data());
  }
  ~ScratchFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path write(const std::string& name, const std::string& text) const {
    std::ofstream(path_ / name) << text;
    return path_ / name;
  }

 private:
  std::filesystem::path path_;
};

/// Loads a text as the file c.yaml and with overrides.
inline Configuration load(const std::string& text, const std::vector<std::string>& overrides = {}) {
  const ScratchFolder folder;
  Registry registry = fake_registry();
  return load_configuration(folder.write("c.yaml", text), overrides, registry, fake_sections());
}

/// Every complaint about a text, a line each, with the file's name left at "c.yaml".
inline std::string complaints(const std::string& text, const std::vector<std::string>& overrides = {}) {
  const ScratchFolder folder;
  Registry registry = fake_registry();
  const std::string file = folder.write("c.yaml", text).string();
  try {
    load_configuration(file, overrides, registry, fake_sections());
  } catch (const ConfigurationError& error) {
    std::string all;
    for (const Diagnostic& diagnostic : error.diagnostics()) all += diagnostic.to_string() + "\n";
    for (std::size_t i; (i = all.find(file)) != std::string::npos;) all.replace(i, file.size(), "c.yaml");
    return all;
  }
  return "";
}

/// What every configuration needs beside its features.
inline const std::string rest = "source: { tum: { path: /data } }\noptimizer: ceres\n";

}  // namespace holdfast::test
