// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "bag.hpp"
#include "depth_registration.hpp"
#include "holdfast/core/association.hpp"
#include "holdfast/core/error.hpp"
#include "holdfast/core/size_text.hpp"
#include "holdfast/image_files/image_sequence.hpp"
#include "holdfast/image_files/recorded_frames.hpp"
#include "holdfast/image_files/recorded_imu.hpp"
#include "holdfast/interfaces/frame_source.hpp"
#include "holdfast/plugin/plugin.hpp"
#include "image_message.hpp"
#include "imu_message.hpp"
#include "realsense_bag.hpp"
#include "topics.hpp"

namespace holdfast {

namespace {

struct RosbagSettings : RecordedFrames {
  std::filesystem::path path;
  std::string colour, depth, right, camera_info, imu;
  double max_time_difference = 0.02;
  double depth_factor = 1000.0;
  int invalid_depth = DepthEncoding::largest;
  std::filesystem::path truth;

  static void describe(ParameterTable<RosbagSettings>& table) {
    using S = RosbagSettings;
    table
        .add(
            "path", &S::path,
            "recording of ROS: a bag of ROS 1 (.bag), an MCAP file (.mcap), a database of rosbag2 (.db3), one of these "
            "compressed (.zstd), or a folder of rosbag2")
        .required();
    table.add("colour", &S::colour,
              "topic of the colour images; empty = found: the one of a usual name, such as /camera/rgb/image_color, or "
              "the only one");
    table.add("depth", &S::depth,
              "topic of the depth images, registered to the colour images; empty = found in the same way, if there is "
              "one; none = colour alone");
    table.add("right", &S::right,
              "topic of the right images of a rectified stereo pair, whose left ones are `colour`, instead of depth; "
              "empty = none");
    table.add("camera_info", &S::camera_info,
              "topic of the calibration of the colour camera; empty = camera_info beside the colour images, if it is "
              "there and the configuration gives no camera; none = it is not read");
    table.add("imu", &S::imu,
              "topic of inertial measurements (sensor_msgs/Imu); empty = the only one, if the configuration has the "
              "section 'imu'; none = they are not read");
    table
        .add(
            "max_time_difference", &S::max_time_difference,
            "upper bound of the time difference between a colour image and its depth image; those of a stereo pair lie "
            "within 1 ms")
        .range(1e-6, 1.0)
        .unit("s");
    table
        .add("depth_factor", &S::depth_factor,
             "value of one metre in depth images of whole numbers (16UC1), unless a bag of librealsense says it")
        .range(1.0, 65535.0);
    table
        .add("invalid_depth", &S::invalid_depth,
             "value of pixels without a measurement in depth images of whole numbers, besides 0")
        .range(0, 65535);
    table.add("truth", &S::truth, "ground-truth trajectory in TUM format");
    add_rows(table, "frame");
  }
};

using namespace rosbag_plugin;

/// A message and the time stamp of its header [s].
struct StampedMessage {
  double stamp = 0.0;
  BagMessage message;
};

/// The messages of a topic in the order of their stamps, which must differ.
std::vector<StampedMessage> stamped_messages(Bag& bag, const std::string& topic) {
  std::vector<StampedMessage> messages;
  for (const BagMessage& message : bag.messages(topic))
    messages.push_back({read_stamp(bag.head(message, stamp_bytes)), message});
  std::stable_sort(messages.begin(), messages.end(),
                   [](const StampedMessage& a, const StampedMessage& b) { return a.stamp < b.stamp; });
  for (std::size_t i = 1; i < messages.size(); ++i)
    if (messages[i].stamp == messages[i - 1].stamp)
      throw InputError({bag.place_of(messages[i].message)},
                       "has the time stamp " + std::to_string(messages[i].stamp) +
                           " s in its header, as an earlier one of this topic; expected stamps that increase; does "
                           "the driver set them, and is there one driver alone?");
  return messages;
}

struct BagFrame {
  StampedMessage colour;
  std::optional<StampedMessage> second;  ///< depth or right image
};

constexpr double simultaneous = 1e-3;  // images of a stereo pair [s]

std::vector<BagFrame> find_bag_frames(Bag& bag, const ChosenTopics& topics, const RosbagSettings& settings) {
  const std::vector<StampedMessage> colour = stamped_messages(bag, topics.colour.name);
  const bool is_stereo = !topics.right.name.empty();
  const std::string second_topic = is_stereo ? topics.right.name : topics.depth.name;
  std::vector<BagFrame> frames;
  if (second_topic.empty()) {
    for (const StampedMessage& message : colour) frames.push_back({message, {}});
    select_range(frames, settings.start, settings.frames, settings.path, "colour images");
    return frames;
  }
  const std::vector<StampedMessage> second = stamped_messages(bag, second_topic);
  const double difference = is_stereo ? simultaneous : settings.max_time_difference;
  const auto stamps = [](const std::vector<StampedMessage>& messages) {
    std::vector<double> list;
    for (const StampedMessage& message : messages) list.push_back(message.stamp);
    return list;
  };
  for (const auto& [i, j] : associate_stamps(stamps(colour), stamps(second), difference))
    frames.push_back({colour[i], second[j]});
  const auto range = [](const std::string& topic, const std::vector<StampedMessage>& messages) {
    return topic + " runs from " + std::to_string(messages.front().stamp) + " to " +
           std::to_string(messages.back().stamp) + " s";
  };
  if (frames.empty())
    throw InputError({settings.path.string()},
                     std::string("no ") + (is_stereo ? "left and right" : "colour and depth") + " image lie within " +
                         std::to_string(difference) + " s: " + range(topics.colour.name, colour) + ", " +
                         range(second_topic, second) +
                         (is_stereo ? "; expected a camera that exposes both at once"
                                    : "; set `source.rosbag.max_time_difference`"));
  select_range(frames, settings.start, settings.frames, settings.path,
               is_stereo ? "stereo pairs" : "colour and depth pairs");
  return frames;
}

/// The name of a file without its endings, or of a folder.
std::string name_of(std::filesystem::path path) {
  if (path.filename() == "metadata.yaml" || path.filename().empty()) path = path.parent_path();
  if (path.extension() == ".zstd") path = path.stem();
  return path.stem().string();
}

/// Colour and depth images of a recording of ROS, associated as those of a recording in TUM layout.
class RosbagSource final : public FrameSource {
 public:
  RosbagSource(const RosbagSettings& settings, const CreationContext& context)
      : settings_(settings),
        bag_(open_bag(settings.path)),
        topics_(choose_topics(*bag_, {settings.colour, settings.depth, settings.camera_info, settings.right})),
        frames_(find_bag_frames(*bag_, topics_, settings)),
        size_(context.camera.width, context.camera.height) {
    description_.name = name_of(settings.path);
    description_.has_depth = !topics_.depth.name.empty();
    description_.has_right = !topics_.right.name.empty();
    description_.can_read_ahead = true;
    description_.frame_count = frames_.size();
    for (const BagFrame& frame : frames_) description_.frame_timestamps.push_back(frame.colour.stamp);
    const bool camera_is_given = !(context.camera == Camera());
    if (!topics_.camera_info.name.empty() && !(settings.camera_info.empty() && camera_is_given)) {
      description_.camera = read_camera();
      size_ = {description_.camera->width, description_.camera->height};
    }
    if (description_.has_right && camera_is_given && context.sensor != Sensor::mono) check_baseline(context.camera);
    if (is_realsense_stream(topics_.depth.name, "Depth"))
      register_depth(description_.camera ? *description_.camera : context.camera);
    if (!settings.truth.empty()) truth_ = read_trajectory(settings.truth);
    const std::string imu_topic = choose_imu_topic(*bag_, settings.imu, context.imu.has_value());
    imu_ = RecordedImu(read_imu_topic(*bag_, imu_topic), settings.path.string() + ", " + imu_topic, context.imu,
                       description_.frame_timestamps);
    imu_.describe(description_);
  }

  SourceDescription describe() const override { return description_; }
  std::optional<SensorFrame> next() override {
    while (position_ < frames_.size()) {
      const std::uint64_t index = position_++;
      try {
        SensorFrame frame = decode(frames_[index]);
        frame.index = index;
        imu_.add_to(frame);
        return frame;
      } catch (const InputError& error) {
        if (!settings_.skips_bad_frames()) throw;
        skipped_.push_back({index, frames_[index].colour.stamp, error.what()});
      }
    }
    if (skipped_.size() == frames_.size())
      throw InputError({settings_.path.string()}, "none of the " + std::to_string(frames_.size()) +
                                                      " frames can be used; the first: " + skipped_.front().reason);
    return std::nullopt;
  }
  std::vector<double> pass_over(double timestamp) override {
    std::vector<double> stamps;
    for (; position_ + 1 < frames_.size() && frames_[position_ + 1].colour.stamp <= timestamp; ++position_)
      stamps.push_back(frames_[position_].colour.stamp);
    return stamps;
  }
  Trajectory truth() const override { return truth_; }
  std::vector<SkippedFrame> skipped() const override { return skipped_; }
  Warnings warnings() const override {
    Warnings warnings = bag_->warnings();
    add_warnings(warnings, imu_.warnings());
    return warnings;
  }

 private:
  Camera read_camera() {
    const BagMessage message = bag_->messages(topics_.camera_info.name).front();
    Camera camera = read_camera_info(bag_->content(message), is_rectified(topics_.colour.name));
    if (description_.has_right) camera.baseline = baseline_of_pair(camera);
    return camera;
  }
  /// Fails for a pair that is not rectified.
  double baseline_of_pair(const Camera& left) {
    const std::string& name = topics_.right_camera_info.name;
    if (name.empty())
      throw InputError({settings_.path.string()},
                       "has no camera_info beside '" + topics_.right.name +
                           "', which tells the baseline; give camera and baseline under `camera:`");
    const Message info = bag_->content(bag_->messages(name).front());
    Camera right = read_right_camera_info(info);
    const double baseline = std::exchange(right.baseline, left.baseline);
    // The projection matrix is that of rectified images, which those of this topic need not be.
    if (!(right == left) || !(read_camera_info(info, is_rectified(topics_.right.name)) == left))
      throw InputError(
          {settings_.path.string()},
          "the images of '" + topics_.colour.name + "' and '" + topics_.right.name +
              "' are not of a rectified pair: their camera_info differ in more than the baseline, or have a "
              "distortion; record the topics image_rect of stereo_image_proc");
    return baseline;
  }
  /// Fails for a configured camera, given or by default, whose baseline is not that of the bag, if the bag tells one.
  void check_baseline(const Camera& given) {
    const std::string& name = topics_.right_camera_info.name;
    const bool is_used = !description_.camera;
    if (name.empty() || (!is_used && given.baseline == Camera().baseline)) return;
    const std::optional<double> told = read_baseline(bag_->content(bag_->messages(name).front()));
    constexpr double rounding = 0.01;
    if (!told || std::abs(given.baseline - *told) <= rounding * *told) return;
    throw InputError(
        {settings_.path.string()},
        "'" + name + "' tells a baseline of " + std::to_string(*told) + " m, but the configuration has one of " +
            std::to_string(given.baseline) + " m" +
            (given.baseline == Camera().baseline ? ", which is the default where `camera:` gives none" : "") +
            "; write `baseline: " + std::to_string(*told) +
            "` under `camera:`, or `source.rosbag.camera_info: none` if the bag is wrong");
  }
  void register_depth(const Camera& colour) {
    const RealsenseDepth depth = read_realsense_depth(*bag_, topics_.colour.name, topics_.depth.name);
    if (depth.factor) settings_.depth_factor = *depth.factor;
    registration_.emplace(depth.camera, colour, depth.T_colour_depth);
  }
  SensorFrame decode(const BagFrame& source) {
    SensorFrame frame;
    frame.timestamp = source.colour.stamp;
    const Message colour = bag_->content(source.colour.message);
    frame.colour = decode_colour(colour);
    if (!source.second) return frame;
    const Message second = bag_->content(source.second->message);
    if (description_.has_right)
      frame.right = decode_colour(second);
    else
      add_depth(second, source.second->stamp - source.colour.stamp, frame);
    return frame;
  }
  cv::Mat decode_colour(const Message& message) {
    return images_.colour(message, [&](const cv::Size& size) {
      if (size != size_)
        throw InputError({message.place}, "is " + size_text(size.width, size.height) + " pixels, but the camera is " +
                                              size_text(size_.width, size_.height) +
                                              "; give the camera of this recording under `camera:`");
    });
  }
  void add_depth(const Message& depth, double delay, SensorFrame& frame) {
    frame.depth_delay = delay;
    const cv::Size expected = registration_ ? registration_->depth_size() : size_;
    frame.depth = images_.depth(depth, {settings_.depth_factor, settings_.invalid_depth}, [&](const cv::Size& size) {
      if (size == expected) return;
      const std::string is = "is " + size_text(size.width, size.height) + " pixels, but its ";
      const std::string wanted = " is " + size_text(expected.width, expected.height);
      if (registration_)
        throw InputError({depth.place}, is + "camera_info" + wanted +
                                            ", so that its calibration is of another mode; record again without "
                                            "changing the mode, or use the colour images alone: "
                                            "`source.rosbag.depth: none`");
      throw InputError({depth.place}, is + "colour image" + wanted +
                                          "; expected depth registered to the colour image; choose its topic with "
                                          "`source.rosbag.depth`");
    });
    if (registration_) frame.depth = registration_->apply(frame.depth);
  }

  RosbagSettings settings_;
  std::unique_ptr<Bag> bag_;
  ChosenTopics topics_;
  std::vector<BagFrame> frames_;
  cv::Size size_;
  ImageMessages images_;
  std::optional<DepthRegistration> registration_;  ///< of depth that is not registered to colour
  SourceDescription description_;
  Trajectory truth_;
  RecordedImu imu_;
  std::vector<SkippedFrame> skipped_;
  std::size_t position_ = 0;
};

}  // namespace

HOLDFAST_PLUGIN(rosbag, registry) {
  registry.add<FrameSource, RosbagSource, RosbagSettings>(
      {.name = "rosbag",
       .summary =
           "Bags of ROS 1 and 2 (.bag, MCAP, SQLite): colour, depth and calibration of their topics, named or found.",
       .paper = ""});
}

}  // namespace holdfast
