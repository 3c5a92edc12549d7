// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/bridge/bridge.hpp"
#include "holdfast/bridge/node_parameters.hpp"

#include <gmock/gmock.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <filesystem>
#include <fstream>
#include <future>
#include <mutex>
#include <opencv2/imgproc.hpp>
#include <thread>

#include "holdfast/core/error.hpp"
#include "holdfast/holdfast.hpp"
#ifdef HOLDFAST_PLUGIN_FOXGLOVE
#include "holdfast/web_server/socket_server.hpp"
#endif

namespace holdfast::bridge {
namespace {

namespace fs = std::filesystem;
using testing::Contains;
using testing::HasSubstr;
using Level = Diagnostics::Level;

/// Keeps what the bridge finds.
class Recorder final : public Listener {
 public:
  void on_frame(const FrameOutput& frame) override { frames.push_back(frame); }
  void on_map(const MapOutput& map) override { maps.push_back(map); }
  void on_grid(const GridOutput& grid) override { grids.push_back(grid); }
  void on_message(Level, const std::string& text) override { messages.push_back(text); }
  std::optional<Eigen::Isometry3d> odometry(Stamp) override { return wheels; }

  std::vector<FrameOutput> frames;
  std::vector<MapOutput> maps;
  std::vector<GridOutput> grids;
  std::vector<std::string> messages;
  std::optional<Eigen::Isometry3d> wheels;
};

/// The frames of a walk through the simulated office, made once.
const std::vector<SensorFrame>& office() {
  static const std::vector<SensorFrame> frames = [] {
    Registry registry;
    register_builtin_plugins(registry);
    const auto source = registry.create<FrameSource>("simulated", {{"path", "xyz"}, {"duration", 1.5}}, {});
    std::vector<SensorFrame> all;
    while (auto frame = source->next()) all.push_back(std::move(*frame));
    return all;
  }();
  return frames;
}

CameraInfo office_camera() {
  Registry registry;
  register_builtin_plugins(registry);
  const Camera camera = registry.create<FrameSource>("simulated", {{"duration", 0.1}}, {})->describe().camera.value();
  CameraInfo info;
  info.width = static_cast<std::uint32_t>(camera.width), info.height = static_cast<std::uint32_t>(camera.height);
  info.distortion_model = "plumb_bob";
  const Distortion& d = camera.distortion;
  info.D = {d.k1, d.k2, d.p1, d.p2, d.k3};
  info.K = {camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1};
  return info;
}

constexpr Stamp first_stamp = 1'700'000'000'123'456'789;  // odd nanoseconds, as of a real clock

Stamp stamp_of(const SensorFrame& frame) { return first_stamp + std::llround(frame.timestamp * 1e9); }

RawImage message_of(const cv::Mat& image, const char* encoding, Stamp stamp) {
  return {stamp,
          static_cast<std::uint32_t>(image.cols),
          static_cast<std::uint32_t>(image.rows),
          encoding,
          false,
          image.step[0],
          image.data,
          image.step[0] * static_cast<std::size_t>(image.rows)};
}

class BridgeTest : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(testing::TempDir()) / ("holdfast_bridge_" + std::to_string(getpid()) + "_" +
                                              testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::create_directories(folder_);
    write("source: bridge\ncamera: auto\nfeatures: { orb: { count: 800 } }\noptimizer: schur\nloop_detector: flann\n");
  }
  void TearDown() override { fs::remove_all(folder_); }

  void write(const std::string& yaml) { std::ofstream(folder_ / "pipeline.yaml") << yaml; }
  Parameters parameters() const {
    Parameters p;
    p.configuration = (folder_ / "pipeline.yaml").string();
    p.is_sequential = true;
    return p;
  }
  static void feed(Bridge& bridge, std::size_t first, std::size_t count, Stamp later = 0) {
    for (std::size_t i = first; i < std::min(first + count, office().size()); ++i) {
      const SensorFrame& frame = office()[i];
      bridge.add_colour(message_of(frame.colour, "bgr8", stamp_of(frame) + later));
      bridge.add_depth(message_of(frame.depth, "32FC1", stamp_of(frame) + later));
    }
    bridge.finish();
  }
  std::string file(const char* name) const { return (folder_ / name).string(); }

  fs::path folder_;
  Recorder recorder_;
};

/// Pose of frame `i` relative to the first one, as the truth has it.
Eigen::Isometry3d true_motion(std::size_t i) {
  return office()[0].truth->T_world_camera->inverse() * *office()[i].truth->T_world_camera;
}

TEST_F(BridgeTest, GivesThePosesOfTheRobotWithTheStampsOfTheImages) {
  Bridge bridge(parameters(), recorder_);
  bridge.set_camera(office_camera());
  // A camera that sits ahead, to the left and above of the robot's origin, and looks down a little.
  Eigen::Isometry3d T_base_camera = Eigen::Isometry3d::Identity();
  T_base_camera.linear() << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  T_base_camera.linear() = Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitY()) * T_base_camera.linear();
  T_base_camera.translation() = Eigen::Vector3d(0.2, 0.1, 0.5);
  bridge.set_camera_pose(T_base_camera);
  feed(bridge, 0, 40);
  ASSERT_EQ(recorder_.frames.size(), 40U) << (recorder_.messages.empty() ? "" : recorder_.messages.back());
  for (std::size_t i = 0; i < 40; ++i) {
    const FrameOutput& frame = recorder_.frames[i];
    EXPECT_EQ(frame.stamp, stamp_of(office()[i])) << i;
    ASSERT_TRUE(frame.has_pose) << i;
    const Eigen::Isometry3d expected = T_base_camera * true_motion(i) * T_base_camera.inverse();
    EXPECT_LT((frame.T_map_base.translation() - expected.translation()).norm(), 0.02) << i;
    EXPECT_LT(((frame.T_map_odom * frame.T_odom_base).matrix() - frame.T_map_base.matrix()).norm(), 1e-9) << i;
    EXPECT_EQ(frame.covariance.norm() > 0.0, i > 0) << i;
  }
  const FrameOutput& before = recorder_.frames[20];
  const FrameOutput& after = recorder_.frames[21];
  const double seconds = 1e-9 * static_cast<double>(after.stamp - before.stamp);
  EXPECT_NEAR(after.velocity.head<3>().norm() * seconds,
              (after.T_odom_base.translation() - before.T_odom_base.translation()).norm(), 1e-6);
  ASSERT_FALSE(recorder_.maps.empty());
  EXPECT_GT(recorder_.maps.back().points.size(), 300U);
  EXPECT_EQ(recorder_.maps.back().keyframes.front().second.matrix(), recorder_.frames[0].T_map_base.matrix());
  EXPECT_EQ(bridge.diagnostics().level, Level::ok) << bridge.diagnostics().message;
  EXPECT_THAT(bridge.diagnostics().values, Contains(std::pair<std::string, std::string>("answered", "40")));
}

TEST_F(BridgeTest, TwiceTheSameFramesGiveTheSameBits) {
  Recorder second;
  for (Recorder* recorder : {&recorder_, &second}) {
    Bridge bridge(parameters(), *recorder);
    bridge.set_camera(office_camera());
    feed(bridge, 0, 20);
  }
  ASSERT_EQ(recorder_.frames.size(), second.frames.size());
  for (std::size_t i = 0; i < second.frames.size(); ++i)
    EXPECT_EQ(recorder_.frames[i].T_map_base.matrix(), second.frames[i].T_map_base.matrix()) << i;
}

TEST_F(BridgeTest, ThreadedItAnswersWhatItDoesNotDrop) {
  Parameters p = parameters();
  p.is_sequential = false;
  p.queue = 3;
  Bridge bridge(p, recorder_);
  bridge.set_camera(office_camera());
  feed(bridge, 0, 30);
  std::uint64_t dropped = 0;
  for (const auto& [name, value] : bridge.diagnostics().values)
    if (name == "dropped") dropped = std::stoull(value);
  EXPECT_EQ(recorder_.frames.size() + dropped, 30U);
  EXPECT_GE(recorder_.frames.size(), 3U);
  EXPECT_EQ(recorder_.frames.back().stamp, stamp_of(office()[29])) << "the newest frame is never dropped";
}

TEST_F(BridgeTest, WaitsForTheCameraAndSaysSo) {
  Bridge bridge(parameters(), recorder_);
  EXPECT_THAT(bridge.diagnostics().message, HasSubstr("no colour image"));
  feed(bridge, 0, 2);
  EXPECT_TRUE(recorder_.frames.empty());
  EXPECT_THAT(bridge.diagnostics().message, HasSubstr("no camera_info"));
  bridge.set_camera(office_camera());
  feed(bridge, 2, 2);
  EXPECT_EQ(recorder_.frames.size(), 2U);
}

TEST_F(BridgeTest, SavesAMapAndLocalisesInIt) {
  Eigen::Isometry3d last;
  {
    Bridge bridge(parameters(), recorder_);
    bridge.set_camera(office_camera());
    EXPECT_THROW(bridge.save_map(file("map.hfm")), Error) << "there is none yet";
    feed(bridge, 0, 40);
    bridge.save_map(file("map.hfm"));
    EXPECT_THROW(bridge.save_map((folder_ / "nowhere" / "map.hfm").string()), InputError);
    EXPECT_THROW(bridge.load_map(file("nothing.hfm"), true), InputError);
    last = recorder_.frames.back().T_map_base;
    // The run has gone on.
    feed(bridge, 40, 2);
    EXPECT_EQ(recorder_.frames.size(), 42U);
  }
  const Map map = read_map(file("map.hfm"));
  EXPECT_GE(map.keyframes().size(), 2U);
  Recorder localised;
  Bridge bridge(parameters(), localised);
  bridge.set_camera(office_camera());
  bridge.load_map(file("map.hfm"), true);
  feed(bridge, 30, 10);
  ASSERT_EQ(localised.frames.size(), 10U);
  ASSERT_TRUE(localised.frames.back().has_pose);
  EXPECT_LT((localised.frames.back().T_map_base.translation() - last.translation()).norm(), 0.02);
  bridge.save_map(file("again.hfm"));
  EXPECT_EQ(read_map(file("again.hfm")).keyframes().size(), map.keyframes().size()) << "localising changes nothing";
}

TEST_F(BridgeTest, BeginsWithAMapOfAFile) {
  {
    Bridge bridge(parameters(), recorder_);
    bridge.set_camera(office_camera());
    feed(bridge, 0, 30);
    bridge.save_map(file("map.hfm"));
  }
  Parameters p = parameters();
  p.map_file = file("map.hfm");
  Recorder continued;
  Bridge bridge(p, continued);
  bridge.set_camera(office_camera());
  feed(bridge, 20, 5, 10'000'000'000);
  ASSERT_EQ(continued.frames.size(), 5U);
  ASSERT_TRUE(continued.frames.back().has_pose);
  EXPECT_LT((continued.frames.back().T_map_base.translation() - recorder_.frames[24].T_map_base.translation()).norm(),
            0.02);
  p.map_file = file("nothing.hfm");
  EXPECT_THROW(Bridge(p, continued), InputError);
}

// Descriptors of another kind cannot be matched: an operator must see it, and not a robot that stays lost.
TEST_F(BridgeTest, AMapOfAnotherExtractorIsAnError) {
  {
    Bridge bridge(parameters(), recorder_);
    bridge.set_camera(office_camera());
    feed(bridge, 0, 10);
    bridge.save_map(file("map.hfm"));
  }
  Parameters p = parameters();
  p.map_file = file("map.hfm");
  p.localise_only = true;
  p.overrides = {"features=akaze"};
  Recorder other;
  Bridge bridge(p, other);
  bridge.set_camera(office_camera());
  feed(bridge, 0, 3);
  const Diagnostics diagnosis = bridge.diagnostics();
  EXPECT_EQ(diagnosis.level, Diagnostics::Level::error);
  EXPECT_THAT(diagnosis.message, HasSubstr("akaze"));
  EXPECT_THAT(diagnosis.message, HasSubstr("orb"));
}

TEST_F(BridgeTest, NumbersThatCannotBeAreNamed) {
  const auto refused = [&](const char* name, const auto& change) {
    Parameters p = parameters();
    change(p);
    try {
      Bridge bridge(p, recorder_);
      ADD_FAILURE() << name << " was accepted";
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr(std::string("parameter '") + name + "': found "));
    }
  };
  for (const double value : {0.0, -1.0, std::nan("")}) {
    refused("map_interval", [=](Parameters& p) { p.map_interval = value; });
    refused("grid_interval", [=](Parameters& p) { p.grid_interval = value; });
    refused("depth_factor", [=](Parameters& p) { p.depth_factor = value; });
  }
  refused("tolerance", [](Parameters& p) { p.tolerance = -0.01; });
  refused("queue", [](Parameters& p) { p.queue = 0; });
}

TEST_F(BridgeTest, ParametersOfANodeFitTogether) {
  NodeParameters given;
  EXPECT_THROW(resolved(given), std::runtime_error) << "no configuration";
  given.bridge.configuration = "pipeline.yaml";
  given.bridge.map_file = "map.hfm";
  EXPECT_EQ(resolved(given).bridge.map_file, "") << "only services use it";
  EXPECT_THAT(resolved(given).bridge.overrides, testing::ElementsAre("surface.enabled=true"));
  given.start = "localise";
  EXPECT_TRUE(resolved(given).bridge.localise_only);
  EXPECT_EQ(resolved(given).bridge.map_file, "map.hfm");
  given.bridge.map_file.clear();
  EXPECT_THROW(resolved(given), std::runtime_error);
  given.start = "now";
  EXPECT_THROW(resolved(given), std::runtime_error);
  given.start = "new";
  given.transform_wait = -1.0;
  EXPECT_THROW(resolved(given), std::runtime_error);
}

TEST_F(BridgeTest, ResetBeginsANewMapAndPauseLeavesFramesOut) {
  Bridge bridge(parameters(), recorder_);
  bridge.set_camera(office_camera());
  feed(bridge, 0, 20);
  bridge.pause(true);
  EXPECT_EQ(bridge.diagnostics().message, "paused");
  feed(bridge, 20, 3);
  EXPECT_EQ(recorder_.frames.size(), 20U);
  bridge.pause(false);
  EXPECT_FALSE(bridge.is_paused());
  bridge.reset();
  feed(bridge, 23, 2);
  ASSERT_EQ(recorder_.frames.size(), 22U);
  EXPECT_LT((recorder_.frames[20].T_map_base.matrix() - Eigen::Matrix4d::Identity()).norm(), 1e-9)
      << "the map begins where the robot is";
}

TEST_F(BridgeTest, ABagThatIsPlayedAgainBeginsANewMap) {
  Bridge bridge(parameters(), recorder_);
  bridge.set_camera(office_camera());
  feed(bridge, 10, 5, 5'000'000'000);
  feed(bridge, 0, 3);
  ASSERT_EQ(recorder_.frames.size(), 8U);
  EXPECT_EQ(recorder_.frames[5].stamp, stamp_of(office()[0]));
  EXPECT_LT((recorder_.frames[5].T_map_base.matrix() - Eigen::Matrix4d::Identity()).norm(), 1e-9);
  EXPECT_THAT(recorder_.messages, Contains(HasSubstr("time went back")));
}

TEST_F(BridgeTest, AFrameThatCannotBeUsedIsCountedAndTheRunGoesOn) {
  Bridge bridge(parameters(), recorder_);
  bridge.set_camera(office_camera());
  feed(bridge, 0, 5);
  const cv::Mat small(10, 10, CV_8UC3, cv::Scalar::all(7));
  bridge.add_colour(message_of(small, "yuv422", stamp_of(office()[5])));
  bridge.add_colour(message_of(small, "bgr8", stamp_of(office()[6])));
  bridge.add_depth(message_of(office()[6].depth, "32FC1", stamp_of(office()[6])));
  feed(bridge, 7, 3);
  EXPECT_EQ(recorder_.frames.size(), 8U);
  EXPECT_THAT(recorder_.messages, Contains(HasSubstr("yuv422")));
  EXPECT_THAT(recorder_.messages, Contains(HasSubstr("frame left out")));
  EXPECT_THAT(bridge.diagnostics().values, Contains(std::pair<std::string, std::string>("unusable", "2")));
}

TEST_F(BridgeTest, ErrorsOfTheConfigurationComeAtOnce) {
  write("features: { orb: { cuont: 800 } }\noptimizer: schru\n");
  try {
    Bridge bridge(parameters(), recorder_);
    FAIL() << "no error";
  } catch (const ConfigurationError& error) {
    EXPECT_EQ(error.diagnostics().size(), 2U) << error.what();
    EXPECT_THAT(error.what(), HasSubstr("count"));
    EXPECT_THAT(error.what(), HasSubstr("schur"));
  }
}

#ifdef HOLDFAST_PLUGIN_FOXGLOVE
/// A port that is free now.
int free_port() {
  const int descriptor = socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof(address);
  EXPECT_EQ(bind(descriptor, reinterpret_cast<sockaddr*>(&address), size), 0);
  EXPECT_EQ(getsockname(descriptor, reinterpret_cast<sockaddr*>(&address), &size), 0);
  close(descriptor);
  return ntohs(address.sin_port);
}

/// Gives a map out for a long time.
class SlowMaps final : public Listener {
 public:
  void on_frame(const FrameOutput&) override { ++frames; }
  void on_map(const MapOutput&) override {
    if (!has_begun.exchange(true)) begun.set_value();
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
  }
  void on_grid(const GridOutput&) override {}
  void on_message(Level, const std::string& text) override { messages.push_back(text); }
  std::optional<Eigen::Isometry3d> odometry(Stamp) override { return std::nullopt; }

  std::atomic<int> frames = 0;
  std::promise<void> begun;
  std::atomic<bool> has_begun = false;
  std::vector<std::string> messages;
};

TEST_F(BridgeTest, AnObserverWithAPortSurvivesAReset) {
  write("source: bridge\ncamera: auto\nfeatures: orb\noptimizer: schur\nobservers: [{ foxglove: { port: " +
        std::to_string(free_port()) + ", token: abcdefgh } }]\n");
  Parameters p = parameters();
  p.map_interval = 0.01;
  SlowMaps listener;
  Bridge bridge(p, listener);
  bridge.set_camera(office_camera());
  const auto add = [&](std::size_t i) {
    bridge.add_colour(message_of(office()[i].colour, "bgr8", stamp_of(office()[i])));
    bridge.add_depth(message_of(office()[i].depth, "32FC1", stamp_of(office()[i])));
  };
  add(0);
  listener.begun.get_future().wait();
  bridge.reset();  // while the map of the old session is given out
  add(1);
  bridge.finish();
  EXPECT_EQ(listener.frames, 2);
  EXPECT_THAT(listener.messages, testing::ElementsAre(HasSubstr("foxglove: ws://127.0.0.1:"), HasSubstr("token=abc")));
}

// The first frame waits for a client that never comes: requests and the end of the bridge end that.
TEST_F(BridgeTest, NothingHangsWhereAnObserverWaits) {
  write("source: bridge\ncamera: auto\nfeatures: orb\noptimizer: schur\nobservers: [{ foxglove: { wait: true } }]\n");
  Bridge bridge(parameters(), recorder_);
  bridge.set_camera(office_camera());
  const auto add = [&](std::size_t i) {
    const std::size_t known = running_servers().size();
    bridge.add_colour(message_of(office()[i].colour, "bgr8", stamp_of(office()[i])));
    bridge.add_depth(message_of(office()[i].depth, "32FC1", stamp_of(office()[i])));
    while (running_servers().size() == known) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  };
  add(0);
  bridge.reset();
  EXPECT_EQ(recorder_.frames.size(), 1U) << "the frame that waited is answered";
  add(1);
}

/// Calls `act` in another thread when the bridge tells the address of an observer, before others can see the session.
class ActsAsASessionBegins final : public Listener {
 public:
  void on_frame(const FrameOutput&) override { ++frames; }
  void on_map(const MapOutput&) override {}
  void on_grid(const GridOutput&) override {}
  void on_message(Level, const std::string& text) override {
    if (text.find("ws://") == std::string::npos || done.valid()) return;
    done = std::async(std::launch::async, act);
    std::this_thread::sleep_for(std::chrono::milliseconds(200));  // so that it has found no session to interrupt
  }
  std::optional<Eigen::Isometry3d> odometry(Stamp) override { return std::nullopt; }

  std::function<void()> act;
  std::future<void> done;
  std::atomic<int> frames = 0;
};

// A request that comes while a session begins whose observer will wait: the session that it could not see must not
// wait.
TEST_F(BridgeTest, ARequestIsServedByASessionThatBeginsMeanwhile) {
  write("source: bridge\ncamera: auto\nfeatures: orb\noptimizer: schur\nobservers: [{ foxglove: { wait: true } }]\n");
  ActsAsASessionBegins listener;
  Bridge bridge(parameters(), listener);
  listener.act = [&] { bridge.reset(); };
  bridge.set_camera(office_camera());
  bridge.add_colour(message_of(office()[0].colour, "bgr8", stamp_of(office()[0])));
  bridge.add_depth(message_of(office()[0].depth, "32FC1", stamp_of(office()[0])));
  for (int i = 0; i < 3000 && listener.frames == 0; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  EXPECT_EQ(listener.frames, 1) << "the session waits for a client that never comes";
  if (listener.frames == 0) bridge.reset();  // interrupts it
  ASSERT_TRUE(listener.done.valid());
  listener.done.get();
}
#endif

TEST_F(BridgeTest, TheSourceOfAConfigurationIsReplacedAndItsCameraCounts) {
  write(
      "source: { tum: { path: not_here } }\ncamera: { width: 640, height: 480, fx: 480, fy: 480, cx: 320, cy: 240 "
      "}\nfeatures: orb\noptimizer: schur\n");
  Parameters p = parameters();
  p.overrides = {"features.orb.count=700"};
  Bridge bridge(p, recorder_);
  bridge.set_camera(office_camera());
  feed(bridge, 0, 3);
  EXPECT_EQ(recorder_.frames.size(), 3U);
  EXPECT_THAT(recorder_.messages, Contains(HasSubstr("write `camera: auto`")));
}

TEST_F(BridgeTest, FollowsTheOdometryOfTheWheels) {
  recorder_.wheels = Eigen::Isometry3d(Eigen::Translation3d(3, 2, 0));
  Bridge bridge(parameters(), recorder_);
  bridge.set_camera(office_camera());
  feed(bridge, 0, 3);
  ASSERT_EQ(recorder_.frames.size(), 3U);
  for (const FrameOutput& frame : recorder_.frames) {
    EXPECT_EQ(frame.T_odom_base.matrix(), recorder_.wheels->matrix());
    EXPECT_LT(((frame.T_map_odom * frame.T_odom_base).matrix() - frame.T_map_base.matrix()).norm(), 1e-9);
  }
}

#if defined(HOLDFAST_SURFACE)
TEST_F(BridgeTest, GivesTheFloorAsAGridInTheAxesOfTheMap) {
  Parameters p = parameters();
  p.overrides = {"surface.enabled=true"};
  Bridge bridge(p, recorder_);
  bridge.set_camera(office_camera());
  // As high and as tilted as it is in the room: the frame `room` has z up and the floor at 0.
  Eigen::Isometry3d T_base_camera = *office()[0].truth->T_world_camera;
  T_base_camera.translation().head<2>().setZero();
  bridge.set_camera_pose(T_base_camera);
  feed(bridge, 0, 45);
  ASSERT_FALSE(recorder_.grids.empty());
  const GridOutput& grid = recorder_.grids.back();
  ASSERT_TRUE(grid.has_grid);
  ASSERT_EQ(grid.cells.size(), std::size_t{grid.width} * grid.height);
  EXPECT_GT(std::count(grid.cells.begin(), grid.cells.end(), 0), 50) << "free cells";
  EXPECT_GT(std::count(grid.cells.begin(), grid.cells.end(), 100), 5) << "occupied cells";
  EXPECT_LT(Eigen::AngleAxisd(grid.T_map_grid.linear()).angle(), 0.03) << "level, and along the axes of the map";
  EXPECT_NEAR(grid.T_map_grid.translation().z(), 0.0, 0.05) << "the floor is at the foot of the robot";
  EXPECT_GT(grid.octree.size(), 100U);
}
#endif

}  // namespace
}  // namespace holdfast::bridge
