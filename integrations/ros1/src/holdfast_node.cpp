// SPDX-License-Identifier: BSD-3-Clause
// A node of ROS 1: images in; pose, transforms, map, grid, obstacles and diagnostics out. README.md says the rest.
#include <ros/ros.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/CompressedImage.h>
#include <sensor_msgs/Image.h>
#include <sensor_msgs/Imu.h>
#include <std_srvs/SetBool.h>
#include <std_srvs/Trigger.h>
#include <tf2_ros/transform_listener.h>

#include <exception>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "holdfast/bridge/message_fields.hpp"
#include "publisher.hpp"

namespace holdfast_ros {

static bridge::CameraInfo camera_info(const sensor_msgs::CameraInfo& message) {
  bridge::CameraInfo info;
  info.width = message.width, info.height = message.height;
  info.distortion_model = message.distortion_model;
  info.D = message.D;
  std::copy(message.K.begin(), message.K.end(), info.K.begin());
  std::copy(message.P.begin(), message.P.end(), info.P.begin());
  info.binning_x = message.binning_x, info.binning_y = message.binning_y;
  return info;
}

class HoldfastNode {
 public:
  HoldfastNode()
      : node_("~"),
        parameters_(read_parameters(node_)),
        listener_(transforms_),
        publisher_(node_, parameters_, transforms_),
        bridge_(parameters_.bridge, publisher_) {
    if (parameters_.is_compressed)
      subscribe_compressed();
    else
      subscribe_raw();
    listen<sensor_msgs::CameraInfo>("camera_info", [this](const auto& m) { bridge_.set_camera(camera_info(m)); });
    if (parameters_.bridge.has_right)
      listen<sensor_msgs::CameraInfo>("right_camera_info",
                                      [this](const auto& m) { bridge_.set_right_camera(camera_info(m)); });
    listen<sensor_msgs::Imu>(
        "imu", [this](const auto& m) { bridge_.add_inertia(bridge::inertial_sample(m, stamp_of(m.header.stamp))); });
    offer_services();
    // By the clock on the wall: a bag that stands still is worth a diagnosis, too.
    timer_ = node_.createWallTimer(ros::WallDuration(1.0), [this](const ros::WallTimerEvent&) {
      publisher_.publish_diagnostics(bridge_.diagnostics());
    });
  }

 private:
  template <class Message>
  void listen(const std::string& topic, std::function<void(const Message&)> use) {
    // 10 messages: the bridge has a queue of its own, and says what it drops.
    subscribers_.push_back(node_.subscribe<Message>(
        topic, 10, [use](const boost::shared_ptr<const Message>& message) { use(*message); }, {},
        ros::TransportHints().tcpNoDelay()));
  }

  void subscribe_raw() {
    listen<sensor_msgs::Image>("colour", [this](const auto& m) {
      if (knows_camera_pose(m.header)) bridge_.add_colour(bridge::raw_image(m, stamp_of(m.header.stamp)));
    });
    if (parameters_.bridge.has_depth)
      listen<sensor_msgs::Image>(
          "depth", [this](const auto& m) { bridge_.add_depth(bridge::raw_image(m, stamp_of(m.header.stamp))); });
    if (parameters_.bridge.has_right)
      listen<sensor_msgs::Image>(
          "right", [this](const auto& m) { bridge_.add_right(bridge::raw_image(m, stamp_of(m.header.stamp))); });
  }

  void subscribe_compressed() {
    listen<sensor_msgs::CompressedImage>("colour/compressed", [this](const auto& m) {
      if (knows_camera_pose(m.header)) bridge_.add_colour(bridge::compressed_image(m, stamp_of(m.header.stamp)));
    });
    if (parameters_.bridge.has_depth)
      listen<sensor_msgs::CompressedImage>("depth/compressedDepth", [this](const auto& m) {
        bridge_.add_depth(bridge::compressed_image(m, stamp_of(m.header.stamp)));
      });
    if (parameters_.bridge.has_right)
      listen<sensor_msgs::CompressedImage>("right/compressed", [this](const auto& m) {
        bridge_.add_right(bridge::compressed_image(m, stamp_of(m.header.stamp)));
      });
  }

  /// Looks for the pose of the camera on the robot until it is there or the wait is over. Called by one thread at a
  /// time, that of the colour images.
  bool knows_camera_pose(const std_msgs::Header& header) {
    if (knows_camera_pose_) return true;
    const std::string frame = parameters_.camera_frame.empty() ? header.frame_id : parameters_.camera_frame;
    publisher_.set_camera_frame(frame);
    if (first_image_.isZero()) first_image_ = ros::WallTime::now();
    try {
      if (frame.empty()) throw tf2::LookupException("the colour images name no frame");
      bridge_.set_camera_pose(
          bridge::isometry_of(transforms_.lookupTransform(parameters_.base_frame, frame, ros::Time(0)).transform));
      return knows_camera_pose_ = true;
    } catch (const tf2::TransformException& error) {
      if (ros::WallTime::now() - first_image_ < ros::WallDuration(parameters_.transform_wait)) return false;
      place_camera_ahead(frame, error.what());
      return knows_camera_pose_ = true;
    }
  }

  void place_camera_ahead(const std::string& frame, const std::string& reason) {
    ROS_WARN_STREAM("the camera is taken to look ahead from " << parameters_.base_frame
                                                              << ", because tf does not tell: " << reason);
    Eigen::Isometry3d T_base_camera = Eigen::Isometry3d::Identity();
    T_base_camera.linear() << 0, 0, 1, -1, 0, 0, 0, -1, 0;
    if (parameters_.publishes_tf && !frame.empty() && frame != parameters_.base_frame)
      publisher_.publish_camera(T_base_camera, frame);
  }

  void offer_services() {
    offer("save_map", [this] {
      bridge_.save_map(map_file_of(node_));
      return "saved " + map_file_of(node_);
    });
    offer("load_map", [this] {
      bridge_.load_map(map_file_of(node_), false);
      return "continues " + map_file_of(node_);
    });
    offer("localise", [this] {
      bridge_.load_map(map_file_of(node_), true);
      return "localises in " + map_file_of(node_);
    });
    offer("reset", [this] {
      bridge_.reset();
      return std::string("a new map begins");
    });
    services_.push_back(node_.advertiseService<std_srvs::SetBool::Request, std_srvs::SetBool::Response>(
        "pause", [this](std_srvs::SetBool::Request& request, std_srvs::SetBool::Response& response) {
          bridge_.pause(request.data != 0);
          response.success = 1;
          response.message = request.data != 0 ? "paused" : "goes on";
          return true;
        }));
  }

  void offer(const std::string& name, const std::function<std::string()>& work) {
    services_.push_back(node_.advertiseService<std_srvs::Trigger::Request, std_srvs::Trigger::Response>(
        name, [work](std_srvs::Trigger::Request&, std_srvs::Trigger::Response& response) {
          try {
            response.message = work();
            response.success = 1;
          } catch (const std::exception& error) {
            response.message = error.what();
            response.success = 0;
          }
          return true;
        }));
  }

  ros::NodeHandle node_;
  const NodeParameters parameters_;
  tf2_ros::Buffer transforms_;
  tf2_ros::TransformListener listener_;
  Publisher publisher_;
  bridge::Bridge bridge_;
  bool knows_camera_pose_ = false;
  ros::WallTime first_image_;
  std::vector<ros::Subscriber> subscribers_;
  std::vector<ros::ServiceServer> services_;
  ros::WallTimer timer_;
};

}  // namespace holdfast_ros

int main(int argument_count, char** arguments) {
  ros::init(argument_count, arguments, "holdfast");
  try {
    holdfast_ros::HoldfastNode node;
    ros::AsyncSpinner spinner(4);  // images of each topic are converted beside each other
    spinner.start();
    ros::waitForShutdown();
  } catch (const std::exception& error) {
    ROS_FATAL_STREAM(error.what());
    return 1;
  }
}
