// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/config/configuration.hpp"

#include <gmock/gmock.h>

#include <fstream>

#include "fixture.hpp"

namespace holdfast {
namespace {

using test::resolve;

TEST(Configuration, IsCompleteWithDefaults) {
  const Configuration c = resolve(test::good);
  EXPECT_EQ(c.features.name, "orb");
  EXPECT_EQ(c.features.values.at("count"), ParameterValue(std::int64_t{500}));
  EXPECT_EQ(c.features.values.at("scale"), ParameterValue(1.2));
  EXPECT_EQ(c.segmenter.name, "none");
  EXPECT_EQ(c.loop_detector.name, "none");
  EXPECT_TRUE(c.filters.empty());
  EXPECT_EQ(c.camera->name, "tum_fr1");
  EXPECT_EQ(c.run.seed, 1U);
  EXPECT_EQ(c.sections.at("tracking").at("window"), ParameterValue(15.0));
  EXPECT_EQ(c.features.location.to_string(), "c.yaml:3:13");
}

TEST(Configuration, ARealMayBeWrittenAsAnInteger) {
  EXPECT_EQ(resolve(test::good + "tracking: { window: 20 }\n").sections.at("tracking").at("window"),
            ParameterValue(20.0));
}

TEST(Configuration, CameraAutoFollowsTheNameOfTheFolder) {
  const auto camera = [](const std::string& folder) {
    return resolve(test::good, {"camera=auto", "source.tum.path=" + folder}).camera->name;
  };
  EXPECT_EQ(camera("/data/rgbd_dataset_freiburg1_xyz"), "tum_fr1");
  EXPECT_EQ(camera("/data/rgbd_dataset_freiburg2_desk/"), "tum_fr2");
  EXPECT_EQ(camera("/data/rgbd_dataset_freiburg3_walking_xyz"), "tum_fr3");
  EXPECT_EQ(camera("/data/rgbd_bonn_crowd"), "bonn");
  EXPECT_EQ(camera("/data/tum_fr1_xyz"), "tum_fr1");
  EXPECT_EQ(resolve(test::good, {"camera=auto", "source.tum.path=/rgbd_bonn_crowd"}).camera, find_camera("bonn"));
}

TEST(Configuration, CameraAutoLeavesAFolderThatNamesNoneToTheSource) {
  const std::string silent = "source: { tum: { path: kitchen } }\ncamera: auto\nfeatures: orb\noptimizer: ceres\n";
  const Configuration c = resolve(silent);
  EXPECT_FALSE(c.camera.has_value());
  ASSERT_TRUE(c.unknown_camera.has_value());
  EXPECT_THAT(c.unknown_camera->to_string(),
              testing::AllOf(testing::StartsWith("c.yaml:2:9: found 'auto' for 'camera', but the source 'tum'"),
                             testing::HasSubstr("the folder 'kitchen' says none"),
                             testing::HasSubstr("expected a name or numbers")));
  EXPECT_FALSE(resolve(test::good).unknown_camera.has_value());
}

TEST(Configuration, WarnsOfAFolderNamedAfterAnotherCamera) {
  const Configuration other = resolve(test::good, {"source.tum.path=/data/rgbd_dataset_freiburg3_sitting_xyz"});
  ASSERT_EQ(other.warnings.size(), 1U);
  EXPECT_THAT(other.warnings[0].to_string(),
              testing::AllOf(testing::StartsWith("c.yaml:2:9: found the camera 'tum_fr1'"),
                             testing::HasSubstr("expected 'tum_fr3'")));
  EXPECT_EQ(other.camera->name, "tum_fr1");  // as it is written all the same
  for (const char* folder : {"/data/rgbd_dataset_freiburg1_xyz", "/data/kitchen", "/data/rgbd_dataset_freiburg3"})
    EXPECT_TRUE(resolve(test::good, {std::string("source.tum.path=") + folder}).warnings.empty()) << folder;
  // Numbers of one's own are meant.
  const std::string numbers = "camera={width: 640, height: 480, fx: 530, fy: 530, cx: 320, cy: 240}";
  EXPECT_TRUE(resolve(test::good, {numbers, "source.tum.path=/data/rgbd_bonn_crowd"}).warnings.empty());
}

TEST(Configuration, WarnsOfRunSettingsWithoutEffect) {
  const auto warnings = [](const std::string& run) {
    std::string text;
    for (const Diagnostic& each : resolve(std::string(test::good) + "run: { " + run + " }\n").warnings)
      text += each.to_string() + "\n";
    return text;
  };
  using testing::AllOf, testing::HasSubstr;
  EXPECT_THAT(warnings("late_frames: drop"),
              AllOf(HasSubstr("c.yaml:"), HasSubstr("'late_frames' of section 'run' has no "
                                                    "effect as 'drop'")));
  EXPECT_THAT(warnings("mode: threaded, late_frames: drop"), HasSubstr("'late_frames' of section 'run' has no effect"));
  EXPECT_THAT(warnings("frame_queue: 8, keyframe_queue: 2"),
              AllOf(HasSubstr("'frame_queue' of section 'run' has no effect in sequential mode"),
                    HasSubstr("'keyframe_queue' of section 'run' has no effect in sequential mode")));
  EXPECT_THAT(warnings("mode: threaded, prefetch: 5"),
              HasSubstr("'prefetch' of section 'run' has no effect in threaded"));
  EXPECT_EQ(warnings("mode: threaded, pace: timestamps, late_frames: drop, frame_queue: 8"), "");
  EXPECT_EQ(warnings("prefetch: 5"), "");
  // As a resolved configuration has them.
  EXPECT_EQ(warnings("late_frames: queue, frame_queue: 4, keyframe_queue: 4, prefetch: 2"), "");
}

TEST(Configuration, WarnsOfASegmenterWithoutAFilter) {
  const auto warnings = [](const std::string& more) {
    Registry registry = test::test_registry();
    test::add<Segmenter, NoSettings>(registry, "network");
    const ConfigurationNode root = parse_yaml(std::string(test::good) + more, "c.yaml", "/data");
    return resolve_configuration(root, "c.yaml", registry, test::test_sections()).warnings;
  };
  ASSERT_EQ(warnings("segmenter: network\n").size(), 1U);
  EXPECT_THAT(warnings("segmenter: network\n")[0].to_string(),
              testing::StartsWith("c.yaml:5:12: no filter uses the masks of the segmenter 'network'"));
  EXPECT_TRUE(warnings("segmenter: network\nfilters: [semantic_mask]\n").empty());
  EXPECT_TRUE(warnings("segmenter: none\n").empty());
}

TEST(Configuration, PathsStartFromTheFileThatSaysThem) {
  EXPECT_EQ(resolve(test::good).source.values.at("path"), ParameterValue(std::string("/data/fr1")));
  EXPECT_EQ(resolve(test::good, {"source.tum.path=../fr2"}).source.values.at("path"),
            ParameterValue((std::filesystem::current_path() / "../fr2").lexically_normal().string()));
  EXPECT_EQ(resolve(test::good, {"source.tum.path=/abs"}).source.values.at("path"),
            ParameterValue(std::string("/abs")));
}

TEST(Configuration, CameraByNumbers) {
  const Configuration c = resolve(
      "source: { tum: { path: x } }\nfeatures: orb\noptimizer: ceres\n"
      "camera: { width: 320, height: 240, fx: 260, fy: 261, cx: 160, cy: 120, k1: -0.1, p2: 0.01, baseline: 0.1 }\n");
  EXPECT_EQ(c.camera->width, 320);
  EXPECT_EQ(c.camera->fy, 261);
  EXPECT_EQ(c.camera->distortion, (Distortion{.k1 = -0.1, .p2 = 0.01}));
  EXPECT_EQ(c.camera->baseline, 0.1);
  EXPECT_EQ(c.camera->frame_rate, 30);
}

/// The examples of the lens itself are in camera_test.
TEST(Configuration, ALensWithoutInverseIsAnErrorAtTheCamera) {
  const auto text = [](const std::string& camera) {
    return "source: { tum: { path: x } }\nfeatures: orb\noptimizer: ceres\ncamera: " + camera + "\n";
  };
  for (const char* camera : {"{ width: 640, height: 480, fx: 400, fy: 400, cx: 318.6, cy: 255.3, k1: -0.4 }",
                             "{ name: tum_fr1, k3: 0.002628, p2: 1.163314 }",
                             "{ name: tum_fr3, fx: 200, fy: 200, k1: -0.4, lens: fisheye }"})
    try {
      resolve(text(camera));
      ADD_FAILURE() << camera;
    } catch (const ConfigurationError& error) {
      EXPECT_THAT(error.what(), testing::AllOf(testing::StartsWith("c.yaml:4:"), testing::HasSubstr("no inverse"),
                                               testing::HasSubstr("px from the principal point")));
    }
}

TEST(Configuration, SuspiciousNumbersOfACameraAreWarnings) {
  const auto warnings = [](const std::string& camera) {
    std::string all;
    for (const Diagnostic& warning : resolve(test::good, {"camera={name: tum_fr1, " + camera + "}"}).warnings)
      all += warning.to_string() + "\n";
    return all;
  };
  EXPECT_EQ(warnings("fx: 520"), "");
  EXPECT_THAT(warnings("cx: 958.6"), testing::HasSubstr("optical axis"));
  EXPECT_THAT(warnings("baseline: 80"), testing::HasSubstr("millimetres"));
  EXPECT_THAT(warnings("cx: 958.6"), testing::StartsWith("--set"));
}

TEST(Configuration, LensesOfCameras) {
  const std::string numbers = "width: 320, height: 240, fx: 260, fy: 261, cx: 160, cy: 120, ";
  const auto camera_of = [&](const std::string& lens) {
    return resolve("source: { tum: { path: x } }\nfeatures: orb\noptimizer: ceres\ncamera: { " + numbers + lens +
                   " }\n")
        .camera->distortion;
  };
  EXPECT_TRUE(camera_of("k1: 0.5, k4: 0.4, k5: 0.1, k6: 0.2").is_rational());
  const Distortion fisheye = camera_of("lens: fisheye, k1: -0.1, k4: 0.01");
  EXPECT_EQ(fisheye.lens, Lens::fisheye);
  EXPECT_EQ(fisheye.coefficients(), (std::vector<double>{-0.1, 0.0, 0.0, 0.01}));
  const auto error = [&](const std::string& lens) {
    try {
      camera_of(lens);
    } catch (const ConfigurationError& problem) {
      return std::string(problem.what());
    }
    return std::string();
  };
  EXPECT_THAT(error("lens: fisheye, p1: 0.1"), ::testing::HasSubstr("k1, k2, k3 and k4 alone"));
  EXPECT_THAT(error("lens: fishey"), ::testing::HasSubstr("expected one of radial_tangential, fisheye"));
}

TEST(Configuration, WrittenAndReadAgainIsTheSame) {
  const Configuration first = resolve(test::good + R"(run: { seed: 7 }
filters:
  - semantic_mask: { classes: [ "true", "a b" ], weights: [ 0.1, 1 ], names: { "1": "it's \"x\"" }, shares: { a b: 0.25, c: 1 } }
  - semantic_mask
)");
  const std::string yaml = to_yaml(first);
  Registry registry = test::test_registry();
  const Configuration second =
      resolve_configuration(parse_yaml(yaml, "out.yaml", "/elsewhere"), "out.yaml", registry, test::test_sections());
  EXPECT_EQ(to_yaml(second), yaml);
  Configuration secret = first;
  secret.observers = {
      {.kind = "observers", .name = "foxglove", .values = {{"token", std::string("hidden")}}, .location = {}}};
  EXPECT_EQ(to_yaml(secret).find("hidden"), std::string::npos);
  EXPECT_EQ(second.source.values, first.source.values);
  EXPECT_EQ(second.features.values, first.features.values);
  ASSERT_EQ(second.filters.size(), 2U);
  EXPECT_EQ(second.filters[0].values, first.filters[0].values);
  EXPECT_EQ(second.sections, first.sections);
  EXPECT_EQ(second.run.seed, 7U);
  EXPECT_EQ(second.camera, first.camera);
}

TEST(Configuration, AKnownCameraCanBeChangedInPart) {
  ConfigurationNode root = parse_yaml(test::good, "c.yaml", "/");
  apply_override(root, "camera.baseline=0.12", choice_sections());
  Registry registry = test::test_registry();
  const Configuration configuration = resolve_configuration(root, "c.yaml", registry, test::test_sections());
  Camera expected = find_camera("tum_fr1").value();
  expected.baseline = 0.12;
  EXPECT_EQ(configuration.camera, expected);
}

TEST(Configuration, LoadsPluginsAndNamesTheirFiles) {
  const std::filesystem::path file = std::filesystem::path(TEST_PLUGIN_FOLDER) / "configuration_test.yaml";
  std::ofstream(file) << test::good << "segmenter: { good: { dilate: 9 } }\nplugins: [ test_plugin_good ]\n";
  Registry registry = test::test_registry();
  const Configuration first = read_configuration(file, {}, registry, test::test_sections());
  EXPECT_EQ(first.segmenter.values.at("dilate"), ParameterValue(std::int64_t{9}));
  // The resolved configuration is run from another folder.
  const ConfigurationNode moved = parse_yaml(to_yaml(first), "out.yaml", "/elsewhere");
  Registry fresh = test::test_registry();
  EXPECT_EQ(resolve_configuration(moved, "out.yaml", fresh, test::test_sections()).segmenter.name, "good");
  EXPECT_NO_THROW(read_configuration(file, {}, registry, test::test_sections())) << "twice into one registry";
  std::filesystem::remove(file);
}

}  // namespace
}  // namespace holdfast
