// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/map_io/map_export.hpp"

#include <algorithm>
#include <utility>

#include "bytes.hpp"
#include "holdfast/core/version.hpp"
#include "json_text.hpp"
#include "records.hpp"

namespace holdfast {

namespace {

using namespace map_io;

void append_keyframe(const KeyFrame& keyframe, std::size_t position, const DenseIndex& index,
                     const SharedTables& tables, JsonText& json) {
  const Frame& frame = keyframe.frame;
  const Eigen::Isometry3d T_world_camera = frame.T_world_camera();
  Eigen::Quaterniond q(T_world_camera.linear());
  if (q.w() < 0.0) q.coeffs() = -q.coeffs();
  const auto camera = std::find_if(tables.cameras.begin(), tables.cameras.end(),
                                   [&](const auto& other) { return *other == *frame.camera; });
  json << R"({"id":)" << position << R"(,"sequence":)" << keyframe.sequence << R"(,"frame":)" << frame.index
       << R"(,"timestamp":)" << frame.timestamp << R"(,"camera":)" << (camera - tables.cameras.begin())
       << R"(,"position":)" << Eigen::Vector3d(T_world_camera.translation()) << R"(,"orientation":[)" << q.x() << ","
       << q.y() << "," << q.z() << "," << q.w() << R"(],"features":)" << frame.size() << R"(,"parent":)";
  if (keyframe.parent.valid())
    json << index.of(keyframe.parent);
  else
    json << "null";
  if (keyframe.vertical) json << R"(,"vertical":)" << *keyframe.vertical;
  if (keyframe.motion)
    json << R"(,"velocity":)" << keyframe.motion->velocity << R"(,"gyroscope_bias":)" << keyframe.motion->bias.gyroscope
         << R"(,"accelerometer_bias":)" << keyframe.motion->bias.accelerometer;
  json << "}";
}

void append_point(const MapPoint& point, std::size_t position, const Map& map, const DenseIndex& index,
                  JsonText& json) {
  json << R"({"id":)" << position << R"(,"position":)" << point.position << R"(,"viewing_direction":)"
       << point.viewing_direction << R"(,"minimum_distance":)" << point.minimum_distance << R"(,"maximum_distance":)"
       << point.maximum_distance << R"(,"reference_keyframe":)" << index.of(point.reference_keyframe)
       << R"(,"created_at":)" << point.created_at << R"(,"visible_count":)" << point.visible_count
       << R"(,"found_count":)" << point.found_count << R"(,"static_log_odds":)" << point.static_log_odds;
  if (point.label < map.classes().size())
    json << R"(,"label":)" << int{point.label};
  else if (!map.classes().empty())
    json << R"(,"label":null)";
  if (const ClassVotes votes = map.class_votes(point); !votes.empty()) {
    json << R"(,"class_votes":[)";
    for (const ClassVotes::Entry& entry : votes.entries())
      json << (&entry == &votes.entries().front() ? "[" : ",[") << int{entry.label} << "," << entry.votes << "]";
    json << "]";
  }
  json << R"(,"observations":[)";
  bool first = true;
  for (const Observation& observation : point.observations) {
    const Frame& frame = map.keyframe(observation.keyframe).frame;
    json << (first ? "[" : ",[") << index.of(observation.keyframe) << "," << observation.feature << ","
         << frame.x[observation.feature] << "," << frame.y[observation.feature] << "]";
    first = false;
  }
  json << "]}";
}

/// Each pair of keyframes once, the older one first.
void append_pairs(const Map& map, const DenseIndex& index, JsonText& covisibility, JsonText& loops) {
  const auto append = [](JsonText& json, auto... values) {
    json << (json.text().empty() ? "\n[" : ",\n[");
    bool first = true;
    ((json << (std::exchange(first, false) ? "" : ",") << values), ...);
    json << "]";
  };
  for (std::uint32_t i = 0; i < index.keyframes().size(); ++i) {
    const KeyFrame& keyframe = map.keyframe(index.keyframes()[i]);
    for (const CovisibilityEdge& edge : keyframe.covisible)
      if (const std::uint32_t other = index.of(edge.keyframe); other > i) append(covisibility, i, other, edge.weight);
    for (const KeyFrameId end : keyframe.loop_edges)
      if (const std::uint32_t other = index.of(end); other > i) append(loops, i, other);
  }
}

}  // namespace

std::string points_ply(const Map& map) {
  ByteWriter writer;
  writer.put_bytes("ply\nformat binary_little_endian 1.0\ncomment static map [m], made by Holdfast " HOLDFAST_VERSION
                   "\nelement vertex " +
                   std::to_string(map.points().size()) + "\n");
  for (const char* name : {"x", "y", "z", "nx", "ny", "nz"})
    writer.put_bytes(std::string("property float ") + name + "\n");
  writer.put_bytes("property int observations\nproperty float static_log_odds\nend_header\n");
  map.points().for_each([&](MapPointId, const MapPoint& point) {
    for (int i = 0; i < 3; ++i) writer.put(static_cast<float>(point.position[i]));
    for (int i = 0; i < 3; ++i) writer.put(static_cast<float>(-point.viewing_direction[i]));
    writer.put(static_cast<std::int32_t>(point.observations.size()));
    writer.put(point.static_log_odds);
  });
  return writer.bytes();
}

void write_points_ply(const std::filesystem::path& file, const Map& map) {
  write_file_atomically(file, points_ply(map));
}

Trajectory keyframe_trajectory(const Map& map) {
  Trajectory trajectory;
  const DenseIndex index(map);
  for (const KeyFrameId id : index.keyframes()) {
    const Frame& frame = map.keyframe(id).frame;
    trajectory.push_back({frame.timestamp, frame.T_world_camera()});
  }
  std::stable_sort(trajectory.begin(), trajectory.end(),
                   [](const TimedPose& a, const TimedPose& b) { return a.timestamp < b.timestamp; });
  return trajectory;
}

std::string map_json(const Map& map) {
  const DenseIndex index(map);
  const SharedTables tables = tables_of(map, index);
  JsonText json, covisibility, loops;
  json << R"({"holdfast":")" << HOLDFAST_VERSION << R"(","next_sequence":)" << map.next_sequence() << R"(,"cameras":[)";
  bool first = true;
  for (const auto& camera : tables.cameras) json << (std::exchange(first, false) ? "\n" : ",\n") << *camera;
  json << "],\n\"keyframes\":[";
  for (std::size_t i = 0; i < index.keyframes().size(); ++i) {
    json << (i == 0 ? "\n" : ",\n");
    append_keyframe(map.keyframe(index.keyframes()[i]), i, index, tables, json);
  }
  append_pairs(map, index, covisibility, loops);
  json << "],\n\"covisibility\":[" << covisibility.text() << "],\n\"loops\":[" << loops.text() << "],\n\"classes\":[";
  for (std::size_t i = 0; i < map.classes().size(); ++i) (json << (i == 0 ? "" : ",")).quote(map.classes()[i]);
  json << "],\n\"inertia\":" << map.inertia() << ",\n\"points\":[";
  for (std::size_t i = 0; i < index.points().size(); ++i) {
    json << (i == 0 ? "\n" : ",\n");
    append_point(map.point(index.points()[i]), i, map, index, json);
  }
  json << "]}\n";
  return std::move(json.text());
}

}  // namespace holdfast
