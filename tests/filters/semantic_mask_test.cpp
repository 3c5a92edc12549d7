// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "holdfast/core/error.hpp"
#include "holdfast/interfaces/dynamic_filter.hpp"
#include "holdfast/plugin/registry.hpp"

extern "C" void holdfast_register_plugin_semantic_mask(holdfast::Registry&);

namespace holdfast {
namespace {

constexpr float movable = -4.0F, background = 0.5F, nothing = 0.0F;
constexpr float person_depth = 1.5F, wall_depth = 3.0F;

/// A person of 200 x 300 px before a wall; pixels 200 to 399 in x, 100 to 399 in y. A chair from x = 500 on, and what
/// is left of x = 100 is unknown.
class SemanticMaskTest : public testing::Test {
 protected:
  SemanticMaskTest() {
    camera = std::make_shared<Camera>();
    frame.camera = camera;
    const CoarseSampler sampler(*camera);
    exact.labels = cv::Mat::zeros(480, 640, CV_8UC1);
    image.depth = cv::Mat(480, 640, CV_32FC1, cv::Scalar(wall_depth));
    const cv::Rect person(200, 100, 200, 300);
    exact.labels(person).setTo(2);
    exact.labels.colRange(500, 640).setTo(1);
    exact.labels.colRange(0, 100).setTo(255);
    image.depth(person).setTo(person_depth);
    sampler.sample_depth(image.depth, frame.coarse);
    sampler.sample_labels(exact.labels, 0, propagated.labels);
    propagated.confidence.assign(propagated.labels.size(), 255);
  }

  std::size_t add_feature(float x, float y, float depth) {
    frame.x.push_back(x), frame.y.push_back(y), frame.depth.push_back(depth);
    frame.features.resize(frame.x.size());
    frame.features.x = frame.x, frame.features.y = frame.y;
    return frame.x.size() - 1;
  }
  /// What the filter says of one feature; it must be a prior.
  float said(std::size_t feature, bool by_exact, const std::vector<std::string>& movable_classes = {}) {
    const StaticEvidence evidence =
        evaluate(by_exact ? &exact : nullptr, by_exact ? nullptr : &propagated, movable_classes);
    EXPECT_EQ(evidence.measurement(feature), 0.0F);
    return evidence.prior(feature);
  }
  StaticEvidence evaluate(const Segmentation* segmentation, const CellMask* mask,
                          const std::vector<std::string>& movable_classes = {}) {
    Registry registry;
    holdfast_register_plugin_semantic_mask(registry);
    const auto filter = registry.create<DynamicFilter>("semantic_mask", {{"classes", movable_classes}}, {});
    EXPECT_TRUE(filter->needs().segmentation);
    StaticEvidence evidence(frame.size(), frame.coarse.depth.size());
    evidence.begin_stage("semantic_mask");
    frame.coarse.mask = mask != nullptr ? *mask : CellMask();
    filter->apply({.sensor_frame = image,
                   .frame = frame,
                   .map = map,
                   .segmentation = segmentation,
                   .classes = &classes,
                   .movable = movable_by_segmenter ? &*movable_by_segmenter : nullptr},
                  evidence);
    return evidence;
  }

  const std::vector<std::string> classes{"background", "chair", "person"};
  std::optional<std::vector<std::string>> movable_by_segmenter;
  std::shared_ptr<Camera> camera;
  Map map;
  SensorFrame image;
  Frame frame;
  Segmentation exact;
  CellMask propagated;
};

TEST_F(SemanticMaskTest, FeaturesOnAPersonAreSuspectAndAllOthersAreNot) {
  const std::size_t person = add_feature(300, 200, person_depth), wall = add_feature(440, 200, wall_depth),
                    chair = add_feature(560, 200, wall_depth), unknown = add_feature(50, 200, wall_depth);
  for (const bool by_exact : {true, false}) {
    EXPECT_EQ(said(person, by_exact), movable);
    EXPECT_EQ(said(wall, by_exact), background);
    EXPECT_EQ(said(chair, by_exact), background);
    EXPECT_EQ(said(unknown, by_exact), nothing);
  }
}

TEST_F(SemanticMaskTest, TheClassesThatCanMoveAreChosenByName) {
  const std::size_t person = add_feature(300, 200, person_depth), chair = add_feature(560, 200, wall_depth);
  for (const bool by_exact : {true, false}) {
    EXPECT_EQ(said(person, by_exact, {"chair"}), background);
    EXPECT_EQ(said(chair, by_exact, {"chair"}), movable);
    EXPECT_EQ(said(person, by_exact, {"chair", "person"}), movable);
    // A name that this segmenter does not know is a mistake, not something that never moves.
    EXPECT_THROW(said(person, by_exact, {"dragon", "person"}), InputError);
  }
}

TEST_F(SemanticMaskTest, TheSegmentersOwnWordCountsWhereNoneAreChosen) {
  const std::size_t person = add_feature(300, 200, person_depth), chair = add_feature(560, 200, wall_depth);
  for (const bool by_exact : {true, false}) {
    movable_by_segmenter = {"chair"};
    EXPECT_EQ(said(person, by_exact), background);
    EXPECT_EQ(said(chair, by_exact), movable);
    EXPECT_EQ(said(person, by_exact, {"person"}), movable);
    EXPECT_EQ(said(chair, by_exact, {"person"}), background);
    movable_by_segmenter.emplace();  // does not say
    EXPECT_EQ(said(person, by_exact), movable);
    EXPECT_EQ(said(chair, by_exact), background);
  }
}

TEST_F(SemanticMaskTest, TheBorderBelongsToTheMaskUnlessItLiesBehind) {
  // The person ends at x = 399. Within 4 px depth does not count, within 10 px it decides, beyond nothing is said.
  struct Case {
    float x, depth, said;
  };
  for (const Case& each :
       {Case{402, wall_depth, movable}, Case{402, person_depth, movable}, Case{408, person_depth, movable},
        Case{408, person_depth + 0.1F, movable}, Case{408, wall_depth, background}, Case{408, 0.0F, movable},
        Case{416, person_depth, background}, Case{416, 0.0F, background}}) {
    const std::size_t feature = add_feature(each.x, 250, each.depth);
    for (const bool by_exact : {true, false})
      EXPECT_EQ(said(feature, by_exact), each.said) << each.x << " " << each.depth << " " << by_exact;
  }
  // Above and below it is the same.
  for (const float y : {91.0F, 408.0F}) {
    const std::size_t near = add_feature(300, y, person_depth), behind = add_feature(300, y, wall_depth);
    for (const bool by_exact : {true, false}) {
      EXPECT_EQ(said(near, by_exact), movable);
      EXPECT_EQ(said(behind, by_exact), background);
    }
  }
}

TEST_F(SemanticMaskTest, AFewPixelsOfAPersonAreFoundFromAllSides) {
  for (const int place : {0, 14, 15, 16, 31, 32, 300, 478}) {
    exact.labels = cv::Mat::zeros(480, 640, CV_8UC1);
    exact.labels(cv::Rect(place, place, 2, 2)).setTo(2);
    for (const auto& [offset, expected] :
         {std::pair{-12, background}, {-10, movable}, {0, movable}, {11, movable}, {13, background}})
      for (const auto& [x, y] : {std::pair{place + offset, place}, {place, place + offset}}) {
        if (x < 0 || y < 0 || x >= 640 || y >= 480) continue;
        const std::size_t feature = add_feature(static_cast<float>(x), static_cast<float>(y), 0.0F);
        EXPECT_EQ(said(feature, true), expected) << place << " " << x << " " << y;
      }
  }
}

TEST_F(SemanticMaskTest, FeaturesAtTheImageBorderAreJudged) {
  for (const auto& [x, y] : {std::pair{639.0F, 0.0F}, {639.0F, 479.0F}, {300.0F, 0.0F}}) {
    const std::size_t feature = add_feature(x, y, wall_depth);
    for (const bool by_exact : {true, false}) EXPECT_EQ(said(feature, by_exact), background);
  }
  const std::size_t outside = add_feature(-30, 200, wall_depth);
  for (const bool by_exact : {true, false}) EXPECT_EQ(said(outside, by_exact), nothing);
}

TEST_F(SemanticMaskTest, WhatIsSaidWeighsByTheMasksConfidence) {
  const std::size_t person = add_feature(300, 200, person_depth), wall = add_feature(440, 200, wall_depth),
                    border = add_feature(402, 200, wall_depth);
  exact.confidence = cv::Mat(480, 640, CV_8UC1, cv::Scalar(102));
  exact.confidence(cv::Rect(200, 100, 200, 300)).setTo(51);
  CoarseSampler(*camera).sample_labels(exact.confidence, 0, propagated.confidence);
  for (const bool by_exact : {true, false}) {
    EXPECT_FLOAT_EQ(said(person, by_exact), movable * 0.2F);
    EXPECT_FLOAT_EQ(said(border, by_exact), movable * 0.2F);
    EXPECT_FLOAT_EQ(said(wall, by_exact), background * 0.4F);
  }
}

TEST_F(SemanticMaskTest, CellsOfTheMaskAreSuspectToo) {
  std::fill(propagated.confidence.begin(), propagated.confidence.end(), 51);
  const StaticEvidence evidence = evaluate(nullptr, &propagated);
  ASSERT_EQ(evidence.cells().size(), propagated.labels.size());
  for (std::size_t i = 0; i < propagated.labels.size(); ++i)
    EXPECT_FLOAT_EQ(evidence.cells()[i], propagated.labels[i] == 2 ? movable * 0.2F : 0.0F);
}

TEST_F(SemanticMaskTest, TheFramesOwnSegmentationCountsBeforeAPropagatedMask) {
  const std::size_t person = add_feature(300, 200, person_depth);
  std::fill(propagated.labels.begin(), propagated.labels.end(), 0);
  EXPECT_EQ(evaluate(&exact, &propagated).prior(person), movable);
  EXPECT_EQ(evaluate(nullptr, &propagated).prior(person), background);
  const Segmentation empty;
  EXPECT_EQ(evaluate(&empty, &propagated).prior(person), background);
}

TEST_F(SemanticMaskTest, WithoutAMaskNothingIsSaid) {
  add_feature(300, 200, person_depth);
  const CellMask no_mask;
  const Segmentation no_segmentation;
  EXPECT_TRUE(evaluate(nullptr, nullptr).contributions().empty());
  EXPECT_TRUE(evaluate(&no_segmentation, &no_mask).contributions().empty());
}

TEST_F(SemanticMaskTest, ClassesThatMoveSeldomHaveAPriorBetween) {
  const std::size_t person = add_feature(300, 250, person_depth), chair = add_feature(560, 250, wall_depth);
  const std::size_t wall = add_feature(450, 50, wall_depth);
  Registry registry;
  holdfast_register_plugin_semantic_mask(registry);
  const auto priors = [&](const RealMap& shares, bool by_exact) {
    const auto filter = registry.create<DynamicFilter>("semantic_mask", {{"movable", shares}}, {});
    StaticEvidence evidence(frame.size(), frame.coarse.depth.size());
    evidence.begin_stage("semantic_mask");
    frame.coarse.mask = by_exact ? CellMask() : propagated;
    filter->apply({.sensor_frame = image,
                   .frame = frame,
                   .map = map,
                   .segmentation = by_exact ? &exact : nullptr,
                   .classes = &classes},
                  evidence);
    return std::vector<float>{evidence.prior(person), evidence.prior(chair), evidence.prior(wall)};
  };
  for (const bool by_exact : {true, false}) {
    EXPECT_EQ(priors({}, by_exact), (std::vector<float>{movable, background, background}));
    EXPECT_EQ(priors({{"chair", 0.2}}, by_exact), (std::vector<float>{movable, -0.4F, background}));
    EXPECT_EQ(priors({{"chair", 1.0}}, by_exact), (std::vector<float>{movable, movable, background}));
    EXPECT_EQ(priors({{"person", 0.0}}, by_exact), (std::vector<float>{background, background, background}))
        << "takes precedence over `classes`";
  }
  EXPECT_THROW(priors({{"sofa", 0.5}}, true), InputError);
  const auto filter =
      registry.create<DynamicFilter>("semantic_mask", {{"movable", RealMap{{"chair", 0.2}, {"tv", 0.6}}}}, {});
  EXPECT_EQ(filter->named_classes(), (std::vector<std::string>{"chair", "tv"}));
  EXPECT_EQ(filter->movable_classes({}), (std::vector<std::string>{"person", "tv"})) << "0.2 is not mostly movable";
}

}  // namespace
}  // namespace holdfast
