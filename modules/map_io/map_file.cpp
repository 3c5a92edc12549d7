// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/map_io/map_file.hpp"

#include <utility>

#include "container.hpp"
#include "content_reader.hpp"
#include "holdfast/core/atomic_file.hpp"
#include "holdfast/core/error.hpp"
#include "holdfast/core/version.hpp"
#include "records.hpp"

namespace holdfast {

namespace {

using namespace map_io;

std::uint64_t observation_count(const Map& map, const DenseIndex& index) {
  std::uint64_t count = 0;
  for (const MapPointId id : index.points()) count += map.point(id).observations.size();
  return count;
}

void write_section(AtomicFile& file, const char* type, const std::string& payload,
                   std::uint32_t flags = section_required) {
  const std::string header = encode_section_header(type, payload, flags);
  file.write(header);
  file.write(payload);
}

/// Features, by far the most, go out keyframe by keyframe; all sizes are known before, for the header comes first.
void write_content(AtomicFile& file, const Map& map, const DenseIndex& index, bool has_first_submap) {
  const SharedTables shared = tables_of(map, index);
  const MapFeatures& map_features = map.features();
  const bool has_descriptor_section = map_features != MapFeatures();
  ByteWriter tables, lenses, descriptors, keyframes, points, places, classes, votes, inertia, motions;
  if (has_descriptor_section) write_map_features(map_features, descriptors);
  write_tables(shared, tables);
  write_lenses(shared, lenses);
  write_keyframes(map, index, shared, keyframes);
  write_points(map, index, points);
  write_places(map, index, places);
  write_classes(map, index, classes);
  write_votes(map, index, votes);
  if (has_first_submap) write_inertia(map, inertia);  // its gravity is in that world
  write_motions(map, index, motions);

  FileHeader header;
  header.library_version = HOLDFAST_VERSION;
  const bool has_lenses = lenses.size() > 0;
  const bool has_places = places.size() > 0;
  const bool has_classes = classes.size() > 0;
  const bool has_votes = votes.size() > 0;
  const bool has_inertia = inertia.size() > 0;
  const bool has_motions = motions.size() > 0;
  std::uint32_t optional_sections = 0;
  for (const bool is_written :
       {has_lenses, has_descriptor_section, has_places, has_classes, has_votes, has_inertia, has_motions})
    optional_sections += is_written ? 1U : 0U;
  header.sections = 3 + optional_sections + static_cast<std::uint32_t>(index.keyframes().size());
  header.keyframes = static_cast<std::uint32_t>(index.keyframes().size());
  header.points = static_cast<std::uint32_t>(index.points().size());
  header.observations = observation_count(map, index);
  header.next_sequence = map.next_sequence();
  header.sensor = static_cast<std::uint32_t>(map.sensor());
  header.file_size = header_size + header.sections * section_header_size + tables.size() + lenses.size() +
                     descriptors.size() + keyframes.size() + points.size() + places.size() + classes.size() +
                     votes.size() + inertia.size() + motions.size();
  for (const KeyFrameId id : index.keyframes())
    header.file_size += features_size(map.keyframe(id).frame.size(), map_features.descriptors);

  file.write(encode(header));
  write_section(file, camera_section, tables.bytes());
  if (has_lenses) write_section(file, lens_section, lenses.bytes());
  if (has_descriptor_section) write_section(file, descriptor_section, descriptors.bytes());
  write_section(file, keyframe_section, keyframes.bytes());
  ByteWriter features;
  for (std::uint32_t i = 0; i < index.keyframes().size(); ++i) {
    features.clear();
    write_features(map.keyframe(index.keyframes()[i]).frame, i, index, features);
    write_section(file, feature_section, features.bytes());
  }
  write_section(file, point_section, points.bytes());
  if (has_places) write_section(file, place_section, places.bytes());
  if (has_classes) write_section(file, class_section, classes.bytes(), 0);
  if (has_votes) write_section(file, vote_section, votes.bytes(), 0);
  if (has_inertia) write_section(file, inertia_section, inertia.bytes(), 0);
  if (has_motions) write_section(file, motion_section, motions.bytes(), 0);
}

}  // namespace

void write_map(const std::filesystem::path& file, const Map& map, std::optional<std::uint32_t> submap) {
  if (std::error_code ignored; std::filesystem::is_directory(file, ignored))
    throw InputError({file.string()}, "found a folder; expected the name of the map file to write");
  AtomicFile written(file);
  write_content(written, map, DenseIndex(map, submap), submap.value_or(0) == 0);
  written.commit();
}

void read_map(const std::filesystem::path& file, Map& map) {
  ContainerReader container(file);
  FileContent content = read_content(container, FeatureReading::all);
  try {
    map.restore(std::move(content.map));
  } catch (const InputError&) {
    throw;
  } catch (const Error& error) {
    throw InputError({file.string()}, std::string(error.what()) + "; the file was written wrongly: make the map again");
  }
}

Map read_map(const std::filesystem::path& file) {
  Map map;
  read_map(file, map);
  return map;
}

}  // namespace holdfast
