// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>

#include "holdfast/image_files/truth_transform.hpp"
#include "sources/recording.hpp"

namespace holdfast {
namespace {

using test::colour_name;
using test::depth_name;
using test::input_error;
using test::read_all;
using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

class TumSourceTest : public testing::Test {
 protected:
  void SetUp() override { test::write_tum_recording(folder_, 5); }

  std::unique_ptr<FrameSource> open(ParameterValues values = {}, int width = test::recording_width,
                                    int height = test::recording_height) const {
    values["path"] = folder_.path().string();
    return test::make_source("tum", values, width, height);
  }
  /// The message of the error on opening and reading everything.
  std::string error(const ParameterValues& values = {}) const {
    return input_error([&] { read_all(*open(values)); });
  }
  std::string place(const char* list, int line) const {
    return (folder_.path() / list).string() + ':' + std::to_string(line) + ": ";
  }
  std::string full(const std::string& name) const { return (folder_.path() / name).string(); }
  /// Frame 2 is made bad and the rest is not: the error names its line, or one skipped frame does.
  void expect_bad_frame(const char* list, const std::string& image, const std::string& reason) const {
    const std::string expected = place(list, 4) + full(image) + ": " + reason;
    EXPECT_THAT(error(), AllOf(StartsWith(expected), HasSubstr("on_bad_frame: skip")));

    const auto source = open({{"on_bad_frame", std::string("skip")}});
    const std::vector<SensorFrame> frames = read_all(*source);
    ASSERT_EQ(frames.size(), 4u);
    EXPECT_EQ(frames[1].index, 1u);
    EXPECT_EQ(frames[2].index, 3u);
    const std::vector<SkippedFrame> skipped = source->skipped();
    ASSERT_EQ(skipped.size(), 1u);
    EXPECT_EQ(skipped[0].index, 2u);
    EXPECT_DOUBLE_EQ(skipped[0].timestamp, 100.2);
    EXPECT_THAT(skipped[0].reason, StartsWith(expected));
  }

  test::TemporaryFolder folder_;
};

TEST_F(TumSourceTest, GivesEveryPairInOrder) {
  const auto source = open();
  EXPECT_EQ(source->describe().frame_count, 5u);
  EXPECT_TRUE(source->describe().has_depth);
  EXPECT_EQ(source->describe().name, folder_.path().filename().string());
  EXPECT_FALSE(source->describe().camera.has_value());
  const std::vector<SensorFrame> frames = read_all(*source);
  ASSERT_EQ(frames.size(), 5u);
  for (int i = 0; i < 5; ++i) {
    const SensorFrame& frame = frames[static_cast<std::size_t>(i)];
    EXPECT_EQ(frame.index, static_cast<std::uint64_t>(i));
    EXPECT_NEAR(frame.timestamp, 100.0 + 0.1 * i, 1e-9);
    EXPECT_NEAR(frame.depth_delay, 0.004, 1e-9);
    ASSERT_EQ(frame.colour.type(), CV_8UC3);
    ASSERT_EQ(frame.depth.type(), CV_32FC1);
    EXPECT_NEAR(frame.colour.at<cv::Vec3b>(10, 10)[0], 40 + i, i % 2 == 0 ? 0 : 4);
    EXPECT_EQ(frame.depth.at<float>(0, 0), 0.0f);
    EXPECT_EQ(frame.depth.at<float>(20, 30), static_cast<float>((100 * i + 64 * 20 + 30) / 5000.0));
  }
  EXPECT_FALSE(source->next().has_value());
  EXPECT_TRUE(source->skipped().empty());
  EXPECT_TRUE(source->truth().empty());
}

TEST_F(TumSourceTest, DepthFactorStartAndFrames) {
  const auto source = open({{"depth_factor", 1000.0}, {"start", std::int64_t{1}}, {"frames", std::int64_t{3}}});
  EXPECT_EQ(source->describe().frame_count, 3u);
  const std::vector<SensorFrame> frames = read_all(*source);
  ASSERT_EQ(frames.size(), 3u);
  EXPECT_EQ(frames[0].index, 0u);
  EXPECT_NEAR(frames[0].timestamp, 100.1, 1e-9);
  EXPECT_EQ(frames[0].depth.at<float>(0, 5), static_cast<float>(105 / 1000.0));
  EXPECT_EQ(open({{"start", std::int64_t{3}}, {"frames", std::int64_t{9}}})->describe().frame_count, 2u);
  EXPECT_THAT(error({{"start", std::int64_t{5}}}), HasSubstr("has 5 colour and depth pairs, but `start` is 5"));
}

/// Depth images whose right part has the value `no_value`.
class DepthWithoutValue : public TumSourceTest {
 protected:
  void write_depth(int no_value) const {
    for (int i = 0; i < 5; ++i) {
      cv::Mat depth = test::depth_image(i);
      depth.colRange(50, depth.cols).setTo(no_value);
      folder_.write_image(depth_name(i), depth);
    }
  }
  float depth_of(const ParameterValues& values) const { return open(values)->next()->depth.at<float>(20, 55); }
};

TEST_F(DepthWithoutValue, TheEndOfTheRangeIsNoDistance) {
  write_depth(65535);
  EXPECT_EQ(depth_of({}), 0.0F);
  EXPECT_EQ(open()->next()->depth.at<float>(20, 30), static_cast<float>((64 * 20 + 30) / 5000.0)) << "beside it";
  EXPECT_EQ(depth_of({{"depth_factor", 5000.1}}), 0.0F) << "a factor that is no float";
  EXPECT_EQ(depth_of({{"invalid_depth", std::int64_t{0}}}), 13.107F);
  EXPECT_TRUE(open()->warnings().empty());
}

TEST_F(DepthWithoutValue, AnotherOneIsSuspectedAndCanBeSet) {
  EXPECT_TRUE(open()->warnings().empty());
  write_depth(20000);
  const Warnings warnings = open()->warnings();
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_THAT(warnings[0].to_string(),
              AllOf(StartsWith(full(depth_name(0)) + ": the largest depth 4.00 m (stored as 20000)"),
                    HasSubstr("`source.tum.invalid_depth: 20000`")));
  const ParameterValues set = {{"invalid_depth", std::int64_t{20000}}};
  EXPECT_TRUE(open(set)->warnings().empty());
  EXPECT_EQ(depth_of(set), 0.0F);
}

/// Depth that ends with the room: not far above the rest, not the same in every image, or of a drawn scene.
TEST_F(DepthWithoutValue, ARoomIsNotSuspected) {
  write_depth(3600);
  EXPECT_TRUE(open()->warnings().empty());
  write_depth(20000);
  cv::Mat other = test::depth_image(0);
  other.colRange(50, other.cols).setTo(21000);
  folder_.write_image(depth_name(0), other);
  EXPECT_TRUE(open()->warnings().empty());
  for (int i = 0; i < 5; ++i) {
    cv::Mat drawn(test::recording_height, test::recording_width, CV_16UC1, cv::Scalar(5000));
    drawn.colRange(30, drawn.cols).setTo(15000);
    folder_.write_image(depth_name(i), drawn);
  }
  EXPECT_TRUE(open()->warnings().empty());
}

TEST_F(TumSourceTest, AColourImageWithoutDepthNearbyMakesNoPair) {
  folder_.write("depth.txt", "100.001 " + depth_name(0) + "\n100.119 " + depth_name(1) + "\n100.225 " + depth_name(2) +
                                 "\n100.315 " + depth_name(3) + "\n");
  const std::vector<SensorFrame> frames = read_all(*open());
  ASSERT_EQ(frames.size(), 3u);  // the depth images of 100.2 and 100.4 are too far
  EXPECT_NEAR(frames[1].timestamp, 100.1, 1e-9);
  EXPECT_NEAR(frames[2].timestamp, 100.3, 1e-9);
  EXPECT_EQ(read_all(*open({{"max_time_difference", 0.01}})).size(), 1u);
}

TEST_F(TumSourceTest, ADepthImageServesTheNearestColourImageOnly) {
  folder_.write("rgb.txt", "100.000 " + colour_name(0) + "\n100.006 " + colour_name(1) + "\n");
  folder_.write("depth.txt", "100.004 " + depth_name(4) + "\n");
  const std::vector<SensorFrame> frames = read_all(*open());
  ASSERT_EQ(frames.size(), 1u);
  EXPECT_NEAR(frames[0].timestamp, 100.006, 1e-9);
}

TEST_F(TumSourceTest, ReadyPairsReplaceTheLists) {
  std::filesystem::remove(folder_.path() / "rgb.txt");
  std::filesystem::remove(folder_.path() / "depth.txt");
  const std::string file = folder_.write("pairs.txt", "7.0 " + colour_name(2) + " 9.0 " + depth_name(3) + "\n8.0 " +
                                                          colour_name(4) + " 9.5 depth/none.png\n");
  const auto source = open({{"associations", file}});
  const std::optional<SensorFrame> frame = source->next();
  ASSERT_TRUE(frame.has_value());
  EXPECT_EQ(frame->timestamp, 7.0);
  EXPECT_EQ(frame->colour.at<cv::Vec3b>(0, 0)[0], 42);
  EXPECT_EQ(frame->depth.at<float>(0, 1), static_cast<float>(301 / 5000.0));
  EXPECT_THAT(input_error([&] { source->next(); }),
              AllOf(StartsWith(file + ":2: "), HasSubstr("none.png: is missing")));
}

/// The transforms of Bonn RGB-D Dynamic by its page: T_world_camera = T_ROS T T_ROS T_m.
Eigen::Matrix4d bonn_ros() {
  Eigen::Matrix4d matrix;
  matrix << -1, 0, 0, 0, 0, 0, 1, 0, 0, 1, 0, 0, 0, 0, 0, 1;
  return matrix;
}
Eigen::Matrix4d bonn_markers() {
  Eigen::Matrix4d matrix;
  matrix << 1.0157, 0.1828, -0.2389, 0.0113, 0.0009, -0.8431, -0.6413, -0.0098, -0.3009, 0.6147, -0.8085, 0.0111, 0, 0,
      0, 1;
  return matrix;
}
RealTable rows_of(const Eigen::Matrix4d& matrix) {
  RealTable rows;
  for (int row = 0; row < 4; ++row) rows.push_back({matrix(row, 0), matrix(row, 1), matrix(row, 2), matrix(row, 3)});
  return rows;
}

TEST_F(TumSourceTest, TimeStampsThatAreNotSecondsAreSuspected) {
  EXPECT_TRUE(open()->warnings().empty());
  std::string colour, depth;
  for (int i = 0; i < 5; ++i) {
    colour += std::to_string(100 * i) + " " + colour_name(i) + "\n";
    depth += std::to_string(100 * i) + " " + depth_name(i) + "\n";
  }
  folder_.write("rgb.txt", colour);
  folder_.write("depth.txt", depth);
  const Warnings warnings = open()->warnings();
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_EQ(warnings[0].location.file, full("rgb.txt"));
  EXPECT_THAT(warnings[0].message,
              AllOf(HasSubstr("look like milliseconds or frame numbers (100"), HasSubstr("divide them by 1000")));
}

TEST_F(TumSourceTest, TruthOfMarkersBecomesThatOfTheCamera) {
  // The nearest rotation by another way than the source: Newton's iteration for the polar decomposition.
  Eigen::Isometry3d T_m = Eigen::Isometry3d::Identity();
  Eigen::Matrix3d rotation = bonn_markers().topLeftCorner<3, 3>();
  for (int i = 0; i < 20; ++i) rotation = (0.5 * (rotation + rotation.inverse().transpose())).eval();
  T_m.linear() = rotation;
  T_m.translation() = bonn_markers().topRightCorner<3, 1>();
  const Eigen::Isometry3d T_ros(bonn_ros());
  Trajectory camera, recorded;
  for (int i = 0; i < 5; ++i) {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.linear() = Eigen::AngleAxisd(0.3 * i, Eigen::Vector3d(1, 2, -1).normalized()).toRotationMatrix();
    pose.translation() = Eigen::Vector3d(0.2 * i, -0.1, 0.05 * i * i);
    camera.push_back({100.0 + 0.1 * i, pose});
    recorded.push_back({100.0 + 0.1 * i, T_ros.inverse() * pose * (T_ros * T_m).inverse()});
  }
  write_trajectory(folder_.path() / "groundtruth.txt", recorded);
  const auto source =
      open({{"truth_left", rows_of(bonn_ros())}, {"truth_right", rows_of(bonn_ros() * bonn_markers())}});
  EXPECT_EQ(source->describe().truth_frame, "transformed");
  const Trajectory truth = source->truth();
  ASSERT_EQ(truth.size(), camera.size());
  for (std::size_t i = 0; i < truth.size(); ++i) {
    EXPECT_EQ(truth[i].timestamp, camera[i].timestamp);
    EXPECT_TRUE(truth[i].T_world_camera.isApprox(camera[i].T_world_camera, 1e-7)) << i;
  }
  EXPECT_EQ(open()->describe().truth_frame, "raw");
  EXPECT_TRUE(open()->truth()[2].T_world_camera.isApprox(recorded[2].T_world_camera, 1e-7));
}

TEST_F(TumSourceTest, TheTransformOfAKnownDatasetIsTheDefault) {
  const auto given =
      make_truth_transform(rows_of(bonn_ros()), rows_of(bonn_ros() * bonn_markers()), "the page of the dataset");
  const Trajectory recorded = {{100.0, Eigen::Isometry3d(Eigen::Translation3d(1, 2, 3))},
                               {100.1, Eigen::Isometry3d(Eigen::AngleAxisd(0.4, Eigen::Vector3d::UnitY()))}};
  std::string lines = trajectory_text(recorded);
  lines.erase(0, lines.find('\n') + 1);
  folder_.write("groundtruth.txt", lines);
  const auto folder = folder_.path().parent_path() / "rgbd_bonn_crowd";
  std::filesystem::remove_all(folder);
  std::filesystem::copy(folder_.path(), folder, std::filesystem::copy_options::recursive);
  const auto open_bonn = [&](ParameterValues values) {
    values["path"] = folder.string();
    return test::make_source("tum", values, test::recording_width, test::recording_height);
  };
  const auto source = open_bonn({});
  EXPECT_EQ(source->describe().truth_frame, "transformed");
  ASSERT_EQ(source->truth().size(), 2U);
  for (std::size_t i = 0; i < 2; ++i)
    EXPECT_TRUE(
        source->truth()[i].T_world_camera.isApprox(given.left * recorded[i].T_world_camera * given.right, 1e-7));
  EXPECT_EQ(open_bonn({{"truth_frame", std::string("raw")}})->describe().truth_frame, "raw");
  EXPECT_TRUE(open_bonn({{"truth_left", rows_of(Eigen::Matrix4d::Identity())}})
                  ->truth()[0]
                  .T_world_camera.isApprox(recorded[0].T_world_camera, 1e-7));
  EXPECT_EQ(open()->describe().truth_frame, "raw") << "a folder of another name";
  // What Holdfast recorded from such a folder has the truth of the camera.
  std::ofstream(folder / "groundtruth.txt") << trajectory_text(recorded);
  EXPECT_EQ(open_bonn({})->describe().truth_frame, "raw");
  std::filesystem::remove_all(folder);

  EXPECT_TRUE(known_truth_transform("crowd", find_camera("bonn").value()).has_value());
  EXPECT_FALSE(known_truth_transform("crowd", find_camera("tum_fr3").value()).has_value());
}

TEST_F(TumSourceTest, RefusesATransformThatIsNoRigidMotion) {
  const auto message = [&](const RealTable& rows) { return error({{"truth_right", rows}}); };
  EXPECT_THAT(message({{1, 0, 0, 0}}), AllOf(HasSubstr("source.tum.truth_right: found [[1"), HasSubstr("four rows")));
  EXPECT_THAT(message({{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 1, 1}}), HasSubstr("found the last row"));
  EXPECT_THAT(message({{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, -1, 0}, {0, 0, 0, 1}}), HasSubstr("no rotation"));
  EXPECT_THAT(message({{2, 0, 0, 0}, {0, 2, 0, 0}, {0, 0, 2, 0}, {0, 0, 0, 1}}), HasSubstr("no rotation"));
}

TEST_F(TumSourceTest, TruthIsGivenWhereThereIsOne) {
  folder_.write("groundtruth.txt", "# t\n99 1 2 3 0 0 0 1\n101 4 5 6 0 0 0 1\n");
  const Trajectory truth = open()->truth();
  ASSERT_EQ(truth.size(), 2u);
  EXPECT_EQ(truth[1].timestamp, 101.0);
  EXPECT_EQ(truth[1].T_world_camera.translation(), Eigen::Vector3d(4, 5, 6));
  folder_.write("groundtruth.txt", "99 1 2 3 0 0 0 1\n101 4 5\n");
  EXPECT_THAT(error(), StartsWith(place("groundtruth.txt", 2)));
}

TEST_F(TumSourceTest, ARecordingMaySayThatItsRowsAreExposedAtOnce) {
  EXPECT_FALSE(open()->describe().has_global_shutter);
  folder_.write("shutter.txt", "rolling\n");
  EXPECT_FALSE(open()->describe().has_global_shutter);
  folder_.write("shutter.txt", "global\n");
  EXPECT_TRUE(open()->describe().has_global_shutter);
  folder_.write("shutter.txt", "glob\n");
  EXPECT_THAT(error(), AllOf(StartsWith(place("shutter.txt", 1)), HasSubstr("expected 'global'")));
}

TEST_F(TumSourceTest, BadFolders) {
  EXPECT_THAT(input_error([] {
                test::make_source("tum", {{"path", std::string("/nowhere/recording")}});
              }),
              AllOf(StartsWith("/nowhere/recording: is missing"), HasSubstr("source.tum.path")));
  EXPECT_THAT(input_error([&] {
                test::make_source("tum", {{"path", full("rgb.txt")}});
              }),
              StartsWith(full("rgb.txt") + ": is not a folder"));
}

TEST_F(TumSourceTest, BadListsAreErrorsEvenWhenBadFramesAreSkipped) {
  const ParameterValues skip{{"on_bad_frame", std::string("skip")}};
  const std::string good = folder_.read("depth.txt");
  folder_.write("depth.txt", good + "100.0 depth/9.png\n");
  EXPECT_THAT(error(skip), AllOf(StartsWith(place("depth.txt", 7)), HasSubstr("earlier than")));
  folder_.write("depth.txt", "# nothing\n");
  EXPECT_THAT(error(skip), StartsWith(full("depth.txt") + ": is an empty list"));
  std::filesystem::remove(folder_.path() / "depth.txt");
  EXPECT_THAT(error(skip), StartsWith(full("depth.txt") + ": is missing"));
  std::filesystem::remove(folder_.path() / "rgb.txt");
  EXPECT_THAT(error(skip), StartsWith(full("rgb.txt") + ": is missing"));
}

TEST_F(TumSourceTest, ListsOfDifferentTimesSaySo) {
  folder_.write("depth.txt", "500.5 depth/0.png\n501.25 depth/1.png\n");
  EXPECT_THAT(error(), AllOf(StartsWith(folder_.path().string() + ": no colour and depth image lie within 0.020000 s"),
                             HasSubstr("rgb.txt runs from 100.000000 to 100.400000 s"),
                             HasSubstr("depth.txt from 500.500000 to 501.250000 s")));
}

TEST_F(TumSourceTest, MissingColour) {
  std::filesystem::remove(folder_.path() / colour_name(2));
  expect_bad_frame("rgb.txt", colour_name(2), "is missing");
}

TEST_F(TumSourceTest, MissingDepth) {
  std::filesystem::remove(folder_.path() / depth_name(2));
  expect_bad_frame("depth.txt", depth_name(2), "is missing");
}

TEST_F(TumSourceTest, TruncatedColour) {
  folder_.truncate(colour_name(2), 0.6);
  expect_bad_frame("rgb.txt", colour_name(2), "is truncated");
}

TEST_F(TumSourceTest, TruncatedDepth) {
  folder_.truncate(depth_name(2), 0.6);
  expect_bad_frame("depth.txt", depth_name(2), "is truncated");
}

TEST_F(TumSourceTest, EightBitDepth) {
  folder_.write_image(depth_name(2), cv::Mat(48, 64, CV_8UC1, cv::Scalar(9)));
  expect_bad_frame("depth.txt", depth_name(2), "is a PNG image of 64x48, 1 channel of 8 bits; expected a depth image");
}

TEST_F(TumSourceTest, GreyColour) {
  folder_.write_image(colour_name(2), cv::Mat(48, 64, CV_8UC1, cv::Scalar(9)));
  const std::vector<SensorFrame> frames = read_all(*open());
  ASSERT_EQ(frames.size(), 5u);
  EXPECT_EQ(frames[2].colour.at<cv::Vec3b>(5, 7), cv::Vec3b::all(9));
  EXPECT_FALSE(frames[2].depth.empty());
}

TEST_F(TumSourceTest, DeepColour) {
  folder_.write_image(colour_name(2), cv::Mat(48, 64, CV_16UC1, cv::Scalar(9)));
  expect_bad_frame("rgb.txt", colour_name(2),
                   "is an image of 64x48, 1 channel of 16 bits; expected a grey or colour image");
}

TEST_F(TumSourceTest, ExchangedColourAndDepthAreNamed) {
  const std::string pairs = folder_.write("pairs.txt", "7.0 " + depth_name(2) + " 9.0 " + colour_name(2) + "\n");
  EXPECT_THAT(error({{"associations", pairs}}),
              AllOf(StartsWith(pairs + ":1: "), HasSubstr("is a depth image, 1 channel of 16 bits"),
                    HasSubstr("colour and depth are exchanged; exchange the columns of the associations")));
  const std::string colour = folder_.read("rgb.txt");
  folder_.write("rgb.txt", folder_.read("depth.txt"));
  folder_.write("depth.txt", colour);
  EXPECT_THAT(error(), HasSubstr("are exchanged; exchange the names of the two lists"));
}

TEST_F(TumSourceTest, OneCameraNeedsNoDepth) {
  std::filesystem::remove(folder_.path() / "depth.txt");
  EXPECT_THAT(error(), AllOf(StartsWith(full("depth.txt") + ": is missing"), HasSubstr("set `sensor: mono`")));
  const auto source = test::make_mono_source("tum", {{"path", folder_.path().string()}, {"start", std::int64_t{1}}});
  EXPECT_FALSE(source->describe().has_depth);
  const std::vector<SensorFrame> frames = read_all(*source);
  ASSERT_EQ(frames.size(), 4u);
  EXPECT_DOUBLE_EQ(frames[0].timestamp, 100.1);
  EXPECT_TRUE(frames[0].depth.empty());
}

TEST_F(TumSourceTest, DoesNotAdviseToLeaveOutAllFrames) {
  // Every image has another size than the camera.
  const std::string message = input_error([&] { read_all(*open({}, 640, 480)); });
  EXPECT_THAT(message, HasSubstr("is 64x48 pixels, but the camera is 640x480; give the camera of this recording"));
  EXPECT_THAT(message, testing::Not(HasSubstr("on_bad_frame")));
}

TEST_F(TumSourceTest, DepthOfAnotherSize) {
  folder_.write_image(depth_name(2), test::depth_image(2, 32, 24));
  expect_bad_frame("depth.txt", depth_name(2),
                   "is 32x24 pixels, but its colour image '" + full(colour_name(2)) + "' is 64x48; expected");
}

TEST_F(TumSourceTest, ImageOfAnotherSizeThanTheCamera) {
  folder_.write_image(colour_name(2), test::colour_image(2, 32, 24));
  expect_bad_frame("rgb.txt", colour_name(2), "is 32x24 pixels, but the camera is 64x48; give the camera");
}

/// The checksum of a PNG's chunk (ISO/IEC 15948, annex D).
std::uint32_t png_checksum(const std::string& bytes) {
  std::uint32_t value = 0xffffffffu;
  for (const char byte : bytes) {
    value ^= static_cast<unsigned char>(byte);
    for (int bit = 0; bit < 8; ++bit) value = (value & 1) != 0 ? 0xedb88320u ^ (value >> 1) : value >> 1;
  }
  return ~value;
}

std::string big_endian(std::uint32_t value) {
  std::string bytes;
  for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(value >> shift);
  return bytes;
}

/// Its pixels cannot be decoded: the size must be found before that.
TEST_F(TumSourceTest, SizesAreComparedBeforeAnImageIsDecoded) {
  for (const std::string& name : {colour_name(2), depth_name(2)}) {
    std::string bytes = folder_.read(name.c_str());
    bytes.replace(16, 8, big_endian(9999) + big_endian(9999));
    bytes.replace(29, 4, big_endian(png_checksum(bytes.substr(12, 17))));
    folder_.write(name.c_str(), bytes);
    expect_bad_frame(name == colour_name(2) ? "rgb.txt" : "depth.txt", name, "is 9999x9999 pixels, but ");
    if (name == colour_name(2)) folder_.write_image(name, test::colour_image(2));
  }
}

TEST_F(TumSourceTest, SkippingEveryFrameIsAnError) {
  const auto source = open({{"on_bad_frame", std::string("skip")}}, 640, 480);
  EXPECT_THAT(input_error([&] { read_all(*source); }),
              AllOf(HasSubstr("none of the 5 frames can be used; the first: " + place("rgb.txt", 2)),
                    HasSubstr("is 64x48 pixels, but the camera is 640x480")));
  EXPECT_EQ(source->skipped().size(), 5u);
}

}  // namespace
}  // namespace holdfast
