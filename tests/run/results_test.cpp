// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/run/results.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "holdfast/core/error.hpp"
#include "holdfast/map_io/map_file.hpp"
#include "holdfast/plugin/parameter_table.hpp"
#include "holdfast/run/trajectory_journal.hpp"
#include "run/point_run.hpp"

namespace holdfast {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
namespace fs = std::filesystem;

class ResultsTest : public ::testing::Test {
 protected:
  ResultsTest() : folder_(fs::temp_directory_path() / ("results_test." + std::to_string(getpid()))) {
    test::PointRun points;
    record_ = run(*points.built, points.configuration);
    record_.map = points.built->pipeline.take_map();
  }
  ~ResultsTest() override { fs::remove_all(folder_); }

  std::string text(const std::string& file) const {
    std::ifstream stream(folder_ / file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  }
  std::vector<std::string> files() const {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder_)) names.push_back(entry.path().filename().string());
    return names;
  }

  fs::path folder_;
  RunRecord record_;
};

TEST_F(ResultsTest, EveryResultIsAFileOfItsOwn) {
  write_results(record_, folder_ / "deep");
  folder_ /= "deep";
  EXPECT_THAT(files(), ::testing::UnorderedElementsAre("trajectory.txt", "keyframes.txt", "config.yaml", "run.json",
                                                       "report.html", "map.hfm", "static_map.ply", "evaluation.json",
                                                       "tracks.json", "trajectory.svg", "error.svg"));
  for (const std::string& name : files())
    EXPECT_EQ(std::count(result_names().begin(), result_names().end(), name), 1) << name;
  EXPECT_EQ(text("trajectory.txt"), trajectory_text(record_.trajectory));
  EXPECT_EQ(read_map(folder_ / "map.hfm").points().size(), record_.map_points);
  EXPECT_EQ(text("run.json"), run_json(record_));
  folder_ = folder_.parent_path();
}

/// What a killed run leaves: every pose of the last second at the latest, under a comment that says so.
TEST_F(ResultsTest, TheJournalKeepsThePosesOfARunThatIsKilled) {
  fs::create_directories(folder_);
  EXPECT_EQ(poses_of_killed_run(folder_), -1);
  {
    TrajectoryJournal journal(folder_);
    EXPECT_EQ(poses_of_killed_run(folder_), 0);
    for (const TimedPose& pose : record_.trajectory) journal.add(pose);
  }
  EXPECT_EQ(poses_of_killed_run(folder_), 30);
  EXPECT_THAT(text("trajectory.txt"), ::testing::StartsWith("# The run has not come to its end"));
  EXPECT_EQ(read_trajectory(folder_ / "trajectory.txt").size(), 30U);
  write_results(record_, folder_);
  EXPECT_EQ(poses_of_killed_run(folder_), -1);
  EXPECT_EQ(text("trajectory.txt"), trajectory_text(record_.trajectory));
  EXPECT_THROW(TrajectoryJournal(folder_ / "nowhere"), InputError);
}

TEST_F(ResultsTest, AMapThatWasOnlyLocalisedInIsNotWritten) {
  record_.localised_only = true;
  write_results(record_, folder_);
  EXPECT_FALSE(fs::exists(folder_ / "map.hfm"));
  EXPECT_FALSE(fs::exists(folder_ / "static_map.ply"));
  EXPECT_TRUE(fs::exists(folder_ / "run.json"));
}

TEST_F(ResultsTest, TheDenseMapTakesThePlaceOfTheMapPoints) {
  record_.dense_map = std::vector<CloudPoint>(3);
  write_results(record_, folder_);
  EXPECT_THAT(text("static_map.ply"), HasSubstr("element vertex 3\n"));
}

TEST_F(ResultsTest, ASurfaceIsWrittenInItsFormatsAndWithItsMaps) {
  record_.surface.emplace().vertices.resize(3);
  for (int i = 0; i < 3; ++i) record_.surface->vertices[static_cast<std::size_t>(i)].position[i] = 1.0F;
  record_.surface->triangles = {{0, 1, 2}};
  SurfaceSettings settings;
  settings.formats = {"glb", "obj"};
  record_.configuration.sections["surface"] = ParameterTable<SurfaceSettings>().values(settings);
  NavigationMaps& maps = record_.navigation.emplace();
  maps.floor.emplace();
  maps.grid.width = maps.grid.height = 1;
  maps.grid.cells = {Occupancy::free};
  maps.octomap = "tree";
  maps.octomap_probabilities = "likely tree";
  record_.surface_views.emplace();
  write_results(record_, folder_);
  EXPECT_THAT(text("surface.glb"), ::testing::StartsWith("glTF"));
  EXPECT_THAT(text("surface.obj"), HasSubstr("f 1//1 2//2 3//3"));
  EXPECT_FALSE(fs::exists(folder_ / "surface.ply"));
  EXPECT_EQ(text("octomap.bt"), "tree");
  EXPECT_EQ(text("octomap.ot"), "likely tree");
  EXPECT_THAT(text("surface_views/views.json"), HasSubstr("\"views\": []"));
  EXPECT_EQ(text("map.pgm"), "P5\n1 1\n255\n\xFE");
  EXPECT_THAT(text("map.yaml"), ::testing::StartsWith("image: map.pgm\n"));
  for (const std::string& name : files())
    EXPECT_EQ(std::count(result_names().begin(), result_names().end(), name), 1) << name;
}

TEST_F(ResultsTest, RunJsonHoldsTheFigures) {
  const nlohmann::json json = nlohmann::json::parse(run_json(record_));
  EXPECT_EQ(json.at("configuration"), "points.yaml");
  EXPECT_EQ(json.at("seed"), 7);
  EXPECT_EQ(json.at("mode"), "sequential");
  EXPECT_EQ(json.at("sequence"), "points");
  EXPECT_EQ(json.at("frames").at("expected"), 30);
  EXPECT_EQ(json.at("frames").at("poses"), 30);
  EXPECT_EQ(json.at("map").at("points"), record_.map_points);
  EXPECT_EQ(json.at("evaluation").at("ate_m").at("rmse"), record_.evaluation->absolute_error.rmse);
  EXPECT_TRUE(json.at("threads").is_null());
  EXPECT_TRUE(json.at("failure").is_null());
  record_.failure = "the disk is full";
  record_.threads.emplace().delays = {0.01, 0.05};
  const nlohmann::json failed = nlohmann::json::parse(run_json(record_));
  EXPECT_EQ(failed.at("failure"), "the disk is full");
  EXPECT_EQ(failed.at("threads").at("frame_to_result").at("share_above_33_ms"), 0.5);
}

TEST_F(ResultsTest, TheTimeOfTheFirstPoseIsUnknownWhereThereWasNone) {
  record_.start_seconds = 1.25;
  EXPECT_EQ(nlohmann::json::parse(run_json(record_)).at("start_to_first_pose_s"), 1.25);
  EXPECT_THAT(summary_text(record_), HasSubstr("\nstart to first pose  1.250 s\n"));
  record_.start_seconds = 0.0;
  EXPECT_TRUE(nlohmann::json::parse(run_json(record_)).at("start_to_first_pose_s").is_null());
  EXPECT_THAT(summary_text(record_), HasSubstr("\nstart to first pose  no frame got a pose\n"));
}

TEST_F(ResultsTest, BytesThatAreNotUtf8AreReplaced) {
  record_.configuration.file = "caf\xe9.yaml";
  record_.source.name = "\xff";
  record_.failure = "\xc3(";
  record_.skipped.push_back({4, 0.5, "caf\xe9.png: is cut short"});
  const nlohmann::json json = nlohmann::json::parse(run_json(record_));
  EXPECT_EQ(json.at("configuration"), "caf\xef\xbf\xbd.yaml");
  EXPECT_EQ(json.at("skipped_frames").at(0).at("reason"), "caf\xef\xbf\xbd.png: is cut short");
  write_results(record_, folder_);
  EXPECT_EQ(files().size(), 11U);
}

/// A folder of the name of a file stands for any file that cannot be replaced.
TEST_F(ResultsTest, OneThatCannotBeWrittenDoesNotTakeTheOthersWithIt) {
  fs::create_directories(folder_ / "whole");
  write_results(record_, folder_ / "whole");
  for (const std::string broken : {"trajectory.txt", "map.hfm", "run.json", "report.html", "static_map.ply"}) {
    const fs::path folder = folder_ / ("without_" + broken);
    fs::create_directories(folder / broken / "full");
    try {
      write_results(record_, folder);
      ADD_FAILURE() << broken;
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), AllOf(HasSubstr("1 result could not be written"), HasSubstr(broken)));
    }
    for (const auto& entry : fs::directory_iterator(folder_ / "whole"))
      EXPECT_TRUE(fs::exists(folder / entry.path().filename())) << broken << ": " << entry.path();
    EXPECT_EQ(std::distance(fs::directory_iterator(folder), {}), 11) << "something half is left";
  }
}

/// A run with poses for 3 of 30 frames, of which most had no depth.
TEST_F(ResultsTest, LowCoverageIsAWarningWithItsCommonestTrouble) {
  EXPECT_FALSE(has_low_coverage(record_));
  EXPECT_EQ(coverage_warning(record_), "");
  EXPECT_THAT(report_html(record_), ::testing::Not(HasSubstr("highlight alarming")));
  record_.trajectory.resize(3);
  for (int i = 0; i < 25; ++i) {
    FrameResult result;
    result.failure = i < 20 ? TrackingFailure::no_depth : TrackingFailure::few_features;
    record_.summary.add(result, 0.0);
  }
  EXPECT_TRUE(has_low_coverage(record_));
  EXPECT_THAT(coverage_warning(record_),
              AllOf(HasSubstr("3 of 30 frames have a pose (10.00 %), less than run.minimum_coverage 50.00 %"),
                    HasSubstr("The commonest trouble: no depth (20 frames)"), HasSubstr("Check the depth factor")));
  EXPECT_THAT(report_html(record_), AllOf(HasSubstr("<div class=\"highlight alarming\"><b>10.00 %</b>"),
                                          HasSubstr("The commonest trouble: no depth")));
  EXPECT_THAT(nlohmann::json::parse(run_json(record_)).at("warnings").dump(), HasSubstr("no depth (20 frames)"));
  record_.skipped.resize(21);
  EXPECT_THAT(coverage_warning(record_), HasSubstr("The commonest trouble: 21 frames skipped"));
  record_.configuration.run.minimum_coverage = 0.1;
  EXPECT_EQ(coverage_warning(record_), "") << "not below";
  record_.configuration.run.minimum_coverage = 0.5;
  record_.was_interrupted = true;
  EXPECT_EQ(coverage_warning(record_), "") << "frames that were not read say nothing";
}

/// A recording that begins with a second of another place.
TEST_F(ResultsTest, ACameraThatIsLostToTheEndIsAdvisedToBeginAnew) {
  record_.frames_expected = 300;
  for (int i = 30; i < 300; ++i) {
    record_.frame_stamps.push_back(i / 30.0);
    FrameResult result;
    result.status = TrackingStatus::lost;
    result.failure = i % 2 == 0 ? TrackingFailure::few_matches : TrackingFailure::few_inliers;
    record_.summary.add(result, 0.0);
  }
  const auto expect_advice = [&](bool expected, const char* reason) {
    EXPECT_EQ(coverage_warning(record_).find("tracking.restart_time") != std::string::npos, expected) << reason;
    EXPECT_NE(coverage_warning(record_), "") << reason;
  };
  EXPECT_THAT(coverage_warning(record_),
              AllOf(HasSubstr("The camera was lost 1.0 s after the first frame, and not found again in the 9.0 s"),
                    HasSubstr("`--set tracking.restart_time=2` helps"), HasSubstr("The commonest trouble: too few")));
  expect_advice(true, "another place");
  record_.sensor = Sensor::mono;
  expect_advice(false, "one camera has one submap");
  record_.sensor = Sensor::rgbd;
  record_.localised_only = true;
  expect_advice(false, "a given map gets no submaps");
  record_.localised_only = false;
  record_.configuration.sections["tracking"]["restart_time"] = 2.0;
  expect_advice(false, "it does so already");
  record_.configuration.sections["tracking"]["restart_time"] = 0.0;
  expect_advice(true, "it does not");
  record_.trajectory.push_back({8.5, Eigen::Isometry3d::Identity()});
  expect_advice(false, "it was found again");
  record_.trajectory.pop_back();
  record_.summary = {};
  for (int i = 30; i < 300; ++i) record_.summary.add(FrameResult{.failure = TrackingFailure::few_features}, 0.0);
  expect_advice(false, "it saw nothing to begin with");
}

/// A stereo pair whose baseline is in millimetres: no frame finds anything of the map that the last one began.
TEST_F(ResultsTest, PosesThatOnlyBeginMapsAreNoResult) {
  EXPECT_EQ(unsupported_poses(record_), "");
  record_.summary = RunSummary();
  record_.sensor = Sensor::stereo;
  FrameResult start;
  start.status = TrackingStatus::initialised;
  for (int i = 0; i < 2; ++i) record_.summary.add(start, 0.0);
  EXPECT_EQ(unsupported_poses(record_), "") << "a recording of two frames";
  for (int i = 0; i < 10; ++i) record_.summary.add(start, 0.0);
  EXPECT_THAT(unsupported_poses(record_), AllOf(HasSubstr("no pose is supported by the map"), HasSubstr("baseline")));
  FrameResult tracked;
  tracked.status = TrackingStatus::tracked;
  record_.summary.add(tracked, 0.0);
  EXPECT_EQ(unsupported_poses(record_), "");
}

/// The files that an observer `overlay` leaves, and others, which are none of its pictures.
TEST_F(ResultsTest, TheReportPlaysThePicturesOfTheOverlay) {
  EXPECT_TRUE(overlay_pictures(folder_).empty());
  fs::create_directories(folder_ / "overlay");
  for (const char* name : {"frame_000010.jpg", "frame_000002.jpg", "frame_1000000.jpg", "frame_.jpg", "frame_1x.jpg",
                           "overlay.mp4", "frame_000003.txt", "frame_99999999999999999999.jpg"})
    std::ofstream(folder_ / "overlay" / name);
  EXPECT_THAT(overlay_pictures(folder_), ::testing::ElementsAre("overlay/frame_000002.jpg", "overlay/frame_000010.jpg",
                                                                "overlay/frame_1000000.jpg"));
  write_results(record_, folder_);
  EXPECT_THAT(text("report.html"), AllOf(HasSubstr("<img src=\"overlay/frame_000002.jpg\" alt=\"frame 2\">"),
                                         HasSubstr("data-names=\"frame 2\nframe 10\nframe 1000000\""),
                                         HasSubstr("data-interval=\"0.32")));  // 29 / 30 s by three pictures
  EXPECT_THAT(report_html(record_), ::testing::Not(HasSubstr("overlay/")));
}

TEST_F(ResultsTest, TheReportShowsPositionAndRotationOverTime) {
  const std::string html = report_html(record_);
  for (const std::string name : {"x", "y", "z", "roll", "pitch", "yaw"})
    EXPECT_THAT(html, HasSubstr("<title>" + name + " over time</title>"));
  record_.evaluation.reset();
  EXPECT_THAT(report_html(record_), ::testing::Not(HasSubstr("roll over time")));
}

TEST_F(ResultsTest, TheSummaryNamesThePerturbation) {
  EXPECT_THAT(summary_text(record_), ::testing::Not(HasSubstr("perturbation")));
  record_.configuration.sections["perturbation"] = {{"noise", 20.0}, {"dropped", 0.5}, {"late", 0.0}};
  EXPECT_THAT(summary_text(record_), HasSubstr("\nperturbation         noise 20 grey levels, dropped 0.5\n"));
  EXPECT_THAT(report_html(record_), HasSubstr("noise 20 grey levels, dropped 0.5"));
  EXPECT_EQ(nlohmann::json::parse(run_json(record_)).at("perturbation").dump(), R"({"dropped":0.5,"noise":20.0})");
}

TEST_F(ResultsTest, CountsHaveTheirPlural) {
  record_.map_keyframes = 1;
  record_.trajectory.resize(1);
  EXPECT_THAT(summary_text(record_), AllOf(HasSubstr("(1 pose)"), HasSubstr("1 keyframe, "), HasSubstr("points")));
}

TEST_F(ResultsTest, TheReportShowsWhatTheRunHas) {
  record_.evaluation->absolute_error.rmse = 0.0123;
  EXPECT_THAT(report_html(record_), AllOf(HasSubstr("Holdfast: points"), HasSubstr("12.30 mm"), HasSubstr("<svg"),
                                          HasSubstr("points.yaml, seed 7, sequential")));
  EXPECT_THAT(summary_text(record_), AllOf(HasSubstr("30 of 30"), HasSubstr("0.012300 m (se3, 30 pairs")));
  EXPECT_THAT(report_html(record_), ::testing::Not(HasSubstr("Skipped frames")));
  record_.skipped.push_back({4, 0.5, "blurred.png: is cut short"});
  record_.evaluation.reset();
  record_.no_evaluation = "the source has no truth";
  EXPECT_THAT(report_html(record_), AllOf(HasSubstr("Skipped frames"), HasSubstr("blurred.png: is cut short"),
                                          HasSubstr("unknown, the source has no truth")));
  EXPECT_THAT(summary_text(record_), HasSubstr("\naccuracy             unknown, the source has no truth\n"));
}

/// A camera that stands still, so that no parallax contradicts its depth, which is 1e10 m for ten frames but for a few
/// points: too few for a map, which takes far ones where it has to.
class FarDepthSource final : public FrameSource {
 public:
  explicit FarDepthSource(test::PointWorld& world) : world_(world) {}
  SourceDescription describe() const override { return {}; }
  std::optional<SensorFrame> next() override {
    if (index_ == 20) return std::nullopt;
    SensorFrame frame = world_.frame(index_, static_cast<double>(index_) / 30.0, Eigen::Isometry3d::Identity());
    cv::Mat right = frame.depth.colRange(60, frame.depth.cols);
    if (index_++ < 10) right.setTo(1e10F, right > 0.0F);
    return frame;
  }

 private:
  test::PointWorld& world_;
  std::uint64_t index_ = 0;
};

TEST_F(ResultsTest, AMapAfterDepthBeyondAnySensorIsWrittenAndReadAgain) {
  test::PointRun points;
  points.built->source = std::make_unique<FarDepthSource>(points.world);
  RunRecord record = run(*points.built, points.configuration);
  record.map = points.built->pipeline.take_map();
  EXPECT_TRUE(record.failure.empty()) << record.failure;
  EXPECT_EQ(record.trajectory.size(), 20U);
  write_results(record, folder_);
  const Map map = read_map(folder_ / "map.hfm");
  EXPECT_GT(map.points().size(), 100U);
  map.points().for_each([&](MapPointId, const MapPoint& point) { EXPECT_LT(point.position.norm(), 10.0); });
}

/// Marks the left columns of an image, but for the upper rows, as a person, or has no mask at all.
class ColumnSegmenter final : public Segmenter {
 public:
  ColumnSegmenter(double share, int first_row) : share_(share), first_row_(first_row) {}
  const std::vector<std::string>& classes() const override { return classes_; }
  Segmentation segment(const SensorFrame& frame) override {
    if (share_ < 0.0) return {};
    cv::Mat labels = cv::Mat::zeros(frame.colour.size(), CV_8UC1);
    labels(cv::Range(first_row_, labels.rows), cv::Range(0, static_cast<int>(share_ * labels.cols))).setTo(1);
    return {labels, {}};
  }

 private:
  double share_;
  int first_row_;
  std::vector<std::string> classes_{"background", "person"};
};

class PersonFilter final : public DynamicFilter {
 public:
  Needs needs() const override { return {.segmentation = true}; }
  std::vector<std::string> movable_classes(const std::vector<std::string>&) const override { return {"person"}; }
  void apply(const FilterContext&, StaticEvidence&) override {}
};

RunRecord run_with_masks(double share, int first_row = 0) {
  test::PointRun points;
  auto source = std::make_unique<test::PointSource>(points.world);
  Registry registry;
  holdfast_register_plugin_ceres(registry);
  PipelineBuilder builder(std::move(registry));
  builder.source(source->describe())
      .features(std::make_unique<test::PointExtractor>(points.world, 0.3))
      .optimizer(CeresSettings{})
      .segmenter({std::make_unique<ColumnSegmenter>(share, first_row), "columns"})
      .segmentation({.frames = SegmentedFrames::every_n, .every = 5})
      .filter(std::make_unique<PersonFilter>());
  points.configuration.segmenter.name = "columns";
  points.built = std::make_unique<BuiltPipeline>(BuiltPipeline{std::move(source), builder.build()});
  return run(*points.built, points.configuration);
}

/// The warnings about the segmenter.
std::vector<std::string> mask_warnings(const RunRecord& record) {
  std::vector<std::string> texts;
  for (const Diagnostic& warning : record.warnings)
    if (warning.message.find("the segmenter 'columns'") != std::string::npos) texts.push_back(warning.to_string());
  return texts;
}

TEST(MaskWarnings, MasksThatAreMissingOrCoverMostOfTheImageAreSuspected) {
  const RunRecord usual = run_with_masks(0.4);
  EXPECT_GE(usual.masks.found, 6U);
  EXPECT_EQ(usual.masks.found, usual.masks.segmented);
  EXPECT_TRUE(mask_warnings(usual).empty());

  const RunRecord crowd = run_with_masks(0.95, 60);
  EXPECT_EQ(crowd.masks.mostly_movable, crowd.masks.found);
  EXPECT_TRUE(mask_warnings(crowd).empty()) << "people who fill the view leave some of the upper edge";

  const RunRecord inverted = run_with_masks(0.95);
  ASSERT_EQ(mask_warnings(inverted).size(), 1U);
  EXPECT_THAT(mask_warnings(inverted)[0],
              AllOf(HasSubstr("masks of the segmenter 'columns' cover more than half of the image with classes that "
                              "can move, its upper edge included in "),
                    HasSubstr("are they inverted"), HasSubstr("overlay")));
  EXPECT_THAT(run_json(inverted), HasSubstr("cover more than half"));
  EXPECT_THAT(report_html(inverted), HasSubstr("cover more than half"));

  const RunRecord missing = run_with_masks(-1.0);
  EXPECT_EQ(missing.masks.found, 0U);
  EXPECT_GE(missing.masks.segmented, 6U);
  ASSERT_EQ(mask_warnings(missing).size(), 1U);
  EXPECT_THAT(mask_warnings(missing)[0], HasSubstr("the segmenter 'columns' had no mask for any of the "));
  EXPECT_THAT(summary_text(missing), HasSubstr("masks                0 of "));
}

}  // namespace
}  // namespace holdfast
