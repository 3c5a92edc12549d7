// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/pipeline/pipeline_builder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <limits>
#include <thread>

#include "holdfast/settings/ceres.hpp"
#include "holdfast/surface/surface_field.hpp"
#include "support/brute_force_detector.hpp"
#include "support/point_world.hpp"

extern "C" void holdfast_register_plugin_ceres(holdfast::Registry&);

namespace holdfast {
namespace {

using ::testing::HasSubstr;

Registry registry() {
  Registry registry;
  holdfast_register_plugin_ceres(registry);
  return registry;
}

PipelineBuilder builder_for(test::PointWorld& world) {
  PipelineBuilder builder(registry());
  builder.camera(world.camera())
      .features(std::make_unique<test::PointExtractor>(world, 0.3))
      .optimizer(CeresSettings{});
  return builder;
}

Trajectory run(Pipeline& pipeline, test::PointWorld& world, int frames) {
  for (int i = 0; i < frames; ++i)
    pipeline.feed(world.frame(static_cast<std::uint64_t>(i), i / 30.0, test::path_pose(i / 30.0)));
  pipeline.finish();
  return pipeline.trajectory();
}

std::string complaints(PipelineBuilder& builder) {
  try {
    builder.build();
  } catch (const ConfigurationError& error) {
    return error.what();
  }
  return "";
}

void expect_same(const Trajectory& first, const Trajectory& second) {
  ASSERT_EQ(first.size(), second.size());
  for (std::size_t i = 0; i < first.size(); ++i)
    EXPECT_EQ(first[i].T_world_camera.matrix(), second[i].T_world_camera.matrix()) << i;
}

/// Matches no bits, and says so before the first frame.
class NumberMatcher final : public NearestMatcher {
 public:
  std::string incompatibility(const DescriptorType& type) const override {
    return type.kind == DescriptorKind::binary ? "takes descriptors of numbers" : "";
  }
};

/// Compares whole images, which it describes by a number of values.
class ImageDetector final : public LoopDetector {
 public:
  explicit ImageDetector(std::uint32_t length)
      : type_{DescriptorKind::float32, DescriptorMetric::cosine, length, 1, 1} {}
  std::optional<DescriptorType> image_descriptor() const override { return type_; }
  DescriptorBlock describe(const cv::Mat&, const cv::Mat&) override { return DescriptorBlock(type_, 1); }
  void add(KeyFrameId, const DescriptorView&) override {}
  void remove(KeyFrameId) override {}
  std::vector<PlaceMatch> query(const DescriptorView&, int) const override { return {}; }

 private:
  DescriptorType type_;
};

/// Needs masks; says nothing.
class MaskReader final : public DynamicFilter {
 public:
  Needs needs() const override { return {.segmentation = true}; }
  void apply(const FilterContext&, StaticEvidence&) override {}
};

/// Uses classes of the segmenter, or all that it calls movable.
class ClassReader final : public DynamicFilter {
 public:
  explicit ClassReader(std::vector<std::string> classes) : classes_(std::move(classes)) {}
  Needs needs() const override { return {.segmentation = true}; }
  std::vector<std::string> movable_classes(const std::vector<std::string>& specified) const override {
    return classes_.empty() ? specified : classes_;
  }
  void apply(const FilterContext&, StaticEvidence&) override {}

 private:
  std::vector<std::string> classes_;
};

class TwoClasses final : public Segmenter {
 public:
  const std::vector<std::string>& classes() const override { return classes_; }
  std::vector<std::string> movable() const override { return {"person"}; }
  Segmentation segment(const SensorFrame&) override { return {}; }

 private:
  std::vector<std::string> classes_{"background", "person"};
};

TEST(PipelineBuilder, ClassesOfFiltersAreThoseOfTheSegmenter) {
  test::PointWorld world(Camera{});
  const auto complaints_with = [&](std::vector<std::string> classes) {
    PipelineBuilder builder = builder_for(world);
    builder.segmenter({std::make_unique<TwoClasses>(), "two"})
        .filter({std::make_unique<ClassReader>(std::move(classes)), "reader"});
    return complaints(builder);
  };
  EXPECT_EQ(complaints_with({"person"}), "");
  EXPECT_EQ(complaints_with({"background", "person"}), "");
  EXPECT_EQ(complaints_with({}), "");
  EXPECT_THAT(complaints_with({"person", "cat"}),
              HasSubstr("the filter 'reader' counts the class 'cat' as movable, and the segmenter 'two' has no such "
                        "class; expected one of its classes in `classes` of the filter; known are background, person"));
  EXPECT_THAT(complaints_with({"persn"}), HasSubstr("did you mean 'person'?"));
}

class WeightingDetector final : public LoopDetector {
 public:
  explicit WeightingDetector(std::string name) : name_(std::move(name)) {}
  std::vector<std::pair<std::string, double>> class_weights() const override { return {{name_, 0.1}}; }
  void add(KeyFrameId, const DescriptorView&) override {}
  void remove(KeyFrameId) override {}
  std::vector<PlaceMatch> query(const DescriptorView&, int) const override { return {}; }

 private:
  std::string name_;
};

TEST(PipelineBuilder, ClassesOfLoopDetectorsAreThoseOfTheSegmenter) {
  test::PointWorld world(Camera{});
  const auto complaints_with = [&](const char* name, bool has_segmenter) {
    PipelineBuilder builder = builder_for(world);
    builder.loop_detector({std::make_unique<WeightingDetector>(name), "places"});
    if (has_segmenter) builder.segmenter({std::make_unique<TwoClasses>(), "two"});
    return complaints(builder);
  };
  EXPECT_EQ(complaints_with("person", true), "");
  EXPECT_THAT(complaints_with("chair", true),
              HasSubstr("the loop detector 'places' weights the class 'chair', and the segmenter 'two' has no such "
                        "class; expected its classes in `class_weights`; known are background, person"));
  EXPECT_THAT(complaints_with("person", false), HasSubstr("weights classes, and the segmenter is 'none'"));
}

TEST(PipelineBuilder, TypedSettingsNamesAndObjectsAreOneThing) {
  const auto trajectory = [](ModuleOf<Optimizer> optimizer) {
    test::PointWorld world(find_camera("tum_fr1").value());
    PipelineBuilder builder = builder_for(world);
    Pipeline pipeline = builder.optimizer(std::move(optimizer)).build();
    return run(pipeline, world, 20);
  };
  // The noise of a disparity changes the weights in every adjustment, and so the poses, however a compiler rounds; the
  // other two need not change any: rounds after the outliers have settled are skipped.
  const Trajectory typed =
      trajectory(CeresSettings{.disparity_sigma = 2.0, .pose_rounds = 2, .function_tolerance = 0.0});
  ASSERT_EQ(typed.size(), 20U);
  // An integer is as good as a real.
  expect_same(typed, trajectory({"ceres", {{"disparity_sigma", 2}, {"pose_rounds", 2}, {"function_tolerance", 0}}}));
  expect_same(
      typed,
      trajectory(registry().create<Optimizer>(
          "ceres", {{"disparity_sigma", 2.0}, {"pose_rounds", std::int64_t{2}}, {"function_tolerance", 0.0}}, {})));
  EXPECT_NE(typed.back().T_world_camera.matrix(), trajectory("ceres").back().T_world_camera.matrix());
}

TEST(PipelineBuilder, TellsEverythingThatIsWrongAtOnce) {
  PipelineBuilder builder(registry());
  builder.camera("tum_fr9")
      .optimizer({"cerse"})
      .filter({std::make_unique<MaskReader>(), "mask_reader"})
      .tracking({.minimum_matches = 2});
  const std::string text = complaints(builder);
  EXPECT_THAT(text, HasSubstr("PipelineBuilder: camera 'tum_fr9' is unknown; did you mean 'tum_fr"));
  EXPECT_THAT(text, HasSubstr("PipelineBuilder: features() is missing"));
  EXPECT_THAT(text, HasSubstr("PipelineBuilder: there is no optimizer module 'cerse'; did you mean 'ceres'?"));
  EXPECT_THAT(text, HasSubstr("found 2 for 'minimum_matches' of tracking: 2 is below 4; expected an integer from 4"));
  EXPECT_THAT(text, HasSubstr("the filter 'mask_reader' needs a segmentation, but the segmenter is 'none'"));
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 4) << text;
}

TEST(PipelineBuilder, ParametersAreCheckedByTheirTable) {
  test::PointWorld world(Camera{});
  PipelineBuilder typed = builder_for(world);
  EXPECT_THAT(complaints(typed.optimizer(CeresSettings{.pose_rounds = 40})),
              HasSubstr("found 40 for 'pose_rounds' of optimizer 'ceres': 40 is above 10; expected an integer from 2"));
  PipelineBuilder named = builder_for(world);
  const std::string text = complaints(named.optimizer({"ceres", {{"pose_round", 4}, {"function_tolerance", "small"}}}));
  EXPECT_THAT(text, HasSubstr("optimizer 'ceres' has no parameter 'pose_round'; did you mean 'pose_rounds'?"));
  EXPECT_THAT(text, HasSubstr("found small for 'function_tolerance' of optimizer 'ceres': small is no real"));
}

TEST(PipelineBuilder, CameraAndMapMustFit) {
  test::PointWorld world(find_camera("tum_fr1").value());
  PipelineBuilder none(registry());
  EXPECT_THAT(complaints(none), HasSubstr("the camera is missing; expected 'camera' with a name (bonn, "));

  SourceDescription source;
  source.name = "robot";
  source.camera = find_camera("tum_fr2");
  source.has_depth = false;
  PipelineBuilder two = builder_for(world);
  const std::string text = complaints(two.source(source).sensor(Sensor::rgbd));
  EXPECT_THAT(text, HasSubstr("the source 'robot' brings its own camera, and 'camera' names one with other numbers"));
  EXPECT_THAT(text, HasSubstr("the sensor is 'rgbd', and the source 'robot' has no depth images"));

  Map map;
  {
    PipelineBuilder builder = builder_for(world);
    Pipeline pipeline = builder.build();
    run(pipeline, world, 10);
    map = pipeline.take_map();
  }
  PipelineBuilder blind = builder_for(world);
  EXPECT_THAT(complaints(blind.map(Map())), HasSubstr("but the loop detector is 'none'"));
  PipelineBuilder other = builder_for(world);
  other.camera("tum_fr3").localise_in(std::move(map)).loop_detector(std::make_unique<test::BruteForceDetector>());
  EXPECT_THROW(other.build(), InputError);
}

TEST(PipelineBuilder, JudgesTheCameraOfTheSource) {
  test::PointWorld world(find_camera("tum_fr1").value());
  const auto builder_with = [&](const Camera& camera) {
    SourceDescription source;
    source.name = "robot";
    source.has_depth = true;
    source.camera = camera;
    PipelineBuilder builder(registry());
    builder.source(source).features(std::make_unique<test::PointExtractor>(world)).optimizer("ceres");
    return builder;
  };
  Camera camera = find_camera("tum_fr1").value();
  EXPECT_TRUE(builder_with(camera).build().warnings().empty());
  camera.baseline = 80;
  camera.cx = 958.6;
  const Warnings warnings = builder_with(camera).build().warnings();
  ASSERT_EQ(warnings.size(), 2U);
  EXPECT_THAT(warnings[0].message, testing::AllOf(testing::StartsWith("of the camera that the source 'robot' gives, "),
                                                  HasSubstr("optical axis")));
  EXPECT_THAT(warnings[1].message, HasSubstr("the baseline is 80 m"));
  camera = find_camera("tum_fr1").value();
  camera.distortion = {.k1 = -0.9};
  PipelineBuilder folded = builder_with(camera);
  EXPECT_THAT(complaints(folded), HasSubstr("has no inverse in the image"));
}

TEST(PipelineBuilder, ADenseMapWhileLocalisingIsNamed) {
  test::PointWorld world(find_camera("tum_fr1").value());
  const auto warnings_of = [&](bool localise) {
    PipelineBuilder first = builder_for(world);
    Pipeline pipeline = first.build();
    run(pipeline, world, 10);
    PipelineBuilder second = builder_for(world);
    second.dense_map({.enabled = true}).loop_detector(std::make_unique<test::BruteForceDetector>());
    localise ? second.localise_in(pipeline.take_map()) : second.map(pipeline.take_map());
    return second.build().warnings();
  };
  ASSERT_EQ(warnings_of(true).size(), 1U);
  EXPECT_THAT(warnings_of(true)[0].message, HasSubstr("'dense_map' has no effect where the camera is only localised"));
  EXPECT_TRUE(warnings_of(false).empty());
}

TEST(PipelineBuilder, ASurfaceIsCheckedBeforeTheRun) {
  test::PointWorld world(find_camera("tum_fr1").value());
  PipelineBuilder unknown = builder_for(world);
  unknown.surface({.enabled = true, .formats = {"stl"}});
  EXPECT_THAT(complaints(unknown),
              HasSubstr("surface.formats: 'stl' is no format of meshes; expected ply, obj or glb"));
  PipelineBuilder range = builder_for(world);
  range.surface({.enabled = true, .voxel = 5.0});
  EXPECT_THAT(complaints(range), HasSubstr("voxel"));
  PipelineBuilder mono = builder_for(world);
  mono.surface({.enabled = true}).sensor(Sensor::mono);
  EXPECT_THAT(complaints(mono), HasSubstr("surface needs depth images, and the sensor is 'mono'"));
  PipelineBuilder pair = builder_for(world);
  StereoSettings without;
  without.dense = DenseStereoMethod::off;
  pair.surface({.enabled = true}).sensor(Sensor::stereo).stereo(without);
  EXPECT_THAT(complaints(pair), HasSubstr("surface needs depth images, and stereo.dense is 'off'"));
  pair.stereo({});
  EXPECT_THAT(complaints(pair), ::testing::Not(HasSubstr("needs depth images")));
  if (SurfaceField::is_available()) return;
  PipelineBuilder builder = builder_for(world);
  builder.surface({.enabled = true});
  EXPECT_THAT(complaints(builder), HasSubstr("this build has no OpenVDB"));
}

TEST(PipelineBuilder, ClassesOfASurfaceWithoutASegmenterAreNamed) {
  if (!SurfaceField::is_available()) GTEST_SKIP() << "built without OpenVDB";
  test::PointWorld world(find_camera("tum_fr1").value());
  const auto warnings_of = [&](bool classes) {
    return builder_for(world).surface({.enabled = true, .classes = classes}).build().warnings();
  };
  ASSERT_EQ(warnings_of(true).size(), 1U);
  EXPECT_THAT(warnings_of(true)[0].message, HasSubstr("'surface.classes' has no effect without a segmenter"));
  EXPECT_TRUE(warnings_of(false).empty());
}

TEST(PipelineBuilder, AnImuWithoutMeasurementsIsNamed) {
  test::PointWorld world(find_camera("tum_fr1").value());
  const auto warnings_of = [&](bool has_imu) {
    PipelineBuilder builder = builder_for(world);
    builder.source({.name = "a recording", .has_depth = true, .has_imu = has_imu}).imu(*find_imu("bmi160"));
    return builder.build().warnings();
  };
  EXPECT_TRUE(warnings_of(true).empty());
  ASSERT_EQ(warnings_of(false).size(), 1U);
  EXPECT_THAT(warnings_of(false)[0].message, HasSubstr("'imu' has no effect, because the source 'a recording'"));
  PipelineBuilder wrong = builder_for(world);
  ImuCalibration calibration;
  calibration.time_offset = 12.0;
  wrong.imu(calibration);
  EXPECT_THAT(complaints(wrong), HasSubstr("time offset"));
}

TEST(PipelineBuilder, InertialMeasurementsOfACallerAreChecked) {
  test::PointWorld world(find_camera("tum_fr1").value());
  PipelineBuilder builder = builder_for(world);
  Pipeline pipeline = builder.imu(*find_imu("bmi160")).build();
  const auto frame = [&](std::uint64_t i) {
    const double stamp = static_cast<double>(i) / 30.0;
    SensorFrame frame = world.frame(i, stamp, test::path_pose(stamp));
    for (int k = 0; k < 7; ++k) {
      const double time = stamp - 1.0 / 30.0 + k / 180.0;
      frame.imu.push_back({time, Eigen::Vector3d::Zero(), Eigen::Vector3d::UnitZ()});
    }
    return frame;
  };
  for (std::uint64_t i = 0; i < 20; ++i) pipeline.feed(frame(i));
  SensorFrame swapped = frame(20);
  std::swap(swapped.imu[2], swapped.imu[3]);
  EXPECT_THROW(pipeline.feed(swapped), InputError);
  SensorFrame infinite = frame(20);
  infinite.imu[2].acceleration.x() = std::numeric_limits<double>::infinity();
  EXPECT_THROW(pipeline.feed(infinite), InputError);
  pipeline.feed(frame(20));
  pipeline.finish();
  ASSERT_EQ(pipeline.warnings().size(), 1U);
  EXPECT_THAT(pipeline.warnings()[0].message, HasSubstr("multiples of g"));
}

TEST(PipelineBuilder, AMapIsContinuedByItsOwnExtractorOnly) {
  test::PointWorld world(find_camera("tum_fr1").value());
  const auto new_map = [&] {
    PipelineBuilder builder = builder_for(world);
    Pipeline pipeline = builder.build();
    run(pipeline, world, 10);
    return pipeline.take_map();
  };
  const MapFeatures own = new_map().features();
  const auto refusal = [&](const MapFeatures& features) -> std::string {
    Map other = new_map();
    other.set_features(features);
    PipelineBuilder continued = builder_for(world);
    continued.map(std::move(other)).loop_detector(std::make_unique<test::BruteForceDetector>());
    try {
      continued.build();
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(refusal(own), "");
  EXPECT_THAT(refusal({"orb", {}}), testing::AllOf(HasSubstr("'orb' with descriptors of 256 bits (hamming)"),
                                                   HasSubstr("'" + own.extractor + "'")));
  DescriptorType numbers{DescriptorKind::float32, DescriptorMetric::cosine, 64, 0.1F, 0.2F};
  EXPECT_THAT(refusal({own.extractor, numbers}), HasSubstr("64 float32 (cosine)"));
  numbers = DescriptorType();
  numbers.loose_distance = 120.0F;
  EXPECT_EQ(refusal({own.extractor, numbers}), "") << "recommended distances may differ";
}

TEST(PipelineBuilder, AMapKeepsWhatTheDetectorSaysOfImages) {
  test::PointWorld world(find_camera("tum_fr1").value());
  const auto new_map = [&](std::unique_ptr<LoopDetector> detector) {
    PipelineBuilder builder = builder_for(world);
    Pipeline pipeline = builder.loop_detector(std::move(detector)).build();
    run(pipeline, world, 60);
    return pipeline.take_map();
  };
  const auto refusal = [&](Map map, std::unique_ptr<LoopDetector> detector) -> std::string {
    PipelineBuilder continued = builder_for(world);
    continued.map(std::move(map)).loop_detector(std::move(detector));
    try {
      continued.build();
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  const Map described = new_map(std::make_unique<ImageDetector>(7));
  ASSERT_FALSE(described.keyframes().empty());
  described.keyframes().for_each(
      [](KeyFrameId, const KeyFrame& keyframe) { EXPECT_EQ(keyframe.frame.image_descriptor.size(), 1U); });
  const auto again = [&] { return new_map(std::make_unique<ImageDetector>(7)); };
  EXPECT_EQ(refusal(again(), std::make_unique<ImageDetector>(7)), "");
  EXPECT_EQ(refusal(again(), std::make_unique<test::BruteForceDetector>()), "");
  EXPECT_THAT(refusal(again(), std::make_unique<ImageDetector>(8)),
              testing::AllOf(HasSubstr("by 7 float32 (cosine)"), HasSubstr("'own' makes 8 float32 (cosine)")));
  EXPECT_THAT(refusal(new_map(std::make_unique<test::BruteForceDetector>()), std::make_unique<ImageDetector>(7)),
              HasSubstr("holds no descriptions of its keyframes' images"));
}

TEST(PipelineBuilder, AMatcherRefusesFeaturesThatItCannotMatch) {
  test::PointWorld world(find_camera("tum_fr1").value());
  PipelineBuilder builder = builder_for(world);
  EXPECT_THAT(complaints(builder.matcher(std::make_unique<NumberMatcher>())),
              HasSubstr("the matcher 'own' takes descriptors of numbers, and the extractor 'own' has "
                        "256 bits (hamming); choose other features, or another matcher"));
}

TEST(PipelineBuilder, TwoPipelinesInOneProcessShareNothing) {
  const auto alone = [](int frames) {
    test::PointWorld world(find_camera("tum_fr1").value());
    PipelineBuilder builder = builder_for(world);
    Pipeline pipeline = builder.build();
    return run(pipeline, world, frames);
  };
  const Trajectory first = alone(40), second = alone(60);
  Trajectory first_beside, second_beside;
  std::thread other([&] { second_beside = alone(60); });
  first_beside = alone(40);
  other.join();
  expect_same(first, first_beside);
  expect_same(second, second_beside);
}

TEST(PipelineBuilder, SnapshotsOfTheMapWhileItGrows) {
  for (const bool threaded : {true, false}) {
    test::PointWorld world(find_camera("tum_fr1").value());
    PipelineBuilder builder = builder_for(world);
    Pipeline pipeline = builder.loop_detector(std::make_unique<test::BruteForceDetector>())
                            .run({.mode = threaded ? RunMode::threaded : RunMode::sequential})
                            .build();
    std::atomic<bool> ended = false;
    std::size_t most_keyframes = 0;
    std::thread watcher([&] {
      while (!ended) {
        const MapSnapshot snapshot = pipeline.map_snapshot();
        for (std::size_t i = 1; i < snapshot.keyframes.size(); ++i)
          EXPECT_LT(snapshot.keyframes[i - 1].sequence, snapshot.keyframes[i].sequence);
        for (const MapSnapshot::Point& point : snapshot.points) {
          EXPECT_TRUE(point.position.allFinite());
          EXPECT_GT(point.observations, 0U);
        }
        most_keyframes = std::max(most_keyframes, snapshot.keyframes.size());
      }
    });
    run(pipeline, world, 60);
    ended = true;
    watcher.join();

    const MapSnapshot last = pipeline.map_snapshot();
    ASSERT_EQ(last.keyframes.size(), pipeline.map().keyframes().size());
    EXPECT_GE(last.keyframes.size(), 2U);
    EXPECT_EQ(last.points.size(), pipeline.map().points().size());
    const KeyFrame& keyframe = pipeline.map().keyframe(last.keyframes.back().id);
    EXPECT_EQ(last.keyframes.back().timestamp, keyframe.frame.timestamp);
    EXPECT_EQ(last.keyframes.back().T_world_camera.matrix(), keyframe.frame.T_world_camera().matrix());
    const MapPoint& point = pipeline.map().point(last.points.front().id);
    EXPECT_EQ(last.points.front().position, point.position);
    EXPECT_EQ(last.points.front().observations, point.observations.size());
  }
}

}  // namespace
}  // namespace holdfast
