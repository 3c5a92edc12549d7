// SPDX-License-Identifier: BSD-3-Clause
#include "scene.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <opencv2/imgcodecs.hpp>

#include "viewer/socket_client.hpp"
#include "viewer/viewed_world.hpp"

namespace holdfast::viewer {
namespace {

using test::pose_at;
using test::ReceivedMessage;
using ::testing::ElementsAre;
using ::testing::FloatEq;
using ::testing::IsEmpty;
using ::testing::SizeIs;

constexpr int path_row = 9;

TEST(SceneTest, TellsABrowserEverythingOnceAndThenWhatHasChanged) {
  Scene scene({.title = "a run"});
  scene.set_map(test::row_map(3));
  scene.add(test::row_frame(0));
  Progress progress;
  const ReceivedMessage first(scene.update(progress));
  EXPECT_EQ(first.json["head"]["title"], "a run");
  EXPECT_THAT(first.array<std::uint32_t>("point_slots"), ElementsAre(0, 1, 2));
  EXPECT_THAT(first.array<std::uint32_t>("keyframe_slots"), ElementsAre(0, 1, 2));
  EXPECT_THAT(first.array<std::uint32_t>("covisibility"), ElementsAre(0, 1, 1, 2));
  EXPECT_THAT(first.array<double>("path_stamps"), ElementsAre(0.0));
  EXPECT_EQ(first.json["state"]["points"], 3);
  EXPECT_THAT(first.json["frames"], SizeIs(1));
  EXPECT_EQ(scene.update(progress), "") << "nothing is new";

  MapSnapshot map = test::row_map(3);
  map.points[1].position.x() += 0.5;
  map.points[2].position.x() += 1e-5;  // not worth a message
  scene.set_map(map);
  const ReceivedMessage second(scene.update(progress));
  EXPECT_THAT(second.array<std::uint32_t>("point_slots"), ElementsAre(1));
  EXPECT_THAT(second.array<float>("point_values"), ElementsAre(1.5F, 0.0F, 2.0F, 1.0F));
  for (const char* unchanged : {"keyframe_slots", "covisibility", "path_stamps"})
    EXPECT_FALSE(second.has(unchanged)) << unchanged;
  EXPECT_FALSE(second.json.contains("head"));
}

TEST(SceneTest, ABrowserThatComesLateGetsTheSameWhole) {
  Scene scene({});
  Progress early;
  for (std::uint32_t i = 0; i < 5; ++i) {
    scene.set_map(test::row_map(i + 1));
    scene.add(test::row_frame(i));
    scene.update(early);
  }
  Progress late;
  const ReceivedMessage message(scene.update(late));
  EXPECT_THAT(message.array<std::uint32_t>("point_slots"), SizeIs(5));
  EXPECT_THAT(message.array<double>("path_stamps"), SizeIs(5));
  EXPECT_THAT(message.json["frames"], SizeIs(5));
  EXPECT_EQ(scene.update(early), "");
}

TEST(SceneTest, TellsWhichPointsAreGone) {
  Scene scene({});
  scene.set_map(test::row_map(3));
  Progress progress;
  scene.update(progress);
  MapSnapshot map = test::row_map(3);
  map.points.erase(map.points.begin() + 1);
  map.points[1].id.generation = 1;  // another point in the slot of one that is gone
  map.keyframes.pop_back();
  scene.set_map(map);
  const ReceivedMessage message(scene.update(progress));
  EXPECT_THAT(message.array<std::uint32_t>("point_slots"), ElementsAre(1, 2));
  EXPECT_TRUE(std::isnan(message.array<float>("point_values")[3]));
  EXPECT_THAT(message.array<float>("point_values")[7], FloatEq(1.0F));
  EXPECT_THAT(message.array<std::uint32_t>("keyframe_slots"), ElementsAre(2));
  EXPECT_EQ(message.array<float>("keyframe_values")[7], 0.0F);
}

TEST(SceneTest, TellsTheClassesOfPoints) {
  Scene scene({});
  Progress progress;
  scene.set_map(test::row_map(3));
  EXPECT_FALSE(ReceivedMessage(scene.update(progress)).has("point_classes")) << "nothing is known of classes";

  scene.set_classes({"background", "person"});
  const std::vector<ViewedClass> classes{{test::point_id(1), 1}, {test::point_id(3), 1}, {test::point_id(2, 5), 1}};
  scene.add(classes);
  ReceivedMessage message(scene.update(progress));
  EXPECT_THAT(message.json["head"]["classes"], ElementsAre("background", "person"));
  EXPECT_THAT(message.array<std::uint32_t>("point_slots"), ElementsAre(1));
  EXPECT_THAT(message.array<std::uint8_t>("point_classes"), ElementsAre(1));
  EXPECT_THAT(message.array<float>("point_values"), ElementsAre(1, 0, 2, 1)) << "with its place, as in every row";

  scene.set_map(test::row_map(4));  // brings point 3, whose class came before it
  message = ReceivedMessage(scene.update(progress));
  EXPECT_THAT(message.array<std::uint32_t>("point_slots"), ElementsAre(3));
  EXPECT_THAT(message.array<std::uint8_t>("point_classes"), ElementsAre(1));

  MapSnapshot map = test::row_map(4);
  map.points[1].id.generation = 1;  // another point in the slot
  scene.set_map(map);
  message = ReceivedMessage(scene.update(progress));
  EXPECT_THAT(message.array<std::uint8_t>("point_classes"), ElementsAre(255));

  Progress late;
  EXPECT_THAT(ReceivedMessage(scene.update(late)).array<std::uint8_t>("point_classes"), ElementsAre(255, 255, 255, 1));
}

TEST(SceneTest, BringsTheDenseCloudWithTheRestOfTheMap) {
  Scene scene({});
  MapSnapshot map = test::row_map(2);
  map.keyframes[1].T_world_camera = pose_at(1, 4);
  scene.set_map(map);
  scene.add(ViewedSurface{test::keyframe_id(1), 1.0, pose_at(1), {{0, 0, 2, 1, 2, 3}}});
  Progress progress;
  ReceivedMessage message(scene.update(progress));
  EXPECT_EQ(message.array<float>("surface_poses")[1], 4.0F) << "where the keyframe is now";
  EXPECT_EQ(scene.update(progress), "");
  ViewedRun run;
  run.cloud = {{5, 6, 7, 1, 2, 3}};
  scene.set_run(run);
  message = ReceivedMessage(scene.update(progress));
  EXPECT_EQ(message.json["new_cloud"], true);
  EXPECT_THAT(message.array<float>("surface_places"), ElementsAre(5, 6, 7));
}

TEST(SceneTest, ThePathFollowsItsKeyframesAfterALoop) {
  Scene scene({});
  scene.set_map(test::row_map(3));
  for (std::uint32_t i = 0; i < 3; ++i) scene.add(test::row_frame(i, 0.25));
  Progress progress;
  scene.update(progress);

  MapSnapshot map = test::row_map(3);
  map.keyframes[2].T_world_camera = pose_at(2.0, 1.0);  // the loop moves the last keyframe
  map.loops.push_back({test::keyframe_id(0), test::keyframe_id(2)});
  scene.set_map(map);
  scene.add_loop(test::keyframe_id(2), test::keyframe_id(0));
  const ReceivedMessage message(scene.update(progress));
  EXPECT_THAT(message.array<std::uint32_t>("moved_path"), ElementsAre(2));
  const std::vector<float> moved = message.array<float>("moved_path_values");
  EXPECT_THAT(std::vector<float>(moved.begin(), moved.begin() + 3), ElementsAre(2.25F, 1.0F, 0.0F));
  EXPECT_THAT(message.array<std::uint32_t>("loops"), ElementsAre(0, 2));
  EXPECT_EQ(message.json["closed_loops"], 1);
  EXPECT_FALSE(message.has("path_stamps"));

  Progress late;  // finds the path where it is now
  const std::vector<float> path = ReceivedMessage(scene.update(late)).array<float>("path_values");
  EXPECT_EQ(path[2 * path_row + 1], 1.0F);
}

TEST(SceneTest, AFrameFollowsTheNearestKeyframeWhenItsOwnIsGone) {
  Scene scene({});
  scene.set_map(test::row_map(3));
  scene.add(test::row_frame(1, 0.25));
  MapSnapshot map = test::row_map(3);
  map.keyframes.erase(map.keyframes.begin() + 1);
  map.keyframes[0].T_world_camera = pose_at(0.0, 0.0, 3.0);
  map.keyframes[1].T_world_camera = pose_at(2.0, 1.0);
  scene.set_map(map);
  Progress progress;
  const std::vector<float> path = ReceivedMessage(scene.update(progress)).array<float>("path_values");
  EXPECT_EQ(path[1], 1.0F) << "frame at 1.25 s, keyframes at 0 s and 2 s";
  EXPECT_EQ(path[2], 0.0F);
}

TEST(SceneTest, SendsThePictureWithWhatIsDrawnOverIt) {
  Scene scene({.picture_width = 100});
  ViewedPicture picture;
  picture.index = 7;
  picture.colour = cv::Mat(160, 200, CV_8UC3, cv::Scalar(10, 200, 30));
  picture.features = {{12.5F, 3.0F, 1.0F, true}, {199.0F, 159.0F, 0.0F, false}};
  picture.points = {test::point_id(4)};
  picture.moving_features = {Eigen::Vector3f(1, 2, 3)};
  picture.mask = {0, 1, 1, 0x70};
  picture.mask_columns = 2;
  scene.set_picture(picture);
  Progress progress;
  const ReceivedMessage message(scene.update(progress));
  EXPECT_EQ(message.json["picture"]["frame"], 7);
  EXPECT_EQ(message.json["picture"]["mask_columns"], 2);
  const cv::Mat decoded = cv::imdecode(message.array<std::uint8_t>("jpeg"), cv::IMREAD_COLOR);
  EXPECT_EQ(decoded.size(), cv::Size(100, 80));
  EXPECT_NEAR(decoded.at<cv::Vec3b>(40, 50)[1], 200, 4);
  EXPECT_THAT(message.array<std::uint16_t>("feature_places"), ElementsAre(200, 48, 3184, 2544));
  EXPECT_THAT(message.array<std::uint8_t>("feature_kinds"), ElementsAre(255, 0));
  EXPECT_THAT(message.array<std::uint32_t>("seen_points"), ElementsAre(4));
  EXPECT_THAT(message.array<float>("moving_features"), ElementsAre(1, 2, 3));
  EXPECT_THAT(message.array<std::uint8_t>("mask"), ElementsAre(0, 1, 1, 0x70));
}

TEST(SceneTest, KeepsTrailsOfMovingObjectsWhileTheyAreSeen) {
  Scene scene({});
  FrameResult frame = test::row_frame(1);
  MovingObject seen, hidden;
  seen.id = 3, hidden.id = 4;
  seen.class_name = "person\"<b>";
  seen.T_world_object = pose_at(5, 6, 7);
  seen.last_seen = frame.timestamp;
  hidden.last_seen = 0.5;
  frame.objects = {seen, hidden};
  scene.add(frame);
  Progress progress;
  const ReceivedMessage message(scene.update(progress));
  EXPECT_THAT(message.json["objects"], SizeIs(2));
  EXPECT_EQ(message.json["objects"][0]["class"], "person\"<b>");
  EXPECT_EQ(message.json["objects"][1]["hidden"], true);
  EXPECT_THAT(message.array<std::uint32_t>("trail_ids"), ElementsAre(3));
  EXPECT_THAT(message.array<float>("trail_places"), ElementsAre(5, 6, 7));
  scene.add(test::row_frame(2));
  EXPECT_FALSE(ReceivedMessage(scene.update(progress)).has("trail_ids"));
}

TEST(SceneTest, ShowsARunThatHasEndedWithItsErrorsAndTruth) {
  Scene scene({});
  scene.add(test::row_frame(0));
  Progress progress;
  scene.update(progress);
  ViewedRun run;
  run.title = "ended";
  run.path = {{0.0, pose_at(0)}, {1.0, pose_at(1)}};
  run.errors = {0.25F, 0.5F};
  run.truth = {{0.5, Eigen::Vector3d(1, 2, 3)}};
  run.figures = {{"ATE RMSE", "3 mm"}};
  scene.set_run(run);
  const ReceivedMessage message(scene.update(progress));
  EXPECT_EQ(message.json["new_path"], true);
  EXPECT_EQ(message.json["head"]["title"], "ended");
  EXPECT_EQ(message.json["state"]["finished"], true);
  const std::vector<float> path = message.array<float>("path_values");
  ASSERT_THAT(path, SizeIs(2 * path_row));
  EXPECT_EQ(path[2 * path_row - 1], 0.5F);
  EXPECT_THAT(message.array<double>("truth_stamps"), ElementsAre(0.5));
  EXPECT_THAT(message.array<float>("truth_places"), ElementsAre(1, 2, 3));
  EXPECT_EQ(message.json["run"]["figures"][0][1], "3 mm");
  EXPECT_EQ(message.json["run"]["has_errors"], true);
}

}  // namespace
}  // namespace holdfast::viewer
