// SPDX-License-Identifier: BSD-3-Clause
#include "session.hpp"

#include <cmath>
#include <utility>

#include "conversions.hpp"
#include "holdfast/core/error.hpp"
#include "holdfast/core/frame_health.hpp"
#include "holdfast/plugin/builtin.hpp"

namespace holdfast::bridge {

namespace {

constexpr const char* source_name = "bridge";

/// Stands for the images of the bridge in a configuration; they come by Pipeline::feed().
class BridgeSource final : public FrameSource {
 public:
  explicit BridgeSource(SourceDescription description) : description_(std::move(description)) {}
  SourceDescription describe() const override { return description_; }
  std::optional<SensorFrame> next() override { return std::nullopt; }

 private:
  SourceDescription description_;
};

void register_source(Registry& registry, const SourceDescription& description) {
  registry.add<FrameSource, NoSettings>(
      {.name = source_name, .summary = "The images of a robot."},
      [description](const NoSettings&, const CreationContext&) { return std::make_unique<BridgeSource>(description); });
}

std::vector<Obstacle> obstacles_of(const FrameResult& result, const Eigen::Isometry3d& T_map_world) {
  std::vector<Obstacle> obstacles;
  for (const MovingObject& object : result.objects) {
    if (object.box.isEmpty()) continue;
    Obstacle obstacle;
    obstacle.id = object.id;
    obstacle.class_name = object.class_name;
    obstacle.T_map_box = T_map_world * object.T_world_object;
    obstacle.T_map_box.translate(object.box.center().cast<double>());
    obstacle.size = object.box.sizes().cast<double>();
    obstacle.velocity = T_map_world.linear() * object.velocity;
    obstacle.is_moving = object.moving;
    obstacles.push_back(std::move(obstacle));
  }
  return obstacles;
}

}  // namespace

Configuration read_bridge_configuration(const Parameters& parameters, Registry& registry) {
  register_builtin_plugins(registry);
  Registry resolving = registry;
  register_source(resolving, {});
  ConfigurationNode root = read_yaml(parameters.configuration);
  for (const std::string& text : parameters.overrides) apply_override(root, text, choice_sections());
  const auto set = [&](const std::string& text) { apply_override(root, text, choice_sections()); };
  set(std::string("source=") + source_name);
  set(std::string("run.mode=") + (parameters.is_sequential ? "sequential" : "threaded"));
  set(std::string("run.pace=") + (parameters.is_sequential ? "none" : "timestamps"));
  Configuration configuration = resolve_configuration(root, parameters.configuration, resolving, pipeline_sections());
  load_plugins(configuration, registry);
  return configuration;
}

/// Sees what the pipeline shows to observers only: the mask of a frame, and when the map changes.
class Session::Watcher final : public Observer {
 public:
  explicit Watcher(Session& session) : session_(session) {}
  void on_frame(const SensorFrame&, const Frame& frame, const FrameResult&) override {
    session_.mask_ = session_.mask_of(frame.coarse);
  }
  void on_keyframe(KeyFrameId, const ObservedMap&) override { session_.has_map_changed_ = true; }
  void on_loop(KeyFrameId, KeyFrameId, const ObservedMap&) override { session_.has_map_changed_ = true; }

 private:
  Session& session_;
};

Session::Session(const SessionStart& start) {
  Configuration configuration = start.configuration;
  Registry registry = start.registry;
  register_source(registry, start.source);
  registry.add<Observer, NoSettings>(
      {.name = source_name, .summary = "Shows the pipeline to the bridge."},
      [this](const NoSettings&, const CreationContext&) { return std::make_unique<Watcher>(*this); });
  configuration.observers.push_back({.kind = "observers", .name = source_name, .values = {}, .location = {}});
  built_.emplace(
      build_pipeline(configuration, registry,
                     {.output_directory = {}, .map_file = start.map_file, .localise_only = start.localise_only}));
  sampler_.emplace(built_->pipeline.camera());
  warnings_ = configuration.warnings;
  add_warnings(warnings_, built_->warnings());
  built_->pipeline.finish_loading();
}

FrameOutput Session::add_frame(const ImageSet& images, std::vector<ImuSample> imu,
                               const Eigen::Isometry3d& T_base_camera,
                               const std::optional<Eigen::Isometry3d>& odometry) {
  SensorFrame frame;
  frame.index = next_index_;
  frame.timestamp = seconds(images.colour.stamp);
  frame.colour = images.colour.image;
  frame.depth = images.depth.image;
  frame.right = images.right.image;
  if (!frame.depth.empty()) frame.depth_delay = 1e-9 * static_cast<double>(images.depth.stamp - images.colour.stamp);
  frame.imu = std::move(imu);
  {
    const std::lock_guard lock(mutex_);
    // The world is the camera where the map began, and `map` the robot there.
    if (!placement_) placement_ = Placement{T_base_camera, T_base_camera};
  }
  mask_.release();
  const FrameResult result = built_->pipeline.feed(frame);
  ++next_index_;
  stamp_ = images.colour.stamp;
  if (result.is_keyframe) ++keyframes_;
  FrameOutput output;
  output.stamp = images.colour.stamp;
  output.state = to_string(result.health.state);
  output.mask = mask_;
  describe_pose(result, odometry, output);
  return output;
}

void Session::describe_pose(const FrameResult& result, const std::optional<Eigen::Isometry3d>& odometry,
                            FrameOutput& output) {
  const std::optional<double> before = std::exchange(last_pose_, std::nullopt);
  if (!result.T_world_camera) return;
  const Placement placement = *placement_;
  const std::optional<Eigen::Isometry3d> motion =
      before && !result.health.reasons.has(HealthReason::new_map) ? base_motion(*before, result) : std::nullopt;
  last_pose_ = result.timestamp;
  output.has_pose = true;
  output.T_map_base = placement.T_map_world * *result.T_world_camera * placement.T_base_camera.inverse();
  if (odometry)
    frames_.add_with_odometry(output.T_map_base, *odometry);
  else
    frames_.add(output.T_map_base, motion);
  output.T_map_odom = frames_.T_map_odom();
  output.T_odom_base = frames_.T_odom_base();
  if (motion) output.velocity = velocity_of(*motion, result.timestamp - *before);
  if (result.covariance)
    output.covariance = covariance_in_map(*result.covariance, output.T_map_base, placement.T_base_camera);
  output.obstacles = obstacles_of(result, placement.T_map_world);
}

/// T_previous_now of the robot, as the map sees both frames now.
std::optional<Eigen::Isometry3d> Session::base_motion(double before, const FrameResult& result) const {
  const Trajectory poses = built_->pipeline.poses_at({before, result.timestamp});
  if (poses.size() != 2) return std::nullopt;
  const Eigen::Isometry3d motion = poses[0].T_world_camera.inverse() * poses[1].T_world_camera;
  return placement_->T_base_camera * motion * placement_->T_base_camera.inverse();
}

cv::Mat Session::mask_of(const CoarseView& view) const {
  const CellMask& mask = view.mask;
  if ((mask.empty() && mask.moving.empty()) || !(view.grid == sampler_->grid())) return {};
  std::vector<std::uint8_t> marked(static_cast<std::size_t>(view.grid.size()), 0);
  bool has_any = false;
  for (std::size_t i = 0; i < marked.size(); ++i) {
    const bool is_object = i < mask.labels.size() && CellMask::is_object(mask.labels[i]);
    const bool is_moving = i < mask.moving.size() && mask.moving[i] != 0;
    marked[i] = is_object || is_moving ? 1 : 0;
    has_any = has_any || marked[i] != 0;
  }
  const Camera& camera = built_->pipeline.camera();
  if (!has_any) return cv::Mat::zeros(camera.height, camera.width, CV_8UC1);
  return sampler_->pixels_of(marked);
}

}  // namespace holdfast::bridge
