// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "check.hpp"
#include "filter_scene.hpp"

namespace holdfast::conformance {

namespace {

const char* const header = "holdfast/interfaces/dynamic_filter.hpp";

const FilterScene& scene() {
  static const FilterScene scene(standard_camera());
  return scene;
}

/// All evidence of one frame, for comparisons.
struct Said {
  std::vector<std::pair<std::uint32_t, float>> features;
  std::vector<std::pair<MapPointId, float>> points;
  std::vector<float> cells;
  std::vector<std::pair<std::uint32_t, Eigen::Matrix4d>> objects;
};

Said said(const StaticEvidence& evidence) {
  Said result;
  for (const auto& each : evidence.contributions()) result.features.emplace_back(each.feature, each.log_odds);
  for (const auto& each : evidence.point_contributions()) result.points.emplace_back(each.point, each.log_odds);
  result.cells = evidence.cells();
  for (const MovingObject& object : evidence.objects())
    result.objects.emplace_back(object.id, object.T_world_object.matrix());
  return result;
}

void expect_same(const std::vector<StaticEvidence>& a, const std::vector<StaticEvidence>& b, const std::string& when) {
  for (std::size_t i = 0; i < a.size(); ++i) {
    const Said first = said(a[i]), second = said(b[i]);
    EXPECT_TRUE(first.features == second.features) << when << ": other evidence about the features of frame " << i;
    EXPECT_TRUE(first.points == second.points) << when << ": other evidence about map points in frame " << i;
    EXPECT_TRUE(first.cells == second.cells) << when << ": other evidence about the cells of frame " << i;
    EXPECT_TRUE(first.objects == second.objects) << when << ": other objects in frame " << i;
  }
}

/// Checks the contract of evidence, which holds for every context.
void expect_sound(const StaticEvidence& evidence, const Frame& frame, const Map& map) {
  ASSERT_EQ(evidence.size(), frame.size()) << "the evidence was resized; a filter adds to what is there";
  for (const auto& each : evidence.contributions()) {
    ASSERT_LT(each.feature, frame.size()) << "evidence about a feature that the frame does not have";
    ASSERT_TRUE(std::isfinite(each.log_odds)) << "log-odds of feature " << each.feature << ": " << each.log_odds;
  }
  for (const auto& each : evidence.point_contributions()) {
    ASSERT_NE(map.find_point(each.point), nullptr) << "evidence about a map point that is not in the map";
    ASSERT_TRUE(std::isfinite(each.log_odds)) << "log-odds of a map point: " << each.log_odds;
  }
  for (const float cell : evidence.cells()) ASSERT_TRUE(std::isfinite(cell)) << "log-odds of a cell: " << cell;
  for (const MovingObject& object : evidence.objects()) {
    EXPECT_NE(object.id, 0U) << "objects are numbered from 1";
    EXPECT_TRUE(object.T_world_object.matrix().allFinite() && object.velocity.allFinite() &&
                object.angular_velocity.allFinite() && std::isfinite(object.speed_deviation))
        << "object " << object.id << " has numbers that are not finite";
    EXPECT_TRUE(object.first_seen <= object.last_seen && object.last_seen <= frame.timestamp)
        << "object " << object.id << " was first seen at " << object.first_seen << ", last at " << object.last_seen
        << ", in a frame of " << frame.timestamp << " s";
  }
}

void expect_sound(FilterScene& given, DynamicFilter& filter, const Shown& shown = {}) {
  for (std::size_t i = 0; i < given.moments().size(); ++i) {
    StaticEvidence evidence = given.earlier(i);
    evidence.begin_stage("filter");
    refused([&] { given.judge(filter, i, shown, evidence); });
    expect_sound(evidence, given.moments()[i].frame, given.map());
  }
}

void needs_stay(const Maker& maker) {
  const auto filter = maker.make<DynamicFilter>();
  const auto text = [](const Needs& n) {
    std::string result;
    for (const auto& [name, needed] : {std::pair{" depth", n.depth},
                                       {" segmentation", n.segmentation},
                                       {" pose_prior", n.pose_prior},
                                       {" matches", n.matches},
                                       {" evidence", n.evidence},
                                       {" inertia", n.inertia}})
      if (needed) result += name;
    return result;
  };
  const std::string before = text(filter->needs());
  scene().judge(*filter);
  EXPECT_EQ(text(filter->needs()), before) << "needs() changed while judging";
  EXPECT_EQ(text(maker.make<DynamicFilter>()->needs()), before) << "another instance with the same settings differs";
}

void evidence_is_sound(const Maker& maker) {
  FilterScene given(standard_camera());
  expect_sound(given, *maker.make<DynamicFilter>());
}

void never_takes_away(const Maker& maker) {
  const auto filter = maker.make<DynamicFilter>();
  for (std::size_t i = 0; i < 4; ++i) {
    const StaticEvidence before = scene().earlier(i);
    StaticEvidence after = before;
    after.begin_stage("filter");
    scene().judge(*filter, i, {}, after);
    ASSERT_GE(after.contributions().size(), before.contributions().size()) << "statements of an earlier stage are gone";
    ASSERT_EQ(after.size(), before.size()) << "the evidence was resized";
    EXPECT_EQ(after.cells().size(), before.cells().size()) << "the evidence about cells was resized";
    for (std::size_t k = 0; k < before.contributions().size(); ++k) {
      const auto &was = before.contributions()[k], &is = after.contributions()[k];
      ASSERT_TRUE(was.feature == is.feature && was.log_odds == is.log_odds && was.stage == is.stage)
          << "a statement of an earlier stage was changed";
    }
    EXPECT_EQ(after.stages(), (std::vector<std::string>{"earlier", "filter"}))
        << "the chain names the stages, not the filter";
  }
}

void lives_without_what_may_be_missing(const Maker& maker) {
  FilterScene given(standard_camera(), 4);
  for (const Shown& shown :
       {Shown{.previous = false}, Shown{.pose = false}, Shown{.masks = false}, Shown{.inertia = false},
        Shown{.previous = false, .pose = false, .masks = false, .inertia = false}}) {
    SCOPED_TRACE(std::string("shown: previous frame ") + (shown.previous ? "yes" : "no") + ", pose " +
                 (shown.pose ? "yes" : "no") + ", masks " + (shown.masks ? "yes" : "no") + ", inertia " +
                 (shown.inertia ? "yes" : "no"));
    expect_sound(given, *maker.make<DynamicFilter>(), shown);
  }
}

void lives_without_depth(const Maker& maker) {
  FilterScene given(standard_camera(), 5);
  const auto filter = maker.make<DynamicFilter>();
  remove_depth(given.moments()[1]);
  remove_depth(given.moments()[2]);
  expect_sound(given, *filter);
}

/// How many statements the filter made itself.
std::size_t statements(const std::vector<StaticEvidence>& all) {
  std::size_t count = 0;
  for (const StaticEvidence& evidence : all) {
    const auto is_own = [&](std::uint16_t stage) { return evidence.stages()[stage] == "filter"; };
    for (const auto& each : evidence.contributions()) count += is_own(each.stage) ? 1 : 0;
    for (const auto& each : evidence.point_contributions()) count += is_own(each.stage) ? 1 : 0;
  }
  return count;
}

void works_without_depth_unless_it_needs_it(const Maker& maker) {
  const auto filter = maker.make<DynamicFilter>();
  if (filter->needs().depth) return;  // one camera is refused before the first frame
  FilterScene one_camera(standard_camera());
  one_camera.remove_depth();
  expect_sound(one_camera, *filter);
  const std::size_t with_depth = statements(scene().judge(*maker.make<DynamicFilter>()));
  const std::size_t without = statements(one_camera.judge(*maker.make<DynamicFilter>()));
  EXPECT_TRUE(without > 0 || with_depth == 0)
      << "needs() does not ask for depth, but the filter says nothing about the frames of one camera, and makes "
      << with_depth << " statements about the same frames with depth";
}

void survives_depth_that_is_no_number(const Maker& maker) {
  FilterScene given(standard_camera(), 4);
  const auto filter = maker.make<DynamicFilter>();
  // A sensor may return such values; the frame built from it has no depth there.
  for (Moment& moment : given.moments()) {
    const cv::Mat image(moment.sensor.colour.size(), CV_32FC1, cv::Scalar(std::numeric_limits<double>::quiet_NaN()));
    remove_depth(moment);
    moment.sensor.depth = image;
  }
  expect_sound(given, *filter);
}

void lives_without_features(const Maker& maker) {
  FilterScene given(standard_camera(), 5);
  remove_features(given.moments()[1].frame);
  remove_features(given.moments()[2].frame);
  expect_sound(given, *maker.make<DynamicFilter>());
}

void lives_without_matches(const Maker& maker) {
  FilterScene given(standard_camera(), 4);
  for (Moment& moment : given.moments()) moment.frame.map_points.assign(moment.frame.size(), MapPointId());
  expect_sound(given, *maker.make<DynamicFilter>());
}

void lives_with_everything_masked(const Maker& maker) {
  for (const std::uint8_t label : {Scene::person, std::uint8_t{255}}) {
    FilterScene given(standard_camera(), 4);
    for (Moment& moment : given.moments()) {
      moment.segmentation.labels = cv::Mat(moment.sensor.colour.size(), CV_8UC1, cv::Scalar(label));
      moment.segmentation.confidence = cv::Mat();
      moment.frame.coarse.mask.labels.assign(moment.frame.coarse.mask.labels.size(), label);
    }
    expect_sound(given, *maker.make<DynamicFilter>());
  }
}

void survives_images_of_any_size(const Maker& maker) {
  for (const cv::Size size : {cv::Size(1, 1), cv::Size(3, 40), cv::Size(12, 6), cv::Size(50, 2)}) {
    SCOPED_TRACE("with a camera of " + std::to_string(size.width) + "x" + std::to_string(size.height));
    CreationContext context = standard_context();
    context.camera.width = size.width, context.camera.height = size.height;
    context.camera.cx = 0.5 * (size.width - 1), context.camera.cy = 0.5 * (size.height - 1);
    FilterScene given(context.camera, 4);
    refused([&] { expect_sound(given, *maker.make<DynamicFilter>(context)); });
  }
}

void changes_nothing_but_evidence(const Maker& maker) {
  FilterScene given(standard_camera(), 4);
  std::vector<std::uint64_t> before;
  for (const Moment& moment : given.moments()) before.push_back(digest(moment.sensor));
  given.judge(*maker.make<DynamicFilter>());
  for (std::size_t i = 0; i < before.size(); ++i)
    EXPECT_EQ(digest(given.moments()[i].sensor), before[i]) << "an image of frame " << i << " was written to";
}

void same_contexts_same_evidence(const Maker& maker) {
  const auto first = scene().judge(*maker.make<DynamicFilter>());
  expect_same(first, scene().judge(*maker.make<DynamicFilter>()), "by a second instance");
}

void may_change_threads(const Maker& maker) {
  const auto here = scene().judge(*maker.make<DynamicFilter>());
  const auto filter = maker.make<DynamicFilter>();
  std::vector<StaticEvidence> there;
  run_side_by_side([&] { there = scene().judge(*filter); }, [] {});
  expect_same(here, there, "in another thread than the one that made the filter");
}

void instances_do_not_meet(const Maker& maker) {
  const auto alone = scene().judge(*maker.make<DynamicFilter>());
  const auto one = maker.make<DynamicFilter>(), two = maker.make<DynamicFilter>();
  std::vector<StaticEvidence> first, second;
  run_side_by_side([&] { first = scene().judge(*one); }, [&] { second = scene().judge(*two); });
  expect_same(alone, first, "beside another instance in another thread");
  expect_same(alone, second, "beside another instance in another thread");
}

void time(const Maker& maker) {
  const auto filter = maker.make<DynamicFilter>();
  std::size_t moment = 0;
  StaticEvidence evidence;
  report_time("filters/" + maker.entry().description.name + ", 320x240", 8, [&] {
    evidence = scene().earlier(moment);
    evidence.begin_stage("filter");
    scene().judge(*filter, moment++, {}, evidence);
  });
}

}  // namespace

std::vector<Check> dynamic_filter_checks() {
  const Promise adds{header,
                     "Adds evidence about the features of context.frame in finite numbers; adds nothing where it "
                     "cannot decide."};
  const Promise missing{
      header,
      "In a single frame, an input may be missing all the same: the frame has no depth, no mask has arrived "
      "yet, or there is no pose."};
  const Promise same{header, "The same contexts in the same order give the same evidence."};
  const Promise threads{header, "Used by one thread."};
  return {
      {"NeedsStay",
       {header, "They are checked against the source and the pipeline before the first frame and do not change."},
       needs_stay},
      {"EvidenceIsSound", adds, evidence_is_sound},
      {"NeverTakesAway", {header, "Evidence is never removed: filters do not delete."}, never_takes_away},
      {"LivesWithoutWhatMayBeMissing", missing, lives_without_what_may_be_missing},
      {"LivesWithoutDepth", missing, lives_without_depth},
      {"WorksWithoutDepthUnlessItNeedsIt",
       {header, "without it, a filter works on the frames of one camera, which have none"},
       works_without_depth_unless_it_needs_it},
      {"SurvivesDepthThatIsNoNumber", adds, survives_depth_that_is_no_number},
      {"LivesWithoutFeatures", adds, lives_without_features},
      {"LivesWithoutMatches", adds, lives_without_matches},
      {"LivesWithEverythingMasked", adds, lives_with_everything_masked},
      {"SurvivesImagesOfAnySize", adds, survives_images_of_any_size},
      {"ChangesNothingButEvidence",
       {"holdfast/core/sensor_frame.hpp", "The images are shared, not copied, and must not be written to."},
       changes_nothing_but_evidence},
      {"SameContextsSameEvidence", same, same_contexts_same_evidence},
      {"MayChangeThreads", threads, may_change_threads},
      {"InstancesDoNotMeet", threads, instances_do_not_meet},
      {"Time", threads, time},
  };
}

}  // namespace holdfast::conformance
