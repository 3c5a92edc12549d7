// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>

#include "holdfast/core/error.hpp"
#include "holdfast/interfaces/observer.hpp"
#include "holdfast/plugin/registry.hpp"
#include "painter.hpp"

extern "C" void holdfast_register_plugin_overlay(holdfast::Registry&);

namespace holdfast {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::UnorderedElementsAre;

constexpr int grey = 100;

/// A lens that moves pixels by many cells near the edge, so that mixing up raw and undistorted shows.
Camera wide_camera() {
  Camera camera;
  camera.width = 160;
  camera.height = 120;
  camera.fx = camera.fy = 110;
  camera.cx = 79.5;
  camera.cy = 59.5;
  camera.distortion.k1 = -0.25;
  camera.distortion.k2 = 0.05;
  return camera;
}

/// A grey image without features, with all cells background and static.
struct Scene {
  explicit Scene(const Camera& camera) {
    sensor_frame.index = 12;
    sensor_frame.colour = cv::Mat(camera.height, camera.width, CV_8UC3, cv::Scalar::all(grey));
    frame.camera = std::make_shared<Camera>(camera);
    frame.coarse.grid = CoarseSampler(camera).grid();
    const auto cells = static_cast<std::size_t>(frame.coarse.grid.size());
    frame.coarse.mask.labels.assign(cells, 0);
    frame.coarse.static_log_odds.assign(cells, 1.0F);
    frame.coarse.depth.assign(cells, 1.0F);
    result.index = 12;
  }
  void add_feature(float x, float y, float probability, bool shows_point) {
    frame.features.x.push_back(x);
    frame.features.y.push_back(y);
    frame.features.resize(frame.features.x.size());
    frame.static_probability.push_back(probability);
    frame.map_points.push_back(shows_point ? MapPointId{1, 0} : MapPointId());
  }
  SensorFrame sensor_frame;
  Frame frame;
  FrameResult result;
};

cv::Vec3b pixel(const cv::Mat& picture, int x, int y) { return picture.at<cv::Vec3b>(y, x); }

TEST(OverlayPainter, TintsTheRawPixelsOfACell) {
  const Camera camera = wide_camera();
  Scene scene(camera);
  // A cell far from the centre, found through the lens.
  const Eigen::Vector2d raw(12, 9), place = camera.undistort(raw);
  ASSERT_GT((place - raw).norm(), 2.0 * CoarseGrid::step);
  const int cell = scene.frame.coarse.grid.cell_of(static_cast<float>(place.x()), static_cast<float>(place.y()));
  ASSERT_GE(cell, 0);
  scene.frame.coarse.mask.labels[static_cast<std::size_t>(cell)] = 1;
  overlay_plugin::Painter painter(camera, false);
  const cv::Mat& picture = painter.paint(scene.sensor_frame, scene.frame, scene.result);
  ASSERT_EQ(picture.size(), cv::Size(160, 120 + overlay_plugin::Painter::text_height));
  int changed = 0;
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x)
      if (pixel(picture, x, y) != cv::Vec3b(grey, grey, grey)) {
        ++changed;
        EXPECT_LT((Eigen::Vector2d(x, y) - raw).norm(), 8.0) << x << " " << y;
      }
  EXPECT_GT(changed, 3);
  EXPECT_GT(pixel(picture, 12, 9)[0], grey + 20);  // blue
}

TEST(OverlayPainter, TellsClassesUnknownAndMovementApart) {
  Camera camera = wide_camera();
  camera.distortion = {};
  Scene scene(camera);
  const auto cell_at = [&](int x, int y) {
    return static_cast<std::size_t>(scene.frame.coarse.grid.cell_of(static_cast<float>(x), static_cast<float>(y)));
  };
  scene.frame.coarse.mask.labels[cell_at(20, 20)] = 255;
  scene.frame.coarse.static_log_odds[cell_at(60, 20)] = -1.0F;
  scene.frame.coarse.static_log_odds[cell_at(100, 20)] = -6.0F;
  scene.frame.coarse.mask.labels[cell_at(20, 60)] = 2;
  overlay_plugin::Painter painter(camera, true);
  const cv::Mat& picture = painter.paint(scene.sensor_frame, scene.frame, scene.result);
  ASSERT_EQ(picture.cols, 320);
  EXPECT_EQ(pixel(picture, 20, 20), cv::Vec3b(grey, grey, grey));  // the image as it came
  const cv::Vec3b unknown = pixel(picture, 180, 20), weak = pixel(picture, 220, 20), strong = pixel(picture, 260, 20),
                  second = pixel(picture, 180, 60);
  EXPECT_LT(unknown[2], grey - 10);
  EXPECT_EQ(unknown[0], unknown[2]);
  EXPECT_GT(weak[2], grey + 10);
  EXPECT_GT(strong[2], weak[2] + 10);
  EXPECT_LT(strong[0], grey);
  EXPECT_GT(second[0], grey + 10);
  EXPECT_GT(second[2], grey + 10);
  EXPECT_LT(second[1], grey);
}

TEST(OverlayPainter, DrawsFeaturesByProbabilityAndMapPoint) {
  Camera camera = wide_camera();
  Scene scene(camera);
  scene.add_feature(30, 30, 1.0F, true);
  scene.add_feature(60, 30, 0.0F, true);
  scene.add_feature(90, 30, 0.5F, true);
  scene.add_feature(120, 30, 1.0F, false);
  overlay_plugin::Painter painter(camera, false);
  const cv::Mat& picture = painter.paint(scene.sensor_frame, scene.frame, scene.result);
  EXPECT_EQ(pixel(picture, 30, 30), cv::Vec3b(0, 255, 0));
  EXPECT_EQ(pixel(picture, 60, 30), cv::Vec3b(0, 0, 255));
  EXPECT_EQ(pixel(picture, 90, 30), cv::Vec3b(0, 255, 255));
  EXPECT_EQ(pixel(picture, 120, 30), cv::Vec3b(grey, grey, grey));  // hollow
  EXPECT_EQ(pixel(picture, 123, 30), cv::Vec3b(0, 255, 0));
}

TEST(OverlayPainter, DrawsWhatMovesWithItsVelocity) {
  Camera camera = wide_camera();
  camera.distortion = {};
  Scene scene(camera);
  MovingObject object;
  object.id = 2;  // white
  object.class_name = "person";
  object.velocity = Eigen::Vector3d(0.6, 0, 0);
  object.box = Eigen::AlignedBox3f(Eigen::Vector3f(-0.3F, -0.5F, -0.1F), Eigen::Vector3f(0.3F, 0.5F, 0.1F));
  object.moving = true;
  scene.result.timestamp = object.last_seen = 5.0;
  scene.result.T_world_camera = Eigen::Isometry3d(Eigen::Translation3d(1, 0, 0));
  object.T_world_object.translation() = Eigen::Vector3d(1, 0, 2);  // two metres before the camera
  scene.result.objects = {object};
  EXPECT_EQ(overlay_plugin::object_text(object), "2 person 0.60 m/s");
  overlay_plugin::Painter painter(camera, false);
  const auto bright = [](const cv::Mat& picture, int x, int y) { return pixel(picture, x, y)[1] > grey + 60; };
  const auto differs = [](const cv::Mat& picture, int x, int y) {
    return pixel(picture, x, y) != cv::Vec3b(grey, grey, grey);
  };
  const cv::Mat moving = painter.paint(scene.sensor_frame, scene.frame, scene.result).clone();
  // The nearer right edge of the box, above the text.
  EXPECT_TRUE(bright(moving, 96, 45) || bright(moving, 97, 45) || bright(moving, 98, 45));
  EXPECT_FALSE(differs(moving, 120, 45));
  scene.result.objects.front().moving = false;
  const cv::Mat standing = painter.paint(scene.sensor_frame, scene.frame, scene.result).clone();
  EXPECT_LT(cv::countNonZero(standing.reshape(1) != grey), cv::countNonZero(moving.reshape(1) != grey));
  // What lies behind the camera is not drawn.
  scene.result.objects.front().T_world_object.translation().z() = -2.0;
  const cv::Mat behind = painter.paint(scene.sensor_frame, scene.frame, scene.result).clone();
  EXPECT_FALSE(differs(behind, 96, 45) || differs(behind, 97, 45) || differs(behind, 98, 45));
}

TEST(OverlayPainter, PaintsFramesWithoutACoarseView) {
  const Camera camera = wide_camera();
  Scene scene(camera);
  scene.frame.coarse = {};
  overlay_plugin::Painter painter(camera, false);
  EXPECT_EQ(pixel(painter.paint(scene.sensor_frame, scene.frame, scene.result), 50, 50), cv::Vec3b(grey, grey, grey));
}

TEST(OverlayStatus, SaysWhatBecameOfTheFrame) {
  FrameResult result;
  result.index = 7;
  result.timestamp = 1.5;
  result.status = TrackingStatus::tracked;
  result.inliers = 33;
  result.features = 500;
  result.static_features = 450;
  EXPECT_EQ(overlay_plugin::status_text(result), "frame 7   1.500 s   tracked   inliers 33   static 450 of 500");
}

class OverlayFiles : public testing::Test {
 protected:
  void SetUp() override {
    holdfast_register_plugin_overlay(registry_);
    folder_ = fs::path(testing::TempDir()) / ("holdfast_overlay_" + std::to_string(getpid()) + "_" +
                                              testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  /// Shows an overlay the frames 0 to 9, the first brightest.
  void watch_ten_frames(const ParameterValues& values, const fs::path& folder) const {
    CreationContext context;
    context.camera = wide_camera();
    context.output_directory = folder;
    const auto observer = registry_.create<Observer>("overlay", values, context);
    Scene scene(context.camera);
    for (int i = 0; i < 10; ++i) {
      scene.sensor_frame.index = scene.result.index = static_cast<std::uint64_t>(i);
      scene.sensor_frame.colour.setTo(cv::Scalar::all(200 - 10 * i));
      observer->on_frame(scene.sensor_frame, scene.frame, scene.result);
    }
    observer->on_finish(Map());
  }
  std::vector<std::string> files() const {
    std::vector<std::string> names;
    if (fs::exists(folder_ / "overlay"))
      for (const auto& entry : fs::directory_iterator(folder_ / "overlay")) names.push_back(entry.path().filename());
    return names;
  }

  Registry registry_;
  fs::path folder_;
};

TEST_F(OverlayFiles, WritesEveryNthFrame) {
  watch_ten_frames({{"every", std::int64_t{4}}, {"format", std::string("png")}}, folder_);
  EXPECT_THAT(files(), UnorderedElementsAre("frame_000000.png", "frame_000004.png", "frame_000008.png"));
  const cv::Mat picture = cv::imread((folder_ / "overlay/frame_000004.png").string());
  ASSERT_EQ(picture.size(), cv::Size(160, 144));
  EXPECT_EQ(pixel(picture, 80, 60), cv::Vec3b(160, 160, 160));
}

TEST_F(OverlayFiles, WritesVideosThatCanBeReadBack) {
  for (const std::string format : {"avi", "mp4"}) {
    watch_ten_frames({{"format", format}, {"layout", std::string("side_by_side")}}, folder_);
    EXPECT_THAT(files(), UnorderedElementsAre("overlay." + format));
    cv::VideoCapture video((folder_ / "overlay" / ("overlay." + format)).string());
    ASSERT_TRUE(video.isOpened()) << format;
    cv::Mat picture;
    int count = 0;
    while (video.read(picture)) {
      ASSERT_EQ(picture.size(), cv::Size(320, 144));
      EXPECT_NEAR(pixel(picture, 80, 60)[1], 200 - 10 * count, 6) << format;
      ++count;
    }
    EXPECT_EQ(count, 10) << format;
    fs::remove_all(folder_ / "overlay");
  }
}

TEST_F(OverlayFiles, AreTheSameBytesEveryTime) {
  const auto bytes = [&](const std::string& format, const fs::path& file) {
    fs::remove_all(folder_ / "overlay");
    watch_ten_frames({{"format", format}}, folder_);
    std::ifstream stream(folder_ / "overlay" / file, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(stream), {});
  };
  for (const auto& [format, file] : {std::pair{"jpg", "frame_000003.jpg"}, {"avi", "overlay.avi"}}) {
    const std::string first = bytes(format, file);
    EXPECT_GT(first.size(), 500U);
    EXPECT_TRUE(first == bytes(format, file)) << format;
  }
}

TEST_F(OverlayFiles, AreNotWrittenWithoutAnOutputFolder) {
  watch_ten_frames({}, {});
  EXPECT_FALSE(fs::exists("overlay"));
}

TEST_F(OverlayFiles, NameTheFileThatCannotBeWritten) {
  std::ofstream(folder_ / "overlay") << "in the way";
  try {
    watch_ten_frames({}, folder_);
    FAIL() << "no error";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr((folder_ / "overlay").string()));
  }
  EXPECT_THROW(watch_ten_frames({{"format", std::string("avi")}}, folder_), InputError);
}

}  // namespace
}  // namespace holdfast
