// SPDX-License-Identifier: BSD-3-Clause
#include "recorder.hpp"

#include <cstdio>
#include <utility>
#include <variant>

#include "holdfast/core/error.hpp"
#include "holdfast/core/trajectory.hpp"
#include "recorded_configuration.hpp"

namespace holdfast {

namespace {

constexpr const char* recording_file = "recording.yaml";

Configuration on_recording(const Configuration& original, const Registry& registry, const SourceDescription& source) {
  Configuration result = recorded_configuration(original, registry, source, "tum");
  result.source.values["path"] = std::string(".");
  result.source.values["associations"] = std::string("associations.txt");
  return result;
}

/// Units of depth that sensors have: of the recording that is read, millimetres, those of the benchmark, a quarter and
/// a tenth of a millimetre.
std::vector<double> depth_factors(const Configuration& configuration) {
  std::vector<double> factors = {1000.0, RecordingWriter::depth_units_per_metre, 4000.0, 10000.0};
  const auto given = configuration.source.values.find("depth_factor");
  if (given != configuration.source.values.end())
    if (const double* factor = std::get_if<double>(&given->second)) factors.insert(factors.begin(), *factor);
  return factors;
}

const SourceDescription& with_depth(const Configuration& configuration, const SourceDescription& source) {
  if (source.has_depth) return source;
  throw ConfigurationError(configuration.source.location,
                           "the source '" + configuration.source.name +
                               "' has no depth, and a recording in the layout of the TUM benchmark holds colour and "
                               "depth; choose a source with depth");
}

class RecordedSource final : public FrameSource {
 public:
  RecordedSource(std::unique_ptr<FrameSource> source, Recorder& recorder)
      : source_(std::move(source)), recorder_(recorder) {}

  SourceDescription describe() const override { return source_->describe(); }
  std::optional<SensorFrame> next() override {
    std::optional<SensorFrame> frame = source_->next();
    if (!frame) return std::nullopt;
    return recorder_.record(*frame);
  }
  Trajectory truth() const override { return source_->truth(); }
  std::vector<SkippedFrame> skipped() const override { return source_->skipped(); }
  Warnings warnings() const override { return source_->warnings(); }
  void interrupt() override { source_->interrupt(); }

 private:
  std::unique_ptr<FrameSource> source_;
  Recorder& recorder_;
};

}  // namespace

std::vector<std::string> Recorder::entries() {
  std::vector<std::string> names = RecordingWriter::entries();
  names.emplace_back(recording_file);
  return names;
}

Recorder::Recorder(const Configuration& configuration, const Registry& registry, const SourceDescription& source,
                   std::filesystem::path folder, bool overwrite)
    : folder_(std::move(folder)),
      configuration_(on_recording(configuration, registry, with_depth(configuration, source))),
      lock_(prepare_output_folder(folder_, overwrite, entries())),
      writer_(folder_,
              {.depth_factors = depth_factors(configuration), .has_global_shutter = source.has_global_shutter}) {}

std::filesystem::path Recorder::configuration_file() const { return folder_ / recording_file; }

SensorFrame Recorder::record(const SensorFrame& frame) {
  if (frame.depth.empty() || frame.colour.empty())
    throw InputError({"frame " + std::to_string(frame.index)},
                     "has no colour or no depth image, and cannot be recorded; check the source");
  SensorFrame recorded = writer_.as_recorded(frame);
  writer_.add(recorded);
  return recorded;
}

void Recorder::finish(const Trajectory& truth) {
  writer_.finish(truth);
  configuration_.source.values["depth_factor"] = writer_.depth_factor();
  write_file_atomically(configuration_file(), to_yaml(configuration_));
}

std::string Recorder::losses() const {
  if (writer_.rounded_frames() == 0) return "";
  char text[200];
  std::snprintf(
      text, sizeof(text),
      "the depth of %llu of %llu frames is not in whole units of 1/%g m: it was rounded, and what lies beyond "
      "%.1f m has no value",
      static_cast<unsigned long long>(writer_.rounded_frames()), static_cast<unsigned long long>(writer_.frame_count()),
      writer_.depth_factor(), 65535.0 / writer_.depth_factor());
  return text;
}

std::unique_ptr<FrameSource> recorded_source(std::unique_ptr<FrameSource> source, Recorder& recorder) {
  return std::make_unique<RecordedSource>(std::move(source), recorder);
}

}  // namespace holdfast
