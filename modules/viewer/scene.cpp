// SPDX-License-Identifier: BSD-3-Clause
#include "scene.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "holdfast/core/after_loss.hpp"
#include "holdfast/core/health_reason_names.hpp"
#include "holdfast/core/version.hpp"

namespace holdfast::viewer {

namespace {

constexpr float unknown = std::numeric_limits<float>::quiet_NaN();
/// Frames of the time chart that a browser which comes later still gets.
constexpr std::size_t chart_length = 600;
/// Positions of moving objects that are kept; the oldest half goes when there are more.
constexpr std::size_t longest_trails = 200'000;

nlohmann::json to_json(const Eigen::Isometry3d& pose) {
  const Eigen::Vector3d t = pose.translation();
  const Eigen::Quaterniond q(pose.linear());
  return {t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()};
}

nlohmann::json to_json(const MovingObject& object, double timestamp) {
  const Eigen::Vector3f low = object.box.min(), high = object.box.max();
  return {{"id", object.id},
          {"class", object.class_name},
          {"pose", to_json(object.T_world_object)},
          {"box", {low.x(), low.y(), low.z(), high.x(), high.y(), high.z()}},
          {"velocity", {object.velocity.x(), object.velocity.y(), object.velocity.z()}},
          {"speed", object.speed()},
          {"moving", object.moving},
          {"hidden", object.last_seen < timestamp}};
}

/// 0 waiting, 1 began the map, 2 tracked, 3 lost, 4 found again, 5 predicted by inertia.
int status_number(TrackingStatus status, TrackingMethod method) {
  if (status == TrackingStatus::waiting) return 0;
  if (status == TrackingStatus::initialised) return 1;
  if (status == TrackingStatus::lost) return 3;
  if (status == TrackingStatus::inertial) return 5;
  return is_after_loss(method) ? 4 : 2;
}

}  // namespace

Scene::Scene(const ViewerOptions& options) : options_(options) {}

void Scene::add(const FrameResult& result) {
  ++version_;
  state_version_ = version_;
  last_ = result;
  ChartEntry entry{
      result.timestamp, result.status, result.method, static_cast<float>(result.tracking_seconds * 1e3), {}};
  for (const StageTimes::Entry& stage : result.times.entries()) {
    const auto [place, is_new] =
        stage_numbers_.try_emplace(std::string(stage.stage), static_cast<std::uint32_t>(stages_.size()));
    if (is_new) stages_.emplace_back(stage.stage);
    entry.stages.emplace_back(place->second, static_cast<float>(stage.seconds * 1e3));
  }
  chart_.push_back(std::move(entry));
  ++chart_end_;
  if (chart_.size() > chart_length) chart_.pop_front();
  if (result.T_world_camera)
    path_.push_back({result.timestamp, result.T_world_camera->translation().cast<float>(),
                     Eigen::Quaternionf(result.T_world_camera->linear().cast<float>()), result.keyframe, result.status,
                     result.method, unknown, 0});
  add_trails(result);
}

void Scene::add_trails(const FrameResult& result) {
  for (const MovingObject& object : result.objects) {
    if (object.last_seen < result.timestamp) continue;
    const Eigen::Vector3f place = object.T_world_object.translation().cast<float>();
    trail_ids_.push_back(object.id);
    trail_positions_.insert(trail_positions_.end(), {place.x(), place.y(), place.z()});
  }
  if (trail_ids_.size() <= longest_trails) return;
  constexpr auto half = static_cast<std::ptrdiff_t>(longest_trails / 2);
  trail_ids_.erase(trail_ids_.begin(), trail_ids_.begin() + half);
  trail_positions_.erase(trail_positions_.begin(), trail_positions_.begin() + 3 * half);
  trail_begin_ += longest_trails / 2;
}

void Scene::set_map(const MapSnapshot& map) {
  map_.update(map, ++version_);
  state_version_ = version_;
  if (map_.has_corrections() && !run_) follow_keyframes();
  cloud_.follow(map_, version_);
}

void Scene::set_classes(std::vector<std::string> names) {
  classes_ = std::move(names);
  head_version_ = ++version_;
}

void Scene::add(std::span<const ViewedClass> classes) { map_.add(classes, ++version_); }

void Scene::add(ViewedSurface surface) {
  if (const Eigen::Isometry3d* pose = map_.pose(surface.keyframe)) surface.T_world_camera = *pose;
  cloud_.add(std::move(surface));
}

void Scene::follow_keyframes() {
  for (PathEntry& entry : path_)
    if (const auto correction = map_.correction(entry.keyframe, entry.timestamp)) {
      entry.position = (*correction * entry.position.cast<double>()).cast<float>();
      entry.turn = Eigen::Quaternionf(correction->linear().cast<float>()) * entry.turn;
      entry.version = version_;
    }
}

void Scene::set_picture(const ViewedPicture& picture) {
  cv::Mat small = picture.colour;
  if (picture.colour.cols > options_.picture_width)
    cv::resize(picture.colour, small, {}, static_cast<double>(options_.picture_width) / picture.colour.cols,
               static_cast<double>(options_.picture_width) / picture.colour.cols, cv::INTER_AREA);
  if (!cv::imencode(".jpg", small, jpeg_, {cv::IMWRITE_JPEG_QUALITY, 72})) return;
  picture_ = picture;
  picture_.colour = cv::Mat();
  ++version_;
  ++picture_number_;
}

void Scene::add_loop(KeyFrameId keyframe, KeyFrameId candidate) {
  ++version_;
  closed_loops_.emplace_back(keyframe, candidate);
}

void Scene::set_run(ViewedRun run) {
  ++version_;
  run_version_ = state_version_ = version_;
  if (!run.title.empty()) options_.title = run.title;
  if (run.camera.width > 0) options_.camera = run.camera;
  head_version_ = version_;
  path_.clear();
  ++path_number_;
  for (std::size_t i = 0; i < run.path.size(); ++i) {
    const Eigen::Isometry3d& pose = run.path[i].T_world_camera;
    path_.push_back({run.path[i].timestamp, pose.translation().cast<float>(),
                     Eigen::Quaternionf(pose.linear().cast<float>()), KeyFrameId(), TrackingStatus::tracked,
                     TrackingMethod::none, i < run.errors.size() ? run.errors[i] : unknown, 0});
  }
  if (!run.cloud.empty()) cloud_.replace(std::exchange(run.cloud, {}));
  if (!run.mesh.empty()) mesh_.replace(std::exchange(run.mesh, {}));
  run_ = std::move(run);
}

void Scene::set_play(const PlayState& play) {
  if (play.is_paused == play_.is_paused && play.speed == play_.speed && play.browsers == play_.browsers) return;
  play_ = play;
  state_version_ = ++version_;
}

void Scene::describe_head(Message& message) const {
  const Camera& camera = options_.camera;
  message.json()["head"] = {{"title", options_.title},
                            {"version", HOLDFAST_VERSION},
                            {"camera", {camera.width, camera.height, camera.fx, camera.fy, camera.cx, camera.cy}},
                            {"frame_rate", camera.frame_rate},
                            {"classes", classes_}};
}

void Scene::describe_state(Message& message) const {
  nlohmann::json& state = message.json()["state"];
  state = {{"paused", play_.is_paused},          {"speed", play_.speed},
           {"browsers", play_.browsers},         {"finished", run_.has_value()},
           {"keyframes", map_.keyframe_count()}, {"points", map_.point_count()}};
  if (!last_) return;
  state["frame"] = last_->index;
  state["timestamp"] = last_->timestamp;
  state["status"] = to_string(last_->status);
  state["status_number"] = status_number(last_->status, last_->method);
  state["health"] = to_string(last_->health.state);
  state["reasons"] = names_of(last_->health.reasons);
  state["method"] = to_string(last_->method);
  state["fallback"] = to_string(last_->fallback);
  state["trouble"] = to_string(last_->failure);
  state["features"] = last_->features;
  state["static_features"] = last_->static_features;
  state["matches"] = last_->matches;
  state["inliers"] = last_->inliers;
  state["tracking_ms"] = last_->tracking_seconds * 1e3;
  if (last_->T_world_camera) state["pose"] = to_json(*last_->T_world_camera);
}

void Scene::describe_frames(Progress& progress, Message& message) const {
  if (progress.stages < stages_.size()) {
    message.json()["stages"] = stages_;
    progress.stages = stages_.size();
  }
  const std::uint64_t begin = std::max(progress.frames, chart_end_ - chart_.size());
  if (begin == chart_end_) return;
  nlohmann::json& frames = message.json()["frames"] = nlohmann::json::array();
  for (std::uint64_t number = begin; number < chart_end_; ++number) {
    const ChartEntry& entry = chart_[chart_.size() - static_cast<std::size_t>(chart_end_ - number)];
    nlohmann::json stages = nlohmann::json::array();
    for (const auto& [stage, milliseconds] : entry.stages) {
      stages.push_back(stage);
      stages.push_back(std::round(milliseconds * 1e3F) * 1e-3F);
    }
    frames.push_back({entry.timestamp, status_number(entry.status, entry.method),
                      std::round(entry.tracking * 1e3F) * 1e-3F, std::move(stages)});
  }
  progress.frames = chart_end_;
}

void Scene::describe_path(Progress& progress, Message& message) const {
  const auto append = [](const PathEntry& entry, std::vector<float>& values) {
    values.insert(values.end(), {entry.position.x(), entry.position.y(), entry.position.z(), entry.turn.x(),
                                 entry.turn.y(), entry.turn.z(), entry.turn.w()});
  };
  if (progress.path_number != path_number_) {
    progress.path_number = path_number_;
    progress.path = 0;
    message.json()["new_path"] = true;
  }
  std::vector<std::uint32_t> moved;
  std::vector<float> values;
  for (std::size_t i = 0; i < progress.path; ++i)
    if (path_[i].version > progress.version) {
      moved.push_back(static_cast<std::uint32_t>(i));
      append(path_[i], values);
    }
  message.add("moved_path", moved);
  message.add("moved_path_values", values);
  values.clear();
  std::vector<double> stamps;
  for (; progress.path < path_.size(); ++progress.path) {
    const PathEntry& entry = path_[progress.path];
    stamps.push_back(entry.timestamp);
    append(entry, values);
    values.insert(values.end(), {static_cast<float>(status_number(entry.status, entry.method)), entry.error});
  }
  message.add("path_stamps", stamps);
  message.add("path_values", values);
}

void Scene::describe_picture(Progress& progress, Message& message) const {
  if (progress.picture == picture_number_) return;
  progress.picture = picture_number_;
  message.json()["picture"] = {{"frame", picture_.index}, {"mask_columns", picture_.mask_columns}};
  message.add("jpeg", jpeg_);
  message.add("mask", picture_.mask);
  std::vector<std::uint16_t> places;
  std::vector<std::uint8_t> kinds;
  for (const ViewedPicture::Feature& feature : picture_.features) {
    places.push_back(static_cast<std::uint16_t>(std::clamp(feature.x * 16.0F, 0.0F, 65535.0F)));
    places.push_back(static_cast<std::uint16_t>(std::clamp(feature.y * 16.0F, 0.0F, 65535.0F)));
    kinds.push_back(static_cast<std::uint8_t>(std::lround(std::clamp(feature.static_probability, 0.0F, 1.0F) * 127.0F) +
                                              (feature.shows_point ? 128 : 0)));
  }
  message.add("feature_places", places);
  message.add("feature_kinds", kinds);
  std::vector<std::uint32_t> seen;
  for (const MapPointId id : picture_.points) seen.push_back(id.slot);
  message.add("seen_points", seen);
  std::vector<float> moving;
  for (const Eigen::Vector3f& place : picture_.moving_features)
    moving.insert(moving.end(), {place.x(), place.y(), place.z()});
  message.add("moving_features", moving);
}

void Scene::describe_objects(Progress& progress, Message& message) const {
  if (last_) {
    nlohmann::json& objects = message.json()["objects"] = nlohmann::json::array();
    for (const MovingObject& object : last_->objects) objects.push_back(to_json(object, last_->timestamp));
  }
  const auto first = static_cast<std::ptrdiff_t>(std::max(progress.trails, trail_begin_) - trail_begin_);
  message.add("trail_ids", std::vector<std::uint32_t>(trail_ids_.begin() + first, trail_ids_.end()));
  message.add("trail_places", std::vector<float>(trail_positions_.begin() + 3 * first, trail_positions_.end()));
  progress.trails = trail_begin_ + trail_ids_.size();
}

void Scene::describe_run(Message& message) const {
  std::vector<double> stamps;
  std::vector<float> places;
  for (const auto& [timestamp, place] : run_->truth) {
    stamps.push_back(timestamp);
    for (int i = 0; i < 3; ++i) places.push_back(static_cast<float>(place[i]));
  }
  nlohmann::json figures = nlohmann::json::array();
  for (const auto& [name, value] : run_->figures) figures.push_back({name, value});
  message.json()["run"] = {{"figures", figures}, {"has_errors", !run_->errors.empty()}};
  message.add("truth_stamps", stamps);
  message.add("truth_places", places);
}

std::string Scene::update(Progress& progress) const {
  if (progress.has_head && progress.version == version_ && !cloud_.has_more(progress.cloud) &&
      !mesh_.has_more(progress.mesh))
    return {};
  const std::uint64_t since = progress.version;
  Message message;
  if (!progress.has_head || head_version_ > since) describe_head(message);
  if (!progress.has_head || state_version_ > since) {
    describe_state(message);
    describe_objects(progress, message);
  }
  describe_frames(progress, message);
  describe_path(progress, message);
  map_.describe(since, message);
  cloud_.describe(progress.cloud, message);
  mesh_.describe(progress.mesh, message);
  describe_picture(progress, message);
  if (run_version_ > since) describe_run(message);
  if (progress.loops < closed_loops_.size()) {
    message.json()["closed_loops"] = closed_loops_.size();
    progress.loops = closed_loops_.size();
  }
  progress.has_head = true;
  progress.version = version_;
  return message.bytes();
}

}  // namespace holdfast::viewer
