// SPDX-License-Identifier: BSD-3-Clause
#include "v4l2_source.hpp"

#include <gmock/gmock.h>

#include <chrono>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>
#include <thread>

#include "sources/recording.hpp"

namespace holdfast {
namespace {

using test::input_error;
using test::read_all;
using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;
using v4l2_plugin::LostFrames;
using v4l2_plugin::V4l2Settings;
using v4l2_plugin::V4l2Source;
using v4l2_plugin::VideoInput;

/// A camera that gives frames of these times, then nothing, as one that is unplugged.
class FakeCamera final : public VideoInput {
 public:
  explicit FakeCamera(std::vector<double> times, cv::Mat image = test::colour_image(0))
      : times_(std::move(times)), image_(std::move(image)) {}
  bool grab() override { return position_++ < times_.size(); }
  cv::Mat decode() override { return image_; }
  double time() const override { return times_[position_ - 1]; }

 private:
  std::vector<double> times_;
  cv::Mat image_;
  std::size_t position_ = 0;
};

std::unique_ptr<V4l2Source> live(std::vector<double> times, const cv::Mat& image = test::colour_image(0)) {
  return std::make_unique<V4l2Source>(V4l2Settings{}, cv::Size(64, 48),
                                      std::make_unique<FakeCamera>(std::move(times), image), true);
}

TEST(V4l2SourceTest, ACameraThatIsUnpluggedSaysSoAfterItsFrames) {
  const auto source = live({10.0, 10.1, 10.2});
  EXPECT_EQ(source->describe().name, "camera /dev/video0");
  EXPECT_FALSE(source->describe().frame_count.has_value());
  EXPECT_FALSE(source->describe().has_depth);
  for (int i = 0; i < 3; ++i) {
    const std::optional<SensorFrame> frame = source->next();
    ASSERT_TRUE(frame.has_value());
    EXPECT_EQ(frame->index, static_cast<std::uint64_t>(i));
    EXPECT_NEAR(frame->timestamp, 10.0 + 0.1 * i, 1e-9) << "the clock of its driver";
  }
  EXPECT_THAT(input_error([&] { source->next(); }),
              AllOf(StartsWith("/dev/video0: the camera gave no more frames after 3"), HasSubstr("unplugged")));
  EXPECT_FALSE(source->next().has_value());
}

/// A camera whose driver gives a frame, then waits for ever, as one behind a hub that hangs.
class HangingCamera final : public VideoInput {
 public:
  bool wait(double seconds) override {
    if (!has_given_) return true;
    std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
    return false;
  }
  bool grab() override {
    EXPECT_FALSE(has_given_) << "would never return";
    return has_given_ = true;
  }
  cv::Mat decode() override { return test::colour_image(0); }
  double time() const override { return 1.0; }

 private:
  bool has_given_ = false;
};

TEST(V4l2SourceTest, AnInterruptEndsTheWaitForACameraThatHangs) {
  V4l2Source source({}, cv::Size(64, 48), std::make_unique<HangingCamera>(), true);
  EXPECT_TRUE(source.next().has_value());
  std::thread other([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    source.interrupt();
  });
  EXPECT_FALSE(source.next().has_value()) << "in place of the error after ten seconds";
  other.join();
  EXPECT_FALSE(source.next().has_value());
}

TEST(V4l2SourceTest, WithoutTheClockOfADriverThatOfTheComputerServes) {
  const auto source = live({0.0, 0.0, 0.0});
  double last = 0.0;
  for (int i = 0; i < 3; ++i) {
    const double stamp = source->next()->timestamp;
    EXPECT_GT(stamp, last);
    last = stamp;
  }
}

TEST(V4l2SourceTest, FramesThatNobodyFetchedAreCounted) {
  const auto source = live({1.0, 1.1, 1.2, 1.3, 1.6, 1.7});
  std::vector<std::uint64_t> indices;
  for (int i = 0; i < 6; ++i) indices.push_back(source->next()->index);
  EXPECT_THAT(indices, testing::ElementsAre(0, 1, 2, 3, 6, 7));
  const std::vector<SkippedFrame> skipped = source->skipped();
  ASSERT_EQ(skipped.size(), 2u);
  EXPECT_EQ(skipped[0].index, 4u);
  EXPECT_NEAR(skipped[0].timestamp, 1.4, 1e-9);
  EXPECT_NEAR(skipped[1].timestamp, 1.5, 1e-9);
  EXPECT_THAT(skipped[0].reason, HasSubstr("was not fetched in time"));
}

TEST(V4l2SourceTest, ACameraThatSlowsDownInTheDarkLosesNothingForLong) {
  LostFrames lost;
  std::size_t count = 0;
  double time = 0.0;
  for (int i = 0; i < 20; ++i) count += lost.before(time += 1.0 / 30.0 + (i % 2 == 0 ? 0.004 : -0.004));
  EXPECT_EQ(count, 0u) << "they come a little early and late";
  for (int i = 0; i < 30; ++i) count += lost.before(time += 1.0 / 15.0);
  EXPECT_LE(count, 5u);
  EXPECT_EQ(lost.before(time += 1.0 / 15.0), 0u);
  EXPECT_EQ(lost.before(time += 3600.0), 0u) << "it paused";
}

TEST(V4l2SourceTest, RefusesFramesThatDoNotFit) {
  EXPECT_THAT(input_error([&] { live({1.0}, test::colour_image(0, 32, 24))->next(); }),
              AllOf(HasSubstr("frames of 32x24 pixels, but the camera is 64x48"), HasSubstr("`camera:`")));
  EXPECT_THAT(input_error([&] { read_all(*live({1.0, 1.0})); }), HasSubstr("not later than"));
  EXPECT_THAT(input_error([&] { live({1.0}, cv::Mat())->next(); }), HasSubstr("frame 0 is damaged"));
  const cv::Mat grey(48, 64, CV_8UC1, cv::Scalar(7));
  EXPECT_EQ(live({1.0}, grey)->next()->colour.at<cv::Vec3b>(0, 0), cv::Vec3b(7, 7, 7));
}

TEST(V4l2SourceTest, AMissingCameraSaysWhatToDo) {
  EXPECT_THAT(input_error([] {
                test::make_source("v4l2", {{"device", std::string("77")}});
              }),
              AllOf(StartsWith("/dev/video77: there is no such camera"), HasSubstr("source.v4l2.device")));
  EXPECT_THAT(input_error([] {
                test::make_source("v4l2", {{"device", std::string("/dev/null")}});
              }),
              HasSubstr("/dev/null: the camera cannot be opened"));
  EXPECT_THAT(input_error([] {
                test::make_source("v4l2", {{"device", std::string("/tmp")}});
              }),
              HasSubstr("/tmp: is not a camera"));
}

class VideoFileTest : public testing::Test {
 protected:
  void SetUp() override {
    file_ = (folder_.path() / "video.avi").string();
    cv::VideoWriter writer(file_, cv::CAP_OPENCV_MJPEG, cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 20.0, {64, 48});
    ASSERT_TRUE(writer.isOpened());
    for (int i = 0; i < 6; ++i) writer.write(cv::Mat(48, 64, CV_8UC3, cv::Scalar::all(20 * i + 30)));
  }
  std::unique_ptr<FrameSource> open(ParameterValues values = {}) const {
    values.emplace("file", file_);
    return test::make_source("v4l2", values);
  }

  test::TemporaryFolder folder_;
  std::string file_;
};

TEST_F(VideoFileTest, GivesEveryFrameWithItsTime) {
  const auto source = open();
  EXPECT_EQ(source->describe().name, "video");
  const std::vector<SensorFrame> frames = read_all(*source);
  ASSERT_EQ(frames.size(), 6u);
  for (int i = 0; i < 6; ++i) {
    const SensorFrame& frame = frames[static_cast<std::size_t>(i)];
    EXPECT_NEAR(frame.colour.at<cv::Vec3b>(24, 32)[1], 20 * i + 30, 3);
    EXPECT_NEAR(frame.timestamp - frames[0].timestamp, 0.05 * i, 1e-6);
  }
  EXPECT_FALSE(source->next().has_value());
  EXPECT_TRUE(source->skipped().empty());
  EXPECT_NEAR(read_all(*open({{"frame_rate", 10.0}}))[3].timestamp, 0.3, 1e-9);
}

TEST_F(VideoFileTest, RefusesWhatIsNoVideo) {
  EXPECT_THAT(input_error([&] { open({{"file", std::string("/none.avi")}}); }), StartsWith("/none.avi: is missing"));
  EXPECT_THAT(input_error([&] { open({{"file", folder_.path().string()}}); }), HasSubstr("is not a file"));
  const std::string text = folder_.write("text.mp4", "this is no video");
  EXPECT_THAT(input_error([&] { open({{"file", text}}); }), HasSubstr("cannot be opened as a video"));
  EXPECT_THAT(input_error([&] {
                test::make_source("v4l2", {{"file", file_}}, 32, 24)->next();
              }),
              HasSubstr("has frames of 64x48 pixels, but the camera is 32x24"));
}

}  // namespace
}  // namespace holdfast
