// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

#include "holdfast/image_files/phone_recording.hpp"
#include "recording.hpp"

namespace holdfast {
namespace {

using ::testing::AllOf;
using ::testing::EndsWith;
using ::testing::HasSubstr;

constexpr int depth_width = 16, depth_height = 12;  // a quarter of the colour images

/// An OpenEXR file by its specification (openexr.com, "OpenEXR File Layout"): one channel of floats, uncompressed.
std::string exr_file(int width, int height, const std::string& channel, const std::vector<float>& values) {
  std::string file;
  const auto number = [&](auto value) { file.append(reinterpret_cast<const char*>(&value), sizeof(value)); };
  const auto attribute = [&](const char* name, const char* type, std::uint32_t size) {
    file.append(name).push_back('\0');
    file.append(type).push_back('\0');
    number(size);
  };
  number(std::uint32_t{20000630});
  number(std::uint32_t{2});
  attribute("channels", "chlist", static_cast<std::uint32_t>(channel.size()) + 1 + 16 + 1);
  file.append(channel).push_back('\0');
  for (const std::uint32_t n : {2U, 0U, 1U, 1U}) number(n);  // floats, nonlinear, sampled at each pixel
  file.push_back('\0');
  attribute("compression", "compression", 1);
  file.push_back('\0');
  for (const char* window : {"dataWindow", "displayWindow"}) {
    attribute(window, "box2i", 16);
    for (const std::int32_t n : {0, 0, width - 1, height - 1}) number(n);
  }
  attribute("lineOrder", "lineOrder", 1);
  file.push_back('\0');
  attribute("pixelAspectRatio", "float", 4);
  number(1.0F);
  attribute("screenWindowCenter", "v2f", 8);
  number(0.0F), number(0.0F);
  attribute("screenWindowWidth", "float", 4);
  number(1.0F);
  file.push_back('\0');
  const auto row_bytes = static_cast<std::uint32_t>(width) * 4U;
  const std::uint64_t first = file.size() + 8U * static_cast<std::uint64_t>(height);
  for (int y = 0; y < height; ++y) number(std::uint64_t{first + static_cast<std::uint64_t>(y) * (8U + row_bytes)});
  for (int y = 0; y < height; ++y) {
    number(std::int32_t{y});
    number(row_bytes);
    for (int x = 0; x < width; ++x) number(values[static_cast<std::size_t>(y * width + x)]);
  }
  return file;
}

class PhoneTest : public ::testing::Test {
 protected:
  std::unique_ptr<FrameSource> open(ParameterValues values = {}) const {
    values["path"] = (folder_.path() / "rec").string();
    return test::make_source("phone", values);
  }
  /// The error after `from` was replaced by `to` in a file.
  std::string error_with(const std::string& name, const std::string& from, const std::string& to,
                         const ParameterValues& values = {}) const {
    const std::string before = folder_.read("rec/" + name);
    std::string content = before;
    const std::size_t place = content.find(from);
    EXPECT_NE(place, std::string::npos) << from;
    folder_.write("rec/" + name, content.replace(place, from.size(), to));
    const std::string message = test::input_error([&] { test::read_all(*open(values)); });
    folder_.write("rec/" + name, before);
    return message;
  }
  test::TemporaryFolder folder_;
};

/// Three frames of Record3D. The camera moves along x; its axes are those of OpenGL.
class Record3DTest : public PhoneTest {
 protected:
  Record3DTest() {
    std::vector<float> depth(depth_width * depth_height, 1.5F);
    depth[0] = std::numeric_limits<float>::quiet_NaN();
    depth[1] = 2.25F;
    for (int i = 0; i < 3; ++i) {
      folder_.write_image("rec/rgb/" + std::to_string(i) + ".jpg", test::colour_image(i));
      folder_.write("rec/depth/" + std::to_string(i) + ".exr", exr_file(depth_width, depth_height, "R", depth));
    }
    folder_.write("rec/metadata.json",
                  R"({"h":48,"w":64,"K":[50,0,0,0,51,0,32,24,1],"fps":60,"dw":16,"dh":12,
"frameTimestamps":[0.5,0.516,0.534],
"poses":[[0,0,0,1,0,0,0],[0,0,0,1,0.1,0,0],[0,0,0,1,0.2,0,0]]})");
  }
};

TEST_F(Record3DTest, ReadsColourDepthCameraAndPoses) {
  const auto source = open();
  const SourceDescription description = source->describe();
  EXPECT_EQ(description.name, "rec");
  EXPECT_TRUE(description.has_depth);
  EXPECT_FALSE(description.has_global_shutter);
  ASSERT_TRUE(description.camera.has_value());
  EXPECT_EQ(description.camera->fx, 50.0);
  EXPECT_EQ(description.camera->fy, 51.0);
  EXPECT_EQ(description.camera->cx, 31.5) << "the principal point is in the middle; pixel centres lie at integers";
  EXPECT_EQ(description.camera->cy, 23.5);
  EXPECT_NEAR(description.camera->frame_rate, 2.0 / 0.034, 1e-9);
  const Trajectory truth = source->truth();
  ASSERT_EQ(truth.size(), 3U);
  EXPECT_EQ(truth[2].timestamp, 0.534);
  EXPECT_EQ(truth[2].T_world_camera.translation().x(), 0.2);
  EXPECT_TRUE(truth[2].T_world_camera.linear().col(2).isApprox(-Eigen::Vector3d::UnitZ())) << "the view is along -z";
#ifdef HOLDFAST_OPENEXR
  const std::vector<SensorFrame> frames = test::read_all(*source);
  ASSERT_EQ(frames.size(), 3U);
  EXPECT_EQ(frames[1].timestamp, 0.516);
  ASSERT_EQ(frames[1].depth.size(), frames[1].colour.size());
  EXPECT_EQ(frames[1].depth.at<float>(3, 3), 0.0F) << "no number";
  EXPECT_EQ(frames[1].depth.at<float>(0, 4), 2.25F) << "pixel 1 covers the columns 4 to 7";
  EXPECT_EQ(frames[1].depth.at<float>(47, 63), 1.5F);
#else
  EXPECT_THAT(test::input_error([&] { test::read_all(*source); }), HasSubstr("libopenexr-dev"));
#endif
}

TEST_F(Record3DTest, ScalesFramesAndCamera) {
  std::string metadata = folder_.read("rec/metadata.json");
  metadata.replace(metadata.find("\"fps\""), 0,
                   "\"perFrameIntrinsicCoeffs\":[[52,52,31,23],[60,60,31,23],[48,48,31,23]],");
  folder_.write("rec/metadata.json", metadata);
  const auto source = open({{"width", 32}});
  const Camera camera = *source->describe().camera;
  EXPECT_EQ(camera.width, 32);
  EXPECT_EQ(camera.height, 24);
  EXPECT_EQ(camera.fx, 26.0) << "the median of the frames";
  EXPECT_EQ(camera.cx, 31.0 / 2 - 0.5) << "the left border is at -0.5";
#ifdef HOLDFAST_OPENEXR
  const std::optional<SensorFrame> frame = source->next();
  EXPECT_EQ(frame->colour.size(), cv::Size(32, 24));
  EXPECT_EQ(frame->depth.size(), cv::Size(32, 24));
  EXPECT_EQ(frame->depth.at<float>(0, 2), 2.25F);
#endif
  EXPECT_THAT(test::input_error([&] { open({{"width", 65}}); }), HasSubstr("has images of 64 pixels in width"));
}

TEST_F(Record3DTest, RefusesWhatDoesNotFitTogether) {
  EXPECT_THAT(error_with("metadata.json", "[50,0,0,0,51,0,32,24,1]", "[50,0,32,0,51,24,0,0,1]"),
              AllOf(HasSubstr("metadata.json:1:"), HasSubstr("column by column")));
  EXPECT_THAT(error_with("metadata.json", "[0.5,0.516,0.534]", "[0.5,0.516]"),
              AllOf(HasSubstr("metadata.json:2:"), HasSubstr("has 2 time stamps, but there are 3 images")));
  EXPECT_THAT(error_with("metadata.json", "0.534", "0.516"), HasSubstr("stamps that increase"));
  EXPECT_THAT(error_with("metadata.json", ",[0,0,0,1,0.2,0,0]", ""), HasSubstr("has 2 poses, but there are 3 images"));
  EXPECT_THAT(error_with("metadata.json", "\"w\":64,", ""), HasSubstr("lacks \"w\""));
  folder_.write("rec/other/rgbd/0.depth", "bvx2");
  folder_.write("rec/other/metadata", "{}");
  EXPECT_THAT(test::input_error([&] { find_phone_folder(folder_.path() / "rec/other"); }), HasSubstr("EXR + RGB"));
  EXPECT_THAT(test::input_error([&] { find_phone_folder(folder_.path()); }), HasSubstr("Stray Scanner"));
}

#ifdef HOLDFAST_OPENEXR
TEST_F(Record3DTest, RefusesDamagedDepth) {
  const std::string whole = folder_.read("rec/depth/1.exr");
  folder_.truncate("rec/depth/1.exr", 0.6);
  EXPECT_THAT(test::input_error([&] { test::read_all(*open()); }),
              AllOf(HasSubstr("1.exr"), HasSubstr("copy it again")));
  folder_.write("rec/depth/1.exr", exr_file(depth_width, depth_height, "G", std::vector<float>(192, 1.0F)));
  EXPECT_THAT(test::input_error([&] { test::read_all(*open()); }), HasSubstr("no channel R, Y or Z"));
  folder_.write("rec/depth/1.exr", exr_file(9000, 1, "R", std::vector<float>(9000, 1.0F)));
  EXPECT_THAT(test::input_error([&] { test::read_all(*open()); }), HasSubstr("at most 8192"));
  std::filesystem::remove(folder_.path() / "rec/depth/1.exr");
  EXPECT_THAT(test::input_error([&] { test::read_all(*open()); }), HasSubstr("1.exr: is missing"));
  const auto source = open({{"on_bad_frame", "skip"}});
  EXPECT_EQ(test::read_all(*source).size(), 2U);
  EXPECT_EQ(source->skipped().size(), 1U);
}
#endif

/// Three frames of NeRFCapture, the last two in the wrong order.
class TransformsTest : public PhoneTest {
 protected:
  TransformsTest() {
    for (int i = 0; i < 3; ++i) {
      folder_.write_image("rec/images/" + std::to_string(i) + ".png", test::colour_image(i));
      folder_.write_image("rec/images/" + std::to_string(i) + ".depth.png", test::depth_image(i));
    }
    folder_.write("rec/transforms.json",
                  "{\"fl_x\":50.0,\"fl_y\":50.0,\"cx\":32,\"cy\":24,\"w\":64,\"h\":48,\n"
                  "\"integer_depth_scale\":0.00015259021896696422,\"frames\":[\n" +
                      frame(0, 7.0) + ",\n" + frame(2, 7.2) + ",\n" + frame(1, 7.1) + "]}");
  }
  static std::string frame(int i, double stamp) {
    const std::string number = std::to_string(i);
    return R"({"file_path":"images/)" + number + R"(","depth_path":"images/)" + number + R"(.depth.png","timestamp":)" +
           std::to_string(stamp) + R"(,"fl_x":5)" + number + R"(.0,"transform_matrix":[[1,0,0,)" + number +
           "],[0,1,0,0],[0,0,1,0],[0,0,0,1]]}";
  }
};

TEST_F(TransformsTest, ReadsFramesInTheOrderOfTime) {
  const auto source = open();
  EXPECT_EQ(source->describe().camera->fx, 51.0) << "the median of the frames";
  EXPECT_EQ(source->describe().camera->fy, 50.0) << "that of the file";
  EXPECT_EQ(source->describe().camera->cx, 31.5) << "pixel centres lie at integers";
  const std::vector<SensorFrame> frames = test::read_all(*source);
  ASSERT_EQ(frames.size(), 3U);
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(frames[static_cast<std::size_t>(i)].timestamp, 7.0 + 0.1 * i, 1e-9);
    EXPECT_EQ(frames[static_cast<std::size_t>(i)].colour.at<cv::Vec3b>(0, 0)[0], 40 + i);
    EXPECT_NEAR(frames[static_cast<std::size_t>(i)].depth.at<float>(10, 20), (100 * i + 64 * 10 + 20) / 6553.5, 1e-6);
    EXPECT_EQ(source->truth()[static_cast<std::size_t>(i)].T_world_camera.translation().x(), i);
  }
}

TEST_F(TransformsTest, ReadsThoseOfNerfstudio) {
  std::string frames;
  for (int i = 0; i < 2; ++i)
    frames += std::string(i == 0 ? "" : ",") + R"({"file_path":"images/)" + std::to_string(i) +
              R"(.png","depth_file_path":"images/)" + std::to_string(i) +
              R"(.depth.png","transform_matrix":[[1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]]})";
  folder_.write("rec/transforms.json",
                R"({"fl_x":50,"fl_y":50,"cx":32,"cy":24,"w":64,"h":48,"camera_model":"OPENCV","k1":0.01,"p2":0.002,
"frames":[)" + frames +
                    "]}");
  const auto source = open({{"frame_rate", 10.0}});
  EXPECT_EQ(source->describe().camera->distortion, (Distortion{.k1 = 0.01, .p2 = 0.002}));
  const std::vector<SensorFrame> read = test::read_all(*source);
  ASSERT_EQ(read.size(), 2U);
  EXPECT_EQ(read[1].timestamp, 0.1);
  EXPECT_EQ(read[1].depth.at<float>(10, 20), static_cast<float>((100 + 64 * 10 + 20) / 1000.0)) << "millimetres";
}

TEST_F(TransformsTest, TakesTheDistortionOfTheFrames) {
  const std::string before = folder_.read("rec/transforms.json");
  const auto write = [&](const std::vector<std::string>& of_frames) {
    std::string content = before;
    std::size_t place = 0;
    for (const std::string& text : of_frames) {
      place = content.find("\"transform_matrix\"", place);
      content.insert(place, text);
      place += text.size() + 1;
    }
    folder_.write("rec/transforms.json", content);
  };
  const std::string fisheye = R"("camera_model":"OPENCV_FISHEYE","k1":0.02,)";
  write({fisheye, fisheye, fisheye});
  EXPECT_EQ(open()->describe().camera->distortion, (Distortion{.k1 = 0.02, .lens = Lens::fisheye}));
  write({fisheye, fisheye, R"("camera_model":"OPENCV_FISHEYE","k1":0.03,)"});
  EXPECT_THAT(test::input_error([&] { open(); }),
              AllOf(HasSubstr("transforms.json:5:"), HasSubstr("another distortion than the first frame")));
}

TEST_F(TransformsTest, RefusesWhatDoesNotFitTogether) {
  EXPECT_THAT(error_with("transforms.json", "0.00015259021896696422", "1.5259021896696422e-05"),
              AllOf(HasSubstr("transforms.json:2:"), HasSubstr("beyond 1.0")));
  EXPECT_THAT(error_with("transforms.json", "\"integer_depth_scale\":0.00015259021896696422,", ""),
              HasSubstr("source.phone.depth_factor"));
  EXPECT_THAT(error_with("transforms.json", "7.100000", "7.200000"), HasSubstr("the time stamp of another frame"));
  EXPECT_THAT(error_with("transforms.json", "\"timestamp\":7.100000,", ""), HasSubstr("of all frames or of none"));
  EXPECT_THAT(error_with("transforms.json", "\"fl_x\":51.0,", "\"w\":65,"), HasSubstr("64, as of the first frame"));
  EXPECT_THAT(error_with("transforms.json", "\"cx\":32,", ""),
              AllOf(HasSubstr("transforms.json:3:"), HasSubstr("\"cx\"")));
  EXPECT_THAT(error_with("transforms.json", "\"cy\"", "\"camera_model\":\"EQUIRECTANGULAR\",\"cy\""),
              HasSubstr("found the camera model 'EQUIRECTANGULAR'"));
  std::filesystem::remove(folder_.path() / "rec/images/1.depth.png");
  EXPECT_THAT(error_with("transforms.json", "\"depth_path\":\"images/1.depth.png\",", ""),
              HasSubstr("1.depth.png: is missing"));
}

/// Four frames of Stray Scanner; the first one has no line of its own in the depth folder: numbers begin at 5.
class StrayScannerTest : public PhoneTest {
 protected:
  StrayScannerTest() {
    write_video("FFV1");
    std::string rows = "timestamp, frame, x, y, z, qx, qy, qz, qw\n";
    for (int i = 0; i < 4; ++i) {
      char line[120];
      std::snprintf(line, sizeof(line), "%.4f, %06d, %d.5, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0\n", 300.0 + i / 60.0, 5 + i, i);
      rows += line;
      std::snprintf(line, sizeof(line), "%06d.png", 5 + i);
      cv::Mat confidence(depth_height, depth_width, CV_8UC1, cv::Scalar(2));
      confidence.at<std::uint8_t>(0, 0) = 1;
      confidence.at<std::uint8_t>(0, 1) = 0;
      folder_.write_image(std::string("rec/depth/") + line,
                          cv::Mat(depth_height, depth_width, CV_16UC1, cv::Scalar(1200 + i)));
      folder_.write_image(std::string("rec/confidence/") + line, confidence);
    }
    folder_.write("rec/odometry.csv", rows);
    folder_.write("rec/camera_matrix.csv", "50.0, 0.0, 32.0\n0.0, 51.0, 24.0\n0.0, 0.0, 1.0");
    folder_.write("rec/imu.csv", "timestamp, a_x, a_y, a_z, alpha_x, alpha_y, alpha_z\n300.0, 0, 0, -1, 0, 0, 0\n");
  }
  /// Four frames, in the container AVI.
  void write_video(const std::string& codec) const {
    cv::VideoWriter video((folder_.path() / "video.avi").string(), cv::CAP_FFMPEG,
                          cv::VideoWriter::fourcc(codec[0], codec[1], codec[2], codec[3]), 60.0, {64, 48});
    for (int i = 0; i < 4; ++i) video.write(test::colour_image(10 * i));
    video.release();
    std::filesystem::create_directories(folder_.path() / "rec");
    std::filesystem::rename(folder_.path() / "video.avi", folder_.path() / "rec/rgb.mp4");
  }
};

TEST_F(StrayScannerTest, ReadsVideoDepthAndPoses) {
  const auto source = open();
  EXPECT_EQ(source->describe().camera->width, 64) << "that of the video";
  EXPECT_EQ(source->describe().camera->cx, 31.5);
  EXPECT_FALSE(source->describe().has_imu) << "the unit of its accelerations is not sure";
  const std::vector<SensorFrame> frames = test::read_all(*source);
  ASSERT_EQ(frames.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(frames[i].colour.at<cv::Vec3b>(20, 20)[0], 40 + 10 * static_cast<int>(i), 2);
    EXPECT_EQ(frames[i].depth.at<float>(47, 63), static_cast<float>(1.2 + 0.001 * static_cast<double>(i)));
    EXPECT_EQ(frames[i].depth.at<float>(0, 0), frames[i].depth.at<float>(47, 63)) << "of medium confidence";
    EXPECT_EQ(frames[i].depth.at<float>(0, 4), 0.0F) << "of low confidence";
  }
  const Trajectory truth = source->truth();
  EXPECT_EQ(truth[3].T_world_camera.translation().x(), 3.5);
  EXPECT_TRUE(truth[3].T_world_camera.linear().isIdentity()) << "its axes are those of the image already";
  EXPECT_EQ(open({{"minimum_confidence", 0}})->next()->depth.at<float>(0, 4), 1.2F);
  EXPECT_EQ(open({{"minimum_confidence", 2}})->next()->depth.at<float>(0, 0), 0.0F);
}

TEST_F(StrayScannerTest, BeginsLater) {
  const auto source = open({{"start", 2}});
  EXPECT_NEAR(source->next()->colour.at<cv::Vec3b>(20, 20)[0], 60, 2);
}

TEST_F(StrayScannerTest, NumbersNoFramesAfterOneThatCannotBeDecoded) {
  write_video("MJPG");
  std::string video = folder_.read("rec/rgb.mp4");
  std::size_t second = video.find("00dc", video.find("movi"));
  second = video.find("00dc", second + 4);
  video.replace(second + 8, 200, std::string(200, '\0'));
  folder_.write("rec/rgb.mp4", video);
  EXPECT_THAT(test::input_error([&] { test::read_all(*open()); }),
              AllOf(HasSubstr("odometry.csv:3"), HasSubstr("cannot be decoded at frame 1; expected frame 1")));
  const auto source = open({{"on_bad_frame", "skip"}});
  const std::vector<SensorFrame> frames = test::read_all(*source);
  ASSERT_EQ(frames.size(), 1U) << "the others are not those of their lines";
  EXPECT_NEAR(frames[0].colour.at<cv::Vec3b>(20, 20)[0], 40, 4);
  EXPECT_EQ(source->skipped().size(), 3U);
}

TEST_F(StrayScannerTest, WantsALineForEachFrameOfTheVideo) {
  EXPECT_THAT(error_with("odometry.csv", "000006", "000007"),
              AllOf(HasSubstr("odometry.csv:3"), HasSubstr("is of frame 000007; expected frame 6")));
  EXPECT_THAT(error_with("odometry.csv", "000007", "000006"), HasSubstr("odometry.csv:4"));
  EXPECT_TRUE(open({{"frames", 2}})->warnings().empty());
  std::string rows = folder_.read("rec/odometry.csv");
  folder_.write("rec/odometry.csv", rows.substr(0, rows.find("300.05")));
  const Warnings warnings = open()->warnings();
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_THAT(warnings[0].to_string(),
              AllOf(HasSubstr("odometry.csv"), HasSubstr("has 3 lines, but the video has 4 frames")));
}

TEST_F(StrayScannerTest, TakesTheIntrinsicsOfEachLine) {
  std::string rows = "timestamp, frame, x, y, z, qx, qy, qz, qw, fx, fy, cx, cy\n";
  for (int i = 0; i < 3; ++i)
    rows += std::to_string(300.0 + i / 60.0) + ", 00000" + std::to_string(5 + i) + ", 0, 0, 0, 0, 0, 0, 1, 5" +
            std::to_string(i) + ", 50, 30, 20\n";
  folder_.write("rec/odometry.csv", rows);
  EXPECT_EQ(open()->describe().camera->fx, 51.0);
  EXPECT_EQ(open()->describe().camera->cy, 19.5);
}

TEST_F(StrayScannerTest, RefusesWhatDoesNotFitTogether) {
  EXPECT_THAT(error_with("odometry.csv", "300.0167", "299.0"),
              AllOf(HasSubstr("odometry.csv:3"), HasSubstr("increase")));
  EXPECT_THAT(error_with("odometry.csv", "timestamp, ", ""), HasSubstr("has no column 'timestamp'"));
  EXPECT_THAT(error_with("odometry.csv", "0.5, 0.0", "0.5, zero"), AllOf(HasSubstr(":2"), HasSubstr("found 'zero'")));
  EXPECT_THAT(error_with("odometry.csv", "0.0, 1.0\n", "0.0\n"), HasSubstr("has 8 values; expected 9"));
  EXPECT_THAT(error_with("odometry.csv", "0.0, 1.0\n", "0.0, 2.0\n"), HasSubstr("quaternion has the length 2.0"));
  EXPECT_THAT(error_with("camera_matrix.csv", "50.0", "-50.0"), HasSubstr("is not the matrix of a camera"));
  const std::string rows = folder_.read("rec/odometry.csv");
  folder_.write("rec/odometry.csv", rows + "300.5, 000009, 0, 0, 0, 0, 0, 0, 1\n");
  EXPECT_THAT(test::input_error([&] { test::read_all(*open()); }),
              AllOf(HasSubstr("odometry.csv:6"), HasSubstr("ends after 4 frames")));
  folder_.write("rec/odometry.csv", rows);
  folder_.write("rec/rgb.mp4", "no video");
  EXPECT_THAT(test::input_error([&] { open(); }), HasSubstr("cannot be opened as a video"));
  std::filesystem::remove(folder_.path() / "rec/rgb.mp4");
  EXPECT_THAT(test::input_error([&] { open(); }), HasSubstr("rgb.mp4: is missing"));
}

}  // namespace
}  // namespace holdfast
