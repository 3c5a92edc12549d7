// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <opencv2/core.hpp>

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

  const std::string json =
      folder_.write("camera.json", R"({"fx": 1, "fy": 2, "cx": 3, "cy": 4, "width": 32, "height": 24, "p2": -0.5})");
  EXPECT_EQ(open({{"intrinsics", json}})->describe().camera->distortion.p2, -0.5);
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
  EXPECT_THAT(error({{"intrinsics", full("none.yaml")}}), StartsWith(full("none.yaml") + ": is missing"));
}

}  // namespace
}  // namespace holdfast
