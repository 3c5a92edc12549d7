// SPDX-License-Identifier: BSD-3-Clause
#include "records.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <span>

namespace holdfast::map_io {

namespace {

constexpr std::size_t bytes_per_camera = 2 + 4 + 4 + 11 * 8;
constexpr std::size_t bytes_per_lens = 4 + 4 + 3 * 8;
constexpr std::size_t bytes_per_pyramid = 4 + 8;
constexpr std::size_t bytes_per_keyframe = 8 + 8 + 8 + 12 * 8 + 7 * 4;
// Without descriptors.
constexpr std::size_t bytes_per_feature = 10 * 4 + 1;
constexpr std::size_t bytes_per_point = 3 * 8 + 3 * 8 + 2 * 4 + 4 + 8 + 3 * 4 + 4;
constexpr std::size_t bytes_per_observation = 8;

template <class Shared>
std::uint32_t position_in(const std::vector<Shared>& table, const Shared& entry, auto&& same) {
  const auto found = std::find_if(table.begin(), table.end(),
                                  [&](const Shared& other) { return other == entry || same(*other, *entry); });
  return static_cast<std::uint32_t>(found - table.begin());
}
std::uint32_t position_of(const SharedTables& tables, const std::shared_ptr<const Camera>& camera) {
  return position_in(tables.cameras, camera, [](const Camera& a, const Camera& b) { return a == b; });
}
std::uint32_t position_of(const SharedTables& tables, const std::shared_ptr<const ScalePyramid>& pyramid) {
  return position_in(tables.pyramids, pyramid, [](const ScalePyramid& a, const ScalePyramid& b) {
    return a.factor == b.factor && a.levels() == b.levels();
  });
}

/// Binary descriptors are stored in whole units of memory, others number by number.
std::size_t bytes_per_descriptor(const DescriptorType& type) {
  return type.kind == DescriptorKind::binary ? DescriptorView::units_of(type) * sizeof(Descriptor256) : type.bytes();
}

void put(const DescriptorView& descriptors, ByteWriter& writer) {
  for (std::size_t i = 0; i < descriptors.size(); ++i) {
    const std::span<const std::byte> bytes = descriptors.bytes(i);
    switch (descriptors.type().kind) {
      case DescriptorKind::binary:
        for (std::size_t unit = 0; unit < descriptors.units(); ++unit)
          for (const std::uint64_t word : descriptors.row(i)[unit].words) writer.put(word);
        break;
      case DescriptorKind::float32:
        for (std::uint32_t k = 0; k < descriptors.type().length; ++k)
          writer.put(reinterpret_cast<const float*>(bytes.data())[k]);
        break;
      case DescriptorKind::int8:
        writer.put_bytes({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
        break;
    }
  }
}

void put(const DescriptorType& type, ByteWriter& writer) {
  writer.put(static_cast<std::uint8_t>(type.kind));
  writer.put(static_cast<std::uint8_t>(type.metric));
  writer.put(type.length);
  writer.put(type.strict_distance);
  writer.put(type.loose_distance);
}

DescriptorType get_descriptor_type(ByteReader& reader) {
  DescriptorType type;
  type.kind = static_cast<DescriptorKind>(reader.get<std::uint8_t>());
  type.metric = static_cast<DescriptorMetric>(reader.get<std::uint8_t>());
  type.length = reader.get<std::uint32_t>();
  type.strict_distance = reader.get<float>();
  type.loose_distance = reader.get<float>();
  if (const std::string trouble = trouble_of(type); !trouble.empty()) reader.fail("descriptors: " + trouble);
  return type;
}

/// Replaces `block` by `count` descriptors. The padding of binary ones must be zero, and numbers finite.
void get_descriptors(ByteReader& reader, const DescriptorType& type, std::size_t count, DescriptorBlock& block) {
  block.reset(type, count);
  for (std::size_t i = 0; i < count; ++i) {
    const std::span<std::byte> bytes = block.bytes(i);
    if (type.kind == DescriptorKind::binary) {
      const std::size_t words = 4 * block.view().units();
      auto* to = reinterpret_cast<std::uint64_t*>(bytes.data());
      for (std::size_t k = 0; k < words; ++k) to[k] = reader.get<std::uint64_t>();
      for (std::size_t bit = type.length; bit < 64 * words; ++bit)
        if (((to[bit / 64] >> (bit % 64)) & 1U) != 0)
          reader.fail("descriptor " + std::to_string(i) + " has more than " + std::to_string(type.length) + " bits");
    } else if (type.kind == DescriptorKind::float32) {
      for (float& number : block.numbers(i)) {
        number = reader.get<float>();
        if (!std::isfinite(number)) reader.fail("descriptor " + std::to_string(i) + " has a number that is not finite");
      }
    } else {
      const std::string_view numbers = reader.get_bytes(bytes.size());
      std::memcpy(bytes.data(), numbers.data(), bytes.size());
    }
  }
}

void put(const Eigen::Vector3d& vector, ByteWriter& writer) {
  for (int i = 0; i < 3; ++i) writer.put(vector[i]);
}
Eigen::Vector3d get_vector(ByteReader& reader) {
  Eigen::Vector3d vector;
  for (int i = 0; i < 3; ++i) vector[i] = reader.get<double>();
  return vector;
}

/// Rows of [R | t].
void put(const Eigen::Isometry3d& pose, ByteWriter& writer) {
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 4; ++column) writer.put(pose.matrix()(row, column));
}
Eigen::Isometry3d get_pose(ByteReader& reader) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 4; ++column) pose.matrix()(row, column) = reader.get<double>();
  return pose;
}

/// Ids of a map that is read from the file: the position, generation 0.
template <class IdType>
IdType get_id(ByteReader& reader) {
  const auto position = reader.get<std::uint32_t>();
  return position == no_index ? IdType() : IdType{position, 0};
}

bool is_label(std::uint8_t label, std::size_t classes) { return label < classes || label == CellMask::unknown; }

void refuse(const ByteReader& reader, const char* kind, std::size_t position, const std::string& trouble) {
  if (!trouble.empty()) reader.fail(kind + (" " + std::to_string(position)) + ": " + trouble);
}

}  // namespace

DenseIndex::DenseIndex(const Map& map, std::optional<std::uint32_t> submap)
    : keyframes_(map.keyframes_by_age()), points_(map.points().ids()) {
  if (submap) {
    std::erase_if(keyframes_, [&](KeyFrameId id) { return map.keyframe(id).submap != *submap; });
    std::erase_if(points_, [&](MapPointId id) { return map.submap_of(map.point(id).reference_keyframe) != submap; });
  }
  keyframe_positions_.assign(map.keyframes().slot_count(), no_index);
  for (std::uint32_t i = 0; i < keyframes_.size(); ++i) keyframe_positions_[keyframes_[i].slot] = i;
  point_positions_.assign(map.points().slot_count(), no_index);
  for (std::uint32_t i = 0; i < points_.size(); ++i) point_positions_[points_[i].slot] = i;
}

std::uint32_t DenseIndex::of(KeyFrameId id) const {
  if (!id.valid()) return no_index;
  const std::uint32_t position = id.slot < keyframe_positions_.size() ? keyframe_positions_[id.slot] : no_index;
  HOLDFAST_CHECK(position != no_index && keyframes_[position] == id, "keyframe " << id.slot << " is gone");
  return position;
}

std::uint32_t DenseIndex::of(MapPointId id) const {
  if (!id.valid()) return no_index;
  const std::uint32_t position = id.slot < point_positions_.size() ? point_positions_[id.slot] : no_index;
  HOLDFAST_CHECK(position != no_index && points_[position] == id, "point " << id.slot << " is gone");
  return position;
}

SharedTables tables_of(const Map& map, const DenseIndex& index) {
  SharedTables tables;
  for (const KeyFrameId id : index.keyframes()) {
    const Frame& frame = map.keyframe(id).frame;
    HOLDFAST_CHECK(frame.camera != nullptr && frame.pyramid != nullptr, "keyframe " << id.slot);
    if (position_of(tables, frame.camera) == tables.cameras.size()) tables.cameras.push_back(frame.camera);
    if (position_of(tables, frame.pyramid) == tables.pyramids.size()) tables.pyramids.push_back(frame.pyramid);
  }
  return tables;
}

void write_tables(const SharedTables& tables, ByteWriter& writer) {
  writer.put(static_cast<std::uint32_t>(tables.cameras.size()));
  for (const auto& shared : tables.cameras) {
    const Camera& camera = *shared;
    const std::string trouble = trouble_of(camera);
    HOLDFAST_CHECK(trouble.empty(), "camera: " << trouble);
    writer.put(static_cast<std::uint16_t>(camera.name.size()));
    writer.put_bytes(camera.name);
    writer.put(static_cast<std::int32_t>(camera.width));
    writer.put(static_cast<std::int32_t>(camera.height));
    const Distortion& d = camera.distortion;
    for (const double value :
         {camera.fx, camera.fy, camera.cx, camera.cy, d.k1, d.k2, d.p1, d.p2, d.k3, camera.baseline, camera.frame_rate})
      writer.put(value);
  }
  writer.put(static_cast<std::uint32_t>(tables.pyramids.size()));
  for (const auto& pyramid : tables.pyramids) {
    const std::string trouble = trouble_of(*pyramid);
    HOLDFAST_CHECK(trouble.empty(), "pyramid: " << trouble);
    writer.put(static_cast<std::uint32_t>(pyramid->levels()));
    writer.put(pyramid->factor);
  }
}

void write_lenses(const SharedTables& tables, ByteWriter& writer) {
  std::vector<std::uint32_t> positions;
  for (std::uint32_t i = 0; i < tables.cameras.size(); ++i) {
    const Distortion& d = tables.cameras[i]->distortion;
    if (d.lens != Lens::radial_tangential || d.is_rational()) positions.push_back(i);
  }
  if (positions.empty()) return;
  writer.put(static_cast<std::uint32_t>(positions.size()));
  for (const std::uint32_t i : positions) {
    const Distortion& d = tables.cameras[i]->distortion;
    writer.put(i);
    writer.put(static_cast<std::uint32_t>(d.lens));
    for (const double value : {d.k4, d.k5, d.k6}) writer.put(value);
  }
}

void read_lenses(ByteReader reader, SharedTables& tables) {
  const std::uint32_t lenses = reader.get_count(bytes_per_lens, "lenses");
  for (std::uint32_t i = 0; i < lenses; ++i) {
    const auto position = reader.get<std::uint32_t>();
    if (position >= tables.cameras.size())
      reader.fail("lens " + std::to_string(i) + ": found camera " + std::to_string(position) + "; expected less than " +
                  std::to_string(tables.cameras.size()));
    const auto lens = reader.get<std::uint32_t>();
    if (lens >= lens_names().size())
      reader.fail("lens " + std::to_string(i) + ": found number " + std::to_string(lens) + "; expected less than " +
                  std::to_string(lens_names().size()));
    Camera camera = *tables.cameras[position];
    Distortion& d = camera.distortion;
    d.lens = static_cast<Lens>(lens);
    for (double* value : {&d.k4, &d.k5, &d.k6}) *value = reader.get<double>();
    refuse(reader, "camera", position, trouble_of_numbers(camera));
    tables.cameras[position] = std::make_shared<const Camera>(std::move(camera));
  }
  reader.expect_end();
}

SharedTables read_tables(ByteReader reader) {
  SharedTables tables;
  const std::uint32_t cameras = reader.get_count(bytes_per_camera, "cameras");
  for (std::uint32_t i = 0; i < cameras; ++i) {
    Camera camera;
    camera.name = std::string(reader.get_bytes(reader.get<std::uint16_t>()));
    camera.width = reader.get<std::int32_t>();
    camera.height = reader.get<std::int32_t>();
    Distortion& d = camera.distortion;
    for (double* value : {&camera.fx, &camera.fy, &camera.cx, &camera.cy, &d.k1, &d.k2, &d.p1, &d.p2, &d.k3,
                          &camera.baseline, &camera.frame_rate})
      *value = reader.get<double>();
    refuse(reader, "camera", i, trouble_of_numbers(camera));  // the lens may follow in a section of its own
    tables.cameras.push_back(std::make_shared<const Camera>(std::move(camera)));
  }
  const std::uint32_t pyramids = reader.get_count(bytes_per_pyramid, "pyramids");
  for (std::uint32_t i = 0; i < pyramids; ++i) {
    const auto levels = reader.get<std::uint32_t>();
    const auto factor = reader.get<double>();
    // The constructor accepts valid arguments only; the other members are checked on the result.
    if (levels < 1 || levels > 64 || !(factor > 1.0))
      reader.fail("pyramid " + std::to_string(i) + ": found " + std::to_string(levels) + " levels and a factor of " +
                  std::to_string(factor) + "; expected 1 to 64 and more than 1");
    const auto pyramid = std::make_shared<const ScalePyramid>(static_cast<int>(levels), factor);
    refuse(reader, "pyramid", i, trouble_of(*pyramid));
    tables.pyramids.push_back(pyramid);
  }
  reader.expect_end();
  return tables;
}

void write_keyframes(const Map& map, const DenseIndex& index, const SharedTables& tables, ByteWriter& writer) {
  writer.put(static_cast<std::uint32_t>(index.keyframes().size()));
  for (const KeyFrameId id : index.keyframes()) {
    const KeyFrame& keyframe = map.keyframe(id);
    const std::string trouble = trouble_of(keyframe);
    HOLDFAST_CHECK(trouble.empty(), "keyframe " << keyframe.sequence << ": " << trouble);
    const Frame& frame = keyframe.frame;
    writer.put(keyframe.sequence);
    writer.put(frame.index);
    writer.put(frame.timestamp);
    put(frame.T_camera_world, writer);
    writer.put(position_of(tables, frame.camera));
    writer.put(position_of(tables, frame.pyramid));
    writer.put(static_cast<std::uint32_t>(frame.size()));
    writer.put(index.of(keyframe.parent));
    writer.put(static_cast<std::uint32_t>(keyframe.children.size()));
    writer.put(static_cast<std::uint32_t>(keyframe.covisible.size()));
    writer.put(static_cast<std::uint32_t>(keyframe.loop_edges.size()));
    for (const KeyFrameId child : keyframe.children) writer.put(index.of(child));
    for (const CovisibilityEdge& edge : keyframe.covisible) {
      writer.put(index.of(edge.keyframe));
      writer.put(static_cast<std::int32_t>(edge.weight));
    }
    for (const KeyFrameId end : keyframe.loop_edges) writer.put(index.of(end));
  }
}

std::vector<KeyFrame> read_keyframes(ByteReader reader, const SharedTables& tables,
                                     std::vector<std::uint32_t>& feature_counts) {
  for (std::size_t i = 0; i < tables.cameras.size(); ++i) refuse(reader, "camera", i, trouble_of(*tables.cameras[i]));
  const std::uint32_t count = reader.get_count(bytes_per_keyframe, "keyframes");
  std::vector<KeyFrame> keyframes;
  keyframes.reserve(count);
  feature_counts.clear();
  for (std::uint32_t i = 0; i < count; ++i) {
    KeyFrame& keyframe = keyframes.emplace_back();
    Frame& frame = keyframe.frame;
    keyframe.sequence = reader.get<std::uint64_t>();
    frame.index = reader.get<std::uint64_t>();
    frame.timestamp = reader.get<double>();
    frame.T_camera_world = get_pose(reader);
    const auto camera = reader.get<std::uint32_t>(), pyramid = reader.get<std::uint32_t>();
    if (camera >= tables.cameras.size() || pyramid >= tables.pyramids.size())
      reader.fail("keyframe " + std::to_string(i) + ": found camera " + std::to_string(camera) + " and pyramid " +
                  std::to_string(pyramid) + "; expected less than " + std::to_string(tables.cameras.size()) + " and " +
                  std::to_string(tables.pyramids.size()));
    frame.camera = tables.cameras[camera];
    frame.pyramid = tables.pyramids[pyramid];
    feature_counts.push_back(reader.get<std::uint32_t>());
    keyframe.parent = get_id<KeyFrameId>(reader);
    const auto children = reader.get<std::uint32_t>(), edges = reader.get<std::uint32_t>(),
               loops = reader.get<std::uint32_t>();
    if (children > reader.remaining() / 4 || edges > reader.remaining() / 8 || loops > reader.remaining() / 4)
      reader.fail("keyframe " + std::to_string(i) + ": found " + std::to_string(children) + " children, " +
                  std::to_string(edges) + " neighbours and " + std::to_string(loops) +
                  " loops, for which the section is too short");
    keyframe.children.resize(children);
    for (KeyFrameId& child : keyframe.children) child = get_id<KeyFrameId>(reader);
    keyframe.covisible.resize(edges);
    for (CovisibilityEdge& edge : keyframe.covisible) {
      edge.keyframe = get_id<KeyFrameId>(reader);
      edge.weight = reader.get<std::int32_t>();
    }
    keyframe.loop_edges.resize(loops);
    for (KeyFrameId& end : keyframe.loop_edges) end = get_id<KeyFrameId>(reader);
    refuse(reader, "keyframe", i, trouble_of(keyframe));
  }
  reader.expect_end();
  return keyframes;
}

std::uint64_t features_size(std::size_t features, const DescriptorType& type) {
  return 8 + static_cast<std::uint64_t>(features) * (bytes_per_feature + bytes_per_descriptor(type));
}

void write_map_features(const MapFeatures& features, ByteWriter& writer) {
  writer.put(static_cast<std::uint16_t>(features.extractor.size()));
  writer.put_bytes(features.extractor);
  put(features.descriptors, writer);
}

MapFeatures read_map_features(ByteReader reader) {
  MapFeatures features;
  constexpr std::size_t longest_name = 255;
  const std::size_t length = reader.get<std::uint16_t>();
  if (length > longest_name) reader.fail("the name of the extractor has more than 255 bytes");
  features.extractor = reader.get_bytes(length);
  for (const char letter : features.extractor)
    if (static_cast<unsigned char>(letter) < 0x20 || letter == 0x7F)
      reader.fail("the name of the extractor holds a control character");
  features.descriptors = get_descriptor_type(reader);
  reader.expect_end();
  return features;
}

void write_places(const Map& map, const DenseIndex& index, ByteWriter& writer) {
  std::vector<std::uint32_t> described;
  for (std::uint32_t i = 0; i < index.keyframes().size(); ++i)
    if (!map.keyframe(index.keyframes()[i]).frame.image_descriptor.empty()) described.push_back(i);
  if (described.empty()) return;
  const DescriptorType type = map.keyframe(index.keyframes()[described.front()]).frame.image_descriptor.type();
  put(type, writer);
  writer.put(static_cast<std::uint32_t>(described.size()));
  for (const std::uint32_t i : described) {
    const DescriptorBlock& place = map.keyframe(index.keyframes()[i]).frame.image_descriptor;
    HOLDFAST_CHECK(place.type().is_comparable(type),
                   "descriptions of images by " << to_string(place.type()) << " and " << to_string(type));
    writer.put(i);
    writer.put(static_cast<std::uint32_t>(place.size()));
    put(place.view(), writer);
  }
}

void read_places(ByteReader reader, std::vector<KeyFrame>& keyframes) {
  const DescriptorType type = get_descriptor_type(reader);
  const std::uint32_t count = reader.get_count(8, "described keyframes");
  std::uint32_t next = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    const auto position = reader.get<std::uint32_t>();
    if (position < next || position >= keyframes.size())
      reader.fail("found keyframe " + std::to_string(position) + "; expected at least " + std::to_string(next) +
                  " and less than " + std::to_string(keyframes.size()));
    next = position + 1;
    const std::uint32_t descriptors = reader.get_count(bytes_per_descriptor(type), "descriptors");
    get_descriptors(reader, type, descriptors, keyframes[position].frame.image_descriptor);
  }
  reader.expect_end();
}

void write_features(const Frame& frame, std::uint32_t position, const DenseIndex& index, ByteWriter& writer) {
  const std::string trouble = trouble_of_features(frame);
  HOLDFAST_CHECK(trouble.empty(), "keyframe of frame " << frame.index << ": " << trouble);
  const Features& f = frame.features;
  writer.put(position);
  writer.put(static_cast<std::uint32_t>(frame.size()));
  for (const std::vector<float>* values :
       {&f.x, &f.y, &frame.x, &frame.y, &frame.depth, &frame.right_x, &f.angle, &f.response, &frame.static_probability})
    writer.put_array(*values);
  for (const MapPointId point : frame.map_points) writer.put(index.of(point));
  put(f.descriptors, writer);
  writer.put_array(f.octave);
}

void read_features(ByteReader reader, std::uint32_t position, std::uint32_t count, const DescriptorType& type,
                   Frame& frame) {
  const auto found_position = reader.get<std::uint32_t>();
  const std::uint32_t found_count = reader.get_count(bytes_per_feature + bytes_per_descriptor(type), "features");
  if (found_position != position || found_count != count)
    reader.fail("found " + std::to_string(found_count) + " features of keyframe " + std::to_string(found_position) +
                "; expected " + std::to_string(count) + " of keyframe " + std::to_string(position));
  Features& f = frame.features;
  for (std::vector<float>* values :
       {&f.x, &f.y, &frame.x, &frame.y, &frame.depth, &frame.right_x, &f.angle, &f.response, &frame.static_probability})
    reader.get_array(*values, count);
  frame.map_points.resize(count);
  for (MapPointId& point : frame.map_points) point = get_id<MapPointId>(reader);
  get_descriptors(reader, type, count, f.descriptors);
  reader.get_array(f.octave, count);
  reader.expect_end();
  refuse(reader, "keyframe", position, trouble_of_features(frame));
}

void write_points(const Map& map, const DenseIndex& index, ByteWriter& writer) {
  writer.put(static_cast<std::uint32_t>(index.points().size()));
  for (const MapPointId id : index.points()) {
    const MapPoint& point = map.point(id);
    const std::string trouble = trouble_of(point);
    HOLDFAST_CHECK(trouble.empty(), "point " << id.slot << ": " << trouble);
    put(point.position, writer);
    put(point.viewing_direction, writer);
    writer.put(point.minimum_distance);
    writer.put(point.maximum_distance);
    put(point.descriptor, writer);
    writer.put(index.of(point.reference_keyframe));
    writer.put(point.created_at);
    writer.put(point.visible_count);
    writer.put(point.found_count);
    writer.put(point.static_log_odds);
    writer.put(static_cast<std::uint32_t>(point.observations.size()));
    for (const Observation& observation : point.observations) {
      writer.put(index.of(observation.keyframe));
      writer.put(observation.feature);
    }
  }
}

std::vector<MapPoint> read_points(ByteReader reader, const DescriptorType& type) {
  const std::uint32_t count = reader.get_count(bytes_per_point + bytes_per_descriptor(type), "points");
  std::vector<MapPoint> points;
  points.reserve(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    MapPoint& point = points.emplace_back();
    point.position = get_vector(reader);
    point.viewing_direction = get_vector(reader);
    point.minimum_distance = reader.get<float>();
    point.maximum_distance = reader.get<float>();
    get_descriptors(reader, type, 1, point.descriptor);
    point.reference_keyframe = get_id<KeyFrameId>(reader);
    point.created_at = reader.get<std::uint64_t>();
    point.visible_count = reader.get<std::uint32_t>();
    point.found_count = reader.get<std::uint32_t>();
    point.static_log_odds = reader.get<float>();
    point.observations.resize(reader.get_count(bytes_per_observation, "observations"));
    for (Observation& observation : point.observations) {
      observation.keyframe = get_id<KeyFrameId>(reader);
      observation.feature = reader.get<std::uint32_t>();
    }
    refuse(reader, "point", i, trouble_of(point));
  }
  reader.expect_end();
  return points;
}

void write_classes(const Map& map, const DenseIndex& index, ByteWriter& writer) {
  if (map.classes().empty()) return;
  writer.put(static_cast<std::uint32_t>(map.classes().size()));
  for (const std::string& name : map.classes()) {
    writer.put(static_cast<std::uint32_t>(name.size()));
    writer.put_bytes(name);
  }
  writer.put(static_cast<std::uint32_t>(index.points().size()));
  for (const MapPointId id : index.points()) {
    const std::uint8_t label = map.point(id).label;
    HOLDFAST_CHECK(is_label(label, map.classes().size()), "point " << id.slot << ": label " << int{label});
    writer.put(label);
  }
}

std::vector<std::string> read_classes(ByteReader reader, std::vector<MapPoint>& points) {
  const std::uint32_t classes = reader.get_count(sizeof(std::uint32_t), "classes");
  if (classes == 0 || classes > CellMask::unknown)
    reader.fail("found " + std::to_string(classes) + " classes; expected 1 to " + std::to_string(CellMask::unknown));
  std::vector<std::string> names;
  for (std::uint32_t i = 0; i < classes; ++i)
    names.emplace_back(reader.get_bytes(reader.get_count(1, "letters of a name")));
  const std::uint32_t labels = reader.get_count(1, "labels");
  if (labels != points.size())
    reader.fail("found " + std::to_string(labels) + " labels; expected one for each of " +
                std::to_string(points.size()) + " points");
  for (std::size_t i = 0; i < points.size(); ++i) {
    points[i].label = reader.get<std::uint8_t>();
    if (!is_label(points[i].label, names.size()))
      reader.fail("point " + std::to_string(i) + ": found label " + std::to_string(points[i].label) +
                  "; expected less than " + std::to_string(names.size()) + ", or " + std::to_string(CellMask::unknown));
  }
  reader.expect_end();
  return names;
}

void write_votes(const Map& map, const DenseIndex& index, ByteWriter& writer) {
  ByteWriter votes;
  bool has_votes = false;
  for (const MapPointId id : index.points()) {
    const ClassVotes of_point = map.class_votes(map.point(id));
    has_votes = has_votes || !of_point.empty();
    votes.put(static_cast<std::uint8_t>(of_point.entries().size()));
    for (const ClassVotes::Entry& entry : of_point.entries()) {
      HOLDFAST_CHECK(entry.label < map.classes().size(), "point " << id.slot << ": votes for " << int{entry.label});
      votes.put(entry.label);
      votes.put(entry.votes);
    }
  }
  if (!has_votes) return;
  writer.put(static_cast<std::uint32_t>(index.points().size()));
  writer.put_bytes(votes.bytes());
}

void read_votes(ByteReader reader, std::size_t classes, std::vector<MapPoint>& points) {
  const std::uint32_t count = reader.get_count(1, "points with votes");
  if (count != points.size())
    reader.fail("found votes of " + std::to_string(count) + " points; expected those of " +
                std::to_string(points.size()));
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::uint8_t entries = reader.get<std::uint8_t>();
    int last = -1;
    for (std::uint8_t k = 0; k < entries; ++k) {
      const std::uint8_t label = reader.get<std::uint8_t>();
      const std::uint32_t votes = reader.get<std::uint32_t>();
      constexpr std::uint32_t most_votes = 1000000000;  // so that further ones can be added
      if (label >= classes || label <= last || votes == 0 || votes > most_votes)
        reader.fail("point " + std::to_string(i) + ": found " + std::to_string(votes) + " votes for label " +
                    std::to_string(label) + "; expected at least one vote each for increasing labels below " +
                    std::to_string(classes));
      last = label;
      points[i].earlier_votes.add(label, votes);
    }
  }
  reader.expect_end();
}

namespace {

/// Calls `number` with every number of the section, in its order.
template <class Inertia>
void for_each_number(Inertia& inertia, auto&& number) {
  const auto vector = [&](auto& v) {
    for (int i = 0; i < 3; ++i) number(v[i]);
  };
  vector(inertia.gravity);
  number(inertia.scale);
  vector(inertia.bias.gyroscope);
  vector(inertia.bias.accelerometer);
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column) number(inertia.mounting(row, column));
  number(inertia.time_offset);
  for (auto* deviation : {&inertia.gravity_deviation, &inertia.gyroscope_deviation, &inertia.accelerometer_deviation,
                          &inertia.mounting_deviation, &inertia.time_offset_deviation, &inertia.position_deviation,
                          &inertia.rotation_deviation})
    number(*deviation);
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 4; ++column) number(inertia.T_body_camera(row, column));
  number(inertia.calibrated_time_offset);
}

}  // namespace

void write_inertia(const Map& map, ByteWriter& writer) {
  if (!map.inertia()) return;
  const std::string trouble = trouble_of(*map.inertia());
  HOLDFAST_CHECK(trouble.empty(), "inertia: " << trouble);
  for_each_number(*map.inertia(), [&](const double& value) { writer.put(value); });
}

MapInertia read_inertia(ByteReader reader) {
  MapInertia inertia;
  for_each_number(inertia, [&](double& value) { value = reader.get<double>(); });
  reader.expect_end();
  if (const std::string trouble = trouble_of(inertia); !trouble.empty()) reader.fail(trouble);
  return inertia;
}

namespace {

constexpr std::uint32_t has_vertical = 1, has_motion = 2;  // flags of an entry

/// The vectors of an entry with these flags, in their order.
template <class Entry>
void for_each_vector(Entry& keyframe, auto&& vector) {
  if (keyframe.vertical) vector(*keyframe.vertical);
  if (!keyframe.motion) return;
  vector(keyframe.motion->velocity);
  vector(keyframe.motion->bias.gyroscope);
  vector(keyframe.motion->bias.accelerometer);
}

}  // namespace

void write_motions(const Map& map, const DenseIndex& index, ByteWriter& writer) {
  ByteWriter entries;
  std::uint32_t count = 0;
  for (std::uint32_t i = 0; i < index.keyframes().size(); ++i) {
    const KeyFrame& keyframe = map.keyframe(index.keyframes()[i]);
    if (!keyframe.vertical && !keyframe.motion) continue;
    const std::string trouble = trouble_of_motion(keyframe);
    HOLDFAST_CHECK(trouble.empty(), "keyframe " << i << ": " << trouble);
    ++count;
    entries.put(i);
    entries.put((keyframe.vertical ? has_vertical : 0U) | (keyframe.motion ? has_motion : 0U));
    for_each_vector(keyframe, [&](const Eigen::Vector3d& v) {
      for (int k = 0; k < 3; ++k) entries.put(v[k]);
    });
  }
  if (count == 0) return;
  writer.put(count);
  writer.put_bytes(entries.bytes());
}

void read_motions(ByteReader reader, std::vector<KeyFrame>& keyframes) {
  const std::uint32_t count = reader.get_count(2 * 4 + 3 * 8, "keyframes with a vertical or a motion");
  std::uint32_t next = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t position = reader.get<std::uint32_t>(), flags = reader.get<std::uint32_t>();
    if (position < next || position >= keyframes.size() || flags == 0 || flags > (has_vertical | has_motion))
      reader.fail("found keyframe " + std::to_string(position) + " with flags " + std::to_string(flags) +
                  "; expected increasing keyframes below " + std::to_string(keyframes.size()) + " and flags 1 to 3");
    next = position + 1;
    KeyFrame& keyframe = keyframes[position];
    if ((flags & has_vertical) != 0) keyframe.vertical.emplace();
    if ((flags & has_motion) != 0) keyframe.motion.emplace();
    for_each_vector(keyframe, [&](Eigen::Vector3d& v) {
      for (int k = 0; k < 3; ++k) v[k] = reader.get<double>();
    });
    refuse(reader, "keyframe", position, trouble_of_motion(keyframe));
  }
  reader.expect_end();
}

}  // namespace holdfast::map_io
