// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <map>

#include "cli/program.hpp"

namespace holdfast {
namespace {

namespace fs = std::filesystem;

/// Figures of the TUM benchmark's own scripts for trajectories that others published: ATE RMSE, mean, median, max [m],
/// RPE RMSE in translation [m] and rotation [deg] over 1 s, as printed.
const std::map<std::string, std::array<const char*, 6>> expected = {
    {"walking_xyz_dyna", {"0.015449", "0.013397", "0.011407", "0.058548", "0.019365", "0.602667"}},
    {"walking_xyz_orbslam2", {"0.656076", "0.562545", "0.587079", "1.502284", "0.366183", "6.924481"}},
    {"walking_static_orbslam2", {"0.378868", "0.345465", "0.289259", "0.660806", "0.212673", "3.813051"}},
    {"walking_static_dyna", {"0.013178", "0.011447", "0.010252", "0.036711", "0.012994", "0.313914"}},
    {"sitting_xyz_dyna", {"0.011730", "0.010308", "0.009486", "0.076597", "0.013358", "0.509499"}},
    {"walking_halfsphere_dyna", {"0.027084", "0.024131", "0.022680", "0.073258", "0.025507", "0.737192"}},
};

/// The figure of a system in the LaTeX table of a label.
std::string printed_figure(const test::Program& program, const std::string& label, const std::string& system,
                           const std::string& statistic) {
  std::string escaped = system;
  for (std::size_t at = 0; (at = escaped.find('_', at)) != std::string::npos; at += 2) escaped.insert(at, "\\");
  std::string sequence = escaped.substr(0, escaped.rfind("\\_"));
  std::istringstream lines(program.text("out/tables/" + label.substr(0, 6) + ".tex"));
  bool is_table = false, is_sequence = false;
  std::size_t column = 0;
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("\\label{")) is_table = line == "\\label{tab:" + label + "}";
    if (!is_table || line.find(" & ") == std::string::npos) continue;
    std::vector<std::string> cells;
    for (std::size_t begin = 0, end; begin < line.size(); begin = end + 3) {
      end = std::min(line.find(" & ", begin), line.find(" \\\\", begin));
      cells.push_back(line.substr(begin, end - begin));
      if (end == std::string::npos || line.substr(end, 3) != " & ") break;
    }
    if (cells[0] == "Sequence")
      column = static_cast<std::size_t>(std::find(cells.begin(), cells.end(), escaped) - cells.begin());
    if (!cells[0].empty()) is_sequence = cells[0] == sequence;
    if (!is_sequence || cells[1] != statistic || column >= cells.size()) continue;
    std::string figure = cells[column];
    if (figure.starts_with("\\textbf{")) figure = figure.substr(8, figure.size() - 9);
    if (figure.ends_with('*')) figure.pop_back();
    return figure;
  }
  return "";
}

/// Programs that "track" by copying a published trajectory.
TEST(BenchDataTest, AgreesWithTheBenchmarksOwnScripts) {
  const char* data = std::getenv("HOLDFAST_DATA");
  if (data == nullptr)
    GTEST_SKIP() << "set HOLDFAST_DATA to a folder with tum_fr3/{groundtruth,associations,published}";
  const fs::path tum = fs::path(data) / "tum_fr3";
  const test::Program program;
  std::string systems = "systems:\n", sequences = "sequences:\n", exclude = "exclude:\n";
  std::map<std::string, bool> seen;
  for (const auto& [name, figures] : expected) {
    const std::string sequence = name.substr(0, name.rfind('_'));
    systems += "  " + name + ": { command: [cp, '" + (tum / "published" / (name + ".txt")).string() +
               "', '{output}/trajectory.txt'] }\n";
    if (!seen[sequence]) {
      fs::create_directories(program.path(sequence));
      fs::copy_file(tum / "groundtruth" / ("fr3_" + sequence + ".txt"), program.path(sequence + "/groundtruth.txt"));
      sequences += "  " + sequence + ": { source: { tum: { path: " + sequence + ", associations: '" +
                   (tum / "associations" / ("fr3_" + sequence + ".txt")).string() + "' } }, camera: tum_fr3 }\n";
    }
    seen[sequence] = true;
  }
  for (const auto& [name, figures] : expected)
    for (const auto& [sequence, is_there] : seen)
      if (name.substr(0, name.rfind('_')) != sequence)
        exclude += "  - { system: " + name + ", sequence: " + sequence + " }\n";
  program.write("matrix.yaml", systems + sequences + exclude + "analysis: { tables: [paper2, paper3], decimals: 6 }\n");
  const test::Outcome outcome = program.run({"bench", "matrix.yaml", "--output", "out"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.errors;

  std::istringstream rows(program.text("out/tables/runs.csv"));
  std::size_t checked = 0;
  std::string line;
  for (std::getline(rows, line); std::getline(rows, line); ++checked) {
    std::vector<std::string> cells;
    std::istringstream row(line);
    for (std::string cell; std::getline(row, cell, ',');) cells.push_back(cell);
    ASSERT_EQ(cells.size(), 30U) << line;
    EXPECT_EQ(cells[4], "finished");
    const auto& figures = expected.at(cells[0]);
    // Behind 12 columns: RMSE, mean, median, S.D., min and max of ATE, then of RPE in translation and in rotation.
    const std::size_t columns[] = {12, 13, 14, 17, 18, 24};
    for (std::size_t i = 0; i < figures.size(); ++i) {
      char printed[32];
      std::snprintf(printed, sizeof(printed), "%.6f", std::stod(cells[columns[i]]));
      EXPECT_STREQ(printed, figures[i]) << cells[0] << ", column " << columns[i];
    }
  }
  EXPECT_EQ(checked, expected.size());

  // The tables for papers print the same figures.
  struct Printed {
    const char* table;
    const char* statistic;
    std::size_t figure;
  };
  for (const Printed& printed :
       {Printed{"paper2", "RMSE", 0}, Printed{"paper2", "Mean", 1}, Printed{"paper2", "Median", 2},
        Printed{"paper2", "Max", 3}, Printed{"paper3_translation", "RMSE", 4}, Printed{"paper3_rotation", "RMSE", 5}})
    for (const auto& [name, figures] : expected)
      EXPECT_EQ(printed_figure(program, printed.table, name, printed.statistic), figures[printed.figure])
          << printed.table << ", " << name << ", " << printed.statistic;
}

}  // namespace
}  // namespace holdfast
