// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "holdfast/core/sensor_frame.hpp"
#include "holdfast/core/trajectory.hpp"
#include "holdfast/simulation/simulator.hpp"
#include "recording_writer.hpp"

namespace holdfast {

/// Writes a simulated sequence in the layout of the TUM RGB-D benchmark with all its truth: rgb/, depth/ (16 bit, 5000
/// units to the metre, 0 = no value), mask/ (8 bit, number of the object, 0 = static world), labels/ (8 bit, index into
/// the classes of scene.json), their lists rgb.txt, depth.txt, mask.txt, labels.txt, associations.txt, groundtruth.txt,
/// objects.json (poses over time of what is numbered) and scene.json (all that was drawn). Every file is written in one
/// step, lists last, so an interrupted run leaves no list that names a missing image. Throws InputError for a file that
/// cannot be written.
class SequenceWriter {
 public:
  /// `colour_format`: "png" or "jpg". Makes the folder where it is missing.
  SequenceWriter(const simulation::Simulator& simulator, std::filesystem::path folder, std::string colour_format);

  /// The images of a frame; frames come in order.
  void write(const SensorFrame& frame);
  /// Lists and truth of the frames that were written.
  void finish();

  std::uint64_t frame_count() const { return truth_.size(); }

  /// What it writes: what an older sequence in the folder consists of, lists first.
  static const std::vector<std::string>& entries();

 private:
  struct ObjectState {
    Eigen::Isometry3d pose;
    bool moving = false;
    int pixels = 0;
  };

  std::string objects_json() const;
  std::string scene_json() const;

  const simulation::Simulator& simulator_;
  std::filesystem::path folder_;
  RecordingWriter recording_;
  std::string mask_list_, label_list_;
  Trajectory truth_;
  std::vector<std::vector<ObjectState>> states_;  // by frame, then by object
};

}  // namespace holdfast
