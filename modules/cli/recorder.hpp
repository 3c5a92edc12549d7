// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "holdfast/config/configuration.hpp"
#include "holdfast/interfaces/frame_source.hpp"
#include "output_folder.hpp"
#include "recording_writer.hpp"

namespace holdfast {

/// Records the frames of a source while they are read, for `holdfast record` and `holdfast run --record`.
class Recorder {
 public:
  /// Takes the folder, as prepare_output_folder() does. Throws ConfigurationError for a source without depth, which the
  /// layout cannot hold.
  Recorder(const Configuration& configuration, const Registry& registry, const SourceDescription& source,
           std::filesystem::path folder, bool overwrite);

  /// Records a frame, and returns it as a reader of the recording will get it.
  SensorFrame record(const SensorFrame& frame);
  /// Writes lists, truth and recording.yaml: the configuration, with the recording as its source.
  void finish(const Trajectory& truth);

  /// What the recording lost of the frames, for people; empty if it has all.
  std::string losses() const;
  std::uint64_t frame_count() const { return writer_.frame_count(); }
  /// The folder, and the file in it that a run on the recording needs.
  /// @{
  const std::filesystem::path& target() const { return folder_; }
  std::filesystem::path configuration_file() const;
  /// @}

  /// What a recording consists of, lists first.
  static std::vector<std::string> entries();

 private:
  std::filesystem::path folder_;
  Configuration configuration_;
  FolderLock lock_;
  RecordingWriter writer_;
};

/// A source that records what is read from it. The frames are those of the recording, so that a run on it and a run on
/// the recording are the same.
std::unique_ptr<FrameSource> recorded_source(std::unique_ptr<FrameSource> source, Recorder& recorder);

}  // namespace holdfast
