// SPDX-License-Identifier: BSD-3-Clause
// A component of ROS 2 with a lifecycle: images in; pose, transforms, map, grid, obstacles and diagnostics out.
#include <chrono>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <rclcpp/rclcpp.hpp>
#include <rclcpp_components/register_node_macro.hpp>
#include <rclcpp_lifecycle/lifecycle_node.hpp>
#include <sensor_msgs/msg/camera_info.hpp>
#include <sensor_msgs/msg/compressed_image.hpp>
#include <sensor_msgs/msg/image.hpp>
#include <sensor_msgs/msg/imu.hpp>
#include <shared_mutex>
#include <std_srvs/srv/set_bool.hpp>
#include <std_srvs/srv/trigger.hpp>
#include <string>
#include <utility>
#include <vector>

#include "holdfast/bridge/message_fields.hpp"
#include "node_parameters.hpp"
#include "publisher.hpp"

namespace holdfast_ros {

using rclcpp_lifecycle::LifecycleNode;
using sensor_msgs::msg::CameraInfo;
using sensor_msgs::msg::CompressedImage;
using sensor_msgs::msg::Image;
using std_srvs::srv::SetBool;
using std_srvs::srv::Trigger;

static bridge::CameraInfo camera_info(const CameraInfo& message) {
  bridge::CameraInfo info;
  info.width = message.width, info.height = message.height;
  info.distortion_model = message.distortion_model;
  info.D = message.d;
  info.K = message.k;
  info.P = message.p;
  info.binning_x = message.binning_x, info.binning_y = message.binning_y;
  return info;
}

class HoldfastNode final : public LifecycleNode {
 public:
  explicit HoldfastNode(const rclcpp::NodeOptions& options) : LifecycleNode("holdfast", options) {
    declare_parameters(*this);
    // A robot's lifecycle manager sets it to false and asks for the transitions itself.
    if (!declare_parameter("autostart", true)) return;
    start_timer_ = create_wall_timer(std::chrono::milliseconds(1), [this] {
      start_timer_->cancel();
      configure();
      activate();
    });
  }

  CallbackReturn on_configure(const rclcpp_lifecycle::State&) override try {
    parameters_ = read_parameters(*this);
    transforms_ = std::make_unique<tf2_ros::Buffer>(get_clock());
    listener_ = std::make_unique<tf2_ros::TransformListener>(*transforms_);
    publisher_ = std::make_unique<Publisher>(*this, parameters_, *transforms_);
    bridge_ = std::make_unique<bridge::Bridge>(parameters_.bridge, *publisher_);
    bridge_->pause(true);
    subscribe();
    offer_services();
    diagnostics_timer_ =
        create_wall_timer(std::chrono::seconds(1), [this] { publisher_->publish_diagnostics(bridge_->diagnostics()); });
    return CallbackReturn::SUCCESS;
  } catch (const std::exception& error) {
    RCLCPP_ERROR(get_logger(), "%s", error.what());
    clear();
    return CallbackReturn::FAILURE;
  }

  CallbackReturn on_activate(const rclcpp_lifecycle::State& state) override {
    LifecycleNode::on_activate(state);  // the publishers
    bridge_->pause(false);
    return CallbackReturn::SUCCESS;
  }

  CallbackReturn on_deactivate(const rclcpp_lifecycle::State& state) override {
    bridge_->pause(true);
    LifecycleNode::on_deactivate(state);
    return CallbackReturn::SUCCESS;
  }

  CallbackReturn on_cleanup(const rclcpp_lifecycle::State&) override {
    clear();
    return CallbackReturn::SUCCESS;
  }

  CallbackReturn on_shutdown(const rclcpp_lifecycle::State&) override {
    clear();
    return CallbackReturn::SUCCESS;
  }

 private:
  void clear() {
    const std::unique_lock lock(use_mutex_);  // no callback is under way
    diagnostics_timer_.reset();
    subscriptions_.clear();
    services_.clear();
    bridge_.reset();  // before what it calls
    publisher_.reset();
    listener_.reset();
    transforms_.reset();
    knows_camera_pose_ = false;
    first_image_.reset();
  }

  /// A topic with a thread of its own, where the executor has several. Sensor data fits every publisher.
  template <class Message>
  void listen(const std::string& topic, std::function<void(const Message&)> use) {
    rclcpp::SubscriptionOptions options;
    options.callback_group = create_callback_group(rclcpp::CallbackGroupType::MutuallyExclusive);
    subscriptions_.push_back(create_subscription<Message>(
        topic, rclcpp::SensorDataQoS(),
        [this, use](std::shared_ptr<const Message> message) {
          const std::shared_lock lock(use_mutex_);
          if (bridge_) use(*message);
        },
        options));
  }

  void subscribe() {
    if (parameters_.is_compressed)
      subscribe_compressed();
    else
      subscribe_raw();
    listen<CameraInfo>("camera_info", [this](const CameraInfo& m) { bridge_->set_camera(camera_info(m)); });
    if (parameters_.bridge.has_right)
      listen<CameraInfo>("right_camera_info",
                         [this](const CameraInfo& m) { bridge_->set_right_camera(camera_info(m)); });
    listen<sensor_msgs::msg::Imu>("imu", [this](const sensor_msgs::msg::Imu& m) {
      bridge_->add_inertia(bridge::inertial_sample(m, stamp_of(m.header.stamp)));
    });
  }

  void subscribe_raw() {
    listen<Image>("colour", [this](const Image& m) {
      if (knows_camera_pose(m.header)) bridge_->add_colour(bridge::raw_image(m, stamp_of(m.header.stamp)));
    });
    if (parameters_.bridge.has_depth)
      listen<Image>("depth",
                    [this](const Image& m) { bridge_->add_depth(bridge::raw_image(m, stamp_of(m.header.stamp))); });
    if (parameters_.bridge.has_right)
      listen<Image>("right",
                    [this](const Image& m) { bridge_->add_right(bridge::raw_image(m, stamp_of(m.header.stamp))); });
  }

  void subscribe_compressed() {
    listen<CompressedImage>("colour/compressed", [this](const CompressedImage& m) {
      if (knows_camera_pose(m.header)) bridge_->add_colour(bridge::compressed_image(m, stamp_of(m.header.stamp)));
    });
    if (parameters_.bridge.has_depth)
      listen<CompressedImage>("depth/compressedDepth", [this](const CompressedImage& m) {
        bridge_->add_depth(bridge::compressed_image(m, stamp_of(m.header.stamp)));
      });
    if (parameters_.bridge.has_right)
      listen<CompressedImage>("right/compressed", [this](const CompressedImage& m) {
        bridge_->add_right(bridge::compressed_image(m, stamp_of(m.header.stamp)));
      });
  }

  /// Looks for the pose of the camera on the robot until it is there or the wait is over. Called by one thread at a
  /// time, that of the colour images.
  bool knows_camera_pose(const std_msgs::msg::Header& header) {
    if (knows_camera_pose_) return true;
    const std::string frame = parameters_.camera_frame.empty() ? header.frame_id : parameters_.camera_frame;
    publisher_->set_camera_frame(frame);
    const auto now = std::chrono::steady_clock::now();
    if (!first_image_) first_image_ = now;
    try {
      bridge_->set_camera_pose(bridge::isometry_of(
          transforms_->lookupTransform(parameters_.base_frame, frame, tf2::TimePointZero).transform));
      return knows_camera_pose_ = true;
    } catch (const tf2::TransformException& error) {
      if (std::chrono::duration<double>(now - *first_image_).count() < parameters_.transform_wait) return false;
      place_camera_ahead(frame, error.what());
      return knows_camera_pose_ = true;
    }
  }

  void place_camera_ahead(const std::string& frame, const std::string& reason) {
    RCLCPP_WARN(get_logger(), "the camera is taken to look ahead from %s, because tf does not tell: %s",
                parameters_.base_frame.c_str(), reason.c_str());
    Eigen::Isometry3d T_base_camera = Eigen::Isometry3d::Identity();
    T_base_camera.linear() << 0, 0, 1, -1, 0, 0, 0, -1, 0;
    if (parameters_.publishes_tf && !frame.empty() && frame != parameters_.base_frame)
      publisher_->publish_camera(T_base_camera, frame);
  }

  void offer_services() {
    const auto map_file = [this] { return get_parameter("map_file").as_string(); };
    offer("~/save_map", [this, map_file] {
      bridge_->save_map(map_file());
      return "saved " + map_file();
    });
    offer("~/load_map", [this, map_file] {
      bridge_->load_map(map_file(), false);
      return "continues " + map_file();
    });
    offer("~/localise", [this, map_file] {
      bridge_->load_map(map_file(), true);
      return "localises in " + map_file();
    });
    offer("~/reset", [this] {
      bridge_->reset();
      return std::string("a new map begins");
    });
    services_.push_back(create_service<SetBool>(
        "~/pause", [this](std::shared_ptr<SetBool::Request> request, std::shared_ptr<SetBool::Response> response) {
          bridge_->pause(request->data);
          response->success = true;
          response->message = request->data ? "paused" : "goes on";
        }));
  }

  void offer(const std::string& name, const std::function<std::string()>& work) {
    services_.push_back(create_service<Trigger>(
        name, [work](std::shared_ptr<Trigger::Request>, std::shared_ptr<Trigger::Response> response) {
          try {
            response->message = work();
            response->success = true;
          } catch (const std::exception& error) {
            response->message = error.what();
            response->success = false;
          }
        }));
  }

  NodeParameters parameters_;
  std::unique_ptr<tf2_ros::Buffer> transforms_;
  std::unique_ptr<tf2_ros::TransformListener> listener_;
  std::unique_ptr<Publisher> publisher_;
  std::unique_ptr<bridge::Bridge> bridge_;
  bool knows_camera_pose_ = false;
  std::optional<std::chrono::steady_clock::time_point> first_image_;
  std::shared_mutex use_mutex_;  // shared by callbacks of topics, which have threads of their own
  std::vector<rclcpp::SubscriptionBase::SharedPtr> subscriptions_;
  std::vector<rclcpp::ServiceBase::SharedPtr> services_;
  rclcpp::TimerBase::SharedPtr start_timer_, diagnostics_timer_;
};

}  // namespace holdfast_ros

RCLCPP_COMPONENTS_REGISTER_NODE(holdfast_ros::HoldfastNode)
