// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bytes.hpp"
#include "holdfast/core/map.hpp"

/// The content of the sections; docs/map_format.md has the layout. Every read_ function checks each number by itself
/// (finite, within its range); whether references agree is checked by Map::restore().
namespace holdfast::map_io {

/// Section types.
inline constexpr const char* camera_section = "CAMS";
inline constexpr const char* lens_section = "LENS";
inline constexpr const char* descriptor_section = "DESC";  ///< absent for ORB's 256 bits
inline constexpr const char* keyframe_section = "KEYF";
inline constexpr const char* feature_section = "FEAT";
inline constexpr const char* point_section = "POIN";
inline constexpr const char* place_section = "PLAC";    ///< only if images of keyframes were described
inline constexpr const char* class_section = "CLAS";    ///< only if points have classes; not required
inline constexpr const char* vote_section = "VOTE";     ///< only if points have votes; not required
inline constexpr const char* inertia_section = "INER";  ///< only if the map keeps estimates of an IMU; not required
inline constexpr const char* motion_section = "MOTN";   ///< only if keyframes have a vertical or a motion; not required

/// Cameras and pyramids that keyframes share; keyframes name them by position.
struct SharedTables {
  std::vector<std::shared_ptr<const Camera>> cameras;
  std::vector<std::shared_ptr<const ScalePyramid>> pyramids;
};

/// Positions in the file of the entries of a map: keyframes by rising sequence, points in slot order.
class DenseIndex {
 public:
  /// Of the whole map, or of one of its submaps.
  explicit DenseIndex(const Map& map, std::optional<std::uint32_t> submap = std::nullopt);
  /// By position.
  const std::vector<KeyFrameId>& keyframes() const { return keyframes_; }
  const std::vector<MapPointId>& points() const { return points_; }
  /// The position; no_index for an invalid id; throws CheckError for an id that names nothing.
  std::uint32_t of(KeyFrameId id) const;
  std::uint32_t of(MapPointId id) const;

 private:
  std::vector<KeyFrameId> keyframes_;
  std::vector<MapPointId> points_;
  std::vector<std::uint32_t> keyframe_positions_, point_positions_;  // by slot
};
inline constexpr std::uint32_t no_index = 0xFFFFFFFFU;

/// What a map file cannot hold in an entry, such as a number that is not finite; "" when all is well.
std::string trouble_of(const Camera& camera);
std::string trouble_of_numbers(const Camera& camera);  ///< each by itself
std::string trouble_of(const ScalePyramid& pyramid);
std::string trouble_of(const KeyFrame& keyframe);  ///< without its features
std::string trouble_of_features(const Frame& frame);
std::string trouble_of(const MapPoint& point);
std::string trouble_of(const MapInertia& inertia);
std::string trouble_of_motion(const KeyFrame& keyframe);  ///< of its vertical and its motion

/// Writing throws CheckError, with the entry's trouble, for a map that no reader would take.
SharedTables tables_of(const Map& map, const DenseIndex& index);
void write_tables(const SharedTables& tables, ByteWriter& writer);
/// Of the cameras whose lens write_tables() cannot say; writes nothing if there is none.
void write_lenses(const SharedTables& tables, ByteWriter& writer);
void write_keyframes(const Map& map, const DenseIndex& index, const SharedTables& tables, ByteWriter& writer);
void write_features(const Frame& frame, std::uint32_t position, const DenseIndex& index, ByteWriter& writer);
void write_points(const Map& map, const DenseIndex& index, ByteWriter& writer);
/// Length of the payload of write_features.
std::uint64_t features_size(std::size_t features, const DescriptorType& type);
void write_map_features(const MapFeatures& features, ByteWriter& writer);
/// Frame::image_descriptor of all keyframes that have one; writes nothing if there is none.
void write_places(const Map& map, const DenseIndex& index, ByteWriter& writer);
/// Names of classes and the labels of all points; writes nothing if there are no classes.
void write_classes(const Map& map, const DenseIndex& index, ByteWriter& writer);
/// Map::class_votes() of all points; writes nothing if there are none.
void write_votes(const Map& map, const DenseIndex& index, ByteWriter& writer);
/// Writes nothing if the map keeps none.
void write_inertia(const Map& map, ByteWriter& writer);
/// KeyFrame::vertical and KeyFrame::motion of all keyframes that have one; writes nothing if there is none.
void write_motions(const Map& map, const DenseIndex& index, ByteWriter& writer);

/// Reading throws InputError.
SharedTables read_tables(ByteReader reader);
/// Completes the cameras of read_tables(), whose lenses are checked by read_keyframes().
void read_lenses(ByteReader reader, SharedTables& tables);
/// All of the keyframes but their features. `feature_counts`: of each keyframe.
std::vector<KeyFrame> read_keyframes(ByteReader reader, const SharedTables& tables,
                                     std::vector<std::uint32_t>& feature_counts);
/// Fills the features of keyframe `position`; `count` is that of the keyframe.
void read_features(ByteReader reader, std::uint32_t position, std::uint32_t count, const DescriptorType& type,
                   Frame& frame);
std::vector<MapPoint> read_points(ByteReader reader, const DescriptorType& type);
MapFeatures read_map_features(ByteReader reader);
/// Fills Frame::image_descriptor of the keyframes.
void read_places(ByteReader reader, std::vector<KeyFrame>& keyframes);
/// The names; fills MapPoint::label of the points.
std::vector<std::string> read_classes(ByteReader reader, std::vector<MapPoint>& points);
/// Fills MapPoint::earlier_votes of the points; `classes`: number of classes of the map.
void read_votes(ByteReader reader, std::size_t classes, std::vector<MapPoint>& points);
MapInertia read_inertia(ByteReader reader);
/// Fills KeyFrame::vertical and KeyFrame::motion of the keyframes.
void read_motions(ByteReader reader, std::vector<KeyFrame>& keyframes);

}  // namespace holdfast::map_io
