// SPDX-License-Identifier: BSD-3-Clause
#include "filter_scene.hpp"

#include <cmath>
#include <limits>

#include "holdfast/core/random.hpp"

namespace holdfast::conformance {

namespace {
constexpr std::uint64_t keyframes = 2;  // the first frames of the scene are in the map
constexpr int wanted_points = 320;
}  // namespace

FilterScene::FilterScene(const Camera& camera, std::size_t count)
    : scene_(camera), sampler_(camera), camera_(std::make_shared<const Camera>(camera)) {
  choose_points();
  make_map();
  for (std::size_t i = 0; i < count; ++i) moments_.push_back(moment_at(keyframes + i));
}

void FilterScene::choose_points() {
  Random random(17);
  for (int i = 0; i < wanted_points; ++i) {
    const Camera& camera = *camera_;
    const double y = random.uniform(0.0, camera.height - 1.0), x = random.uniform(0.0, camera.width - 1.0);
    const auto hit = scene_.look(0, x, y);
    if (hit.depth <= 0.0) continue;
    Point point{hit.point, hit.label == Scene::person, static_cast<std::uint8_t>(random.below(4)), {}, {}};
    for (std::uint64_t& word : point.descriptor.words) word = random.next();
    points_.push_back(point);
  }
}

Moment FilterScene::moment_at(std::uint64_t index) {
  const Camera& camera = *camera_;
  Moment moment;
  moment.sensor = scene_.frame(index);
  Frame& frame = moment.frame;
  frame.index = index;
  frame.timestamp = moment.sensor.timestamp;
  frame.camera = camera_;
  frame.pyramid = pyramid_;
  frame.T_camera_world = Scene::T_world_camera(index).inverse();
  sampler_.sample_depth(moment.sensor.depth, frame.coarse);
  point_of_feature_.clear();
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const Point& point = points_[i];
    const Eigen::Vector3d seen =
        frame.T_camera_world * (point.position + (point.moves ? Scene::moved(index) : Eigen::Vector3d::Zero()));
    if (seen.z() < 0.2) continue;
    const Eigen::Vector2d pixel = camera.project(seen);
    const int column = static_cast<int>(std::lround(pixel.x())), row = static_cast<int>(std::lround(pixel.y()));
    if (column < 0 || row < 0 || column >= camera.width || row >= camera.height) continue;
    constexpr double same_surface = 0.05;  // m
    if (std::abs(moment.sensor.depth.at<float>(row, column) - seen.z()) > same_surface) continue;
    frame.x.push_back(static_cast<float>(pixel.x())), frame.y.push_back(static_cast<float>(pixel.y()));
    frame.depth.push_back(static_cast<float>(seen.z()));
    frame.right_x.push_back(static_cast<float>(camera.right_x(pixel.x(), seen.z())));
    frame.map_points.push_back(point.id);
    frame.features.angle.push_back(1.0F), frame.features.response.push_back(50.0F);
    frame.features.octave.push_back(point.octave);
    frame.features.descriptors.push_back(point.descriptor);
    point_of_feature_.push_back(i);
  }
  frame.features.x = frame.x, frame.features.y = frame.y;
  frame.static_probability.assign(frame.size(), 1.0F);
  frame.measured_log_odds.assign(frame.size(), 0.0F);
  frame.grid.build(frame.x, frame.y, {0.0F, 0.0F, static_cast<float>(camera.width), static_cast<float>(camera.height)});
  moment.segmentation.labels = moment.sensor.truth->class_labels;
  moment.segmentation.confidence = cv::Mat(moment.segmentation.labels.size(), CV_8UC1, cv::Scalar(220));
  sampler_.sample_labels(moment.segmentation.labels, 255, frame.coarse.mask.labels);
  frame.coarse.mask.confidence.assign(frame.coarse.mask.labels.size(), 200);
  frame.coarse.mask.age = 0.1;
  return moment;
}

void FilterScene::make_map() {
  for (std::uint64_t index = 0; index < keyframes; ++index) {
    const Moment moment = moment_at(index);
    const std::vector<std::size_t> owners = point_of_feature_;
    Frame frame = moment.frame;
    frame.map_points.assign(frame.size(), MapPointId());
    const KeyFrameId keyframe = map_.add_keyframe(std::move(frame));
    for (std::size_t feature = 0; feature < owners.size(); ++feature) {
      Point& point = points_[owners[feature]];
      if (!point.id.valid()) point.id = map_.add_point(point.position, index);
      map_.add_observation(point.id, keyframe, static_cast<std::uint32_t>(feature));
    }
    map_.update_covisibility(keyframe);
  }
  for (const Point& point : points_)
    if (point.id.valid()) map_.update_point(point.id);
}

StaticEvidence FilterScene::earlier(std::size_t moment) const {
  const Moment& now = moments_[moment];
  StaticEvidence evidence(now.frame.size(), now.frame.coarse.depth.size());
  evidence.begin_stage("earlier");
  const cv::Mat& labels = now.segmentation.labels;
  for (std::size_t i = 0; i < now.frame.size(); ++i) {
    const int column = static_cast<int>(std::lround(now.frame.x[i])),
              row = static_cast<int>(std::lround(now.frame.y[i]));
    if (labels.at<std::uint8_t>(row, column) == Scene::person) evidence.add(i, -1.5F, StaticEvidence::Kind::prior);
  }
  for (std::size_t cell = 0; cell < now.frame.coarse.depth.size(); ++cell)
    if (now.frame.coarse.mask.labels[cell] == Scene::person) evidence.add_cell(cell, -2.0F);
  return evidence;
}

void FilterScene::judge(DynamicFilter& filter, std::size_t moment, const Shown& shown, StaticEvidence& evidence) const {
  const Moment& now = moments_[moment];
  const Eigen::Isometry3d T_camera_world = now.frame.T_camera_world;
  const bool has_masks = shown.masks && !now.frame.coarse.mask.empty();
  Frame frame = now.frame;
  if (!has_masks) frame.coarse.mask.clear();
  constexpr double deviation = 0.002;  // [m], [rad]
  const PredictedPose predicted{T_camera_world, deviation * deviation * Eigen::Matrix<double, 6, 6>::Identity()};
  filter.apply({.sensor_frame = now.sensor,
                .frame = frame,
                .previous = shown.previous && moment > 0 ? &moments_[moment - 1].frame : nullptr,
                .map = map_,
                .T_camera_world = shown.pose ? &T_camera_world : nullptr,
                .inertial_prediction = shown.inertia ? &predicted : nullptr,
                .segmentation = has_masks && moment % 2 == 1 ? &now.segmentation : nullptr,
                .classes = has_masks ? &Scene::classes() : nullptr},
               evidence);
}

std::vector<StaticEvidence> FilterScene::judge(DynamicFilter& filter, const Shown& shown) const {
  std::vector<StaticEvidence> result;
  for (std::size_t i = 0; i < moments_.size(); ++i) {
    StaticEvidence& evidence = result.emplace_back(earlier(i));
    evidence.begin_stage("filter");
    judge(filter, i, shown, evidence);
  }
  return result;
}

void remove_features(Frame& frame) {
  frame.features.clear();
  frame.x.clear(), frame.y.clear(), frame.depth.clear(), frame.right_x.clear(), frame.map_points.clear();
  frame.static_probability.clear(), frame.measured_log_odds.clear();
  frame.grid.build(frame.x, frame.y,
                   {0.0F, 0.0F, static_cast<float>(frame.camera->width), static_cast<float>(frame.camera->height)});
}

namespace {
void strip_depth(Frame& frame) {
  frame.depth.assign(frame.size(), 0.0F);
  frame.right_x.assign(frame.size(), std::numeric_limits<float>::quiet_NaN());
  frame.coarse.depth.assign(frame.coarse.depth.size(), 0.0F);
}
}  // namespace

void remove_depth(Moment& moment) {
  moment.sensor.depth = cv::Mat();
  strip_depth(moment.frame);
}

void FilterScene::remove_depth() {
  map_.set_sensor(Sensor::mono);
  for (const KeyFrameId id : map_.keyframes().ids()) strip_depth(map_.keyframe(id).frame);
  for (Moment& moment : moments_) conformance::remove_depth(moment);
}

}  // namespace holdfast::conformance
