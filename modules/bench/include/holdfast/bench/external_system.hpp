// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "holdfast/core/camera.hpp"
#include "holdfast/core/trajectory.hpp"
#include "holdfast/image_files/image_list.hpp"
#include "holdfast/image_files/truth_transform.hpp"

namespace holdfast {

/// A recording in TUM layout for external systems, with the frames of the source `tum`.
struct RecordedSequence {
  std::string name;
  std::filesystem::path folder;  ///< absolute
  Camera camera;
  double depth_factor = 5000.0;    ///< value of one metre in a depth image
  std::vector<ListedPair> frames;  ///< file names relative to the folder
  TruthTransform truth;            ///< of groundtruth.txt
};

/// A copy of frames in TUM layout for external systems, needed for other sources and for perturbed frames. Written once
/// by `holdfast record`.
struct RecordedCopy {
  std::string id;             ///< SEQUENCE/PERTURBATION: its folder below `copies`
  std::string name;           ///< of the sequence
  std::string configuration;  ///< what is recorded: source, camera, perturbation and seed
};

/// Lines "colour_stamp colour_file depth_stamp depth_file", stamps with 6 decimals.
std::string associations_text(const RecordedSequence& sequence);

/// A settings file in the format of ORB-SLAM2's RGB-D example, with the features, thresholds and viewer values of the
/// files that come with it. `changes` replace or add values, which are written as they are.
std::string orb_slam2_settings(const RecordedSequence& sequence,
                               const std::vector<std::pair<std::string, std::string>>& changes);

/// Values of the placeholders in command, folder, environment and trajectory.
using Placeholders = std::map<std::string, std::string>;

/// The names of all placeholders: sequence (folder), name (of the sequence), associations (file), settings (file),
/// output (folder).
const std::vector<std::string>& placeholder_names();
/// The first {word} of lower-case letters that is no placeholder.
std::optional<std::string> unknown_placeholder(const std::string& text);
/// Replaces every placeholder. Placeholders in values are not replaced.
std::string fill_placeholders(const std::string& text, const Placeholders& values);

/// Trajectory of an external system, with counts of invalid lines.
struct SalvagedTrajectory {
  bool exists = false;
  Trajectory poses;            ///< sorted and cleaned
  std::size_t not_finite = 0;  ///< lines with a value that is not finite, or a quaternion of no length; left out
  std::size_t malformed =
      0;  ///< other lines that are no pose, such as one cut short or without a unit quaternion; left out
};

/// Reads a trajectory in TUM format and skips invalid lines.
SalvagedTrajectory salvage_trajectory(const std::filesystem::path& file);

}  // namespace holdfast
