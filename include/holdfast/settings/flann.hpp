// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace holdfast {

class LoopDetector;
template <class Settings>
class ParameterTable;

/// Settings of the loop detector `flann`. Ranges and units: `holdfast modules flann`.
/// Thread: any.
struct FlannSettings {
  using Interface = LoopDetector;
  static constexpr const char* module = "flann";

  /// Maximum distance between a descriptor and its visual word; 0 = 0.64 times the extractor's strict distance, 32 bits
  /// for ORB.
  double radius = 0.0;
  int descriptors = 700;  ///< maximum number of descriptors used per keyframe; time and memory are proportional to it
  /// Number of buckets of words that are searched per descriptor; more find more words at a higher cost.
  int probes = 3;
  int checks = 48;  ///< number of bucket centres that FLANN compares per descriptor before it stops
  /// Weights of the features of some classes, 0 to 1, by the segmenter's names; features of other classes count fully.
  std::vector<std::pair<std::string, double>> class_weights;

  static void describe(ParameterTable<FlannSettings>& table);
};

}  // namespace holdfast
