// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <unistd.h>

#include "holdfast/interfaces/observer.hpp"
#include "holdfast/plugin/registry.hpp"
#include "holdfast/viewer/viewer.hpp"
#include "picture.hpp"
#include "point_classes.hpp"
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

TEST(ViewerObserverTest, ShowsClassesAndTheDenseCloud) {
  Registry registry;
  holdfast_register_plugin_viewer(registry);
  const CreationContext context;
  const auto observer = registry.create<Observer>("viewer", {}, context);
  test::SocketClient client{test::ViewerAddress(running_viewers().front()->address())};
  observer->on_start({"background", "person"});
  ObservedView view{.keyframe = test::keyframe_id(0), .T_world_camera = test::pose_at(3)};
  std::size_t asked = 0;
  view.points = [&](std::size_t most) {
    asked = most;
    return std::vector<CloudPoint>{{0, 0, 2, 1, 2, 3}};
  };
  observer->on_static_view(view);
  EXPECT_LE(asked, 5000U);
  Frame frame = two_features(context.camera);
  frame.coarse.grid = CoarseSampler(context.camera).grid();
  frame.coarse.mask.assign(static_cast<std::size_t>(frame.coarse.grid.size()), 1, 255);
  SensorFrame sensor_frame;
  sensor_frame.colour = cv::Mat(context.camera.height, context.camera.width, CV_8UC3, cv::Scalar::all(80));
  observer->on_frame(sensor_frame, frame, test::row_frame(1));
  observer->on_keyframe(test::keyframe_id(0), ObservedMap([] { return test::row_map(6); }));
  bool has_cloud = false, has_classes = false;
  client.receive_until([&](const ReceivedMessage& m) {
    has_cloud = has_cloud || m.array<float>("surface_places") == std::vector<float>{0, 0, 2};
    const auto slots = m.array<std::uint32_t>("point_slots");
    const auto classes = m.array<std::uint8_t>("point_classes");
    for (std::size_t i = 0; i < classes.size(); ++i) has_classes = has_classes || (slots[i] == 4 && classes[i] == 1);
    return has_cloud && has_classes;
  });
}

TEST(ViewerObserverTest, ShowsWhatHasChangedOfTheSurfaceToWhoeverWatches) {
  Registry registry;
  holdfast_register_plugin_viewer(registry);
  const auto observer = registry.create<Observer>("viewer", {}, {});
  std::vector<std::uint64_t> asked_since;
  const auto surface_at = [&](std::uint64_t version) {
    return ObservedSurface{version, [&, version](std::uint64_t since, int coarseness) {
                             EXPECT_EQ(coarseness, 0);
                             asked_since.push_back(since);
                             const float height = static_cast<float>(version);
                             SurfacePatch patch{{1, 2, 3}, std::vector<MeshVertex>(3), {{0, 1, 2}}};
                             for (MeshVertex& vertex : patch.vertices) vertex.position.z() = height;
                             return std::vector<SurfacePatch>{patch};
                           }};
  };
  observer->on_surface(surface_at(1));
  EXPECT_THAT(asked_since, SizeIs(0)) << "nobody watches";

  test::SocketClient client{test::ViewerAddress(running_viewers().front()->address())};
  client.receive();
  observer->on_surface(surface_at(2));
  observer->on_surface(surface_at(3));
  EXPECT_THAT(asked_since, ElementsAre(0)) << "and no more than once a second";
  const auto brings_height = [](float height) {
    return [height](const ReceivedMessage& m) {
      const std::vector<float> places = m.array<float>("patch_places");
      return places.size() == 9 && places[2] == height;
    };
  };
  client.receive_until(brings_height(2.0F));
  while (asked_since.size() < 2) {
    usleep(50'000);
    observer->on_surface(surface_at(4));
  }
  EXPECT_THAT(asked_since, ElementsAre(0, 2));
  client.receive_until(brings_height(4.0F));
}

TEST(ViewerObserverTest, AProgramCanKeepTheViewerBeyondTheRun) {
  Registry registry;
  holdfast_register_plugin_viewer(registry);
  auto observer = registry.create<Observer>("viewer", {}, {});
  const std::vector<std::shared_ptr<Viewer>> kept = running_viewers();
  observer.reset();
  EXPECT_EQ(running_viewers(), kept);
}

/// A frame that sees point 4, with a mask of one label.
Frame labelled_frame(std::uint8_t label, std::uint32_t generation = 0) {
  static const Camera camera;
  Frame frame = two_features(camera);
  frame.map_points[0].generation = generation;
  frame.coarse.grid = CoarseSampler(camera).grid();
  frame.coarse.mask.assign(static_cast<std::size_t>(frame.coarse.grid.size()), label, 255);
  return frame;
}

TEST(PointClassesTest, TheMajorityOfMasksDecides) {
  viewer_plugin::PointClasses classes;
  const auto change = [&](std::uint8_t label, std::uint32_t generation = 0) {
    const std::vector<ViewedClass> changes = classes.add(labelled_frame(label, generation));
    EXPECT_LE(changes.size(), 1U);
    if (changes.empty()) return -1;
    EXPECT_EQ(changes[0].point, test::point_id(4, generation));
    return static_cast<int>(changes[0].label);
  };
  EXPECT_EQ(change(CellMask::unknown), -1) << "says nothing";
  EXPECT_EQ(change(0), 0);
  EXPECT_EQ(change(0), -1);
  EXPECT_EQ(change(2), -1) << "one against two";
  EXPECT_EQ(change(2), -1) << "a draw leaves it";
  EXPECT_EQ(change(2), 2);
  for (int i = 0; i < 100; ++i) EXPECT_EQ(change(2), -1);
  int frames = 1;
  while (change(0) != 0 && frames < 100) ++frames;
  EXPECT_LE(frames, 25) << "what was long is not for ever";
  EXPECT_EQ(change(1, 7), 1) << "another point in the same slot begins anew";
  Frame unmasked = labelled_frame(1, 9);
  unmasked.coarse.mask.clear();
  EXPECT_THAT(classes.add(unmasked), SizeIs(0));
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
