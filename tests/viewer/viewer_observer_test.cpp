// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include "holdfast/interfaces/observer.hpp"
#include "holdfast/plugin/registry.hpp"
#include "holdfast/viewer/viewer.hpp"
#include "picture.hpp"
#include "viewer/socket_client.hpp"
#include "viewer/viewed_world.hpp"

extern "C" void holdfast_register_plugin_viewer(holdfast::Registry&);

namespace holdfast {
namespace {

using test::ReceivedMessage;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::SizeIs;

/// A frame with two features: one static with a map point, one that moves and has depth.
Frame two_features(const Camera& camera) {
  Frame frame;
  frame.camera = std::make_shared<Camera>(camera);
  frame.features.x = frame.x = {100.0F, static_cast<float>(camera.cx)};
  frame.features.y = frame.y = {50.0F, static_cast<float>(camera.cy)};
  frame.depth = {0.0F, 2.0F};
  frame.map_points = {test::point_id(4), MapPointId()};
  frame.static_probability = {0.9F, 0.1F};
  return frame;
}

TEST(ViewerObserverTest, ShowsFramesMapAndPictureToABrowser) {
  Registry registry;
  holdfast_register_plugin_viewer(registry);
  const CreationContext context{.output_directory = "out/name"};
  const auto observer = registry.create<Observer>("viewer", {}, context);
  ASSERT_THAT(running_viewers(), SizeIs(1));
  const std::shared_ptr<Viewer> viewer = running_viewers().front();

  int snapshots = 0;
  const ObservedMap map([&] {
    ++snapshots;
    return test::row_map(3);
  });
  observer->on_keyframe(test::keyframe_id(0), map);
  observer->on_keyframe(test::keyframe_id(1), map);
  EXPECT_EQ(snapshots, 1) << "without a browser a snapshot every two seconds at most";

  test::SocketClient client{test::ViewerAddress(viewer->address())};
  const ReceivedMessage first = client.receive_until([](const ReceivedMessage& m) { return m.has("point_slots"); });
  EXPECT_EQ(first.json["head"]["title"], "name");
  SensorFrame sensor_frame;
  sensor_frame.index = 12;
  sensor_frame.colour = cv::Mat(context.camera.height, context.camera.width, CV_8UC3, cv::Scalar::all(80));
  observer->on_frame(sensor_frame, two_features(context.camera), test::row_frame(1));
  const ReceivedMessage second = client.receive_until([](const ReceivedMessage& m) { return m.has("jpeg"); });
  EXPECT_EQ(second.json["picture"]["frame"], 12);
  EXPECT_THAT(second.array<std::uint32_t>("seen_points"), ElementsAre(4));
  EXPECT_THAT(second.array<float>("moving_features"), ElementsAre(1, 0, 2)) << "two metres ahead of the camera";

  MapSnapshot closed = test::row_map(3);
  closed.loops.push_back({test::keyframe_id(0), test::keyframe_id(2)});
  observer->on_loop(test::keyframe_id(2), test::keyframe_id(0), ObservedMap([&] { return closed; }));
  client.receive_until([](const ReceivedMessage& m) { return m.json.value("closed_loops", 0) == 1; });
  observer->on_finish(Map());
  client.receive_until([](const ReceivedMessage& m) { return m.has("point_slots") && m.json["state"]["points"] == 0; });
}

TEST(ViewerObserverTest, AProgramCanKeepTheViewerBeyondTheRun) {
  Registry registry;
  holdfast_register_plugin_viewer(registry);
  auto observer = registry.create<Observer>("viewer", {}, {});
  const std::vector<std::shared_ptr<Viewer>> kept = running_viewers();
  observer.reset();
  EXPECT_EQ(running_viewers(), kept);
}

TEST(PictureMakerTest, SamplesMaskAndMotionOnTheRawImage) {
  Camera camera;
  camera.width = 64, camera.height = 48;
  camera.fx = camera.fy = 60.0, camera.cx = 31.5, camera.cy = 23.5;
  const viewer_plugin::PictureMaker maker(camera);
  Frame frame;
  frame.camera = std::make_shared<Camera>(camera);
  frame.coarse.grid = CoarseSampler(camera).grid();
  const auto cells = static_cast<std::size_t>(frame.coarse.grid.size());
  frame.coarse.mask.assign(cells, 1, 255);
  frame.coarse.static_log_odds.assign(cells, -4.0F);
  SensorFrame sensor_frame;
  sensor_frame.colour = cv::Mat(48, 64, CV_8UC3, cv::Scalar::all(1));
  const ViewedPicture picture = maker.make(sensor_frame, frame, {});
  EXPECT_EQ(picture.mask_columns, 8);
  EXPECT_THAT(picture.mask, SizeIs(48));
  EXPECT_THAT(picture.mask, Each(0xF1)) << "class 1, certainly moving";
  EXPECT_NE(picture.colour.data, sensor_frame.colour.data) << "the image belongs to the source";

  frame.coarse.static_log_odds.clear();
  frame.coarse.mask.assign(cells, CellMask::unknown, 255);
  EXPECT_THAT(maker.make(sensor_frame, frame, {}).mask, Each(7));
  frame.coarse.mask.clear();
  EXPECT_THAT(maker.make(sensor_frame, frame, {}).mask, SizeIs(0));
}

}  // namespace
}  // namespace holdfast
