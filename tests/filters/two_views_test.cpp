// SPDX-License-Identifier: BSD-3-Clause
#include "two_views.hpp"

#include <gtest/gtest.h>

#include "holdfast/geometry/epipolar.hpp"
#include "holdfast/geometry/so3.hpp"

namespace holdfast::epipolar_consistency_plugin {
namespace {

constexpr double focal = 525.0, pixel = 1.0 / focal;

/// Two views of a scene: pairs with noise of 0.2 px, and which of them moved.
struct Views {
  PointPairs pairs;
  std::vector<bool> moved;
};

struct SceneKind {
  Eigen::Vector3d translation{0.03, 0.0, 0.01};  // of the camera [m]
  Eigen::Vector3d rotation{0.004, 0.01, -0.003};
  double movers = 0.0;                     // share of the points
  Eigen::Vector3d motion{0.0, 0.04, 0.0};  // of the movers [m]
  bool coherent = true;                    // otherwise each moves its own way
  bool plane = false;                      // all that stands still lies on one
  double distrusted = 0.0;                 // share of the movers known to be suspect
};

Views make_views(const SceneKind& kind, std::uint64_t seed = 1, int count = 400) {
  Views views;
  Random random(seed);
  const Eigen::Quaterniond rotation = geometry::exp_so3(kind.rotation);
  for (int i = 0; i < count; ++i) {
    const bool moves = random.uniform() < kind.movers;
    const double depth = moves ? random.uniform(1.2, 1.5) : kind.plane ? 2.5 : random.uniform(1.2, 4.0);
    Eigen::Vector3d point{random.uniform(-0.55, 0.55) * depth, random.uniform(-0.4, 0.4) * depth, depth};
    const Eigen::Vector2d a = point.hnormalized();
    if (moves) {
      Eigen::Vector3d motion = kind.motion;
      if (!kind.coherent)
        motion = 0.06 * Eigen::Vector3d{random.normal(), random.normal(), random.normal()}.normalized();
      point += motion;
    }
    const Eigen::Vector2d b = (rotation * (point - kind.translation)).hnormalized();
    const auto noisy = [&](double value) { return static_cast<float>(value + 0.2 * pixel * random.normal()); };
    const bool trusted = !(moves && random.uniform() < kind.distrusted);
    const float ax = noisy(a.x()), ay = noisy(a.y()), bx = noisy(b.x()), by = noisy(b.y());
    views.pairs.add(ax, ay, bx, by, trusted);
    views.moved.push_back(moves);
  }
  return views;
}

struct Rates {
  Verdict verdict = Verdict::few_points;
  double found = 0.0, false_alarms = 0.0;  // shares of the movers and of the rest beyond 1.5 px
};

Rates evaluate(const Views& views, std::uint64_t seed = 7) {
  TwoViewOptions options;
  options.threshold = 1.5 * pixel, options.parallax = 0.7 * pixel;
  TwoViews two_views(options);
  Random random(seed);
  Rates rates;
  rates.verdict = two_views.estimate(views.pairs, random);
  if (rates.verdict != Verdict::usable) return rates;
  double movers = 0.0, rest = 0.0;
  for (std::size_t i = 0; i < views.moved.size(); ++i) {
    const bool far = two_views.distance2()[i] > options.threshold * options.threshold;
    (views.moved[i] ? movers : rest) += 1.0;
    (views.moved[i] ? rates.found : rates.false_alarms) += far ? 1.0 : 0.0;
  }
  rates.found /= std::max(movers, 1.0), rates.false_alarms /= std::max(rest, 1.0);
  return rates;
}

TEST(TwoViews, DistancesAreThoseOfTheGeometryModule) {
  const Views views = make_views({}, 3, 20);
  Eigen::Matrix3d matrix;
  matrix << 0.1, -0.7, 0.3, 0.5, 0.2, -0.9, -0.4, 0.8, 0.05;
  std::vector<float> distance2;
  epipolar_distances2(matrix, views.pairs, distance2);
  for (std::size_t i = 0; i < views.pairs.size(); ++i) {
    const Eigen::Vector2d a(views.pairs.ax[i], views.pairs.ay[i]), b(views.pairs.bx[i], views.pairs.by[i]);
    EXPECT_NEAR(distance2[i], geometry::epipolar_line(matrix, a).distance2(b.x(), b.y()), 1e-5);
  }
}

TEST(TwoViews, AMovingCameraFindsMovers) {
  double false_alarms = 0.0;
  for (const std::uint64_t seed : {1, 2, 3, 4, 5, 6}) {
    SCOPED_TRACE(seed);
    const Rates rates = evaluate(make_views({.movers = 0.25}, seed), seed);
    ASSERT_EQ(rates.verdict, Verdict::usable);
    EXPECT_GE(rates.found, 0.9);
    EXPECT_LE(rates.false_alarms, 0.12);
    false_alarms += rates.false_alarms / 6.0;
  }
  EXPECT_LE(false_alarms, 0.04);
}

TEST(TwoViews, AStaticSceneRaisesFewAlarms) {
  for (const std::uint64_t seed : {1, 2, 3, 4, 5, 6}) {
    SCOPED_TRACE(seed);
    const Rates rates = evaluate(make_views({}, seed), seed);
    ASSERT_EQ(rates.verdict, Verdict::usable);
    EXPECT_LE(rates.false_alarms, 0.01);
  }
}

TEST(TwoViews, WithoutParallaxThereIsNothingToSay) {
  for (const std::uint64_t seed : {1, 2, 3, 4, 5, 6}) {
    SCOPED_TRACE(seed);
    const Eigen::Vector3d none = Eigen::Vector3d::Zero(), turn(0.0, 0.04, 0.01);
    EXPECT_EQ(evaluate(make_views({.translation = none, .rotation = turn}, seed), seed).verdict, Verdict::no_parallax);
    EXPECT_EQ(evaluate(make_views({.translation = none, .rotation = none}, seed), seed).verdict, Verdict::no_parallax);
    // One mover under a turning camera fits a fundamental matrix of its own: no reason to believe it.
    EXPECT_EQ(evaluate(make_views({.translation = none, .rotation = turn, .movers = 0.15}, seed), seed).verdict,
              Verdict::no_parallax);
    EXPECT_EQ(evaluate(make_views({.translation = {0.002, 0, 0}}, seed), seed).verdict, Verdict::no_parallax);
  }
}

TEST(TwoViews, AWallAloneHasNoParallax) {
  for (const std::uint64_t seed : {1, 2, 3})
    EXPECT_EQ(evaluate(make_views({.plane = true}, seed), seed).verdict, Verdict::no_parallax);
}

TEST(TwoViews, MoversInTheMajorityThatAreKnownDoNotTakePart) {
  for (const std::uint64_t seed : {1, 2, 3, 4, 5, 6}) {
    SCOPED_TRACE(seed);
    const Rates rates = evaluate(make_views({.movers = 0.65, .distrusted = 0.9}, seed, 800), seed);
    ASSERT_EQ(rates.verdict, Verdict::usable);
    EXPECT_GE(rates.found, 0.85);
    EXPECT_LE(rates.false_alarms, 0.06);
  }
}

TEST(TwoViews, UnknownMoversOfAllDirectionsInTheMajorityLeaveNoSupport) {
  for (const std::uint64_t seed : {1, 2, 3})
    EXPECT_EQ(evaluate(make_views({.movers = 0.7, .coherent = false}, seed), seed).verdict, Verdict::no_support);
}

TEST(TwoViews, FewPairsAreNotJudged) {
  EXPECT_EQ(evaluate(make_views({}, 1, 29)).verdict, Verdict::few_points);
  EXPECT_EQ(evaluate(make_views({}, 1, 0)).verdict, Verdict::few_points);
  EXPECT_EQ(evaluate(make_views({.movers = 1.0, .distrusted = 1.0}, 1, 300)).verdict, Verdict::few_points);
}

TEST(TwoViews, SamePairsAndSeedSameResult) {
  const Views views = make_views({.movers = 0.25});
  TwoViewOptions options;
  options.threshold = 1.5 * pixel, options.parallax = 0.7 * pixel;
  TwoViews used(options), fresh(options);
  Random elsewhere(3), one(9), two(9);
  used.estimate(make_views({.movers = 0.1}, 8).pairs, elsewhere);
  ASSERT_EQ(used.estimate(views.pairs, one), fresh.estimate(views.pairs, two));
  EXPECT_EQ(used.fundamental(), fresh.fundamental());
  EXPECT_EQ(used.distance2(), fresh.distance2());
}

}  // namespace
}  // namespace holdfast::epipolar_consistency_plugin
