// SPDX-License-Identifier: BSD-3-Clause
#include "recording_writer.hpp"

#include <charconv>
#include <cstdio>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <utility>

#include "depth_units.hpp"
#include "holdfast/core/error.hpp"
#include "holdfast/image_files/recorded_imu.hpp"
#include "png_encoder.hpp"

namespace holdfast {

namespace fs = std::filesystem;

namespace {

constexpr int encoders = 2;
constexpr std::size_t waiting_frames = 2;  // for each of them

/// The digits that give the same number when they are read, at least six after the point.
std::string exact_text(double value) {
  char buffer[400];
  std::string text(buffer, std::to_chars(buffer, buffer + sizeof(buffer), value, std::chars_format::fixed).ptr);
  const std::size_t point = text.find('.');
  const std::size_t decimals = point == std::string::npos ? 0 : text.size() - point - 1;
  if (point == std::string::npos) text += '.';
  if (decimals < 6) text.append(6 - decimals, '0');
  return text;
}

double depth_stamp(const SensorFrame& frame) { return frame.timestamp + frame.depth_delay; }

}  // namespace

void write_image_atomically(const fs::path& file, const cv::Mat& image, const std::vector<int>& parameters,
                            Durability durability) {
  std::vector<std::uint8_t> bytes;
  if (!cv::haveImageWriter(file.string()) || !cv::imencode(file.extension().string(), image, bytes, parameters))
    throw InputError({file.string()}, "the image cannot be encoded; expected a name that ends with .png or .jpg");
  write_file_atomically(file, std::string(bytes.begin(), bytes.end()), durability);
}

const std::vector<std::string>& RecordingWriter::entries() {
  static const std::vector<std::string> names = {
      "rgb.txt", "depth.txt", "associations.txt", "groundtruth.txt", "shutter.txt", "imu.csv", "rgb", "depth"};
  return names;
}

RecordingWriter::RecordingWriter(fs::path folder, Options options)
    : folder_(std::move(folder)),
      options_(std::move(options)),
      colour_list_("# color images\n# timestamp filename\n"),
      depth_list_("# depth maps\n# timestamp filename\n") {
  for (const char* name : {"rgb", "depth"}) fs::create_directories(folder_ / name);
  for (int i = 0; i < encoders; ++i)
    encoders_.push_back(
        std::make_unique<Worker<Job>>("recorder", waiting_frames, [this](const Job& job) { encode(job); }));
}

SensorFrame RecordingWriter::as_recorded(const SensorFrame& frame) {
  choose_depth_factor(frame.depth);
  SensorFrame recorded = frame;
  recorded.depth_delay = depth_stamp(frame) - frame.timestamp;
  if (const cv::Mat depth = depth_of_units(to_depth_units(frame.depth, depth_factor()), depth_factor());
      !is_same_depth(depth, frame.depth)) {
    recorded.depth = depth;
    ++rounded_frames_;
  }
  return recorded;
}

void RecordingWriter::choose_depth_factor(const cv::Mat& depth) {
  if (depth_factor_ || cv::countNonZero(depth) == 0) return;
  const double exact = exact_depth_factor(depth, options_.depth_factors);
  depth_factor_ = exact > 0.0 ? exact : depth_units_per_metre;
}

std::string RecordingWriter::stamp_name(double timestamp) const {
  if (options_.stamps == Stamps::exact) return exact_text(timestamp);
  char text[400];
  std::snprintf(text, sizeof(text), "%.6f", timestamp);
  return text;
}

void RecordingWriter::encode(const Job& job) const {
  if (options_.colour_format == "png")
    write_file_atomically(job.colour_file, encode_png(job.colour), Durability::later);
  else
    write_image_atomically(job.colour_file, job.colour, {cv::IMWRITE_JPEG_QUALITY, 95});
  write_file_atomically(job.depth_file, encode_png(to_depth_units(job.depth, job.depth_factor)), Durability::later);
}

void RecordingWriter::add(const SensorFrame& frame) {
  const std::string colour_stamp = stamp_name(frame.timestamp), stamp = stamp_name(depth_stamp(frame));
  const std::string colour_name = "rgb/" + colour_stamp + "." + options_.colour_format;
  const std::string depth_name = "depth/" + stamp + ".png";
  Worker<Job>& encoder = *encoders_[frames_ % encoders];
  try {
    encoder.rethrow();
  } catch (...) {
    has_failed_ = true;
    throw;
  }
  choose_depth_factor(frame.depth);
  encoder.queue().push({folder_ / colour_name, folder_ / depth_name, frame.colour, frame.depth, depth_factor()});
  colour_list_ += colour_stamp + " " + colour_name + "\n";
  depth_list_ += stamp + " " + depth_name + "\n";
  for (const ImuSample& sample : frame.imu) {
    if (!imu_lines_.empty() && !(sample.timestamp > last_imu_stamp_)) continue;  // shared with the frame before
    if (imu_lines_.empty()) imu_lines_ = imu_header;
    imu_lines_ += imu_sample_text(sample);
    last_imu_stamp_ = sample.timestamp;
  }
  associations_ += colour_stamp + " " + colour_name + " " + stamp + " " + depth_name + "\n";
  ++frames_;
}

void RecordingWriter::finish(const Trajectory& truth) {
  for (const auto& encoder : encoders_) encoder->finish();
  for (const auto& encoder : encoders_) encoder->rethrow();
  if (has_failed_)
    throw InputError({folder_.string()}, "an image could not be written, so that the recording has no lists");
  sync_file_system(folder_);
  if (!truth.empty()) write_trajectory(folder_ / "groundtruth.txt", truth);
  if (!imu_lines_.empty()) write_file_atomically(folder_ / "imu.csv", imu_lines_);
  if (options_.has_global_shutter) write_file_atomically(folder_ / "shutter.txt", "global\n");
  write_file_atomically(folder_ / "associations.txt", associations_);
  write_file_atomically(folder_ / "depth.txt", depth_list_);
  write_file_atomically(folder_ / "rgb.txt", colour_list_);
}

}  // namespace holdfast
