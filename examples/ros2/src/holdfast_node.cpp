// SPDX-License-Identifier: BSD-3-Clause
// A node for ROS 2: colour, depth and camera_info in; pose, path, static points and masks out. README.md says the rest.
#include <rclcpp/version.h>
#include <cv_bridge/cv_bridge.hpp>
#include <geometry_msgs/msg/pose_stamped.hpp>
#include <message_filters/subscriber.hpp>
#include <message_filters/sync_policies/approximate_time.hpp>
#include <message_filters/synchronizer.hpp>
#include <nav_msgs/msg/path.hpp>
#include <rclcpp/rclcpp.hpp>
#include <sensor_msgs/msg/camera_info.hpp>
#include <sensor_msgs/msg/image.hpp>
#include <sensor_msgs/msg/point_cloud2.hpp>
#include <sensor_msgs/point_cloud2_iterator.hpp>
#include <tf2_eigen/tf2_eigen.hpp>

#include "holdfast/holdfast.hpp"
#include "holdfast/settings/all.hpp"
using geometry_msgs::msg::PoseStamped;
using nav_msgs::msg::Path;
using sensor_msgs::msg::CameraInfo;
using sensor_msgs::msg::Image;
using sensor_msgs::msg::PointCloud2;

/// Holdfast's world is the first camera (z forward, y down); ROS has x forward and z up.
static const Eigen::Isometry3d T_map_world(Eigen::Quaterniond(0.5, -0.5, 0.5, -0.5));

static PoseStamped to_message(const std_msgs::msg::Header& header, const Eigen::Isometry3d& T_world_camera) {
  PoseStamped message;
  message.header = header;
  message.header.frame_id = "map";
  message.pose = tf2::toMsg(T_map_world * T_world_camera);
  return message;
}

static holdfast::Camera to_camera(const CameraInfo& info) {
  holdfast::Camera camera;
  camera.width = int(info.width), camera.height = int(info.height);
  camera.fx = info.k[0], camera.fy = info.k[4], camera.cx = info.k[2], camera.cy = info.k[5];
  std::vector<double> d = info.d;
  d.resize(8, 0.0);
  camera.distortion = {d[0], d[1], d[2], d[3], d[4], d[5], d[6], d[7]};  // plumb_bob or rational_polynomial
  if (info.distortion_model == "equidistant")
    camera.distortion = {d[0], d[1], 0, 0, d[2], d[3], 0, 0, holdfast::Lens::fisheye};
  return camera;
}

/// Publishes masks in the thread of the frames, and points in that of the mapping.
class Publisher final : public holdfast::Observer {
 public:
  explicit Publisher(rclcpp::Node& node)
      : mask_(node.create_publisher<Image>("~/mask", 1)), points_(node.create_publisher<PointCloud2>("~/points", 1)) {}

  void on_frame(const holdfast::SensorFrame& sensor, const holdfast::Frame& frame,
                const holdfast::FrameResult&) override {
    const holdfast::CoarseView& view = frame.coarse;
    if (view.mask.empty()) return;
    cv_bridge::CvImage message;
    message.header.stamp = rclcpp::Time(static_cast<std::int64_t>(sensor.timestamp * 1e9));
    message.encoding = "mono8";  // 255 where something is that can move; a cell is four undistorted pixels wide
    message.image.create(view.grid.rows, view.grid.columns, CV_8UC1);
    for (std::size_t i = 0; i < view.mask.labels.size(); ++i)
      message.image.data[i] = holdfast::CellMask::is_object(view.mask.labels[i]) ? 255 : 0;
    mask_->publish(*message.toImageMsg());
  }

  void on_keyframe(holdfast::KeyFrameId, const holdfast::ObservedMap& map) override {
    PointCloud2 cloud;
    cloud.header.frame_id = "map";
    sensor_msgs::PointCloud2Modifier modifier(cloud);
    modifier.setPointCloud2FieldsByString(1, "xyz");
    modifier.resize(map.snapshot().points.size());
    std::size_t count = 0;
    sensor_msgs::PointCloud2Iterator<float> x(cloud, "x"), y(cloud, "y"), z(cloud, "z");
    for (const holdfast::MapSnapshot::Point& point : map.snapshot().points) {
      if (point.static_log_odds < 0.0F) continue;  // rather moving
      const Eigen::Vector3f place = (T_map_world * point.position).cast<float>();
      *x = place.x(), *y = place.y(), *z = place.z(), ++x, ++y, ++z, ++count;
    }
    modifier.resize(count);
    points_->publish(cloud);
  }

 private:
  rclcpp::Publisher<Image>::SharedPtr mask_;
  rclcpp::Publisher<PointCloud2>::SharedPtr points_;
};

class HoldfastNode final : public rclcpp::Node {
 public:
  HoldfastNode() : Node("holdfast"), synchroniser_(Policy(10), colour_, depth_, info_) {
#if RCLCPP_VERSION_GTE(29, 0, 0)
    const rclcpp::QoS quality = rclcpp::SensorDataQoS();
#else
    const rmw_qos_profile_t quality = rmw_qos_profile_sensor_data;  // what the filters take up to Jazzy
#endif
    colour_.subscribe(this, "colour", quality);
    depth_.subscribe(this, "depth", quality);
    info_.subscribe(this, "camera_info", quality);
    synchroniser_.registerCallback(&HoldfastNode::on_images, this);
  }

 private:
  using Policy = message_filters::sync_policies::ApproximateTime<Image, Image, CameraInfo>;

  void start(const CameraInfo& info) {
    holdfast::PipelineBuilder builder;
    builder.camera(to_camera(info)).features(holdfast::OrbSettings{}).optimizer(holdfast::SchurSettings{});
    if (segment_people_) builder.segmenter(holdfast::UnetSettings{}).filter(holdfast::SemanticMaskSettings{});
    builder.filter(holdfast::MultiViewDepthSettings{}).loop_detector(holdfast::FlannSettings{});
    builder.observer({std::make_unique<Publisher>(*this), "ros"}).run({.mode = holdfast::RunMode::threaded});
    pipeline_.emplace(builder.build());
  }

  void on_images(const Image::ConstSharedPtr& colour, const Image::ConstSharedPtr& depth,
                 const CameraInfo::ConstSharedPtr& info) try {
    if (!pipeline_) start(*info);
    holdfast::SensorFrame frame;
    frame.timestamp = rclcpp::Time(colour->header.stamp).seconds();
    frame.colour = cv_bridge::toCvCopy(colour, "bgr8")->image;
    const cv_bridge::CvImageConstPtr raw = cv_bridge::toCvShare(depth);
    raw->image.convertTo(frame.depth, CV_32FC1, raw->encoding == "16UC1" ? 1e-3 : 1.0);  // millimetres, or metres
    cv::patchNaNs(frame.depth, 0.0);
    const holdfast::FrameResult result = pipeline_->feed(frame);
    if (!result.T_world_camera) return;  // lost; it recovers by itself
    const PoseStamped pose = to_message(colour->header, *result.T_world_camera);
    pose_->publish(pose);
    if (!result.is_keyframe) return;
    Path path;  // all of it, with what later frames corrected
    path.header = pose.header;
    for (const auto& past : pipeline_->trajectory()) path.poses.push_back(to_message(pose.header, past.T_world_camera));
    path_->publish(path);
  } catch (const std::exception& error) {
    RCLCPP_WARN(get_logger(), "frame left out: %s", error.what());
  }

  const bool segment_people_ = declare_parameter("segment_people", true);
  const rclcpp::Publisher<PoseStamped>::SharedPtr pose_ = create_publisher<PoseStamped>("~/pose", 10);
  const rclcpp::Publisher<Path>::SharedPtr path_ = create_publisher<Path>("~/path", 1);
  message_filters::Subscriber<Image> colour_, depth_;
  message_filters::Subscriber<CameraInfo> info_;
  message_filters::Synchronizer<Policy> synchroniser_;
  std::optional<holdfast::Pipeline> pipeline_;
};

int main(int argument_count, char** arguments) {
  rclcpp::init(argument_count, arguments);
  rclcpp::spin(std::make_shared<HoldfastNode>());
  rclcpp::shutdown();
}
