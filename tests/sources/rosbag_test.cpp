// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <limits>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "holdfast/plugin/registry.hpp"
#include "sources/recording.hpp"
#include "support/bag_writer.hpp"

extern "C" void holdfast_register_plugin_rosbag(holdfast::Registry& registry);

namespace holdfast {
namespace {

using test::BagWriter;
using test::camera_info_message;
using test::compressed_message;
using test::image_message;
using test::input_error;
using test::read_all;
using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

constexpr const char* image = "sensor_msgs/Image";
constexpr const char* compressed_image = "sensor_msgs/CompressedImage";
constexpr const char* camera_info = "sensor_msgs/CameraInfo";
constexpr const char* colour_topic = "/camera/rgb/image_color";
constexpr const char* depth_topic = "/camera/depth/image";
constexpr const char* info_topic = "/camera/rgb/camera_info";

/// Of frame i, 0.1 s apart; the clocks of messages and of the bag differ.
std::uint64_t colour_stamp(int i) { return 1305031102175304000ULL + 100'000'000ULL * static_cast<unsigned>(i); }
std::uint64_t depth_stamp(int i) { return colour_stamp(i) - 4'000'000; }
std::uint64_t received(int i) { return colour_stamp(i) + 3'000'000'000; }

cv::Mat colour_pixels(int i) { return test::colour_image(i); }
cv::Mat depth_metres(int i) {
  cv::Mat depth;
  test::depth_image(i).convertTo(depth, CV_32FC1);
  depth = depth / 5000.0F;
  depth.at<float>(0, 0) = std::numeric_limits<float>::quiet_NaN();
  return depth;
}
std::string colour_message(int i) { return image_message(colour_stamp(i), "bgr8", colour_pixels(i)); }
std::string depth_message(int i) { return image_message(depth_stamp(i), "32FC1", depth_metres(i)); }
std::string info_message() {
  return camera_info_message(colour_stamp(0), 64, 48, "plumb_bob", {0.1, -0.2, 0.003, 0.004, 0.5},
                             {52, 0, 32, 0, 53, 24, 0, 0, 1}, {50, 0, 31, 0, 0, 51, 23, 0, 0, 0, 1, 0});
}
std::string encoded(const char* extension, const cv::Mat& pixels) {
  std::vector<uchar> bytes;
  cv::imencode(extension, pixels, bytes);
  return {bytes.begin(), bytes.end()};
}

/// As those of the TUM benchmark, which have other topics too.
std::string tum_bag(const std::string& compression = "none", int frames = 5) {
  BagWriter bag(compression);
  for (int i = 0; i < frames; ++i) {
    bag.add("/imu", "sensor_msgs/Imu", received(i) - 1000, "numbers");
    bag.add(depth_topic, image, received(i), depth_message(i));
    bag.add(info_topic, camera_info, received(i) + 1000, info_message());
    bag.add(colour_topic, image, received(i) + 2000, colour_message(i));
  }
  return bag.finish();
}

class RosbagTest : public testing::Test {
 protected:
  std::unique_ptr<FrameSource> open(const std::string& bag, ParameterValues values = {}) const {
    values["path"] = folder_.write("recording.bag", bag);
    return test::make_source("rosbag", values);
  }
  std::string error(const std::string& bag, const ParameterValues& values = {}) const {
    return input_error([&] { read_all(*open(bag, values)); });
  }
  std::string file() const { return (folder_.path() / "recording.bag").string(); }

  test::TemporaryFolder folder_;
};

TEST_F(RosbagTest, GivesWhatABagOfTheBenchmarkHas) {
  for (const char* compression : {"none", "lz4", "bz2"}) {
    SCOPED_TRACE(compression);
    const auto source = open(tum_bag(compression));
    EXPECT_EQ(source->describe().name, "recording");
    EXPECT_EQ(source->describe().frame_count, 5u);
    EXPECT_TRUE(source->describe().has_depth);
    EXPECT_FALSE(source->describe().camera.has_value()) << "the configuration has one";
    const std::vector<SensorFrame> frames = read_all(*source);
    ASSERT_EQ(frames.size(), 5u);
    for (int i = 0; i < 5; ++i) {
      const SensorFrame& frame = frames[static_cast<std::size_t>(i)];
      EXPECT_EQ(frame.index, static_cast<std::uint64_t>(i));
      EXPECT_EQ(frame.timestamp, std::stod("130503110" + std::to_string(2 + (1753 + 1000 * i) / 10000) + '.' +
                                           std::to_string((1753 + 1000 * i) % 10000) + "04"))
          << "as a list of images has it";
      EXPECT_NEAR(frame.depth_delay, -0.004, 1e-6);
      EXPECT_EQ(cv::norm(frame.colour, colour_pixels(i), cv::NORM_INF), 0.0);
      EXPECT_EQ(frame.depth.at<float>(0, 0), 0.0F) << "no number is no value";
      cv::Mat expected = depth_metres(i);
      expected.at<float>(0, 0) = 0.0F;
      EXPECT_EQ(cv::norm(frame.depth, expected, cv::NORM_INF), 0.0);
    }
    EXPECT_FALSE(source->next().has_value());
    EXPECT_TRUE(source->skipped().empty());
  }
}

TEST_F(RosbagTest, PairsByTheStampsOfTheMessages) {
  BagWriter bag;
  // Received in another order than taken; the last depth image is too far from every colour image.
  for (const int i : {1, 0, 2}) bag.add(colour_topic, image, received(3 - i), colour_message(i));
  for (const int i : {0, 2, 1}) bag.add(depth_topic, image, received(3 - i), depth_message(i));
  bag.add(depth_topic, image, received(9), depth_message(9));
  const std::vector<SensorFrame> frames = read_all(*open(bag.finish()));
  ASSERT_EQ(frames.size(), 3u);
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(frames[static_cast<std::size_t>(i)].colour.at<cv::Vec3b>(0, 0)[0], 40 + i);
    EXPECT_FLOAT_EQ(frames[static_cast<std::size_t>(i)].depth.at<float>(0, 1),
                    (100.0F * static_cast<float>(i) + 1) / 5000);
  }
  EXPECT_THAT(error(tum_bag(), {{"max_time_difference", 0.001}}),
              AllOf(HasSubstr("no colour and depth image lie within 0.001000 s"), HasSubstr("max_time_difference")));
}

TEST_F(RosbagTest, ColourInEveryEncoding) {
  const auto first = [&](const char* encoding, const cv::Mat& pixels) {
    BagWriter bag;
    bag.add("/usb_cam/image_raw", image, received(0), image_message(colour_stamp(0), encoding, pixels));
    const auto source = open(bag.finish());
    EXPECT_FALSE(source->describe().has_depth);
    return source->next()->colour.at<cv::Vec3b>(3, 5);
  };
  const cv::Size size(64, 48);
  EXPECT_EQ(first("bgr8", cv::Mat(size, CV_8UC3, cv::Scalar(1, 2, 3))), cv::Vec3b(1, 2, 3));
  EXPECT_EQ(first("8UC3", cv::Mat(size, CV_8UC3, cv::Scalar(1, 2, 3))), cv::Vec3b(1, 2, 3));
  EXPECT_EQ(first("rgb8", cv::Mat(size, CV_8UC3, cv::Scalar(1, 2, 3))), cv::Vec3b(3, 2, 1));
  EXPECT_EQ(first("bgra8", cv::Mat(size, CV_8UC4, cv::Scalar(1, 2, 3, 4))), cv::Vec3b(1, 2, 3));
  EXPECT_EQ(first("rgba8", cv::Mat(size, CV_8UC4, cv::Scalar(1, 2, 3, 4))), cv::Vec3b(3, 2, 1));
  EXPECT_EQ(first("mono8", cv::Mat(size, CV_8UC1, cv::Scalar(9))), cv::Vec3b(9, 9, 9));
  BagWriter bag;
  bag.add("/usb_cam/image_raw", image, received(0),
          image_message(colour_stamp(0), "bayer_rggb8", cv::Mat(size, CV_8UC1, cv::Scalar(9))));
  EXPECT_THAT(error(bag.finish()), AllOf(HasSubstr("encoding 'bayer_rggb8'"), HasSubstr("rgb8, bgr8")));
}

TEST_F(RosbagTest, DepthInWholeNumbersAndCompressed) {
  const cv::Mat raw = test::depth_image(2);
  BagWriter bag("lz4");
  bag.add("/camera/color/image_raw/compressed", compressed_image, received(0),
          compressed_message(colour_stamp(0), "rgb8; jpeg compressed bgr8", encoded(".jpg", colour_pixels(0))));
  bag.add("/camera/color/image_raw/compressed", compressed_image, received(1),
          compressed_message(colour_stamp(1), "bgr8; png compressed bgr8", encoded(".png", colour_pixels(1))));
  bag.add("/camera/aligned_depth_to_color/image_raw", image, received(0), image_message(depth_stamp(0), "16UC1", raw));
  bag.add("/camera/aligned_depth_to_color/image_raw", image, received(1), image_message(depth_stamp(1), "mono16", raw));
  const std::string bytes = bag.finish();
  std::vector<SensorFrame> frames = read_all(*open(bytes));
  ASSERT_EQ(frames.size(), 2u);
  for (const SensorFrame& frame : frames) {
    EXPECT_EQ(frame.depth.at<float>(20, 30), static_cast<float>((200 + 64 * 20 + 30) / 1000.0));
    EXPECT_EQ(frame.depth.at<float>(0, 0), 0.0F);
  }
  EXPECT_NEAR(frames[0].colour.at<cv::Vec3b>(10, 10)[0], 40, 4);
  EXPECT_EQ(cv::norm(frames[1].colour, colour_pixels(1), cv::NORM_INF), 0.0);
  EXPECT_EQ(open(bytes, {{"depth_factor", 5000.0}})->next()->depth.at<float>(20, 30),
            static_cast<float>((200 + 64 * 20 + 30) / 5000.0));

  BagWriter other;
  other.add(colour_topic, image, received(0), colour_message(0));
  other.add("/camera/depth/image/compressedDepth", compressed_image, received(0),
            compressed_message(depth_stamp(0), "16UC1; compressedDepth", std::string(12, '\0') + encoded(".png", raw)));
  EXPECT_EQ(open(other.finish())->next()->depth.at<float>(20, 30), static_cast<float>((200 + 64 * 20 + 30) / 1000.0));
}

TEST_F(RosbagTest, ReadsTheCameraOfCameraInfo) {
  const auto camera = [&](const std::string& message, const char* topic = colour_topic) {
    BagWriter bag;
    bag.add(topic, image, received(0), colour_message(0));
    bag.add("/info", camera_info, received(0), message);
    return open(bag.finish(), {{"camera_info", std::string("/info")}})->describe().camera;
  };
  const std::optional<Camera> plain = camera(info_message());
  ASSERT_TRUE(plain.has_value());
  EXPECT_EQ(plain->width, 64);
  EXPECT_EQ(plain->height, 48);
  EXPECT_EQ(plain->fx, 52.0);
  EXPECT_EQ(plain->fy, 53.0);
  EXPECT_EQ(plain->cx, 32.0);
  EXPECT_EQ(plain->cy, 24.0);
  EXPECT_EQ(plain->distortion, (Distortion{.k1 = 0.1, .k2 = -0.2, .p1 = 0.003, .p2 = 0.004, .k3 = 0.5}));
  const std::optional<Camera> rectified = camera(info_message(), "/camera/rgb/image_rect_color");
  EXPECT_TRUE(rectified->distortion.is_zero());
  EXPECT_EQ(rectified->fx, 50.0);
  EXPECT_EQ(rectified->fy, 51.0);
  EXPECT_EQ(rectified->cx, 31.0);
  EXPECT_EQ(rectified->cy, 23.0);

  const std::vector<double> k = {52, 0, 32, 0, 53, 24, 0, 0, 1};
  EXPECT_TRUE(camera(camera_info_message(1, 64, 48, "", {}, k))->distortion.is_zero());
  EXPECT_EQ(
      camera(camera_info_message(1, 64, 48, "rational_polynomial", {0.1, 0.2, 0.003, 0.004, 0.05, 0.06, 0.07, 0.08}, k))
          ->distortion.k6,
      0.08);
  const Distortion fisheye = camera(camera_info_message(1, 64, 48, "equidistant", {0.1, 0.2, 0.3, 0.4}, k))->distortion;
  EXPECT_EQ(fisheye, (Distortion{.k1 = 0.1, .k2 = 0.2, .k3 = 0.3, .k4 = 0.4, .lens = Lens::fisheye}));

  const auto refused = [&](const std::string& message) { return input_error([&] { camera(message); }); };
  EXPECT_THAT(refused(camera_info_message(1, 64, 48, "omni", {1, 2, 3, 4, 5}, k)),
              AllOf(HasSubstr("distortion model 'omni'"), HasSubstr("camera_info: none")));
  EXPECT_THAT(refused(camera_info_message(1, 64, 48, "plumb_bob", {1, 2, 3, 4, 5, 6}, k)), HasSubstr("6 coefficients"));
  EXPECT_THAT(refused(camera_info_message(1, 64, 48, "plumb_bob", {}, std::vector<double>(9))),
              HasSubstr("not calibrated"));
  EXPECT_THAT(refused(info_message().substr(0, 100)), HasSubstr("is cut short"));
  EXPECT_THAT(refused(camera_info_message(1, 64, 48, "plumb_bob", std::vector<double>(15), k)),
              HasSubstr("15 distortion coefficients"));
}

constexpr const char* left_image = "/stereo/left/image_rect";
constexpr const char* right_image = "/stereo/right/image_rect";
constexpr const char* left_info = "/stereo/left/camera_info";

/// Pairs whose right image comes so much later [ns]; `x` is the fourth number of P of the right camera.
std::string stereo_bag(double x, std::uint64_t later = 0, double right_fx = 50.0,
                       const char* right_topic = right_image) {
  BagWriter bag;
  const auto info = [](double fx, double fourth) {
    return camera_info_message(colour_stamp(0), 64, 48, "plumb_bob", {0.1, -0.2, 0.003, 0.004, 0.5},
                               {52, 0, 32, 0, 53, 24, 0, 0, 1}, {fx, 0, 31, fourth, 0, 51, 23, 0, 0, 0, 1, 0});
  };
  for (int i = 0; i < 3; ++i) {
    bag.add(left_info, camera_info, received(i), info(50.0, 0.0));
    bag.add("/stereo/right/camera_info", camera_info, received(i), info(right_fx, x));
    bag.add(left_image, image, received(i), colour_message(i));
    bag.add(right_topic, image, received(i) + 1000,
            image_message(colour_stamp(i) + later, "bgr8", colour_pixels(i + 10)));
  }
  return bag.finish();
}

TEST_F(RosbagTest, ReadsStereoPairs) {
  const ParameterValues right = {{"right", std::string(right_image)}, {"camera_info", std::string(left_info)}};
  const auto source = open(stereo_bag(-6.0, 900'000), right);
  EXPECT_TRUE(source->describe().has_right);
  EXPECT_FALSE(source->describe().has_depth);
  ASSERT_TRUE(source->describe().camera);
  EXPECT_DOUBLE_EQ(source->describe().camera->baseline, 0.12);
  EXPECT_EQ(source->describe().camera->fx, 50.0);
  EXPECT_TRUE(source->describe().camera->distortion.is_zero());
  const std::vector<SensorFrame> frames = read_all(*source);
  ASSERT_EQ(frames.size(), 3U);
  for (int i = 0; i < 3; ++i) {
    const SensorFrame& frame = frames[static_cast<std::size_t>(i)];
    EXPECT_EQ(cv::norm(frame.colour, colour_pixels(i), cv::NORM_INF), 0.0);
    EXPECT_EQ(cv::norm(frame.right, colour_pixels(i + 10), cv::NORM_INF), 0.0);
    EXPECT_TRUE(frame.depth.empty());
  }
  EXPECT_THAT(error(stereo_bag(-6.0, 1'100'000), right), HasSubstr("no left and right image lie within 0.001000 s"));
  EXPECT_THAT(error(stereo_bag(6.0), right), HasSubstr("has no baseline: the fourth number of P is 6.0"));
  EXPECT_THAT(error(stereo_bag(-6.0, 0, 51.0), right), HasSubstr("are not of a rectified pair"));
  const char* raw = "/stereo/right/image_raw";
  ParameterValues values = right;
  values["right"] = std::string(raw);
  EXPECT_THAT(error(stereo_bag(-6.0, 0, 50.0, raw), values),
              HasSubstr("'/stereo/left/image_rect' and '/stereo/right/image_raw' are not of a rectified pair"));
  values = right;
  values["depth"] = std::string(depth_topic);
  EXPECT_THAT(error(stereo_bag(-6.0), values), HasSubstr("with depth and with a right camera"));
  values = {{"right", std::string(right_image)}, {"colour", std::string(right_image)}};
  EXPECT_THAT(error(stereo_bag(-6.0), values), HasSubstr("the same images on the left and on the right"));
  EXPECT_FALSE(open(stereo_bag(0.0), {{"right", std::string(right_image)}})->describe().camera)
      << "the configuration has one, with the baseline";
}

TEST_F(RosbagTest, ABaselineOfTheConfigurationIsThatOfTheBag) {
  Registry registry;
  holdfast_register_plugin_rosbag(registry);
  ParameterValues values = {{"path", folder_.write("recording.bag", stereo_bag(-6.0))},
                            {"right", std::string(right_image)}};
  CreationContext context;
  context.camera.width = 64, context.camera.height = 48;
  const auto refused = [&] { return input_error([&] { registry.create<FrameSource>("rosbag", values, context); }); };
  const auto is_told = AllOf(HasSubstr("'/stereo/right/camera_info' tells a baseline of 0.120000 m"),
                             HasSubstr("write `baseline: 0.120000` under `camera:`"));
  EXPECT_THAT(refused(), AllOf(is_told, HasSubstr("one of 0.080000 m, which is the default")));
  context.camera.baseline = 0.2;
  EXPECT_THAT(refused(), AllOf(is_told, HasSubstr("one of 0.200000 m;")));
  context.camera.baseline = 0.1199;
  EXPECT_FALSE(registry.create<FrameSource>("rosbag", values, context)->describe().camera);
  context.camera.baseline = 0.2;
  context.sensor = Sensor::mono;
  EXPECT_NO_THROW(registry.create<FrameSource>("rosbag", values, context));
  context.sensor = {};

  values["camera_info"] = std::string(left_info);  // whose camera is used
  EXPECT_THAT(refused(), is_told);
  context.camera.baseline = Camera().baseline;
  EXPECT_DOUBLE_EQ(registry.create<FrameSource>("rosbag", values, context)->describe().camera->baseline, 0.12);
  values["camera_info"] = std::string("none");
  EXPECT_NO_THROW(registry.create<FrameSource>("rosbag", values, context));
}

TEST_F(RosbagTest, SaysWhatThereIsToChooseFrom) {
  BagWriter bag;
  bag.add("/left/image_raw", image, received(0), colour_message(0));
  bag.add("/right/image_raw", image, received(0), colour_message(0));
  bag.add("/depth", image, received(0), depth_message(0));
  bag.add("/imu", "sensor_msgs/Imu", received(0), "numbers");
  bag.add("/imu", "sensor_msgs/Imu", received(1), "numbers");
  const std::string bytes = bag.finish();
  EXPECT_THAT(error(bytes),
              AllOf(StartsWith(file() + ": several topics have colour images: '/left/image_raw', '/right/image_raw'"),
                    HasSubstr("`source.rosbag.colour`"), HasSubstr("\n  /imu  sensor_msgs/Imu  2 messages")));
  EXPECT_EQ(read_all(*open(bytes, {{"colour", std::string("/right/image_raw")}})).size(), 1u);
  EXPECT_FALSE(
      open(bytes, {{"colour", std::string("/right/image_raw")}, {"depth", std::string("none")}})->next()->depth.data !=
      nullptr);
  EXPECT_THAT(
      error(bytes, {{"colour", std::string("/middle")}}),
      AllOf(HasSubstr("has no topic '/middle'"), HasSubstr("\n  /left/image_raw  sensor_msgs/Image  1 message")));
  EXPECT_THAT(error(bytes, {{"colour", std::string("/imu")}}), HasSubstr("has messages of the type sensor_msgs/Imu"));
  EXPECT_THAT(error(bytes, {{"colour", std::string("/left/image_raw")}, {"camera_info", std::string("/depth")}}),
              HasSubstr("expected sensor_msgs/CameraInfo"));
  EXPECT_THAT(error(BagWriter().finish()), HasSubstr("has no colour images; it has no topics"));
}

TEST_F(RosbagTest, RefusesWhatIsNoBag) {
  EXPECT_THAT(input_error([&] {
                test::make_source("rosbag", {{"path", std::string("/none.bag")}});
              }),
              StartsWith("/none.bag: is missing"));
  EXPECT_THAT(error("a text"), HasSubstr("is not a bag"));
  EXPECT_THAT(error(""), HasSubstr("is empty; expected a recording of ROS: a bag of ROS 1"));
  EXPECT_THAT(error("#ROSBAG V1.2\n"), HasSubstr("older format"));
  std::string unindexed = tum_bag();
  const std::size_t index = unindexed.find("index_pos=") + 10;
  EXPECT_THAT(error(std::string(unindexed).replace(index, 8, 8, '\0')), HasSubstr("`rosbag reindex " + file()));
  EXPECT_THAT(error(unindexed.substr(0, unindexed.size() / 2)), AllOf(HasSubstr("is truncated"), HasSubstr("reindex")));
}

// Neither a crash nor silence, wherever it was cut.
TEST_F(RosbagTest, RefusesABagThatWasCutAnywhere) {
  for (const char* compression : {"none", "lz4"}) {
    const std::string bag = tum_bag(compression, 1);
    for (std::size_t size = 0; size < bag.size(); size += 1 + size / 100) {
      const std::string message = error(bag.substr(0, size));
      EXPECT_FALSE(message.empty()) << size;
    }
  }
}

TEST_F(RosbagTest, NeverReadsBeyondAMessage) {
  const auto with = [&](const std::string& message) {
    BagWriter bag;
    bag.add(colour_topic, image, received(0), colour_message(0));
    bag.add(colour_topic, image, received(1), message);
    return bag.finish();
  };
  const std::string pixels(64 * 48 * 3, 'x');
  const auto stamp = colour_stamp(1);
  EXPECT_THAT(error(with(image_message(stamp, "bgr8", 64, 48, 64 * 3, pixels.substr(1)))),
              HasSubstr("bytes of pixels"));
  EXPECT_THAT(error(with(image_message(stamp, "bgr8", 64, 48, 64 * 3 - 1, pixels))), HasSubstr("bytes of pixels"));
  EXPECT_THAT(error(with(image_message(stamp, "bgr8", 64, 0xffffffff, 64 * 3, pixels))), HasSubstr("64x4294967295"));
  EXPECT_THAT(error(with(image_message(stamp, "bgr8", 32, 48, 64 * 3, pixels))),
              HasSubstr("is 32x48 pixels, but the camera"));
  std::string longer = image_message(stamp, "bgr8", 64, 48, 64 * 3, pixels);
  longer.pop_back();
  const std::string message = error(with(longer));
  EXPECT_THAT(message, AllOf(HasSubstr("message of /camera/rgb/image_color at"), HasSubstr("its pixels takes 9216")));
  EXPECT_THAT(error(with("short")), HasSubstr("is cut short"));

  const auto source = open(with(longer), {{"on_bad_frame", std::string("skip")}});
  EXPECT_EQ(read_all(*source).size(), 1u);
  ASSERT_EQ(source->skipped().size(), 1u);
  EXPECT_EQ(source->skipped()[0].index, 1u);
  EXPECT_EQ(source->skipped()[0].reason, message);
}

TEST_F(RosbagTest, RefusesStampsThatDoNotIncrease) {
  BagWriter bag;
  for (int i = 0; i < 2; ++i) bag.add(colour_topic, image, received(i), image_message(0, "bgr8", colour_pixels(i)));
  EXPECT_THAT(error(bag.finish()), HasSubstr("as an earlier one of this topic"));
}

TEST_F(RosbagTest, RefusesADamagedChunk) {
  for (const char* compression : {"lz4", "bz2"}) {
    std::string bag = tum_bag(compression);
    const std::size_t chunk = bag.find("compression=") + 300;
    for (std::size_t i = 0; i < 40; ++i) bag[chunk + i] = static_cast<char>(bag[chunk + i] ^ 0x55);
    EXPECT_FALSE(error(bag).empty()) << compression;
  }
}

TEST_F(RosbagTest, StartFramesAndTruth) {
  const std::string truth = folder_.write("truth.txt", "1 1 2 3 0 0 0 1\n2 4 5 6 0 0 0 1\n");
  const auto source = open(tum_bag(), {{"start", std::int64_t{1}}, {"frames", std::int64_t{2}}, {"truth", truth}});
  EXPECT_EQ(source->describe().frame_count, 2u);
  EXPECT_EQ(source->truth().size(), 2u);
  EXPECT_EQ(source->next()->colour.at<cv::Vec3b>(0, 0)[0], 41);
}

/// A sensor_msgs/Imu of ROS 1.
std::string imu_message(std::uint64_t stamp, double rate, double force) {
  test::ByteText message;
  message.number(std::uint32_t{0}).number(static_cast<std::uint32_t>(stamp / 1'000'000'000));
  message.number(static_cast<std::uint32_t>(stamp % 1'000'000'000)).text("imu");
  for (int i = 0; i < 13; ++i) message.number(-1.0);
  for (int i = 0; i < 3; ++i) message.number(rate + i);
  for (int i = 0; i < 9; ++i) message.number(-2.0);
  for (int i = 0; i < 3; ++i) message.number(force + i);
  for (int i = 0; i < 9; ++i) message.number(-3.0);
  return message.bytes;
}

std::string bag_with_imu(const std::vector<std::string>& topics, std::size_t bytes = 1000) {
  BagWriter bag;
  for (int i = 0; i < 3; ++i) {
    bag.add(depth_topic, image, received(i), depth_message(i));
    bag.add(colour_topic, image, received(i) + 2000, colour_message(i));
    for (const std::string& topic : topics)
      for (int k = 0; k < 10; ++k)
        bag.add(topic, "sensor_msgs/Imu", received(i) + 3000,
                imu_message(colour_stamp(i) + 10'000'000ULL * static_cast<unsigned>(k), 0.1, 9.8).substr(0, bytes));
  }
  return bag.finish();
}

TEST_F(RosbagTest, FramesHaveTheInertialMeasurementsOfATopic) {
  EXPECT_FALSE(open(bag_with_imu({"/imu"}))->describe().has_imu) << "unless they are asked for";
  const auto source = open(bag_with_imu({"/imu"}), {{"imu", std::string("/imu")}});
  EXPECT_TRUE(source->describe().has_imu);
  const std::vector<SensorFrame> frames = read_all(*source);
  ASSERT_EQ(frames.size(), 3U);
  ASSERT_EQ(frames[1].imu.size(), 11U);
  EXPECT_EQ(frames[1].imu.front().timestamp, frames[0].timestamp);
  EXPECT_EQ(frames[1].imu.back().timestamp, frames[1].timestamp);
  EXPECT_EQ(frames[1].imu[5].angular_velocity, Eigen::Vector3d(0.1, 1.1, 2.1));
  EXPECT_EQ(frames[1].imu[5].acceleration, Eigen::Vector3d(9.8, 10.8, 11.8));
}

TEST_F(RosbagTest, ErrorsOfInertialMeasurementsNameTheTopics) {
  const ParameterValues other = {{"imu", std::string("/other")}};
  EXPECT_THAT(error(bag_with_imu({"/a", "/b"}), other), AllOf(HasSubstr("'/other'"), HasSubstr("has /a, /b")));
  EXPECT_THAT(error(bag_with_imu({}), other), HasSubstr("the recording has none"));
  EXPECT_THAT(error(bag_with_imu({"/a"}, 100), {{"imu", std::string("/a")}}), HasSubstr("covariance"));
}

}  // namespace
}  // namespace holdfast
