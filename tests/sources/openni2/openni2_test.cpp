// SPDX-License-Identifier: BSD-3-Clause
#include <OpenNI.h>
#include <gmock/gmock.h>

#include <chrono>
#include <thread>

#include "fake_images.hpp"
#include "openni2_source.hpp"
#include "sources/recording.hpp"

namespace holdfast {
namespace {

using openni2_plugin::DepthCamera;
using openni2_plugin::Openni2Settings;
using openni2_plugin::Openni2Source;
using openni2_plugin::StreamImage;
using test::input_error;
using test::read_all;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

std::unique_ptr<FrameSource> open(const Openni2Settings& settings, int width = fake_width) {
  CreationContext context;
  context.camera.width = width;
  context.camera.height = fake_height;
  return std::make_unique<Openni2Source>(settings, context);
}

/// The number of the image that the driver made.
int number_of(const SensorFrame& frame) { return frame.colour.at<cv::Vec3b>(3, 5)[2] / 10; }

/// Frames are those that the driver gave, unmirrored and in pairs, whichever were lost on a busy machine.
void expect_fake_frames(const std::vector<SensorFrame>& frames) {
  ASSERT_FALSE(frames.empty());
  for (const SensorFrame& frame : frames) {
    const int i = number_of(frame);
    EXPECT_EQ(frame.colour.at<cv::Vec3b>(3, 5), cv::Vec3b(5, 2, fake_red(i)));
    EXPECT_EQ(frame.depth.at<float>(3, 5), static_cast<float>(fake_depth(i, 5)) / 1000.0F)
        << "the depth image of the same time";
    EXPECT_NEAR(frame.timestamp - frames[0].timestamp, 0.033333 * (i - number_of(frames[0])), 1e-9);
    EXPECT_EQ(frame.index - frames[0].index, static_cast<std::uint64_t>(i - number_of(frames[0])));
  }
}

TEST(Openni2DeviceTest, ACameraGivesItsFramesUntilItIsUnplugged) {
  const auto source = open({.device = "fake:unplugged"});
  EXPECT_TRUE(source->describe().has_depth);
  EXPECT_FALSE(source->describe().frame_count.has_value());
  std::vector<SensorFrame> frames;
  const std::string message = input_error([&] {
    while (std::optional<SensorFrame> frame = source->next()) frames.push_back(*frame);
  });
  EXPECT_THAT(message, AllOf(StartsWith("fake:unplugged: "), HasSubstr("was unplugged")));
  expect_fake_frames(frames);
  EXPECT_NEAR(frames[0].timestamp, static_cast<double>(fake_colour_time(number_of(frames[0]))) * 1e-6, 1e-9);
  EXPECT_NEAR(frames[0].depth_delay, 0.004, 1e-9);
  EXPECT_FALSE(source->next().has_value());
}

TEST(Openni2DeviceTest, TheFirstCameraIsTakenWithoutAName) { EXPECT_TRUE(open({})->next().has_value()); }

TEST(Openni2DeviceTest, SaysWhatACameraCannotDo) {
  EXPECT_THAT(input_error([] { open({.device = "fake:none"}); }),
              AllOf(StartsWith("fake:none: cannot be opened"), HasSubstr("`source.openni2.device`"),
                    HasSubstr("\n  fake:plain")));
  EXPECT_THAT(input_error([] { open({.device = "fake:plain"}, 640); }),
              AllOf(HasSubstr("its colour has no size of 640x48"), HasSubstr("it has 64x48 at 30 Hz")));
  EXPECT_THAT(input_error([] { open({.device = "fake:unregistered"}); }),
              AllOf(HasSubstr("cannot register its depth"), HasSubstr("registration: none")));
  EXPECT_TRUE(open({.device = "fake:unregistered", .registration = "none"})->next().has_value());
  EXPECT_THAT(input_error([] { open({.device = "some.oni"}); }),
              AllOf(StartsWith("some.oni: is a recording"), HasSubstr("for the source 'rosbag'")));
}

/// Gives the images that a test names, then nothing.
class ListedImages final : public DepthCamera {
 public:
  explicit ListedImages(std::vector<StreamImage> images) : images_(std::move(images)) {}
  std::optional<StreamImage> next(const std::function<bool()>&) override {
    if (position_ == images_.size()) return std::nullopt;
    return images_[position_++];
  }

 private:
  std::vector<StreamImage> images_;
  std::size_t position_ = 0;
};

StreamImage colour(std::uint64_t number, std::uint64_t time) {
  return {false, number, time, cv::Mat(2, 2, CV_8UC3, cv::Scalar::all(static_cast<double>(number)))};
}
StreamImage depth(std::uint64_t number, std::uint64_t time) {
  return {true, number, time, cv::Mat(2, 2, CV_32FC1, cv::Scalar::all(static_cast<double>(number)))};
}

struct Paired {
  std::vector<int> colours, depths;
  std::vector<SkippedFrame> skipped;
};
Paired paired(std::vector<StreamImage> images) {
  Openni2Source source(Openni2Settings{}, std::make_unique<ListedImages>(std::move(images)));
  Paired result;
  for (const SensorFrame& frame : read_all(source)) {
    result.colours.push_back(frame.colour.at<cv::Vec3b>(0, 0)[0]);
    result.depths.push_back(static_cast<int>(frame.depth.at<float>(0, 0)));
  }
  result.skipped = source.skipped();
  return result;
}

TEST(Openni2PairsTest, ImagesNearInTimeAreAFrameWhicheverComesFirst) {
  const Paired result = paired({depth(1, 1000), colour(1, 9000), colour(2, 42'000), depth(2, 34'000)});
  EXPECT_THAT(result.colours, ElementsAre(1, 2));
  EXPECT_THAT(result.depths, ElementsAre(1, 2));
  EXPECT_TRUE(result.skipped.empty());
}

TEST(Openni2PairsTest, ColourWithoutDepthAndLostColourAreCounted) {
  const Paired result =
      paired({colour(1, 1000), depth(1, 2000), colour(2, 34'000), colour(3, 67'000), depth(3, 68'000),
              colour(6, 167'000), depth(6, 168'000), depth(7, 233'000), colour(7, 200'000), colour(8, 233'000)});
  EXPECT_THAT(result.colours, ElementsAre(1, 3, 6, 8));
  EXPECT_THAT(result.depths, ElementsAre(1, 3, 6, 7));
  ASSERT_EQ(result.skipped.size(), 4u);
  EXPECT_THAT(result.skipped[0].reason, HasSubstr("no depth image near enough"));
  EXPECT_NEAR(result.skipped[0].timestamp, 0.034, 1e-9);
  EXPECT_THAT(result.skipped[1].reason, HasSubstr("was not fetched in time"));
  EXPECT_NEAR(result.skipped[1].timestamp, 0.1003333, 1e-5);
  EXPECT_THAT(result.skipped[3].reason, HasSubstr("no depth image near enough"));
}

TEST(Openni2PairsTest, AnInterruptEndsTheWaitForACameraThatHangs) {
  class HangingCamera final : public DepthCamera {
    std::optional<StreamImage> next(const std::function<bool()>& stop) override {
      while (!stop()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
      return std::nullopt;
    }
  };
  Openni2Source source({}, std::make_unique<HangingCamera>());
  std::thread other([&] { source.interrupt(); });
  EXPECT_FALSE(source.next().has_value()) << "and says nothing of images that do not fit";
  other.join();
}

TEST(Openni2PairsTest, RefusesStampsThatDoNotIncreaseAndRecordingsWithoutPairs) {
  EXPECT_THAT(input_error([] {
                paired({colour(1, 1000), colour(2, 1000)});
              }),
              HasSubstr("expected time stamps that increase"));
  EXPECT_THAT(input_error([] { paired({colour(1, 1000), depth(1, 90'000)}); }), HasSubstr("max_time_difference"));
}

}  // namespace
}  // namespace holdfast
