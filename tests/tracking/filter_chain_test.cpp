// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/tracking/filter_chain.hpp"

#include <gtest/gtest.h>

#include <memory>

namespace holdfast {
namespace {

/// Says one thing about every feature whose index is a multiple of a number.
class EveryNth final : public DynamicFilter {
 public:
  EveryNth(std::size_t n, float log_odds) : n_(n), log_odds_(log_odds) {}
  Needs needs() const override { return {}; }
  void apply(const FilterContext& context, StaticEvidence& evidence) override {
    for (std::size_t i = 0; i < context.frame.size(); i += n_) evidence.add(i, log_odds_);
  }

 private:
  std::size_t n_;
  float log_odds_;
};

Frame six_features() {
  Frame frame;
  frame.features.resize(6);
  frame.static_probability.assign(6, 1.0F);
  return frame;
}

TEST(FilterChain, EmptyChainLeavesFullWeight) {
  FilterChain chain;
  Frame frame = six_features();
  const Map map;
  const SensorFrame sensor_frame;
  chain.apply({.sensor_frame = sensor_frame, .frame = frame, .map = map}, frame);
  for (const float probability : frame.static_probability) EXPECT_EQ(probability, 1.0F);
}

TEST(FilterChain, EvidenceAddsUpAndNamesItsStage) {
  FilterChain chain;
  chain.add("even", std::make_unique<EveryNth>(2, -2.0F));
  chain.add("third", std::make_unique<EveryNth>(3, 1.0F));
  Frame frame = six_features();
  const Map map;
  const SensorFrame sensor_frame;
  chain.apply({.sensor_frame = sensor_frame, .frame = frame, .map = map}, frame);
  EXPECT_NEAR(frame.static_probability[0], 1.0 / (1.0 + std::exp(1.0)), 1e-6);   // -2 + 1
  EXPECT_EQ(frame.static_probability[1], 1.0F);                                  // nothing said
  EXPECT_NEAR(frame.static_probability[2], 1.0 / (1.0 + std::exp(2.0)), 1e-6);   // -2
  EXPECT_NEAR(frame.static_probability[3], 1.0 / (1.0 + std::exp(-1.0)), 1e-6);  // +1
  ASSERT_EQ(chain.evidence().stages(), (std::vector<std::string>{"even", "third"}));
  for (const auto& statement : chain.evidence().statements())
    EXPECT_EQ(statement.stage, statement.log_odds < 0 ? 0 : 1);
}

}  // namespace
}  // namespace holdfast
