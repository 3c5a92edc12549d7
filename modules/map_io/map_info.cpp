// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/map_io/map_info.hpp"

#include <algorithm>
#include <cstdio>
#include <utility>

#include "content_reader.hpp"
#include "json_text.hpp"

namespace holdfast {

namespace {

using namespace map_io;

std::string fixed(double value, int decimals) {
  char text[400];
  std::snprintf(text, sizeof(text), "%.*f", decimals, value);
  return text;
}

std::string corner(const Eigen::Vector3d& point) {
  return "(" + fixed(point.x(), 2) + ", " + fixed(point.y(), 2) + ", " + fixed(point.z(), 2) + ")";
}

std::string size_text(std::uint64_t bytes) {
  const double value = static_cast<double>(bytes);
  if (value >= 1e6) return fixed(value / 1e6, 1) + " MB";
  return value >= 1e3 ? fixed(value / 1e3, 1) + " KB" : std::to_string(bytes) + " bytes";
}

std::string camera_text(const Camera& camera) {
  return (camera.name.empty() ? "unnamed" : camera.name) + ", " + std::to_string(camera.width) + "x" +
         std::to_string(camera.height) + ", fx " + fixed(camera.fx, 2) + " fy " + fixed(camera.fy, 2) + " cx " +
         fixed(camera.cx, 2) + " cy " + fixed(camera.cy, 2) +
         (camera.distortion.lens == Lens::fisheye ? ", fisheye"
          : camera.distortion.is_zero()           ? ", no distortion"
                                                  : ", distorted");
}

/// Names are quoted, because anything can be in them.
std::string classes_text(const MapInfo& info) {
  JsonText text;
  std::uint64_t unknown = info.points;
  for (const auto& [name, points] : info.classes) {
    text.quote(name) << " " << points << ", ";
    unknown -= points;
  }
  return std::move((text << "unknown " << unknown).text());
}

std::string inertia_text(const MapInertia& inertia) {
  return "down is " + corner(inertia.gravity.normalized()) + ", biases of the gyroscope " +
         fixed(inertia.bias.gyroscope.norm(), 4) + " rad/s, of the accelerometer " +
         fixed(inertia.bias.accelerometer.norm(), 3) + " m/s^2";
}

void add_keyframes(const std::vector<KeyFrame>& keyframes, MapInfo& info) {
  info.keyframes = keyframes.size();
  for (const KeyFrame& keyframe : keyframes) {
    info.covisibility_edges += keyframe.covisible.size();
    info.loops += keyframe.loop_edges.size();
    info.motions += keyframe.motion ? 1 : 0;
    const double stamp = keyframe.frame.timestamp;
    const bool first = &keyframe == &keyframes.front();
    info.first_timestamp = first ? stamp : std::min(info.first_timestamp, stamp);
    info.last_timestamp = first ? stamp : std::max(info.last_timestamp, stamp);
  }
  info.covisibility_edges /= 2;
  info.loops /= 2;
}

void add_points(const std::vector<MapPoint>& points, MapInfo& info) {
  info.points = points.size();
  if (!points.empty()) info.minimum_point = info.maximum_point = points.front().position;
  for (const MapPoint& point : points) {
    info.observations += point.observations.size();
    if (point.label < info.classes.size()) ++info.classes[point.label].second;
    info.minimum_point = info.minimum_point.cwiseMin(point.position);
    info.maximum_point = info.maximum_point.cwiseMax(point.position);
  }
}

}  // namespace

MapInfo read_map_info(const std::filesystem::path& file) {
  ContainerReader container(file);
  const FileContent content = read_content(container, FeatureReading::none);
  MapInfo info;
  info.file = file.string();
  info.file_size = container.header().file_size;
  info.format_version = container.header().version;
  info.made_by = container.header().library_version;
  info.next_sequence = container.header().next_sequence;
  info.sensor = content.map.sensor;
  info.map_features = content.map.features;
  info.features = content.features;
  for (const auto& camera : content.tables.cameras) info.cameras.push_back(*camera);
  add_keyframes(content.map.keyframes, info);
  info.inertia = content.map.inertia;
  for (const std::string& name : content.map.classes) info.classes.emplace_back(name, 0);
  add_points(content.map.points, info);
  return info;
}

std::string to_text(const MapInfo& info) {
  std::vector<std::pair<std::string, std::string>> rows;
  rows.emplace_back("file", info.file + ", " + size_text(info.file_size));
  rows.emplace_back("format", "version " + std::to_string(info.format_version) + ", made by Holdfast " + info.made_by);
  rows.emplace_back("sensor", sensor_name(info.sensor));
  rows.emplace_back("features", (info.map_features.extractor.empty() ? "" : info.map_features.extractor + ", ") +
                                    to_string(info.map_features.descriptors));
  for (const Camera& camera : info.cameras) rows.emplace_back("camera", camera_text(camera));
  rows.emplace_back("keyframes", std::to_string(info.keyframes) + ", " + std::to_string(info.features) + " features, " +
                                     std::to_string(info.covisibility_edges) + " covisibility edges");
  rows.emplace_back("points", std::to_string(info.points) + ", " + std::to_string(info.observations) + " observations");
  if (!info.classes.empty()) rows.emplace_back("classes", classes_text(info));
  if (info.inertia) rows.emplace_back("inertia", inertia_text(*info.inertia));
  if (info.motions > 0) rows.emplace_back("velocities", "of " + std::to_string(info.motions) + " keyframes");
  rows.emplace_back("loops", std::to_string(info.loops));
  if (info.keyframes > 0)
    rows.emplace_back("time", fixed(info.last_timestamp - info.first_timestamp, 2) + " s, from " +
                                  fixed(info.first_timestamp, 3) + " to " + fixed(info.last_timestamp, 3));
  if (info.points > 0) {
    const Eigen::Vector3d size = info.maximum_point - info.minimum_point;
    rows.emplace_back("extent", fixed(size.x(), 2) + " x " + fixed(size.y(), 2) + " x " + fixed(size.z(), 2) +
                                    " m, from " + corner(info.minimum_point) + " to " + corner(info.maximum_point));
  }
  std::string text;
  for (auto& [name, value] : rows) {
    name.resize(11, ' ');
    text += name + value + "\n";
  }
  return text;
}

std::string to_json(const MapInfo& info) {
  JsonText json;
  json << "{\n  \"file\": ";
  json.quote(info.file) << ",\n  \"file_size\": " << info.file_size
                        << ",\n  \"format_version\": " << info.format_version << ",\n  \"made_by\": ";
  json.quote(info.made_by) << ",\n  \"sensor\": ";
  json.quote(sensor_name(info.sensor)) << ",\n  \"extractor\": ";
  json.quote(info.map_features.extractor) << ",\n  \"descriptors\": ";
  json.quote(to_string(info.map_features.descriptors)) << ",\n  \"cameras\": [";
  json.list(info.cameras, ",\n    ") << "],\n  \"keyframes\": " << info.keyframes
                                     << ",\n  \"features\": " << info.features << ",\n  \"points\": " << info.points
                                     << ",\n  \"observations\": " << info.observations << ",\n  \"classes\": {";
  for (std::size_t k = 0; k < info.classes.size(); ++k)
    (json << (k == 0 ? "" : ", ")).quote(info.classes[k].first) << ": " << info.classes[k].second;
  json << "}"
       << ",\n  \"inertia\": " << info.inertia << ",\n  \"motions\": " << info.motions
       << ",\n  \"covisibility_edges\": " << info.covisibility_edges << ",\n  \"loops\": " << info.loops
       << ",\n  \"next_sequence\": " << info.next_sequence << ",\n  \"first_timestamp\": " << info.first_timestamp
       << ",\n  \"last_timestamp\": " << info.last_timestamp << ",\n  \"minimum_point\": " << info.minimum_point
       << ",\n  \"maximum_point\": " << info.maximum_point << "\n}\n";
  return std::move(json.text());
}

}  // namespace holdfast
