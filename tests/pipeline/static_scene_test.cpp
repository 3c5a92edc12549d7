// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "holdfast/dense_map/static_scene.hpp"
#include "holdfast/pipeline/pipeline.hpp"
#include "holdfast/plugin/registry.hpp"
#include "support/point_world.hpp"

extern "C" void holdfast_register_plugin_ceres(holdfast::Registry&);

namespace holdfast {
namespace {

/// Sees somebody in the right third of every image.
class RightThird final : public Segmenter {
 public:
  const std::vector<std::string>& classes() const override {
    static const std::vector<std::string> names{"background", "cat", "person"};
    return names;
  }
  Segmentation segment(const SensorFrame& frame) override {
    Segmentation segmentation;
    segmentation.labels = cv::Mat::zeros(frame.colour.size(), CV_8UC1);
    segmentation.labels.colRange(0, frame.colour.cols / 3) = 1;
    segmentation.labels.colRange(2 * frame.colour.cols / 3, frame.colour.cols) = 2;
    return segmentation;
  }
};

Pipeline fed_pipeline(bool enabled, bool segmented, bool threaded) {
  test::PointWorld world(find_camera("tum_fr3").value());
  Registry registry;
  holdfast_register_plugin_ceres(registry);
  PipelineParts parts;
  parts.camera = world.camera();
  parts.features = std::make_unique<test::PointExtractor>(world, 0.3);
  parts.optimizer = registry.create<Optimizer>("ceres", {}, {});
  parts.dense_map.enabled = enabled;
  if (threaded) parts.run.mode = RunMode::threaded;
  if (segmented) parts.segmenter = std::make_unique<RightThird>();
  Pipeline pipeline(std::move(parts));
  for (int i = 0; i < 60; ++i)
    pipeline.feed(world.frame(static_cast<std::uint64_t>(i), i / 30.0, test::path_pose(i / 30.0)));
  pipeline.finish();
  return pipeline;
}

TEST(PipelineStaticScene, IsKeptOnlyWhenAskedFor) {
  EXPECT_EQ(fed_pipeline(false, false, false).static_scene(), nullptr);
}

TEST(PipelineStaticScene, HasEveryKeyframeWithItsOwnMask) {
  for (const bool segmented : {false, true})
    for (const bool threaded : {false, true}) {
      const Pipeline pipeline = fed_pipeline(true, segmented, threaded);
      const StaticScene* scene = pipeline.static_scene();
      ASSERT_NE(scene, nullptr);
      ASSERT_GE(scene->views().size(), 2U);
      EXPECT_EQ(scene->views().size(), pipeline.mapping_counts().keyframes_made);
      for (const KeptView& view : scene->views()) {
        EXPECT_EQ(view.moves(300, 100), segmented);  // the person
        EXPECT_FALSE(view.moves(10, 100));           // the cat is not among the classes to be left out
      }
      EXPECT_FALSE(scene->cloud(pipeline.map()).empty());
    }
}

}  // namespace
}  // namespace holdfast
