// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/moving_world/filter_chain.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

namespace holdfast {
namespace {

/// Says one thing about every feature whose index is a multiple of a number.
class EveryNth final : public DynamicFilter {
 public:
  EveryNth(std::size_t n, float log_odds, StaticEvidence::Kind kind = StaticEvidence::Kind::measurement)
      : n_(n), log_odds_(log_odds), kind_(kind) {}
  Needs needs() const override { return {}; }
  void apply(const FilterContext& context, StaticEvidence& evidence) override {
    for (std::size_t i = 0; i < context.frame.size(); i += n_) evidence.add(i, log_odds_, kind_);
  }

 private:
  std::size_t n_;
  float log_odds_;
  StaticEvidence::Kind kind_;
};

Frame six_features() {
  Frame frame;
  frame.features.resize(6);
  frame.static_probability.assign(6, 1.0F);
  frame.measured_log_odds.assign(6, 0.0F);
  frame.map_points.assign(6, MapPointId());
  return frame;
}

EvidenceSettings plain_settings() {
  EvidenceSettings settings;
  settings.static_log_odds = 0.0;
  settings.ignore_below = 0.0;
  return settings;
}

void evaluate(FilterChain& chain, const Map& map, Frame& frame) {
  const SensorFrame sensor_frame;
  const FilterContext context{.sensor_frame = sensor_frame, .frame = frame, .map = map};
  chain.begin(frame);
  chain.evaluate(FilterStage::before_matching, context);
  chain.evaluate(FilterStage::after_matching, context);
  chain.weight_features(map, frame);
}

TEST(FilterChain, EmptyChainLeavesFullWeight) {
  FilterChain chain;
  Frame frame = six_features();
  evaluate(chain, Map(), frame);
  for (const float probability : frame.static_probability) EXPECT_EQ(probability, 1.0F);
}

TEST(FilterChain, EvidenceAddsUpAndNamesItsStage) {
  FilterChain chain(plain_settings());
  chain.add("even", std::make_unique<EveryNth>(2, -2.0F));
  chain.add("third", std::make_unique<EveryNth>(3, 1.0F));
  Frame frame = six_features();
  evaluate(chain, Map(), frame);
  EXPECT_NEAR(frame.static_probability[0], 1.0 / (1.0 + std::exp(1.0)), 1e-6);   // -2 + 1
  EXPECT_EQ(frame.static_probability[1], 0.5F);                                  // nothing said
  EXPECT_NEAR(frame.static_probability[2], 1.0 / (1.0 + std::exp(2.0)), 1e-6);   // -2
  EXPECT_NEAR(frame.static_probability[3], 1.0 / (1.0 + std::exp(-1.0)), 1e-6);  // +1
  ASSERT_EQ(chain.evidence().stages(), (std::vector<std::string>{"even", "third"}));
  for (const auto& contribution : chain.evidence().contributions())
    EXPECT_EQ(contribution.stage, contribution.log_odds < 0 ? 0 : 1);
}

TEST(FilterChain, HardRemovalLeavesAllOrNothing) {
  EvidenceSettings settings = plain_settings();
  settings.removal = Removal::hard;
  settings.static_log_odds = 1.0;
  FilterChain chain(settings);
  chain.add("even", std::make_unique<EveryNth>(2, -2.0F));
  Frame frame = six_features();
  evaluate(chain, Map(), frame);
  for (std::size_t i = 0; i < frame.size(); ++i) EXPECT_EQ(frame.static_probability[i], i % 2 == 0 ? 0.0F : 1.0F);
}

TEST(FilterChain, MapPointsCarryMeasurementsButNotPriors) {
  Map map;
  Frame frame = six_features();
  for (MapPointId& id : frame.map_points) id = map.add_point(Eigen::Vector3d::Zero(), 0);
  FilterChain chain(plain_settings());
  chain.add("measured", std::make_unique<EveryNth>(2, -2.0F));
  chain.add("prior", std::make_unique<EveryNth>(3, -1.0F, StaticEvidence::Kind::prior));
  evaluate(chain, map, frame);
  chain.accumulate(frame, map);
  const float share = static_cast<float>(chain.settings().measured_share);
  for (std::size_t i = 0; i < frame.size(); ++i)
    EXPECT_FLOAT_EQ(map.point(frame.map_points[i]).static_log_odds, i % 2 == 0 ? -2.0F * share : 0.0F);
  // In the next frame they begin with what is carried.
  evaluate(chain, map, frame);
  EXPECT_NEAR(frame.static_probability[2], 1.0 / (1.0 + std::exp(2.0 + 2.0 * share)), 1e-6);
  EXPECT_FLOAT_EQ(frame.measured_log_odds[2], -2.0F - 2.0F * share);
}

/// Says of every feature and cell what it says, when there is a mask.
class OfMask final : public DynamicFilter {
 public:
  Needs needs() const override { return {.segmentation = true}; }
  void apply(const FilterContext& context, StaticEvidence& evidence) override {
    if (context.segmentation == nullptr) return;
    for (std::size_t i = 0; i < evidence.size(); ++i) evidence.add(i, -2.0F, StaticEvidence::Kind::prior);
    for (std::size_t cell = 0; cell < evidence.cells().size(); cell += 2) evidence.add_cell(cell, -3.0F);
  }
};

/// Says of every cell that it is static, once the local map was matched.
class LateCells final : public DynamicFilter {
 public:
  Needs needs() const override { return {.matches = true}; }
  void apply(const FilterContext&, StaticEvidence& evidence) override {
    for (std::size_t cell = 0; cell < evidence.cells().size(); ++cell) evidence.add_cell(cell, 1.5F);
  }
};

TEST(FilterChain, WeightsAndCellsFollowWhatBecomesKnownWithinAFrame) {
  FilterChain chain(plain_settings());
  chain.add("early", std::make_unique<EveryNth>(2, -1.0F));
  chain.add("late", std::make_unique<LateCells>());
  const SensorFrame sensor_frame;
  Map map;
  for (int round = 0; round < 2; ++round) {
    Frame frame = six_features();
    frame.coarse.depth.assign(4, 1.0F);
    const FilterContext context{.sensor_frame = sensor_frame, .frame = frame, .map = map};
    chain.begin(frame);
    chain.evaluate(FilterStage::before_matching, context);
    chain.weight_features(map, frame);
    EXPECT_EQ(frame.coarse.static_log_odds, std::vector<float>(4, 0.0F));
    EXPECT_EQ(frame.static_probability[1], 0.5F);
    frame.map_points[1] = map.add_point(Eigen::Vector3d::Zero(), 0);
    map.point(frame.map_points[1]).static_log_odds = 2.0F;
    chain.evaluate(FilterStage::after_matching, context);
    chain.weight_features(map, frame);
    EXPECT_EQ(frame.coarse.static_log_odds, std::vector<float>(4, 1.5F));
    EXPECT_NEAR(frame.static_probability[1], 1.0 / (1.0 + std::exp(-2.0)), 1e-6);
    EXPECT_NEAR(frame.static_probability[2], 1.0 / (1.0 + std::exp(1.0)), 1e-6);
  }
}

TEST(FilterChain, DiscountedPriorsCostLittleUntilTheNextFrame) {
  EvidenceSettings settings;  // a static prior of 2, at most -1.5 after the discount
  settings.fallback = true;
  FilterChain chain(settings);
  chain.add("mask", std::make_unique<EveryNth>(2, -6.0F, StaticEvidence::Kind::prior));
  chain.add("moves", std::make_unique<EveryNth>(3, -6.0F));
  Frame frame = six_features();
  const Map map;
  evaluate(chain, map, frame);
  EXPECT_EQ(frame.static_probability[2], 0.0F);
  EXPECT_TRUE(chain.discount_priors());
  chain.weight_features(map, frame);
  EXPECT_NEAR(frame.static_probability[2], 1.0 / (1.0 + std::exp(-0.5)), 1e-6);
  EXPECT_EQ(frame.static_probability[3], 0.0F);  // measured, which no discount changes
  EXPECT_GT(frame.static_probability[1], 0.8F);
  EXPECT_FALSE(chain.discount_priors());  // a second time there is nothing to gain
  evaluate(chain, map, frame);
  EXPECT_EQ(frame.static_probability[2], 0.0F);

  settings.fallback = false;
  FilterChain strict(settings);
  strict.add("mask", std::make_unique<EveryNth>(2, -6.0F, StaticEvidence::Kind::prior));
  evaluate(strict, map, frame);
  EXPECT_FALSE(strict.discount_priors());
}

TEST(FilterChain, AStageCountsOncePerFrame) {
  FilterChain chain(plain_settings());
  chain.add("even", std::make_unique<EveryNth>(2, -2.0F));
  Frame frame = six_features();
  evaluate(chain, Map(), frame);
  const SensorFrame sensor_frame;
  const Map map;
  chain.evaluate(FilterStage::before_matching, {.sensor_frame = sensor_frame, .frame = frame, .map = map});
  EXPECT_EQ(chain.evidence().measurement(0), -2.0F);
}

TEST(FilterChain, AKeyframeLearnsFromItsOwnSegmentationAndKeepsItsMeasurements) {
  for (const bool evaluated_before : {false, true}) {
    FilterChain chain(plain_settings());
    chain.add("mask", std::make_unique<OfMask>());
    chain.add("even", std::make_unique<EveryNth>(2, -1.0F));
    Frame frame = six_features();
    frame.coarse.depth.assign(4, 1.0F);
    Map map;
    if (evaluated_before) {
      evaluate(chain, map, frame);
      frame.coarse.static_log_odds = {-5.0F, -1.0F, 0.0F, 2.0F};
    }
    const SensorFrame sensor_frame;
    const Segmentation segmentation;
    chain.evaluate_keyframe({.sensor_frame = sensor_frame, .frame = frame, .map = map, .segmentation = &segmentation},
                            frame);
    for (std::size_t i = 0; i < frame.size(); ++i) {
      const double measured = evaluated_before && i % 2 == 0 ? -1.0 : 0.0;
      EXPECT_NEAR(frame.static_probability[i], 1.0 / (1.0 + std::exp(2.0 - measured)), 1e-6);
    }
    // Cells become more suspect by it, never less.
    const std::vector<float> expected =
        evaluated_before ? std::vector<float>{-5.0F, -1.0F, -3.0F, 2.0F} : std::vector<float>{-3.0F, 0.0F, -3.0F, 0.0F};
    EXPECT_EQ(frame.coarse.static_log_odds, expected);
  }
}

}  // namespace
}  // namespace holdfast
