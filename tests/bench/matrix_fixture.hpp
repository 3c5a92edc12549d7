// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gmock/gmock.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "config/fixture.hpp"
#include "holdfast/bench/run_plan.hpp"

namespace holdfast::test {

/// A segmenter with a folder, and one that nobody chooses.
struct MaskSettings {
  std::filesystem::path path;
  static void describe(ParameterTable<MaskSettings>& table) {
    table.add("path", &MaskSettings::path, "folder of masks").required();
  }
};

/// A folder with matrices and configurations of known modules (those of the configuration's tests, and the segmenters
/// `masks` and `network`), gone when the test ends.
class MatrixTest : public ::testing::Test {
 protected:
  MatrixTest() {
    std::string name = (std::filesystem::temp_directory_path() / "holdfast_bench_XXXXXX").string();
    folder_ = mkdtemp(name.data());
    write("plain.yaml", "source: { tum: { path: nowhere } }\nfeatures: { orb: { count: 500 } }\noptimizer: ceres\n");
    write("masked.yaml",
          "source: { tum: { path: nowhere } }\nfeatures: orb\noptimizer: ceres\n"
          "segmenter: { masks: { path: nowhere/mask } }\nfilters: [semantic_mask]\n");
    for (const char* sequence : {"one", "two"})
      for (const char* list : {"rgb.txt", "depth.txt", "groundtruth.txt"})
        write(std::string(sequence) + "/" + list, "");
    std::filesystem::create_directories(folder_ / "one/mask");
  }
  ~MatrixTest() override {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }

  void write(const std::string& name, const std::string& text) const {
    std::filesystem::create_directories((folder_ / name).parent_path());
    std::ofstream(folder_ / name) << text;
  }

  RunPlan plan(const std::string& text, const Variables& variables = {}) {
    write("matrix.yaml", text);
    diagnostics_.clear();
    Registry registry = test_registry();
    add<Segmenter, MaskSettings>(registry, "masks");
    add<Segmenter, NoSettings>(registry, "network");
    Matrix matrix = read_matrix(folder_ / "matrix.yaml", variables, diagnostics_);
    return make_run_plan(std::move(matrix), registry, test_sections(), diagnostics_);
  }
  /// What was wrong, without the folder's name.
  std::vector<std::string> problems() const { return texts(diagnostics_); }
  std::vector<std::string> texts(const std::vector<Diagnostic>& diagnostics) const {
    std::vector<std::string> lines;
    for (const Diagnostic& diagnostic : diagnostics) {
      std::string line = diagnostic.to_string();
      const std::string prefix = folder_.string() + "/";
      for (std::size_t at; (at = line.find(prefix)) != std::string::npos;) line.erase(at, prefix.size());
      lines.push_back(line);
    }
    return lines;
  }
  static std::vector<std::string> ids(const RunPlan& plan) {
    std::vector<std::string> names;
    for (const PlannedRun& run : plan.runs) names.push_back(run.id);
    return names;
  }

  std::filesystem::path folder_;
  std::vector<Diagnostic> diagnostics_;
};

}  // namespace holdfast::test
