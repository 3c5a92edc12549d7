// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "holdfast/bench/run_result.hpp"
#include "holdfast/core/error.hpp"

namespace holdfast {

/// A row of a published table: ATE RMSE by sequence, with source and protocol, because figures of one system differ
/// between papers by a factor of up to 4.7.
struct PublishedResult {
  std::string system;
  std::string citation;
  std::string protocol;
  std::map<std::string, double> values;  ///< RMSE [m] by name of the sequence
  std::string alignment = "SE(3)";       ///< or "Sim(3)", whose errors are smaller by the free scale
  std::string input = "RGB-D";           ///< or "monocular"
  /// All that is printed [m], by name of the sequence; NaN for a statistic that is not.
  std::map<std::string, SixStatistics> statistics = {};
  /// The same in the digits that are printed, "" for a statistic that is not.
  std::map<std::string, std::array<std::string, 6>> printed = {};

  /// Whether a figure other than the RMSE is printed.
  bool has_more_than_rmse() const;
  /// The system with deviations of its protocol: "DROID-W (monocular, Sim(3))".
  std::string marked_system() const;
};

/// Time per frame as a ratio to ORB-SLAM2 on the same machine.
struct PublishedTimes {
  std::string citation;
  std::string protocol;
  std::vector<std::pair<std::string, double>> ratios;  ///< by system, in the order of the file
};

/// All published figures of a file, in its order.
struct PublishedResults {
  std::vector<PublishedResult> results;
  std::vector<PublishedTimes> times;
};

/// Reads a file of published figures. Appends everything that is wrong to `diagnostics`: a figure without a source, a
/// source without a protocol, what is no number. A value is the RMSE, or a map of statistics { rmse, mean, median,
/// standard_deviation, min, max } as far as they are printed.
PublishedResults read_published(const std::filesystem::path& file, std::vector<Diagnostic>& diagnostics);

}  // namespace holdfast
