// SPDX-License-Identifier: BSD-3-Clause
#include "content_reader.hpp"

#include <string>
#include <utility>

namespace holdfast::map_io {

namespace {

/// Takes sections as they come: tables, keyframes, features of each keyframe, points.
class ContentReader {
 public:
  ContentReader(ContainerReader& container, FeatureReading features) : container_(container), features_(features) {}

  FileContent read() {
    while (container_.next()) take_section();
    if (!has_points_ || features_read_ != feature_counts_.size())
      fail("the file ends after " + std::to_string(features_read_) + " keyframes; expected " +
           std::to_string(feature_counts_.size()) + " and a section '" + point_section + "'");
    check_header();
    content_.map.next_sequence = container_.header().next_sequence;
    const std::uint32_t sensor = container_.header().sensor;
    if (sensor >= sensor_names().size())
      fail("found sensor number " + std::to_string(sensor) + "; expected less than " +
           std::to_string(sensor_names().size()));
    content_.map.sensor = static_cast<Sensor>(sensor);
    return std::move(content_);
  }

 private:
  [[noreturn]] void fail(const std::string& message) const {
    container_.fail(message + "; the file was written wrongly: make the map again");
  }

  void take_section() {
    const std::string& type = container_.type();
    if (type == camera_section) {
      expect(!has_tables_);
      has_tables_ = true;
      content_.tables = read_tables(container_.payload());
    } else if (type == lens_section) {
      expect(has_tables_ && !has_lenses_ && !has_keyframes_);
      read_lenses(container_.payload(), content_.tables);
      has_lenses_ = true;
    } else if (type == descriptor_section) {
      expect(has_tables_ && !has_descriptors_ && !has_keyframes_);
      has_descriptors_ = true;
      content_.map.features = read_map_features(container_.payload());
    } else if (type == keyframe_section) {
      expect(has_tables_ && !has_keyframes_);
      content_.map.keyframes = read_keyframes(container_.payload(), content_.tables, feature_counts_);
      has_keyframes_ = true;
    } else if (type == feature_section) {
      expect(has_keyframes_ && features_read_ < feature_counts_.size());
      if (features_ == FeatureReading::all)
        read_features(container_.payload(), features_read_, feature_counts_[features_read_],
                      content_.map.features.descriptors, content_.map.keyframes[features_read_].frame);
      ++features_read_;
    } else if (type == point_section) {
      expect(has_keyframes_ && !has_points_);
      content_.map.points = read_points(container_.payload(), content_.map.features.descriptors);
      has_points_ = true;
    } else if (type == place_section) {
      expect(has_points_ && !has_places_);
      read_places(container_.payload(), content_.map.keyframes);
      has_places_ = true;
    } else if (type == class_section) {
      expect(has_points_ && !has_classes_);
      content_.map.classes = read_classes(container_.payload(), content_.map.points);
      has_classes_ = true;
    } else if (type == vote_section) {
      expect(has_classes_ && !has_votes_);
      read_votes(container_.payload(), content_.map.classes.size(), content_.map.points);
      has_votes_ = true;
    } else if (type == inertia_section) {
      expect(has_points_ && !content_.map.inertia);
      content_.map.inertia = read_inertia(container_.payload());
    } else if (type == motion_section) {
      expect(has_points_ && !has_motions_);
      read_motions(container_.payload(), content_.map.keyframes);
      has_motions_ = true;
    } else if (container_.required()) {
      container_.fail("found a section '" + type +
                      "' that this Holdfast does not know and cannot leave out: use a newer Holdfast");
    }
  }

  void expect(bool right_place) const {
    if (!right_place)
      fail("found section '" + container_.type() + "' where it does not belong; expected '" + camera_section + "', '" +
           lens_section + "' if there are such lenses, '" + descriptor_section + "' if there are such descriptors, '" +
           keyframe_section + "', one '" + feature_section + "' for each keyframe, '" + point_section + "', '" +
           place_section + "' if images were described, '" + class_section + "' if points have classes, '" +
           vote_section + "' if they have votes, '" + inertia_section + "' if estimates of an IMU are kept, '" +
           motion_section + "' if keyframes have a vertical or a motion, in this order");
  }

  void check_header() {
    const FileHeader& header = container_.header();
    std::uint64_t observations = 0;
    for (const MapPoint& point : content_.map.points) observations += point.observations.size();
    const auto compare = [&](const char* what, std::uint64_t found, std::uint64_t said) {
      if (found != said)
        fail(std::string("found ") + std::to_string(found) + " " + what + "; the header says " + std::to_string(said));
    };
    for (const std::uint32_t count : feature_counts_) content_.features += count;
    compare("keyframes", content_.map.keyframes.size(), header.keyframes);
    compare("points", content_.map.points.size(), header.points);
    compare("observations", observations, header.observations);
  }

  ContainerReader& container_;
  FeatureReading features_;
  FileContent content_;
  std::vector<std::uint32_t> feature_counts_;
  std::uint32_t features_read_ = 0;
  bool has_tables_ = false, has_lenses_ = false, has_descriptors_ = false, has_keyframes_ = false, has_points_ = false,
       has_places_ = false, has_classes_ = false, has_votes_ = false, has_motions_ = false;
};

}  // namespace

FileContent read_content(ContainerReader& container, FeatureReading features) {
  return ContentReader(container, features).read();
}

}  // namespace holdfast::map_io
