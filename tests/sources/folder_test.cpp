// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <opencv2/core.hpp>
#include <sstream>

#include "sources/recording.hpp"

namespace holdfast {
namespace {

using test::input_error;
using test::read_all;
using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

const std::string text_skip = "skip";

class FolderSourceTest : public testing::Test {
 protected:
  std::unique_ptr<FrameSource> open(ParameterValues values = {}) const {
    values["path"] = folder_.path().string();
    return test::make_source("folder", values);
  }
  std::string error(const ParameterValues& values = {}) const {
    return input_error([&] { read_all(*open(values)); });
  }
  std::string full(const std::string& name) const { return (folder_.path() / name).string(); }
  void write_colour(const std::string& name, int number) const {
    folder_.write_image(name, test::colour_image(number));
  }
  void write_depth(const std::string& name, int number) const { folder_.write_image(name, test::depth_image(number)); }
  static int number_of(const SensorFrame& frame) { return frame.colour.at<cv::Vec3b>(0, 0)[0] - 40; }

  test::TemporaryFolder folder_;
};

TEST_F(FolderSourceTest, PassesOverFramesThatAreDue) {
  for (const int number : {1, 2, 3, 4}) write_colour("colour/" + std::to_string(number) + ".png", number);
  const auto source = open({{"frame_rate", 10.0}});
  EXPECT_EQ(number_of(*source->next()), 1);
  EXPECT_TRUE(source->pass_over(0.15).empty()) << "the second one is the newest that is due";
  EXPECT_EQ(source->pass_over(0.25), std::vector<double>{0.1});
  EXPECT_EQ(number_of(*source->next()), 3);
  EXPECT_TRUE(source->pass_over(9.0).empty()) << "the last one is never passed over";
  EXPECT_EQ(number_of(*source->next()), 4);
}

TEST_F(FolderSourceTest, NaturalOrderAndStampsFromTheFrameRate) {
  for (const int number : {10, 9, 100, 2}) write_colour("colour/image" + std::to_string(number) + ".png", number);
  folder_.write("colour/notes.txt", "not an image");
  const auto source = open({{"frame_rate", 20.0}});
  EXPECT_FALSE(source->describe().has_depth);
  EXPECT_EQ(source->describe().frame_count, 4u);
  const std::vector<SensorFrame> frames = read_all(*source);
  ASSERT_EQ(frames.size(), 4u);
  EXPECT_EQ(number_of(frames[0]), 2);
  EXPECT_EQ(number_of(frames[1]), 9);
  EXPECT_EQ(number_of(frames[2]), 10);
  EXPECT_EQ(number_of(frames[3]), 100);
  EXPECT_EQ(frames[3].timestamp, 3 / 20.0);
  EXPECT_TRUE(frames[0].depth.empty());
}

TEST_F(FolderSourceTest, DepthFoldersPairByNumber) {
  for (const int number : {1, 2, 3}) {
    write_colour("colour/frame000" + std::to_string(number) + ".png", number);
    if (number != 2) write_depth("depth/d" + std::to_string(number) + ".png", number);
  }
  write_depth("depth/d7.png", 7);
  const auto source = open({{"depth", std::string("depth")}, {"depth_factor", 1000.0}, {"on_bad_frame", text_skip}});
  EXPECT_TRUE(source->describe().has_depth);
  const std::vector<SensorFrame> frames = read_all(*source);
  ASSERT_EQ(frames.size(), 2u);
  EXPECT_EQ(number_of(frames[1]), 3);
  EXPECT_EQ(frames[1].depth.at<float>(0, 1), static_cast<float>(301 / 1000.0));
  ASSERT_EQ(source->skipped().size(), 1u);
  EXPECT_THAT(source->skipped()[0].reason, StartsWith(full("depth/frame0002.png") + ": is missing"));
}

TEST_F(FolderSourceTest, PatternsListTheGapsAsMissing) {
  for (const int number : {4, 5, 7}) {
    write_colour("frame-00000" + std::to_string(number) + ".color.png", number);
    write_depth("frame-00000" + std::to_string(number) + ".depth.png", number);
  }
  const ParameterValues patterns{{"colour", std::string("frame-%06d.color.png")},
                                 {"depth", std::string("frame-%06d.depth.png")}};
  EXPECT_THAT(error(patterns),
              AllOf(StartsWith(full("frame-000006.color.png") + ": is missing"), HasSubstr("on_bad_frame: skip")));
  ParameterValues skipping = patterns;
  skipping["on_bad_frame"] = text_skip;
  const auto source = open(skipping);
  const std::vector<SensorFrame> frames = read_all(*source);
  ASSERT_EQ(frames.size(), 3u);
  EXPECT_EQ(frames[2].index, 3u);
  EXPECT_EQ(frames[2].timestamp, 3 / 30.0);
  EXPECT_EQ(number_of(frames[2]), 7);
  EXPECT_EQ(source->skipped().size(), 1u);
}

TEST_F(FolderSourceTest, BadPatterns) {
  write_colour("colour/1.png", 1);
  for (const char* pattern :
       {"colour/%s.png", "colour/%d_%d.png", "colour/%6d.png", "%d/colour.png", "colour/%", "colour/%0d.png"})
    EXPECT_THAT(error({{"colour", std::string(pattern)}}), HasSubstr("is not a pattern that can be used")) << pattern;
  EXPECT_THAT(error({{"colour", std::string("colour/%06d.png")}}),
              StartsWith(full("colour/%06d.png") + ": fits no file"));
  EXPECT_EQ(read_all(*open({{"colour", std::string("colour/%d.png")}})).size(), 1u);
  EXPECT_THAT(error({{"colour", std::string("colour/%d.png")}, {"depth", std::string("depth")}}),
              HasSubstr("is a folder, but the colour images 'colour/%d.png' are a pattern"));
}

TEST_F(FolderSourceTest, BadFolders) {
  EXPECT_THAT(error(), StartsWith(full("colour") + ": is missing"));
  folder_.write("colour/readme.txt", "");
  EXPECT_THAT(error(), StartsWith(full("colour") + ": holds no image"));
  write_colour("colour/1.png", 1);
  write_colour("colour/01.jpg", 1);
  EXPECT_THAT(error(), AllOf(HasSubstr("has the same number as"), HasSubstr(full("colour/01.jpg")),
                             HasSubstr(full("colour/1.png"))));
  write_colour("colour/cover.png", 1);
  EXPECT_THAT(error(), StartsWith(full("colour/cover.png") + ": has no number"));
  EXPECT_THAT(input_error([] {
                test::make_source("folder", {{"path", std::string("/nowhere")}});
              }),
              AllOf(StartsWith("/nowhere: is missing"), HasSubstr("source.folder.path")));
}

TEST_F(FolderSourceTest, StampsTruthAndRange) {
  for (const int number : {1, 2, 3}) write_colour("colour/" + std::to_string(number) + ".png", number);
  const std::string stamps = folder_.write("stamps.txt", "# s\n10.5\n11\n12.25\n");
  const std::string truth = folder_.write("truth.txt", "10 1 2 3 0 0 0 1\n");
  const auto source =
      open({{"stamps", stamps}, {"truth", truth}, {"start", std::int64_t{1}}, {"frames", std::int64_t{1}}});
  EXPECT_EQ(source->truth().size(), 1u);
  const std::vector<SensorFrame> frames = read_all(*source);
  ASSERT_EQ(frames.size(), 1u);
  EXPECT_EQ(frames[0].timestamp, 11.0);
  EXPECT_EQ(number_of(frames[0]), 2);
  EXPECT_THAT(error({{"start", std::int64_t{3}}}), HasSubstr("has 3 frames, but `start` is 3"));

  folder_.write("stamps.txt", "10.5\n11\n");
  EXPECT_THAT(error({{"stamps", stamps}}),
              AllOf(StartsWith(stamps + ":2: "), HasSubstr("2 stamps, but there are 3 images")));
  folder_.write("stamps.txt", "10.5\n11\n11\n");
  EXPECT_THAT(error({{"stamps", stamps}}), AllOf(StartsWith(stamps + ":3: "), HasSubstr("the same as in line 2")));
  EXPECT_THAT(error({{"truth", full("none.txt")}}), StartsWith(full("none.txt")));
}

TEST_F(FolderSourceTest, GreyImagesMayHaveDepthAndExchangedFoldersAreNamed) {
  folder_.write_image("colour/1.png", cv::Mat(48, 64, CV_8UC1, cv::Scalar(9)));
  folder_.write_image("depth/1.png", test::depth_image(1));
  const auto source = open({{"depth", std::string("depth")}});
  const std::optional<SensorFrame> frame = source->next();
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->colour.at<cv::Vec3b>(5, 7), cv::Vec3b::all(9));
  EXPECT_GT(frame->depth.at<float>(5, 7), 0.0F);
  EXPECT_THAT(error({{"colour", std::string("depth")}, {"depth", std::string("colour")}}),
              HasSubstr("colour and depth are exchanged; exchange the names of their folders"));
}

TEST_F(FolderSourceTest, BadImagesNameTheFile) {
  write_colour("colour/1.png", 1);
  write_colour("colour/2.jpg", 2);
  folder_.truncate("colour/2.jpg", 0.7);
  EXPECT_THAT(error(), StartsWith(full("colour/2.jpg") + ": is truncated"));
  folder_.write_image("colour/2.jpg", test::colour_image(2, 32, 24));
  EXPECT_THAT(error(), StartsWith(full("colour/2.jpg") + ": is 32x24 pixels, but the camera is 64x48"));
}

TEST_F(FolderSourceTest, IntrinsicsComeThroughTheDescription) {
  folder_.write_image("colour/1.png", test::colour_image(1, 32, 24));
  const std::string yaml =
      folder_.write("camera.yaml", "fx: 30\nfy: 31.5\ncx: 15.5\ncy: 11.5\nwidth: 32\nheight: 24\nk1: 0.25\n");
  const auto source = open({{"intrinsics", yaml}, {"frame_rate", 15.0}});
  const std::optional<Camera> camera = source->describe().camera;
  ASSERT_TRUE(camera.has_value());
  EXPECT_EQ(camera->fx, 30.0);
  EXPECT_EQ(camera->fy, 31.5);
  EXPECT_EQ(camera->width, 32);
  EXPECT_EQ(camera->height, 24);
  EXPECT_EQ(camera->distortion.k1, 0.25);
  EXPECT_EQ(camera->distortion.k3, 0.0);
  EXPECT_EQ(camera->frame_rate, 15.0);
  EXPECT_EQ(camera->name, "camera.yaml");
  EXPECT_EQ(read_all(*source).size(), 1u);  // the size is that of this camera, not of the configuration's

  const std::string json = folder_.write(
      "camera.json", R"({"fx": 30, "fy": 32, "cx": 15, "cy": 11, "width": 32, "height": 24, "p2": -0.05})");
  EXPECT_EQ(open({{"intrinsics", json}})->describe().camera->distortion.p2, -0.05);
}

TEST_F(FolderSourceTest, StereoPairsPairByNumberAndMayBeGrey) {
  for (const int number : {1, 2, 3}) {
    cv::Mat grey;
    cv::extractChannel(test::colour_image(number), grey, 0);
    folder_.write_image("left/" + std::to_string(number) + ".png", grey);
    if (number != 2) folder_.write_image("right/r0" + std::to_string(number) + ".png", grey);
  }
  const std::string camera =
      folder_.write("camera.yaml", "fx: 60\nfy: 60\ncx: 32\ncy: 24\nwidth: 64\nheight: 48\nbaseline: 0.12\n");
  const auto source = open({{"colour", std::string("left")},
                            {"right", std::string("right")},
                            {"intrinsics", camera},
                            {"on_bad_frame", text_skip}});
  EXPECT_TRUE(source->describe().has_right);
  EXPECT_EQ(source->describe().camera->baseline, 0.12);
  const std::vector<SensorFrame> frames = read_all(*source);
  ASSERT_EQ(frames.size(), 2u);
  EXPECT_EQ(number_of(frames[1]), 3);
  EXPECT_EQ(frames[1].right.at<std::uint8_t>(0, 0), 43);
  EXPECT_EQ(source->skipped().at(0).index, 1u);
  EXPECT_THAT(source->skipped().at(0).reason, HasSubstr("right/2.png"));
  EXPECT_THAT(error({{"colour", std::string("left")}, {"right", std::string("right/%d.png")}}),
              HasSubstr("expected two patterns or two folders"));
}

TEST_F(FolderSourceTest, APairThatIsNotRectifiedIsRectified) {
  for (const char* side : {"left", "right"}) folder_.write_image(std::string(side) + "/1.png", test::colour_image(1));
  const std::string numbers = "fx: 60, fy: 60, cx: 32, cy: 24, width: 64, height: 48, ";
  const auto open_with = [&](const std::string& pose, const std::string& more = "") {
    return open(
        {{"colour", std::string("left")},
         {"right", std::string("right")},
         {"intrinsics", folder_.write("camera.yaml", "{" + numbers + "k1: -0.1, right: {" + numbers +
                                                         "lens: fisheye, k4: 0.01, " + pose + "}" + more + "}\n")}});
  };
  const auto source = open_with("T_left_right: [[1, 0, 0, 0.2], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]");
  const std::optional<Camera> camera = source->describe().camera;
  EXPECT_TRUE(camera->distortion.is_zero());
  EXPECT_NEAR(camera->baseline, 0.2, 1e-12);
  EXPECT_EQ(read_all(*source).at(0).right.cols, 64);
  const auto wrong = [&](const std::string& pose, const std::string& more = "") {
    return input_error([&] { open_with(pose, more); });
  };
  EXPECT_THAT(wrong("k1: 0"), AllOf(StartsWith(full("camera.yaml") + ":1:"), HasSubstr("lacks T_left_right")));
  EXPECT_THAT(wrong("T_left_right: [1, 0, 0]"), HasSubstr("expected a list of 16 numbers"));
  EXPECT_THAT(wrong("T_left_right: [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 1, 1]]"),
              HasSubstr("not a rigid motion"));
  EXPECT_THAT(wrong("T_left_right: [[1, 0, 0, -1], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]"),
              HasSubstr("exchange the cameras"));
  EXPECT_THAT(wrong("baseline: 1"), HasSubstr("unknown key 'baseline'"));
  EXPECT_THAT(wrong("p1: 0.1, T_left_right: [1, 0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]"),
              HasSubstr("k1, k2, k3 and k4 alone"));
  EXPECT_THAT(wrong("k1: 0", ", lens: fishey"), HasSubstr("did you mean 'fisheye'?"));
  EXPECT_THAT(wrong("k1: -0.45, T_left_right: [1, 0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]"),
              AllOf(StartsWith(full("camera.yaml") + ":1:"), HasSubstr("has no inverse in the image")));
}

/// A pose of frame i, and its matrix of three or four rows as text, its numbers separated by `between`.
Eigen::Isometry3d pose_at(int i) {
  Eigen::Isometry3d pose(Eigen::AngleAxisd(0.2 * i, Eigen::Vector3d(0.0, 0.6, 0.8)));
  pose.translation() = Eigen::Vector3d(0.1 * i, -0.2, 1.0);
  return pose;
}
std::string matrix_text(const Eigen::Isometry3d& pose, int rows, const char* after_row, const char* between = " ") {
  std::ostringstream text;
  text.precision(12);
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < 4; ++column)
      text << pose.matrix()(row, column) << (column < 3 ? between : row + 1 < rows ? after_row : "");
  return text.str();
}
/// An array of NumPy with n x 4 x 4 numbers.
template <class Number>
std::string array_text(const std::vector<Eigen::Isometry3d>& poses, const std::string& type) {
  std::string header =
      "{'descr': '" + type + "', 'fortran_order': False, 'shape': (" + std::to_string(poses.size()) + ", 4, 4), }";
  header.resize(117, ' ');
  std::string text =
      std::string("\x93NUMPY\x01", 7) + std::string(1, '\0') + "v" + std::string(1, '\0') + header + "\n";
  for (const Eigen::Isometry3d& pose : poses)
    for (int row = 0; row < 4; ++row)
      for (int column = 0; column < 4; ++column) {
        const auto number = static_cast<Number>(pose.matrix()(row, column));
        text.append(reinterpret_cast<const char*>(&number), sizeof(number));
      }
  return text;
}

class FolderPosesTest : public FolderSourceTest {
 protected:
  FolderPosesTest() {
    for (int i = 0; i < 3; ++i) {
      write_colour("colour/frame-00000" + std::to_string(i) + ".color.png", i);
      poses_.push_back(pose_at(i));
      all_ += matrix_text(pose_at(i), 4, " ") + "\n";
    }
  }
  Trajectory truth(const std::string& name, ParameterValues values = {}) const {
    values["truth"] = full(name);
    return open(values)->truth();
  }
  static void expect_poses(const Trajectory& truth, std::vector<int> frames = {0, 1, 2}) {
    ASSERT_EQ(truth.size(), frames.size());
    for (std::size_t i = 0; i < truth.size(); ++i) {
      EXPECT_DOUBLE_EQ(truth[i].timestamp, frames[i] / 30.0);
      EXPECT_TRUE(truth[i].T_world_camera.isApprox(pose_at(frames[i]), 1e-5)) << i;
    }
  }
  std::string truth_error(const std::string& name) const {
    return input_error([&] { truth(name); });
  }

  std::vector<Eigen::Isometry3d> poses_;
  std::string all_;  // a 4 x 4 matrix a line
};

TEST_F(FolderPosesTest, MatricesOfEveryLayoutAreTheTruth) {
  folder_.write("traj.txt", "# one line an image\n" + all_);
  expect_poses(truth("traj.txt"));
  expect_poses(truth("traj.txt", {{"start", std::int64_t{1}}, {"frames", std::int64_t{1}}}), {1});
  std::string rows;
  for (int i = 0; i < 3; ++i) {
    rows += matrix_text(pose_at(i), 3, " ") + "\n";
    folder_.write("pose/" + std::to_string(i) + ".txt", matrix_text(pose_at(i), 4, "\n") + "\n");
    folder_.write("colour/frame-00000" + std::to_string(i) + ".pose.txt", matrix_text(pose_at(i), 4, "\t\n", "\t "));
  }
  folder_.write("kitti.txt", rows);
  expect_poses(truth("kitti.txt"));
  expect_poses(truth("pose"));
  expect_poses(truth("colour/frame-%06d.pose.txt"));
  folder_.write("pose/1.txt", "-inf -inf -inf -inf\n-inf -inf -inf -inf\n-inf -inf -inf -inf\n-inf -inf -inf -inf\n");
  expect_poses(truth("pose"), {0, 2});
  folder_.write("poses.npy", array_text<double>(poses_, "<f8"));
  expect_poses(truth("poses.npy"));
  folder_.write("poses.npy", array_text<float>(poses_, "<f4"));
  expect_poses(truth("poses.npy"));
  folder_.write("truth.txt", "# timestamp tx ty tz qx qy qz qw\n5 1 2 3 0 0 0 1\n");
  EXPECT_EQ(truth("truth.txt")[0].timestamp, 5.0);
}

TEST_F(FolderPosesTest, CamerasOfOpenGlAreTurned) {
  std::string frames, quaternions;
  for (int i = 2; i >= 0; --i) {  // by their names, not in order
    Eigen::Isometry3d pose = pose_at(i);
    pose.linear() = pose.linear() * Eigen::Vector3d(1, -1, -1).asDiagonal();
    frames += std::string(i < 2 ? "," : "") + "{\"file_path\": \"images/frame_" + std::to_string(i) +
              ".jpg\", \"transform_matrix\": [[" + matrix_text(pose, 4, "],[", ",") + "]]}";
    const Eigen::Quaterniond q(pose.linear());
    std::ostringstream text;
    text.precision(12);
    text << "[" << q.x() << "," << q.y() << "," << q.z() << "," << q.w() << "," << pose.translation().x() << ","
         << pose.translation().y() << "," << pose.translation().z() << "]" << (i < 2 ? "," : "");
    quaternions = text.str() + quaternions;
  }
  folder_.write("transforms.json", "{\"fl_x\": 500, \"frames\": [" + frames + "]}");
  expect_poses(truth("transforms.json"));
  folder_.write("metadata.json", "{\"w\": 64, \"poses\": [" + quaternions + "]}");
  expect_poses(truth("metadata.json"));
}

TEST_F(FolderPosesTest, SayWhatIsWrong) {
  folder_.write("traj.txt", all_ + matrix_text(pose_at(3), 4, " ") + "\n");
  EXPECT_THAT(truth_error("traj.txt"), HasSubstr("traj.txt: has 4 poses, but there are 3 images"));
  folder_.write("traj.txt", "2 0 0 0 0 2 0 0 0 0 2 0 0 0 0 1\n");
  EXPECT_THAT(truth_error("traj.txt"),
              HasSubstr("traj.txt:1: is not a pose: its 3 x 3 part is not a rotation, or a scaled"));
  folder_.write("traj.txt", "1 0 0 0 0 1 0 0 0 0 -1 0 0 0 0 1\n");
  EXPECT_THAT(truth_error("traj.txt"), HasSubstr("traj.txt:1: is not a pose: its 3 x 3 part is a reflection"));
  folder_.write("traj.txt", all_ + "1 2 3\n");
  EXPECT_THAT(truth_error("traj.txt"), HasSubstr("traj.txt:4: has 3 numbers; expected 16 or 12"));
  folder_.write("pose/7.txt", "1 0 0 0\n0 1 0 0\n0 0 1 0\n");
  EXPECT_THAT(truth_error("pose"), HasSubstr("pose: has a pose for none of the 3 images"));
  folder_.write("pose/0.txt", "1 0 0 0\n0 1 0 0\n");
  EXPECT_THAT(truth_error("pose"), HasSubstr("0.txt: has 8 numbers"));
  folder_.write("poses.npy", array_text<double>(poses_, "<i8"));
  EXPECT_THAT(truth_error("poses.npy"), HasSubstr("has numbers of type '<i8'"));
  folder_.write("poses.npy", array_text<double>(poses_, "<f8").substr(0, 400));
  EXPECT_THAT(truth_error("poses.npy"), HasSubstr("ends after 2 poses"));
  folder_.write("poses.npy", "abc");
  EXPECT_THAT(truth_error("poses.npy"), HasSubstr("no .npy file"));
  folder_.write("poses.json", "{\"cameras\": []}");
  EXPECT_THAT(truth_error("poses.json"), HasSubstr("has neither \"frames\" with"));
}

TEST_F(FolderSourceTest, DepthOfAnotherSizeIsScaledWhereItIsAllowed) {
  write_colour("colour/1.png", 1);
  folder_.write_image("depth/1.png", test::depth_image(1, 32, 24));
  const ParameterValues plain = {{"depth", std::string("depth")}};
  EXPECT_THAT(error(plain), HasSubstr("`scale_depth: true` if both show the same view"));
  ParameterValues scaled = plain;
  scaled["scale_depth"] = true;
  const std::optional<SensorFrame> frame = open(scaled)->next();
  ASSERT_TRUE(frame);
  ASSERT_EQ(frame->depth.size(), frame->colour.size());
  const cv::Mat stored = test::depth_image(1, 32, 24);
  for (const auto& [x, y] : {std::pair(2, 2), {3, 3}, {63, 47}, {10, 31}})
    EXPECT_EQ(frame->depth.at<float>(y, x), static_cast<float>(stored.at<std::uint16_t>(y / 2, x / 2) / 5000.0));
  folder_.write_image("depth/1.png", test::depth_image(1, 32, 30));
  EXPECT_THAT(error(scaled), HasSubstr("they do not show the same view"));
}

TEST_F(FolderSourceTest, BadIntrinsicsNameThePlace) {
  write_colour("colour/1.png", 1);
  const std::string file = full("camera.yaml");
  const auto error_of = [&](const std::string& content) {
    folder_.write("camera.yaml", content);
    return error({{"intrinsics", file}});
  };
  const std::string good = "fx: 30\nfy: 30\ncx: 15\ncy: 11\nwidth: 64\nheight: 48\n";
  EXPECT_THAT(error_of(good + "fz: 3\n"), AllOf(StartsWith(file + ":7:1: "), HasSubstr("unknown key 'fz'")));
  EXPECT_THAT(error_of(good + "fx: 3\n"), AllOf(StartsWith(file + ":7:1: "), HasSubstr("given twice")));
  EXPECT_THAT(error_of(good + "k1: big\n"), AllOf(StartsWith(file + ":7:5: "), HasSubstr("found 'big' for k1")));
  EXPECT_THAT(error_of(good + "baseline: -1\n"), HasSubstr("expected a number greater than 0"));
  EXPECT_THAT(error_of("fx: 30\ncx: 15\nwidth: 64\nheight: 48\n"), HasSubstr("lacks fy, cy"));
  EXPECT_THAT(error_of("fx: 30\nwidth: 64.5\n"), AllOf(StartsWith(file + ":2:8: "), HasSubstr("whole number")));
  EXPECT_THAT(error_of("fx: [30\n"), StartsWith(file + ":"));
  EXPECT_THAT(error_of("- 1\n"), HasSubstr("holds no keys"));
  EXPECT_THAT(error({{"intrinsics", full("none.yaml")}}), StartsWith(full("none.yaml") + ": no such file"));
}

}  // namespace
}  // namespace holdfast
