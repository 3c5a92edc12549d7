// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/map_io/map_file.hpp"

#include <fstream>
#include <utility>

#include "container.hpp"
#include "content_reader.hpp"
#include "holdfast/core/error.hpp"
#include "holdfast/core/version.hpp"
#include "records.hpp"

namespace holdfast {

namespace {

using namespace map_io;

std::uint64_t observation_count(const Map& map) {
  std::uint64_t count = 0;
  map.points().for_each([&](MapPointId, const MapPoint& point) { count += point.observations.size(); });
  return count;
}

void write_section(std::ostream& stream, const char* type, const std::string& payload,
                   std::uint32_t flags = section_required) {
  const std::string header = encode_section_header(type, payload, flags);
  stream.write(header.data(), static_cast<std::streamsize>(header.size()));
  stream.write(payload.data(), static_cast<std::streamsize>(payload.size()));
}

/// Features, by far the most, go out keyframe by keyframe; all sizes are known before, for the header comes first.
void write_content(std::ostream& stream, const Map& map) {
  const DenseIndex index(map);
  const SharedTables shared = tables_of(map, index);
  const MapFeatures& map_features = map.features();
  const bool has_descriptor_section = map_features != MapFeatures();
  ByteWriter tables, lenses, descriptors, keyframes, points, places, classes;
  if (has_descriptor_section) write_map_features(map_features, descriptors);
  write_tables(shared, tables);
  write_lenses(shared, lenses);
  write_keyframes(map, index, shared, keyframes);
  write_points(map, index, points);
  write_places(map, index, places);
  write_classes(map, index, classes);

  FileHeader header;
  header.library_version = HOLDFAST_VERSION;
  const bool has_lenses = lenses.size() > 0;
  const bool has_places = places.size() > 0;
  const bool has_classes = classes.size() > 0;
  const std::uint32_t optional_sections =
      (has_lenses ? 1U : 0U) + (has_descriptor_section ? 1U : 0U) + (has_places ? 1U : 0U) + (has_classes ? 1U : 0U);
  header.sections = 3 + optional_sections + static_cast<std::uint32_t>(index.keyframes().size());
  header.keyframes = static_cast<std::uint32_t>(index.keyframes().size());
  header.points = static_cast<std::uint32_t>(index.points().size());
  header.observations = observation_count(map);
  header.next_sequence = map.next_sequence();
  header.sensor = static_cast<std::uint32_t>(map.sensor());
  header.file_size = header_size + header.sections * section_header_size + tables.size() + lenses.size() +
                     descriptors.size() + keyframes.size() + points.size() + places.size() + classes.size();
  for (const KeyFrameId id : index.keyframes())
    header.file_size += features_size(map.keyframe(id).frame.size(), map_features.descriptors);

  const std::string start = encode(header);
  stream.write(start.data(), static_cast<std::streamsize>(start.size()));
  write_section(stream, camera_section, tables.bytes());
  if (has_lenses) write_section(stream, lens_section, lenses.bytes());
  if (has_descriptor_section) write_section(stream, descriptor_section, descriptors.bytes());
  write_section(stream, keyframe_section, keyframes.bytes());
  ByteWriter features;
  for (std::uint32_t i = 0; i < index.keyframes().size(); ++i) {
    features.clear();
    write_features(map.keyframe(index.keyframes()[i]).frame, i, index, features);
    write_section(stream, feature_section, features.bytes());
  }
  write_section(stream, point_section, points.bytes());
  if (has_places) write_section(stream, place_section, places.bytes());
  if (has_classes) write_section(stream, class_section, classes.bytes(), 0);
}

/// Removes a file at the end of the scope unless keep() was called.
struct TemporaryFile {
  std::filesystem::path path;
  bool keep = false;
  ~TemporaryFile() {
    std::error_code ignored;
    if (!keep) std::filesystem::remove(path, ignored);
  }
};

}  // namespace

void write_map(const std::filesystem::path& file, const Map& map) {
  if (std::error_code ignored; std::filesystem::is_directory(file, ignored))
    throw InputError({file.string()}, "found a folder; expected the name of the map file to write");
  std::filesystem::path temporary_name = file;
  temporary_name += ".tmp";
  std::ofstream stream(temporary_name, std::ios::binary | std::ios::trunc);
  const char* cannot = "cannot be written; is the folder there, writable and not full?";
  if (!stream) throw InputError({file.string()}, cannot);
  TemporaryFile temporary{temporary_name};
  write_content(stream, map);
  stream.close();
  if (!stream) throw InputError({file.string()}, cannot);
  std::error_code error;
  std::filesystem::rename(temporary_name, file, error);
  if (error) throw InputError({file.string()}, "cannot be replaced: " + error.message());
  temporary.keep = true;
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
