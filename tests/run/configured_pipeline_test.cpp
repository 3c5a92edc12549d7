// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/run/configured_pipeline.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "holdfast/core/error.hpp"

namespace holdfast {
namespace {

using ::testing::HasSubstr;

/// What the fake modules say of themselves, and what they were told.
struct World {
  SourceDescription source;
  Needs needs;
  std::vector<CreationContext> told;
};

class FakeSource final : public FrameSource {
 public:
  explicit FakeSource(SourceDescription description) : description_(std::move(description)) {}
  SourceDescription describe() const override { return description_; }
  std::optional<SensorFrame> next() override { return std::nullopt; }

 private:
  SourceDescription description_;
};

class FakeFeatures final : public FeatureExtractor {
 public:
  void extract(const cv::Mat&, const cv::Mat&, Features&) override {}
  const ScalePyramid& pyramid() const override { return pyramid_; }

 private:
  ScalePyramid pyramid_;
};

class FakeFilter final : public DynamicFilter {
 public:
  explicit FakeFilter(Needs needs) : needs_(needs) {}
  Needs needs() const override { return needs_; }
  void apply(const FilterContext&, StaticEvidence&) override {}

 private:
  Needs needs_;
};

class FakeSegmenter final : public Segmenter {
 public:
  const std::vector<std::string>& classes() const override { return classes_; }
  Segmentation segment(const SensorFrame&) override { return {}; }

 private:
  std::vector<std::string> classes_;
};

class FakeOptimizer final : public Optimizer {
 public:
  PoseSummary optimize_pose(PoseProblem&) override { return {}; }
  BundleSummary optimize_bundle(BundleProblem&, const std::atomic<bool>&) override { return {}; }
  GraphSummary optimize_pose_graph(PoseGraphProblem&) override { return {}; }
};

struct RecordingSettings {
  std::filesystem::path path;
  static void describe(ParameterTable<RecordingSettings>& table) {
    table.add("path", &RecordingSettings::path, "folder").required();
  }
};

template <class Interface, class Make>
void add(Registry& registry, const char* name, Make make) {
  registry.add<Interface, NoSettings>({.name = name}, [make](const NoSettings&, const CreationContext& context) {
    return std::unique_ptr<Interface>(make(context));
  });
}

class ConfiguredPipeline : public ::testing::Test {
 protected:
  ConfiguredPipeline() {
    world_.source.name = "fake";
    world_.source.has_depth = true;
    World& world = world_;
    add<FrameSource>(registry_, "fake", [&world](const CreationContext& context) {
      world.told.push_back(context);
      return std::make_unique<FakeSource>(world.source);
    });
    registry_.add<FrameSource, RecordingSettings>(
        {.name = "recorded"}, [&world](const RecordingSettings&, const CreationContext&) {
          return std::unique_ptr<FrameSource>(std::make_unique<FakeSource>(world.source));
        });
    add<FeatureExtractor>(registry_, "fake", [&world](const CreationContext& context) {
      world.told.push_back(context);
      return std::make_unique<FakeFeatures>();
    });
    add<DynamicFilter>(registry_, "filter",
                       [&world](const CreationContext&) { return std::make_unique<FakeFilter>(world.needs); });
    add<Segmenter>(registry_, "none", [](const CreationContext&) { return std::make_unique<NullSegmenter>(); });
    add<Segmenter>(registry_, "fake", [](const CreationContext&) { return std::make_unique<FakeSegmenter>(); });
    add<LoopDetector>(registry_, "none", [](const CreationContext&) { return std::make_unique<NullLoopDetector>(); });
    add<Optimizer>(registry_, "fake", [](const CreationContext&) { return std::make_unique<FakeOptimizer>(); });
  }

  BuiltPipeline build(const std::string& more) {
    const std::string text = "source: fake\nfeatures: fake\noptimizer: fake\n" + more;
    const ConfigurationNode root = parse_yaml(text, "c.yaml", "/");
    PipelineOptions options;
    options.output_directory = "/out";
    return build_pipeline(resolve_configuration(root, "c.yaml", registry_, pipeline_sections()), registry_, options);
  }
  std::string warnings(const std::string& more) {
    std::string text;
    for (const Diagnostic& warning : build(more).pipeline.warnings()) text += warning.to_string() + "\n";
    return text;
  }
  std::string complaints(const std::string& more) {
    try {
      build(more);
    } catch (const ConfigurationError& error) {
      return error.what();
    }
    return "";
  }

  World world_;
  Registry registry_;
};

TEST_F(ConfiguredPipeline, TellsTheModulesAboutTheRun) {
  const BuiltPipeline built = build("camera: tum_fr2\nrun: { seed: 77 }\n");
  ASSERT_EQ(world_.told.size(), 2U);
  for (const CreationContext& context : world_.told) {
    EXPECT_EQ(context.camera, find_camera("tum_fr2"));
    EXPECT_EQ(context.seed, 77U);
    EXPECT_TRUE(context.sequential);
    EXPECT_EQ(context.output_directory, "/out");
  }
  EXPECT_EQ(built.pipeline.camera(), find_camera("tum_fr2"));
  EXPECT_EQ(built.source->describe().name, "fake");
}

TEST_F(ConfiguredPipeline, TheCameraComesFromOneOfBoth) {
  EXPECT_THAT(complaints(""), HasSubstr("c.yaml: the camera is missing, and the source 'fake' does not know its own; "
                                        "expected 'camera' with a name (bonn, "));
  world_.source.camera = find_camera("tum_fr3");
  EXPECT_EQ(build("").pipeline.camera(), find_camera("tum_fr3"));
  EXPECT_EQ(world_.told.back().camera, find_camera("tum_fr3"));  // the features are made for it
  EXPECT_THAT(complaints("camera: tum_fr1\n"),
              HasSubstr("the source 'fake' brings its own camera, and 'camera' names one with other numbers"));
}

TEST_F(ConfiguredPipeline, CameraAutoIsTheSourcesOwn) {
  EXPECT_THAT(complaints("camera: auto\n"),
              HasSubstr("c.yaml:4:9: found 'auto' for 'camera', but the source 'fake' does not know its own"));
  world_.source.camera = find_camera("tum_fr3");
  EXPECT_EQ(build("camera: auto\n").pipeline.camera(), find_camera("tum_fr3"));
  EXPECT_EQ(world_.told.back().camera, find_camera("tum_fr3"));
}

TEST_F(ConfiguredPipeline, TheSourcesOwnCameraPrecedesThatOfTheFoldersName) {
  const auto camera_of = [&] {
    const std::string text =
        "source: { recorded: { path: rgbd_bonn_crowd } }\nfeatures: fake\noptimizer: fake\n"
        "camera: auto\n";
    const ConfigurationNode root = parse_yaml(text, "c.yaml", "/");
    const Configuration configuration = resolve_configuration(root, "c.yaml", registry_, pipeline_sections());
    return build_pipeline(configuration, registry_, {}).pipeline.camera();
  };
  EXPECT_EQ(camera_of(), find_camera("bonn"));
  world_.source.camera = find_camera("tum_fr3");
  EXPECT_EQ(camera_of(), find_camera("tum_fr3"));
}

TEST_F(ConfiguredPipeline, ASourceAloneNeedsItsCameraToo) {
  const auto build_alone = [&] {
    const ConfigurationNode root =
        parse_yaml("source: fake\nfeatures: fake\noptimizer: fake\ncamera: auto\n", "c.yaml", "/");
    build_source(resolve_configuration(root, "c.yaml", registry_, pipeline_sections()), registry_);
  };
  EXPECT_THROW(build_alone(), ConfigurationError);
  world_.source.camera = find_camera("tum_fr3");
  EXPECT_NO_THROW(build_alone());
}

TEST_F(ConfiguredPipeline, BothMaySayTheSameCamera) {
  world_.source.camera = find_camera("tum_fr3");
  EXPECT_EQ(complaints("camera: tum_fr3\n"), "");
  // By numbers alone: the name does not matter.
  CameraSettings settings = camera_settings(*world_.source.camera);
  settings.name.clear();
  const ParameterValues values = ParameterTable<CameraSettings>().values(settings);
  std::string numbers = "camera:\n";
  for (const auto& [name, value] : values) numbers += "  " + name + ": " + to_string(value) + "\n";
  EXPECT_EQ(complaints(numbers), "");
  world_.source.camera->fx += 1e-6;
  EXPECT_NE(complaints(numbers), "");
}

TEST_F(ConfiguredPipeline, FiltersGetWhatTheyNeed) {
  const std::string filter = "camera: tum_fr1\nfilters: [ filter ]\n";
  EXPECT_EQ(complaints(filter), "");
  world_.needs.segmentation = true;
  EXPECT_THAT(complaints(filter),
              HasSubstr("c.yaml:5:12: the filter 'filter' needs a segmentation, but the segmenter is 'none'"));
  EXPECT_EQ(complaints(filter + "segmenter: fake\n"), "");
}

class WeightingDetector final : public LoopDetector {
 public:
  std::vector<std::pair<std::string, double>> class_weights() const override { return {{"chair", 0.1}}; }
  void add(KeyFrameId, const DescriptorView&) override {}
  void remove(KeyFrameId) override {}
  std::vector<PlaceMatch> query(const DescriptorView&, int) const override { return {}; }
};

TEST_F(ConfiguredPipeline, ClassesThatTheSegmenterDoesNotHaveAreNamedWithTheirPlace) {
  add<LoopDetector>(registry_, "places", [](const CreationContext&) { return std::make_unique<WeightingDetector>(); });
  EXPECT_THAT(
      complaints("camera: tum_fr1\nsegmenter: fake\nloop_detector: places\n"),
      HasSubstr("c.yaml:6:16: the loop detector 'places' weights the class 'chair', and the segmenter 'fake' has "
                "no such class"));
}

TEST_F(ConfiguredPipeline, FiltersThatMissEvidenceAndMasksThatMissAFilterAreNamed) {
  const std::string camera = "camera: tum_fr1\n";
  EXPECT_THAT(warnings(camera + "segmenter: fake\nfilters: [ filter ]\n"),
              HasSubstr("c.yaml:5:12: no filter needs the masks of the segmenter 'fake'"));
  world_.needs = {.segmentation = true};
  EXPECT_EQ(warnings(camera + "segmenter: fake\nfilters: [ filter ]\n"), "");
  world_.needs = {.matches = true, .evidence = true};
  EXPECT_THAT(warnings(camera + "filters: [ filter ]\n"),
              HasSubstr("c.yaml:5:12: the filter 'filter' starts from the evidence of filters that run before it"));
  const std::string two = warnings(camera + "filters: [ filter, filter ]\n");
  EXPECT_EQ(std::count(two.begin(), two.end(), '\n'), 1) << "the second one follows the first\n" << two;
  // A filter of an earlier stage runs before it, wherever it is in the list.
  add<DynamicFilter>(registry_, "early", [](const CreationContext&) { return std::make_unique<FakeFilter>(Needs{}); });
  EXPECT_EQ(warnings(camera + "filters: [ filter, early ]\n"), "");
}

TEST_F(ConfiguredPipeline, TheSensorNeedsItsImages) {
  const std::string camera = "camera: tum_fr1\n";
  world_.source.has_depth = false;
  EXPECT_EQ(complaints(camera), "");  // one camera
  EXPECT_EQ(complaints(camera + "sensor: auto\n"), "");
  EXPECT_THAT(complaints(camera + "sensor: rgbd\n"),
              HasSubstr("c.yaml:1:9: the sensor is 'rgbd', and the source 'fake' has no depth images"));
  EXPECT_THAT(complaints(camera + "sensor: stereo\n"), HasSubstr("the source 'fake' has no right images"));
  EXPECT_THAT(complaints(camera + "sensor: rgb\n"),
              HasSubstr("c.yaml:5:9: found 'rgb' for 'sensor'; did you mean 'rgbd'?"));
  world_.needs.depth = true;
  EXPECT_THAT(complaints(camera + "filters: [ filter ]\n"),
              HasSubstr("c.yaml:5:12: the filter 'filter' needs depth, and the sensor is 'mono'"));
}

TEST_F(ConfiguredPipeline, TellsAllMisfitsAtOnce) {
  world_.source.has_depth = false;
  world_.needs = {.depth = true, .segmentation = true};
  try {
    build("filters: [ filter, filter ]\n");
    FAIL();
  } catch (const ConfigurationError& error) {
    EXPECT_EQ(error.diagnostics().size(), 5U) << error.what();  // no camera, two for each filter
  }
}

TEST_F(ConfiguredPipeline, DescribesItsSections) {
  std::vector<std::string> names;
  for (const SectionDescription& section : pipeline_sections()) {
    names.push_back(section.name);
    EXPECT_FALSE(section.help.empty());
    for (const Parameter& parameter : section.parameters) {
      EXPECT_FALSE(parameter.help.empty()) << parameter.name;
      EXPECT_FALSE(parameter.reject(parameter.default_value).has_value()) << parameter.name;
    }
  }
  EXPECT_THAT(names, ::testing::ElementsAre("tracking", "stereo", "segmentation", "evidence", "mapping", "loop_closing",
                                            "dense_map", "surface", "perturbation"));
}

}  // namespace
}  // namespace holdfast
