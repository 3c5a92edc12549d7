// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/perturbation/perturbed_source.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <opencv2/core.hpp>

#include "holdfast/core/error.hpp"
#include "holdfast/perturbation/image_faults.hpp"
#include "holdfast/run/configured_pipeline.hpp"

namespace holdfast {
namespace {

constexpr std::uint64_t frame_count = 200;
const Camera camera{.width = 64, .height = 48, .fx = 50, .fy = 50, .cx = 31.5, .cy = 23.5};

/// Frames with a texture, from an index on.
class TexturedSource final : public FrameSource {
 public:
  explicit TexturedSource(std::uint64_t begin = 0) : next_(begin) {}
  SourceDescription describe() const override {
    SourceDescription description{.name = "textured", .has_depth = true, .frame_count = frame_count, .camera = camera};
    for (std::uint64_t i = 0; i < frame_count; ++i) description.frame_timestamps.push_back(stamp(i));
    return description;
  }
  std::optional<SensorFrame> next() override {
    if (next_ == frame_count) return std::nullopt;
    return frame(next_++);
  }
  std::vector<double> pass_over(double timestamp) override {
    std::vector<double> stamps;
    for (; next_ + 1 < frame_count && stamp(next_ + 1) <= timestamp; ++next_) stamps.push_back(stamp(next_));
    return stamps;
  }
  static double stamp(std::uint64_t index) { return 100.0 + static_cast<double>(index) / 30.0; }
  static SensorFrame frame(std::uint64_t index) {
    SensorFrame frame;
    frame.index = index;
    frame.timestamp = stamp(index);
    frame.colour = block_texture(64, 48, 4, Random(index));
    frame.depth = cv::Mat(48, 64, CV_32FC1, cv::Scalar(2.0));
    auto truth = std::make_shared<FrameTruth>();
    truth->object_mask = cv::Mat::zeros(48, 64, CV_8UC1);
    truth->object_mask.col(30).setTo(1);
    truth->class_labels = truth->object_mask.clone();
    frame.truth = truth;
    return frame;
  }

 private:
  std::uint64_t next_;
};

std::vector<SensorFrame> frames_of(const PerturbationSettings& settings, std::uint64_t begin = 0,
                                   std::uint64_t seed = 1) {
  PerturbedSource source(std::make_unique<TexturedSource>(begin), settings, camera, seed);
  std::vector<SensorFrame> frames;
  while (auto frame = source.next()) frames.push_back(*frame);
  return frames;
}

bool are_equal(const cv::Mat& a, const cv::Mat& b) { return cv::norm(a, b, cv::NORM_INF) == 0.0; }
bool are_equal(const SensorFrame& a, const SensorFrame& b) {
  return a.index == b.index && a.timestamp == b.timestamp && are_equal(a.colour, b.colour) &&
         are_equal(a.depth, b.depth) && are_equal(a.truth->object_mask, b.truth->object_mask);
}

/// One setting for each thing that can be made worse, at a strength that shows.
std::vector<std::pair<std::string, PerturbationSettings>> all_perturbations() {
  return {{"motion_blur", {.motion_blur = 6}},
          {"noise", {.noise = 20}},
          {"exposure", {.exposure = 1}},
          {"rolling_shutter", {.rolling_shutter = 8}},
          {"dropped", {.dropped = 0.3}},
          {"repeated", {.repeated = 0.3}},
          {"late", {.late = 0.02}},
          {"depth_holes", {.depth_holes = 0.3}},
          {"depth_bias", {.depth_bias = 0.05}},
          {"depth_offset", {.depth_offset = 6}},
          {"calibration", {.calibration = 0.02}},
          {"occluder", {.occluder = 0.3}},
          {"covered", {.covered = 3, .covered_after = 2}}};
}

/// Frames that are given and passed over together are those without passing over, with the same stamps and content.
TEST(PerturbedSourceTest, LateFramesArePassedOver) {
  for (const PerturbationSettings& settings :
       {PerturbationSettings{.noise = 20}, PerturbationSettings{.dropped = 0.3}, PerturbationSettings{.late = 0.2},
        PerturbationSettings{.dropped = 0.3, .late = 0.2}}) {
    const std::vector<SensorFrame> all = frames_of(settings);
    PerturbedSource source(std::make_unique<TexturedSource>(), settings, camera, 1);
    std::size_t position = 0, passed_over = 0;
    double now = 99.0;
    while (true) {
      const std::vector<double> passed = source.pass_over(now);
      passed_over += passed.size();
      for (const double stamp : passed) EXPECT_EQ(stamp, all.at(position++).timestamp);
      const std::optional<SensorFrame> frame = source.next();
      if (!frame) break;
      EXPECT_TRUE(are_equal(*frame, all.at(position++)));
      EXPECT_TRUE(position == all.size() || all[position].timestamp > now) << "the newest that is due";
      now = std::max(now, frame->timestamp) + 0.15;
    }
    EXPECT_EQ(position, all.size());
    EXPECT_GT(passed_over, all.size() / 3);
  }
}

TEST(PerturbedSourceTest, EveryKindHasATestAndChangesItsFrames) {
  const ParameterTable<PerturbationSettings> table;
  std::vector<std::string> kinds;
  for (const Parameter& parameter : table.parameters())
    if (parameter.type == ParameterType::real) kinds.push_back(parameter.name);
  std::vector<std::string> tested;
  for (const auto& [kind, settings] : all_perturbations()) {
    tested.push_back(kind);
    ASSERT_EQ(settings.strengths().size(), 1U);
    EXPECT_EQ(settings.strengths().front().first, kind);
    const std::vector<SensorFrame> frames = frames_of(settings);
    std::size_t changed = frame_count - frames.size();
    for (const SensorFrame& frame : frames) changed += are_equal(frame, TexturedSource::frame(frame.index)) ? 0 : 1;
    if (kind == "calibration")
      EXPECT_EQ(changed, 0U) << "the calibration is wrong, the images are not";
    else
      EXPECT_GT(changed, frame_count / 5) << kind;
  }
  EXPECT_EQ(tested, kinds);
}

TEST(PerturbedSourceTest, RepeatsItselfAndFollowsTheSeed) {
  for (const auto& [kind, settings] : all_perturbations()) {
    const std::vector<SensorFrame> first = frames_of(settings), second = frames_of(settings);
    ASSERT_EQ(first.size(), second.size()) << kind;
    for (std::size_t i = 0; i < first.size(); ++i) ASSERT_TRUE(are_equal(first[i], second[i])) << kind << " " << i;
    if (kind == "depth_bias" || kind == "calibration" || kind == "covered") continue;
    const std::vector<SensorFrame> other = frames_of(settings, 0, 2);
    std::size_t equal = 0;
    for (std::size_t i = 0; i < std::min(first.size(), other.size()); ++i)
      equal += are_equal(first[i], other[i]) ? 1 : 0;
    EXPECT_LT(equal, first.size()) << kind << " does not depend on the seed";
    PerturbationSettings own = settings;
    own.seed = 2;
    const std::vector<SensorFrame> same = frames_of(own, 0, 77);
    ASSERT_EQ(same.size(), other.size()) << kind;
    for (std::size_t i = 0; i < same.size(); ++i) ASSERT_TRUE(are_equal(same[i], other[i])) << kind << " " << i;
  }
}

/// Frames that are skipped change nothing about the others.
TEST(PerturbedSourceTest, DoesNotDependOnTheFramesBefore) {
  for (const auto& [kind, settings] : all_perturbations()) {
    if (kind == "repeated" || kind == "late") continue;
    const std::vector<SensorFrame> whole = frames_of(settings), clip = frames_of(settings, 57);
    ASSERT_FALSE(clip.empty());
    for (std::size_t i = 0; i < clip.size(); ++i)
      ASSERT_TRUE(are_equal(clip[clip.size() - 1 - i], whole[whole.size() - 1 - i])) << kind << " " << i;
  }
}

TEST(PerturbedSourceTest, SaysHowManyFramesAreLeft) {
  PerturbedSource source(std::make_unique<TexturedSource>(), {.dropped = 0.4}, camera, 1);
  const std::size_t left = frames_of({.dropped = 0.4}).size();
  EXPECT_EQ(source.describe().frame_count, left);
  EXPECT_NEAR(static_cast<double>(left) / frame_count, 0.6, 0.1);
  EXPECT_EQ(source.next()->index, 0U) << "the first frame is never dropped";
}

TEST(PerturbedSourceTest, RepeatedFramesShowTheImagesBeforeAtTheirOwnTime) {
  const std::vector<SensorFrame> frames = frames_of({.repeated = 0.4});
  ASSERT_EQ(frames.size(), frame_count);
  std::size_t repeated = 0;
  for (std::size_t i = 1; i < frames.size(); ++i) {
    EXPECT_EQ(frames[i].timestamp, TexturedSource::frame(i).timestamp);
    repeated += frames[i].colour.data == frames[i - 1].colour.data && frames[i].truth == frames[i - 1].truth ? 1 : 0;
  }
  EXPECT_NEAR(static_cast<double>(repeated) / frame_count, 0.4, 0.1);
}

TEST(PerturbedSourceTest, LateStampsIncreaseStrictlyAndStayWithinTheDelay) {
  const std::vector<SensorFrame> frames = frames_of({.late = 0.2});  // six frames of time
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const double delay = frames[i].timestamp - TexturedSource::frame(i).timestamp;
    EXPECT_GE(delay, 0.0);
    EXPECT_LT(delay, 0.21);
    if (i > 0) {
      EXPECT_GT(frames[i].timestamp, frames[i - 1].timestamp);
    }
  }
}

TEST(PerturbedSourceTest, TheOccluderIsNearMovesAndIsAnObjectWithoutAClass) {
  const std::vector<SensorFrame> frames = frames_of({.occluder = 0.25});
  EXPECT_FALSE(are_equal(frames[0].truth->object_mask, frames[40].truth->object_mask));
  for (const SensorFrame& frame : frames) {
    const cv::Mat is_occluder = frame.truth->object_mask == 255;
    EXPECT_EQ(cv::countNonZero(is_occluder), 32 * 24);
    EXPECT_EQ(cv::countNonZero(frame.depth == 0.5), 32 * 24);
    EXPECT_EQ(cv::countNonZero(frame.truth->class_labels & is_occluder), 0);
    EXPECT_THAT(frame.truth->moving_objects, ::testing::ElementsAre(255));
  }
}

TEST(PerturbedSourceTest, ACoveredLensShowsNothingForItsTime) {
  const std::vector<SensorFrame> frames = frames_of({.covered = 1.5, .covered_after = 2});
  ASSERT_EQ(frames.size(), frame_count);
  for (const SensorFrame& frame : frames) {
    if (frame.index < 60 || frame.index >= 105) {
      EXPECT_TRUE(are_equal(frame, TexturedSource::frame(frame.index))) << frame.index;
      continue;
    }
    EXPECT_EQ(cv::norm(frame.colour, cv::NORM_INF), 0.0) << frame.index;
    for (const cv::Mat& image : {frame.depth, frame.truth->object_mask, frame.truth->class_labels})
      EXPECT_EQ(cv::countNonZero(image), 0) << frame.index;
  }
}

TEST(PerturbedSourceTest, NothingIsDoneAtStrengthZero) {
  EXPECT_TRUE(PerturbationSettings{}.is_nothing());
  PerturbationSettings seeded;
  seeded.seed = 5;
  EXPECT_TRUE(seeded.is_nothing());
  EXPECT_EQ(perturbed_camera(camera, {}, 1), camera);
}

TEST(PerturbedSourceTest, CalibrationIsWrongByItsStrength) {
  const Camera wrong = perturbed_camera(camera, {.calibration = 0.02}, 1);
  EXPECT_NEAR(std::abs(wrong.fx / camera.fx - 1.0), 0.02, 1e-12);
  EXPECT_NEAR(wrong.fx / camera.fx, wrong.fy / camera.fy, 1e-12);
  EXPECT_NEAR(std::abs(wrong.cx - camera.cx), 0.02 * 32, 1e-12);
  EXPECT_NEAR(std::abs(wrong.cy - camera.cy), 0.02 * 24, 1e-12);
  PerturbedSource source(std::make_unique<TexturedSource>(), {.calibration = 0.02}, camera, 1);
  EXPECT_EQ(source.describe().camera, wrong);
}

Configuration configured(const std::vector<std::string>& overrides, Registry& registry) {
  ConfigurationNode root = parse_yaml(
      "source: { simulated: { duration: 0.2 } }\nfeatures: orb\noptimizer: ceres\n"
      "camera: { width: 160, height: 120, fx: 130, fy: 130, cx: 79.5, cy: 59.5 }\n",
      "test.yaml", ".");
  for (const std::string& each : overrides) apply_override(root, each, choice_sections());
  return resolve_configuration(root, "test.yaml", registry, pipeline_sections());
}

TEST(PerturbedSourceTest, TheSectionOfAConfigurationWrapsItsSource) {
  Registry registry;
  register_builtin_plugins(registry);
  const auto first_frame = [&](const std::vector<std::string>& overrides) {
    BuiltPipeline built = build_pipeline(configured(overrides, registry), registry);
    return *built.source->next();
  };
  const SensorFrame plain = first_frame({}), biased = first_frame({"perturbation.depth_bias=0.5"});
  EXPECT_TRUE(are_equal(biased.depth, scaled_depth(plain.depth, 1.5)));
  EXPECT_TRUE(are_equal(first_frame({"perturbation.seed=3"}).colour, plain.colour));

  const BuiltPipeline wrong = build_pipeline(configured({"perturbation.calibration=0.1"}, registry), registry);
  EXPECT_NEAR(std::abs(wrong.pipeline.camera().fx / 130.0 - 1.0), 0.1, 1e-12);
  EXPECT_THROW(configured({"perturbation.dropped=1.5"}, registry), ConfigurationError);
}

}  // namespace
}  // namespace holdfast
