// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "holdfast/matching/frame_features.hpp"
#include "holdfast/pipeline/pipeline.hpp"
#include "holdfast/plugin/builtin.hpp"
#include "holdfast/plugin/registry.hpp"
#include "holdfast/simulation/scene_file.hpp"
#include "holdfast/simulation/simulator.hpp"

namespace holdfast {
namespace {

/// People come into view and fill three quarters of it: a part of walking_xyz.
class People {
 public:
  static constexpr std::uint64_t first = 48, count = 48;

  People()
      : simulator_(simulation::read_scene(std::string(HOLDFAST_SOURCE_DIR) + "/examples/scenes/walking_xyz.yaml"),
                   find_camera("tum_fr3").value()) {
    const auto& names = simulator_.class_names();
    person_ = static_cast<std::uint8_t>(std::find(names.begin(), names.end(), "person") - names.begin());
    for (std::uint64_t i = 0; i < count; ++i) frames_.push_back(simulator_.frame(first + i));
  }
  const std::vector<SensorFrame>& frames() const { return frames_; }
  const SensorFrame& at(std::uint64_t index) const { return frames_[index - first]; }
  const Camera& camera() const { return simulator_.camera(); }
  const std::vector<std::string>& class_names() const { return simulator_.class_names(); }
  /// Whether a pixel and all around it within a few pixels show a person.
  bool shows_person(const SensorFrame& frame, double x, double y) const {
    constexpr int margin = 3;
    const cv::Mat& labels = frame.truth->class_labels;
    const int column = static_cast<int>(std::lround(x)), row = static_cast<int>(std::lround(y));
    if (column < margin || row < margin || column + margin >= labels.cols || row + margin >= labels.rows) return false;
    for (const int dy : {-margin, 0, margin})
      for (const int dx : {-margin, 0, margin})
        if (labels.at<std::uint8_t>(row + dy, column + dx) != person_) return false;
    return true;
  }
  /// Points of a map that lie on people in a frame.
  int points_on_people(const Map& map, const SensorFrame& frame, const Eigen::Isometry3d& T_world_camera) const {
    int points = 0;
    map.points().for_each([&](MapPointId, const MapPoint& point) {
      const Eigen::Vector3d p = T_world_camera.inverse() * point.position;
      if (p.z() < 0.1) return;
      const Eigen::Vector2d pixel = camera().project(p);
      if (!shows_person(frame, pixel.x(), pixel.y())) return;
      const float depth =
          frame.depth.at<float>(static_cast<int>(std::lround(pixel.y())), static_cast<int>(std::lround(pixel.x())));
      points += depth > 0.0F && std::abs(depth - p.z()) < 0.1 ? 1 : 0;
    });
    return points;
  }

 private:
  simulation::Simulator simulator_;
  std::uint8_t person_ = 0;
  std::vector<SensorFrame> frames_;
};

/// Notes which frames a segmenter was given, and may overlook people or call them something else, which can move.
class Noting final : public Segmenter {
 public:
  Noting(std::unique_ptr<Segmenter> segmenter, std::set<std::uint64_t>& noted, const std::string& people_are_called,
         bool overlooks_people)
      : segmenter_(std::move(segmenter)),
        noted_(noted),
        classes_(segmenter_->classes()),
        overlooks_people_(overlooks_people) {
    std::replace(classes_.begin(), classes_.end(), std::string("person"), people_are_called);
    if (people_are_called != "person") movable_.push_back(people_are_called);
  }
  const std::vector<std::string>& classes() const override { return classes_; }
  std::vector<std::string> movable() const override { return movable_; }
  Segmentation segment(const SensorFrame& frame) override {
    noted_.insert(frame.index);
    Segmentation segmentation = segmenter_->segment(frame);
    if (overlooks_people_) segmentation.labels = cv::Mat::zeros(segmentation.labels.size(), CV_8UC1);
    return segmentation;
  }

 private:
  std::unique_ptr<Segmenter> segmenter_;
  std::set<std::uint64_t>& noted_;
  std::vector<std::string> classes_, movable_;
  bool overlooks_people_;
};

/// Keeps what it is given and recognises nothing.
class NotingDetector final : public LoopDetector {
 public:
  using Database = std::map<KeyFrameId, std::vector<Descriptor256>>;

  explicit NotingDetector(Database& database) : database_(database) {}
  void add(KeyFrameId keyframe, const DescriptorView& descriptors) override {
    database_[keyframe].assign(descriptors.row(0), descriptors.row(0) + descriptors.size());
  }
  void remove(KeyFrameId keyframe) override { database_.erase(keyframe); }
  std::vector<PlaceMatch> query(const DescriptorView&, int) const override { return {}; }

 private:
  Database& database_;
};

struct Options {
  bool filters = true, threaded = false;
  int latency = 5;
  double new_view_share = 0.3;
  SegmentedFrames on = SegmentedFrames::keyframes;
  std::string people_are_called = "person";
  bool overlooks_people = false;  ///< no filter sees anybody
  std::size_t begin = 0;          ///< the first of the frames that is fed
  double start_share = 0.0;
};

struct WholeRun {
  explicit WholeRun(const People& people, const Options& options = {}) : pipeline(parts_of(people, options)) {
    for (std::size_t i = options.begin; i < people.frames().size(); ++i) {
      results.push_back(pipeline.feed(people.frames()[i]));
      if (!options.threaded && results.back().is_keyframe) points_at_once.push_back(points_of(results.back().keyframe));
    }
    pipeline.finish();
  }
  PipelineParts parts_of(const People& people, const Options& options) {
    Registry registry;
    register_builtin_plugins(registry);
    CreationContext context;
    context.camera = people.camera();
    context.class_names = people.class_names();
    PipelineParts parts;
    parts.camera = context.camera;
    parts.features = registry.create<FeatureExtractor>("orb", {}, context);
    parts.optimizer = registry.create<Optimizer>("ceres", {}, context);
    parts.loop_detector = std::make_unique<NotingDetector>(database);
    parts.segmentation.latency = options.latency;
    parts.tracking.start_share = options.start_share;
    parts.segmentation.new_view_share = options.new_view_share;
    parts.segmentation.frames = options.on;
    if (options.threaded) parts.run.mode = RunMode::threaded;
    if (!options.filters) return parts;
    parts.segmenter = std::make_unique<Noting>(registry.create<Segmenter>("truth", {}, context), segmented,
                                               options.people_are_called, options.overlooks_people);
    for (const char* name : {"semantic_mask", "multi_view_depth"})
      if (!options.overlooks_people || std::string(name) == "semantic_mask")
        parts.filters.emplace_back(name, registry.create<DynamicFilter>(name, {}, context));
    return parts;
  }
  /// Number of features of a keyframe that show map points.
  std::ptrdiff_t points_of(KeyFrameId keyframe) const {
    const std::vector<MapPointId>& points = pipeline.map().keyframe(keyframe).frame.map_points;
    return std::count_if(points.begin(), points.end(), [](MapPointId id) { return id.valid(); });
  }
  /// Largest distance from the truth, both relative to the last frame with a pose [m].
  double largest_error(const People& people) const {
    double largest = 0.0;
    const Trajectory trajectory = pipeline.trajectory();
    const auto truth_at = [&](double time) {
      for (const SensorFrame& frame : people.frames())
        if (frame.timestamp == time) return *frame.truth->T_world_camera;
      return Eigen::Isometry3d::Identity();
    };
    const TimedPose& last = trajectory.back();
    const Eigen::Isometry3d T_truth_world = truth_at(last.timestamp) * last.T_world_camera.inverse();
    for (const TimedPose& pose : trajectory)
      largest = std::max(
          largest, (T_truth_world * pose.T_world_camera.translation() - truth_at(pose.timestamp).translation()).norm());
    return largest;
  }
  int points_on_people_at_end(const People& people) const {
    return people.points_on_people(pipeline.map(), people.frames().back(), pipeline.trajectory().back().T_world_camera);
  }

  // Before the pipeline, whose segmenter and loop detector write to them.
  std::set<std::uint64_t> segmented;
  NotingDetector::Database database;
  Pipeline pipeline;
  std::vector<std::ptrdiff_t> points_at_once;  // of each keyframe right after its frame
  std::vector<FrameResult> results;
};

class PeopleTest : public testing::Test {
 protected:
  static void SetUpTestSuite() { people_ = new People; }
  static void TearDownTestSuite() {
    delete people_;
    people_ = nullptr;
  }
  static const People& people() { return *people_; }

  /// No feature on a person names a map point in keyframes that were segmented.
  static void expect_clean_keyframes(const WholeRun& run) {
    int judged = 0, on_people = 0;
    run.pipeline.map().keyframes().for_each([&](KeyFrameId, const KeyFrame& keyframe) {
      const Frame& frame = keyframe.frame;
      if (!run.segmented.contains(frame.index)) return;
      for (std::size_t i = 0; i < frame.size(); ++i) {
        if (!people().shows_person(people().at(frame.index), frame.features.x[i], frame.features.y[i])) continue;
        ++judged;
        on_people += frame.map_points[i].valid() ? 1 : 0;
      }
    });
    EXPECT_GE(judged, 100);
    EXPECT_EQ(on_people, 0);
  }

  /// The database of place recognition has no descriptor of a feature on a person in keyframes that were segmented,
  /// and that of every static feature.
  static void expect_clean_database(const Map& map, const std::set<std::uint64_t>& segmented,
                                    const NotingDetector::Database& database) {
    int judged = 0, on_people = 0;
    EXPECT_EQ(database.size(), map.keyframes().size());
    for (const auto& [id, descriptors] : database) {
      ASSERT_NE(map.find_keyframe(id), nullptr);
      const Frame& frame = map.keyframe(id).frame;
      EXPECT_TRUE(DescriptorView(descriptors) == static_descriptors(frame).view());
      if (!segmented.contains(frame.index)) continue;
      for (std::size_t i = 0; i < frame.size(); ++i) {
        if (!people().shows_person(people().at(frame.index), frame.features.x[i], frame.features.y[i])) continue;
        ++judged;
        on_people += std::find(descriptors.begin(), descriptors.end(), frame.features.descriptors.of_256_bits()[i]) !=
                             descriptors.end()
                         ? 1
                         : 0;
      }
    }
    EXPECT_GE(judged, 100);
    EXPECT_EQ(on_people, 0);
  }

 private:
  static inline const People* people_ = nullptr;
};

TEST_F(PeopleTest, PeopleStayOutOfTheMapHoweverLateTheirMasksCome) {
  for (const int latency : {0, 5}) {
    const WholeRun run(people(), {.latency = latency});
    EXPECT_GE(run.pipeline.trajectory().size(), People::count * 9 / 10);
    EXPECT_LE(run.largest_error(people()), 0.04) << latency;
    EXPECT_EQ(run.points_on_people_at_end(people()), 0) << latency;
    expect_clean_keyframes(run);
    const std::uint64_t made = run.pipeline.mapping_counts().keyframes_made;
    EXPECT_GE(made, 2U);
    EXPECT_EQ(run.segmented.size(), made);  // every keyframe and nothing else
    ASSERT_EQ(run.pipeline.mask_latencies().size(), made);
    std::size_t i = 0;
    for (const std::uint64_t index : run.segmented) {
      const double measured = run.pipeline.mask_latencies()[i++];
      const auto frames = static_cast<std::uint64_t>(latency);
      if (index + frames < People::first + People::count) {  // the run did not end before
        EXPECT_NEAR(measured, static_cast<double>(frames) / 30.0, 1e-6) << index;
      }
    }
  }
}

TEST_F(PeopleTest, AMapThatBeganOnPeopleBeginsAnewWithTheFirstMask) {
  // The first frame that is fed shows little but people; their mask comes five frames later.
  constexpr std::size_t begin = 30;
  const WholeRun stays(people(), {.begin = begin});
  const WholeRun restarts(people(), {.begin = begin, .start_share = 0.75});
  const auto starts = [](const WholeRun& run) {
    return std::count_if(run.results.begin(), run.results.end(),
                         [](const FrameResult& result) { return result.status == TrackingStatus::initialised; });
  };
  EXPECT_EQ(starts(stays), 1);
  EXPECT_EQ(starts(restarts), 2);
  EXPECT_EQ(restarts.results[5].status, TrackingStatus::initialised);
  EXPECT_LT(restarts.largest_error(people()), 0.5 * stays.largest_error(people()));
  expect_clean_keyframes(restarts);
}

TEST_F(PeopleTest, AKeyframeOfANewViewDoesNotWaitForItsMask) {
  const WholeRun waits(people(), {.new_view_share = 0.0, .overlooks_people = true});
  const WholeRun does_not(people(), {.new_view_share = 1.0, .overlooks_people = true});
  ASSERT_GE(waits.points_at_once.size(), 2U);
  ASSERT_GE(does_not.points_at_once.size(), 2U);
  EXPECT_EQ(waits.points_at_once[0], does_not.points_at_once[0]);  // the first never waits
  EXPECT_GT(does_not.points_at_once[1], waits.points_at_once[1] + 50);

  // Where people are seen, keyframes wait, or their own masks take the points back.
  const WholeRun among_people(people(), {.new_view_share = 1.0});
  EXPECT_LE(among_people.largest_error(people()), 0.04);
  EXPECT_EQ(among_people.points_on_people_at_end(people()), 0);
  expect_clean_keyframes(among_people);
}

TEST_F(PeopleTest, PeopleStayOutOfTheKeyframeDatabase) {
  for (const int latency : {0, 5}) {
    WholeRun run(people(), {.latency = latency});
    expect_clean_database(run.pipeline.map(), run.segmented, run.database);
    // A map that is loaded again makes the same database.
    NotingDetector::Database loaded;
    PipelineParts parts = run.parts_of(people(), {});
    parts.loop_detector = std::make_unique<NotingDetector>(loaded);
    parts.map = run.pipeline.take_map();
    parts.localise_only = true;
    const Pipeline continued(std::move(parts));
    expect_clean_database(continued.map(), run.segmented, loaded);
  }
}

TEST_F(PeopleTest, WhatTheSegmenterCallsMovableStaysOutOfTheMap) {
  const WholeRun run(people(), {.people_are_called = "visitor"});
  EXPECT_LE(run.largest_error(people()), 0.04);
  EXPECT_EQ(run.points_on_people_at_end(people()), 0);
  expect_clean_keyframes(run);
}

TEST_F(PeopleTest, EveryNthFrameIsSegmentedWhenAsked) {
  const WholeRun run(people(), {.on = SegmentedFrames::every_n});
  std::uint64_t before = People::first;
  for (const std::uint64_t index : run.segmented) {
    EXPECT_LE(index - before, 5U);
    before = index;
  }
  EXPECT_LE(People::first + People::count - before, 5U);
  EXPECT_LT(run.segmented.size(), People::count / 5 + run.pipeline.mapping_counts().keyframes_made + 1);
  EXPECT_EQ(run.pipeline.mask_latencies().size(), run.segmented.size());
  EXPECT_LE(run.largest_error(people()), 0.08);
}

TEST_F(PeopleTest, WithoutFiltersTheyAreInTheMapAndDragThePose) {
  const WholeRun run(people(), {.filters = false});
  EXPECT_GE(run.points_on_people_at_end(people()), 50);
  EXPECT_GE(run.largest_error(people()), 0.1);
}

TEST_F(PeopleTest, TwoRunsGiveTheSameBits) {
  const WholeRun first(people()), second(people());
  const Trajectory a = first.pipeline.trajectory(), b = second.pipeline.trajectory();
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_EQ(a[i].T_world_camera.matrix(), b[i].T_world_camera.matrix()) << i;
  for (std::size_t i = 0; i < first.results.size(); ++i) {
    EXPECT_EQ(first.results[i].features, second.results[i].features) << i;
    EXPECT_EQ(first.results[i].static_features, second.results[i].static_features) << i;
    EXPECT_EQ(first.results[i].inliers, second.results[i].inliers) << i;
  }
  std::vector<std::pair<Eigen::Vector3d, float>> points[2];
  for (int k = 0; k < 2; ++k)
    (k == 0 ? first : second).pipeline.map().points().for_each([&](MapPointId, const MapPoint& point) {
      points[k].emplace_back(point.position, point.static_log_odds);
    });
  EXPECT_GE(points[0].size(), 200U);
  EXPECT_TRUE(points[0] == points[1]);
}

TEST_F(PeopleTest, ThreadsSegmentEveryKeyframeOrPassItOn) {
  const WholeRun run(people(), {.threaded = true});
  EXPECT_GE(run.pipeline.trajectory().size(), People::count * 9 / 10);
  const std::uint64_t made = run.pipeline.mapping_counts().keyframes_made;
  EXPECT_GE(made, 2U);
  EXPECT_GE(run.segmented.size(), 1U);
  EXPECT_LE(run.segmented.size(), made);
  EXPECT_EQ(run.pipeline.mask_latencies().size(), run.segmented.size());
  const std::vector<WorkerCounts> workers = run.pipeline.worker_counts();
  ASSERT_EQ(workers.size(), 4U);
  EXPECT_EQ(workers[0].queue.taken, made);  // local mapping
  EXPECT_EQ(workers[3].queue.taken, run.segmented.size());
  expect_clean_keyframes(run);
  expect_clean_database(run.pipeline.map(), run.segmented, run.database);
}

}  // namespace
}  // namespace holdfast
