// SPDX-License-Identifier: BSD-3-Clause
#include "bag_recorder.hpp"

#include <algorithm>
#include <cmath>
#include <exception>
#include <initializer_list>
#include <utility>

#include "depth_units.hpp"
#include "holdfast/core/atomic_file.hpp"
#include "holdfast/core/counted.hpp"
#include "holdfast/core/error.hpp"
#include "holdfast/core/trajectory.hpp"
#include "output_file.hpp"
#include "recorded_configuration.hpp"

namespace holdfast {

namespace {

// As realsense2_camera names them, so that the source `rosbag` and the nodes of ROS find them.
constexpr const char* colour_topic = "/camera/color/image_raw";
constexpr const char* depth_topic = "/camera/aligned_depth_to_color/image_raw";
constexpr const char* camera_info_topic = "/camera/color/camera_info";
constexpr const char* imu_topic = "/camera/imu";
// As stereo_image_proc names rectified pairs.
constexpr const char* left_topic = "/stereo/left/image_rect_color";
constexpr const char* right_topic = "/stereo/right/image_rect_color";
constexpr const char* left_info_topic = "/stereo/left/camera_info";
constexpr const char* right_info_topic = "/stereo/right/camera_info";
constexpr const char* camera_frame = "camera_color_optical_frame";
constexpr const char* imu_frame = "camera_imu_optical_frame";

constexpr double millimetres = 1000.0;  // of 16UC1 (REP 118)
constexpr std::size_t waiting_frames = 4;

bool is_same_file(const std::filesystem::path& one, const std::filesystem::path& other) {
  std::error_code ignored;  // of one that is not there
  return std::filesystem::equivalent(one, other, ignored);
}

/// Throws if a file that is to be written is what this recording reads, or lies in the folder that its source reads.
void require_no_inputs(std::initializer_list<std::filesystem::path> files, const Configuration& configuration) {
  const auto refuse = [](const std::filesystem::path& file, const char* what) {
    throw InputError({file.string()}, std::string("is ") + what + " of this recording; name another bag");
  };
  for (const std::filesystem::path& file : files) {
    if (!std::filesystem::exists(file)) continue;
    if (is_same_file(file, configuration.file)) refuse(file, "the configuration");
    for (const auto& [name, value] : configuration.source.values)
      if (const std::string* path = std::get_if<std::string>(&value); path != nullptr && !path->empty())
        if (is_same_file(file, *path) || is_same_file(std::filesystem::absolute(file).parent_path(), *path))
          refuse(file, "a file of the source");
  }
}

/// Whether the frames are stereo pairs; where they have depth as well, the pipeline uses that.
bool is_stereo(const SourceDescription& source) { return source.has_right && !source.has_depth; }

const char* encoding_of(const cv::Mat& image) { return image.channels() == 1 ? "mono8" : "bgr8"; }

}  // namespace

BagRecorder::BagRecorder(const Configuration& configuration, const Registry& registry, const SourceDescription& source,
                         std::filesystem::path file, bool overwrite)
    : file_(std::move(file)), configuration_(recorded_configuration(configuration, registry, source, "rosbag")) {
  require_no_inputs({file_, configuration_file(), truth_file()}, configuration);
  require_new_files({file_, configuration_file(), truth_file()}, overwrite);
  std::error_code ignored;
  std::filesystem::remove(truth_file(), ignored);
  configuration_.source.values["path"] = file_.filename().string();
  // A bag does not tell that all rows are exposed at once.
  if (source.has_global_shutter) configuration_.sections["tracking"]["rolling_shutter"] = std::string("off");
  bag_.emplace(file_, "ros2", mcap::Compression::zstd);
  add_channels(source);
  writer_.emplace("recorder", waiting_frames, [this](const SensorFrame& frame) { write(frame); });
}

void BagRecorder::add_channels(const SourceDescription& source) {
  const auto channel = [&](const char* topic, const char* type) {
    return bag_->add_channel(mcap::sensor_channel(topic, type));
  };
  std::optional<Camera>& camera = configuration_.camera;
  const bool has_right = is_stereo(source);
  colour_ = channel(has_right ? left_topic : colour_topic, "Image");
  if (source.has_depth) depth_ = channel(depth_topic, "Image");
  if (camera) camera_info_ = channel(has_right ? left_info_topic : camera_info_topic, "CameraInfo");
  if (source.has_imu) imu_ = channel(imu_topic, "Imu");
  if (!has_right) return;
  right_ = channel(right_topic, "Image");
  configuration_.source.values["colour"] = std::string(left_topic);
  configuration_.source.values["right"] = std::string(right_topic);
  if (!camera) return;
  right_info_ = channel(right_info_topic, "CameraInfo");
  if (source.camera) camera->baseline = source.camera->baseline;  // of the real pair
}

std::filesystem::path BagRecorder::configuration_file() const {
  return std::filesystem::path(file_).replace_extension(".yaml");
}

std::filesystem::path BagRecorder::truth_file() const {
  return std::filesystem::path(file_).replace_extension(".truth.txt");
}

void BagRecorder::record(const SensorFrame& frame) {
  if (frame.colour.empty() || (depth_ != 0 && frame.depth.empty()) || (right_ != 0 && frame.right.empty()))
    throw InputError({"frame " + std::to_string(frame.index)}, std::string("has no colour or no ") +
                                                                   (right_ != 0 ? "right" : "depth") +
                                                                   " image, and cannot be recorded; check the source");
  writer_->rethrow();
  if (!has_begun_) begin(frame);
  writer_->queue().push(frame);
  largest_delay_ = std::max(largest_delay_, std::abs(frame.depth_delay));
}

/// Chooses the shift of all stamps by the first frame, whose depth and inertial measurements may precede time 0.
void BagRecorder::begin(const SensorFrame& frame) {
  has_begun_ = true;
  double earliest = std::min(frame.timestamp, frame.timestamp + frame.depth_delay);
  if (!frame.imu.empty()) earliest = std::min(earliest, frame.imu.front().timestamp);
  if (earliest < 0.0) shift_ = std::ceil(-earliest);
}

void BagRecorder::write(const SensorFrame& frame) {
  const mcap::MessageHeader header{mcap::message_stamp(frame.timestamp + shift_), camera_frame};
  if (imu_ != 0) write_imu(frame);
  if (camera_info_ != 0)
    bag_->write(camera_info_, header.stamp, mcap::camera_info_message(header, *configuration_.camera));
  bag_->write(colour_, header.stamp, mcap::image_message(header, encoding_of(frame.colour), frame.colour));
  if (right_ != 0) write_right(header, frame.right);
  if (depth_ != 0) write_depth(frame);
  ++frames_;
}

/// sensor_msgs/CameraInfo: both cameras of a rectified pair have the frame of the left one.
void BagRecorder::write_right(const mcap::MessageHeader& header, const cv::Mat& image) {
  if (right_info_ != 0)
    bag_->write(right_info_, header.stamp, mcap::right_camera_info_message(header, *configuration_.camera));
  bag_->write(right_, header.stamp, mcap::image_message(header, encoding_of(image), image));
}

void BagRecorder::write_depth(const SensorFrame& frame) {
  const mcap::MessageHeader at_depth{mcap::message_stamp(frame.timestamp + frame.depth_delay + shift_), camera_frame};
  const bool is_whole = exact_depth_factor(frame.depth, {millimetres}) == millimetres;
  bag_->write(depth_, at_depth.stamp,
              is_whole ? mcap::image_message(at_depth, "16UC1", to_depth_units(frame.depth, millimetres))
                       : mcap::image_message(at_depth, "32FC1", frame.depth));
}

void BagRecorder::write_imu(const SensorFrame& frame) {
  for (const ImuSample& sample : frame.imu) {
    if (!(sample.timestamp > last_imu_stamp_)) continue;  // shared with the frame before
    const mcap::MessageHeader header{mcap::message_stamp(sample.timestamp + shift_), imu_frame};
    bag_->write(imu_, header.stamp, mcap::imu_message(header, sample));
    last_imu_stamp_ = sample.timestamp;
  }
}

void BagRecorder::finish(const Trajectory& truth) {
  writer_->finish();
  std::exception_ptr failure;
  try {
    write_files_beside(truth);
  } catch (...) {
    failure = std::current_exception();
  }
  writer_->rethrow();
  bag_->close();
  if (failure) std::rethrow_exception(failure);
}

std::string BagRecorder::losses() const {
  if (shift_ == 0.0) return {};
  return "all time stamps are " + counted(static_cast<std::size_t>(shift_), "second") +
         " later than those of the source, some of which are negative; a bag cannot hold such";
}

void BagRecorder::write_files_beside(const Trajectory& truth) {
  ParameterValues& values = configuration_.source.values;
  if (!truth.empty()) {
    Trajectory shifted = truth;
    for (TimedPose& pose : shifted) pose.timestamp += shift_;
    write_trajectory(truth_file(), shifted);
    values["truth"] = truth_file().filename().string();
  }
  // Whole millimetres up to the largest number.
  values["invalid_depth"] = std::int64_t{0};
  if (double& limit = std::get<double>(values["max_time_difference"]); largest_delay_ >= limit)
    limit = std::min(1.0, 1.01 * largest_delay_);
  const std::string note = losses();
  write_file_atomically(configuration_file(), (note.empty() ? "" : "# " + note + "\n") + to_yaml(configuration_));
}

}  // namespace holdfast
