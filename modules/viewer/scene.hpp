// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "dense_cloud.hpp"
#include "holdfast/core/frame_result.hpp"
#include "holdfast/viewer/viewer.hpp"
#include "message.hpp"
#include "shown_map.hpp"
#include "shown_mesh.hpp"

namespace holdfast::viewer {

/// What one browser has been told.
struct Progress {
  bool has_head = false;
  std::uint64_t version = 0;      ///< of the scene
  std::uint64_t path_number = 0;  ///< a new number: another path
  std::size_t path = 0, stages = 0;
  std::uint64_t trails = 0;  ///< number of positions of moving objects
  std::uint64_t frames = 0;  ///< number of the next frame for the time chart
  std::uint64_t picture = 0, loops = 0;
  CloudProgress cloud;
  MeshProgress mesh;
};

/// How the run is being played, as the page shows it.
struct PlayState {
  bool is_paused = false;
  double speed = 0.0;
  int browsers = 0;
};

/// What the page shows, and the messages that bring a browser from what it knows to what there is. One thread.
class Scene {
 public:
  explicit Scene(const ViewerOptions& options);

  void add(const FrameResult& result);
  void set_map(const MapSnapshot& map);
  void set_classes(std::vector<std::string> names);
  void add(std::span<const ViewedClass> classes);
  void add(ViewedSurface surface);
  void add(std::vector<SurfacePatch> patches, int coarseness) { mesh_.add(std::move(patches), coarseness); }
  /// Of the patches that are wanted.
  int mesh_coarseness() const { return mesh_.coarseness(); }
  void set_picture(const ViewedPicture& picture);
  void add_loop(KeyFrameId keyframe, KeyFrameId candidate);
  void set_run(ViewedRun run);
  void set_play(const PlayState& play);

  /// Everything that the browser lacks, as the bytes of a Message; empty if it lacks nothing. Moves its progress to
  /// here.
  std::string update(Progress& progress) const;

 private:
  struct PathEntry {
    double timestamp = 0.0;
    Eigen::Vector3f position;
    Eigen::Quaternionf turn;
    KeyFrameId keyframe;
    TrackingStatus status = TrackingStatus::tracked;
    TrackingMethod method = TrackingMethod::none;
    float error;
    std::uint64_t version = 0;  // in which it moved last
  };
  struct ChartEntry {
    double timestamp = 0.0;
    TrackingStatus status = TrackingStatus::waiting;
    TrackingMethod method = TrackingMethod::none;
    float tracking = 0.0F;                                // [ms]
    std::vector<std::pair<std::uint32_t, float>> stages;  // number and [ms]
  };

  void add_trails(const FrameResult& result);
  void follow_keyframes();
  void describe_head(Message& message) const;
  void describe_state(Message& message) const;
  void describe_frames(Progress& progress, Message& message) const;
  void describe_path(Progress& progress, Message& message) const;
  void describe_picture(Progress& progress, Message& message) const;
  void describe_objects(Progress& progress, Message& message) const;
  void describe_run(Message& message) const;

  ViewerOptions options_;
  std::uint64_t version_ = 1, head_version_ = 1, state_version_ = 1, run_version_ = 0;
  ShownMap map_;
  DenseCloud cloud_;
  ShownMesh mesh_;
  std::vector<std::string> classes_;
  std::vector<PathEntry> path_;
  std::uint64_t path_number_ = 1;
  std::deque<ChartEntry> chart_;
  std::uint64_t chart_end_ = 0;  // number of the frame after the last one in chart_
  std::vector<std::string> stages_;
  std::map<std::string, std::uint32_t, std::less<>> stage_numbers_;
  std::optional<FrameResult> last_;
  std::vector<std::uint32_t> trail_ids_;
  std::vector<float> trail_positions_;  // three for each id
  std::uint64_t trail_begin_ = 0;       // number of the first position that is kept
  std::uint64_t picture_number_ = 0;
  ViewedPicture picture_;           // without its image, which is
  std::vector<std::uint8_t> jpeg_;  // here
  std::vector<std::pair<KeyFrameId, KeyFrameId>> closed_loops_;
  std::optional<ViewedRun> run_;
  PlayState play_;
};

}  // namespace holdfast::viewer
