// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <set>

#include "bench/matrix_fixture.hpp"
#include "cli/program.hpp"
#include "holdfast/bench/dataset_check.hpp"
#include "holdfast/bench/published.hpp"
#include "holdfast/image_files/recorded_imu.hpp"
#include "sources/png_file.hpp"

namespace holdfast {
namespace {

namespace fs = std::filesystem;
using test::Outcome;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::StartsWith;

TEST(DatasetRecipeTest, EveryRecipeSaysWhatPeopleMustKnow) {
  std::set<std::string> names;
  std::map<std::string, int> sequences;
  for (const DatasetRecipe& recipe : dataset_recipes()) {
    EXPECT_TRUE(names.insert(recipe.name).second) << recipe.name << " stands twice";
    EXPECT_TRUE(is_plain_name(recipe.name)) << recipe.name;
    EXPECT_FALSE(recipe.folder.empty() || recipe.licence.empty() || recipe.citation.empty()) << recipe.name;
    EXPECT_THAT(recipe.address, StartsWith("https://")) << recipe.name;
    EXPECT_EQ(recipe.camera.name.empty(), brings_camera(recipe.layout)) << recipe.name;
    EXPECT_EQ(recipe.has_masks, !recipe.make.empty()) << recipe.name;
    ++sequences[recipe.dataset];
  }
  EXPECT_EQ(sequences["Bonn RGB-D Dynamic"], 26);
  EXPECT_EQ(sequences["ICL-NUIM"], 8);
  EXPECT_EQ(sequences["KITTI odometry"], 11);
  EXPECT_EQ(sequences["EuRoC MAV"], 11);
  EXPECT_EQ(find_recipe("euroc_v2_03")->folder, "V2_03_difficult");
  EXPECT_EQ(find_recipe("euroc_v2_03")->layout, DatasetLayout::euroc);
  EXPECT_EQ(find_recipe("kitti_04")->pairs, 271U);
  for (const char* name : {"sitting_static", "sitting_xyz", "sitting_halfsphere", "sitting_rpy", "walking_static",
                           "walking_xyz", "walking_halfsphere", "walking_rpy"}) {
    const DatasetRecipe* recipe = find_recipe(std::string("fr3_") + name);
    ASSERT_NE(recipe, nullptr) << name;
    EXPECT_EQ(recipe->folder, std::string("rgbd_dataset_freiburg3_") + name);
    EXPECT_EQ(recipe->camera.fx, 535.4);
  }
  EXPECT_EQ(find_recipe("fr2_desk_with_person")->camera.name, "tum_fr2");
  EXPECT_THAT(find_recipe("w21")->make, HasSubstr("compose_people.py"));
  EXPECT_EQ(find_recipe("fr9_xyz"), nullptr);
}

TEST(DatasetRecipeTest, PublishedFiguresAreOfKnownSequences) {
  std::vector<Diagnostic> diagnostics;
  const auto published = read_published(HOLDFAST_SOURCE_DIR "/benchmarks/published.yaml", diagnostics);
  ASSERT_TRUE(diagnostics.empty());
  for (const PublishedResult& result : published.results)
    for (const auto& [sequence, value] : result.values) EXPECT_NE(find_recipe(sequence), nullptr) << sequence;
}

TEST(DatasetRecipeTest, SaysAllThatIsWrongWithAFile) {
  std::vector<Diagnostic> diagnostics;
  read_recipes(
      "dataset: Ours\nlayout: tom\nlicence: none\ncitation: us\nadress: https://nowhere\n"
      "sequences:\n  one: { folder: one, camera: tum_fr4, colour: many, depth: 10, pairs: unknown }\n",
      "ours.yaml", diagnostics);
  std::vector<std::string> texts;
  for (const Diagnostic& each : diagnostics) texts.push_back(each.to_string());
  EXPECT_THAT(texts, Contains(HasSubstr("ours.yaml:2:9: found 'tom' for 'layout'")));
  EXPECT_THAT(texts, Contains(AllOf(HasSubstr("ours.yaml:5:1"), HasSubstr("did you mean 'address'?"))));
  EXPECT_THAT(texts, Contains(HasSubstr("needs 'address'")));
  EXPECT_THAT(texts, Contains(HasSubstr("there is no camera 'tum_fr4'; did you mean")));
  EXPECT_THAT(texts, Contains(AllOf(HasSubstr("'many'"), HasSubstr("a number above 0, or unknown"))));
}

/// A recording of four frames with masks, and a recipe for it.
class DatasetCheckTest : public ::testing::Test {
 protected:
  DatasetCheckTest() {
    for (const char* kind : {"rgb", "depth", "mask"}) {
      fs::create_directories(program_.path(std::string("rec/") + kind));
      std::string list = "# timestamp filename\n";
      for (int i = 0; i < 4; ++i) {
        const std::string name = std::string(kind) + "/" + std::to_string(i) + ".png";
        char line[100];
        std::snprintf(line, sizeof(line), "%.6f %s\n", 10.0 + 0.1 * i, name.c_str());
        list += line;
        const int type = std::string(kind) == "rgb" ? CV_8UC3 : std::string(kind) == "depth" ? CV_16UC1 : CV_8UC1;
        cv::imwrite(path(name).string(), cv::Mat(480, 640, type, cv::Scalar::all(3 * i)));
      }
      program_.write("rec/" + std::string(kind) + ".txt", list);
    }
    program_.write("rec/groundtruth.txt", "9 0 0 0 0 0 0 1\n11 1 0 0 0 0 0 1\n");
    std::vector<Diagnostic> diagnostics;
    recipe_ = read_recipes(
                  "dataset: Ours\nlayout: tum\nmasks: true\nlicence: none\ncitation: us\naddress: https://nowhere\n"
                  "sequences: { rec: { folder: rec, camera: tum_fr3, colour: 4, depth: 4, pairs: 4 } }\n",
                  "ours.yaml", diagnostics)
                  .at(0);
  }

  fs::path path(const std::string& name) const { return program_.path("rec/" + name); }
  std::vector<std::string> problems() const { return check_dataset(program_.path("rec"), &recipe_).problems; }
  /// Leaves the last line of a list out.
  void cut(const std::string& list) const {
    const std::string text = program_.text("rec/" + list);
    program_.write("rec/" + list, text.substr(0, text.rfind('\n', text.size() - 2) + 1));
  }

  test::Program program_;
  DatasetRecipe recipe_;
};

TEST_F(DatasetCheckTest, FindsNothingWrongWithAWholeRecording) {
  EXPECT_THAT(problems(), IsEmpty());
  EXPECT_THAT(check_dataset(program_.path("rec"), &recipe_).facts,
              AllOf(Contains("4 colour images, expected 4"), Contains("4 colour-depth pairs, expected 4"),
                    Contains("2 true poses"), Contains("4 mask images, expected 4")));
}

TEST_F(DatasetCheckTest, LooksAtInertialMeasurements) {
  const auto write = [&](double force, double offset) {
    std::string text = imu_header;
    for (int i = 0; i <= 200; ++i) text += imu_sample_text({9.0 + offset + 0.01 * i, {0, 0, 0}, {0, force, 0}});
    program_.write("rec/imu.csv", text);
  };
  write(9.8, 0.0);
  EXPECT_THAT(problems(), IsEmpty());
  EXPECT_THAT(check_dataset(program_.path("rec"), &recipe_).facts, Contains("201 inertial measurements"));
  write(1.0, 0.0);
  EXPECT_THAT(problems(), ElementsAre(AllOf(HasSubstr("imu.csv"), HasSubstr("multiples of g"))));
  write(9.8, 100.0);
  EXPECT_THAT(problems(), ElementsAre(HasSubstr("expected the same time by the same clock")));
}

TEST_F(DatasetCheckTest, ExplainsWhatIsMissing) {
  fs::remove(path("depth.txt"));
  fs::remove(path("groundtruth.txt"));
  fs::remove(path("rgb/2.png"));
  fs::remove(path("mask.txt"));
  EXPECT_THAT(problems(), ElementsAre(HasSubstr("rgb.txt lists 1 image that is missing: rgb/2.png (line 4)"),
                                      HasSubstr("depth.txt is missing, the list of depth images"),
                                      HasSubstr("mask.txt is missing, the list of masks"),
                                      HasSubstr("groundtruth.txt is missing, the true poses")));
  EXPECT_THAT(check_dataset(program_.path("nowhere"), &recipe_).problems,
              ElementsAre(HasSubstr("is no folder; get it from https://nowhere")));
}

TEST_F(DatasetCheckTest, ExplainsWhatIsCut) {
  cut("rgb.txt");
  EXPECT_THAT(problems(), ElementsAre(HasSubstr("rgb.txt lists 3 images; expected 4")));
  cut("mask.txt");
  cut("mask.txt");
  EXPECT_THAT(problems(), Contains(HasSubstr("1 colour image without a mask of the same stamp")));
  fs::resize_file(path("depth/3.png"), fs::file_size(path("depth/3.png")) / 2);
  EXPECT_THAT(problems(), Contains(HasSubstr("depth/3.png")));
}

/// Every file is looked at, not only a sample: forty frames, of which two in the middle are cut short.
TEST_F(DatasetCheckTest, LooksAtEveryFile) {
  std::string list;
  for (int i = 0; i < 40; ++i) {
    const std::string name = "rgb/" + std::to_string(100 + i) + ".png";
    list += std::to_string(10 + i) + ".0 " + name + "\n";
    cv::Mat noise(480, 640, CV_8UC3);
    cv::randu(noise, 0, 255);  // does not compress: larger than what is read of a file at first
    cv::imwrite(path(name).string(), noise);
  }
  program_.write("rec/rgb.txt", list);
  recipe_.colour = 40;
  EXPECT_THAT(problems(), Not(Contains(HasSubstr("damaged"))));
  for (const char* name : {"rgb/117.png", "rgb/121.png"}) fs::resize_file(path(name), fs::file_size(path(name)) - 20);
  EXPECT_THAT(problems(), Contains(AllOf(HasSubstr("rgb.txt lists 2 images that are damaged: rgb/117.png (line 18) is "
                                                   "truncated"),
                                         HasSubstr("rgb/121.png (line 22)"), HasSubstr("download them again"))));
  std::ofstream(path("rgb/117.png")) << "no image";
  cv::imwrite(path("rgb/121.png").string(), cv::Mat(240, 320, CV_8UC3, cv::Scalar::all(1)));
  EXPECT_THAT(problems(), AllOf(Contains(HasSubstr("rgb/117.png (line 18) is neither a PNG nor a JPEG image")),
                                Contains(HasSubstr("1 image of another size: rgb/121.png (line 22) has 320x240"))));
}

/// A small file that would take gigabytes is known by its header, whatever camera the recording has.
TEST_F(DatasetCheckTest, DecodesNoImageThatIsLargerThanACamera) {
  constexpr int side = 20000;
  const std::vector<std::uint8_t> no_pixels(100, 0);  // to decode it would be reported as damage
  const auto bytes = test::png_of_stream({.width = side, .height = side, .bits = 8, .colour_type = 2}, no_pixels);
  std::ofstream(path("rgb/0.png"), std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  const auto too_large = HasSubstr(
      "rgb.txt lists 1 image that is larger than a camera's: rgb/0.png (line 2) has 20000x20000 pixels; "
      "expected at most 32768 pixels in width");
  EXPECT_THAT(problems(), ElementsAre(too_large));
  EXPECT_THAT(check_dataset(program_.path("rec"), nullptr).problems, ElementsAre(too_large));
  // Without a camera that is known, the images of a list have one size.
  cv::imwrite(path("depth/2.png").string(), cv::Mat(240, 320, CV_16UC1, cv::Scalar::all(1)));
  EXPECT_THAT(check_dataset(program_.path("rec"), nullptr).problems,
              ElementsAre(too_large, HasSubstr("depth.txt lists 1 image of another size: depth/2.png (line 4) has "
                                               "320x240 pixels; expected 640x480 of the list's first image")));
}

TEST_F(DatasetCheckTest, SaysWhatIsKnownToBeAbsentAsAFact) {
  ASSERT_TRUE(find_recipe("bonn_crowd")->lists_absent_depth);
  fs::remove(path("depth/1.png"));
  EXPECT_THAT(problems(), ElementsAre(HasSubstr("depth.txt lists 1 image that is missing: depth/1.png (line 3)")));
  recipe_.lists_absent_depth = true;
  EXPECT_THAT(problems(), IsEmpty());
  EXPECT_THAT(check_dataset(program_.path("rec"), &recipe_).facts,
              Contains(AllOf(HasSubstr("depth.txt lists 1 image that does not exist: depth/1.png (line 3)"),
                             HasSubstr("known of the dataset"))));
  fs::remove(path("rgb/1.png"));
  EXPECT_THAT(problems(), ElementsAre(HasSubstr("rgb.txt lists 1 image that is missing")));
  fs::remove_all(path("depth"));
  EXPECT_THAT(problems(), Contains(HasSubstr("depth.txt lists 4 images that are missing")));
}

TEST_F(DatasetCheckTest, SeesThatItIsAnotherRecording) {
  cv::imwrite(path("rgb/0.png").string(), cv::Mat(540, 960, CV_8UC3, cv::Scalar::all(1)));
  program_.write("rec/groundtruth.txt", "100 0 0 0 0 0 0 1\n110 1 0 0 0 0 0 1\n");
  EXPECT_THAT(problems(), ElementsAre(HasSubstr("960x540 pixels; expected 640x480 of the camera tum_fr3"),
                                      HasSubstr("covers the time of 0 of 4 colour images")));
}

TEST_F(DatasetCheckTest, TurnsTheListsOfIclNuimRound) {
  program_.write("rec/associations.txt", "0 depth/0.png 0 rgb/0.png\n1 depth/1.png 1 rgb/1.png\n");
  const auto pairs = dataset_pairs(program_.path("rec"), DatasetLayout::icl_nuim, 0.02);
  ASSERT_EQ(pairs.size(), 2u);
  EXPECT_EQ(pairs[1].colour.name, "rgb/1.png");
  EXPECT_EQ(pairs[1].depth.name, "depth/1.png");
}

TEST_F(DatasetCheckTest, LooksAtARecordingOfIclNuim) {
  fs::rename(path("rgb.txt"), path("rgb_list"));
  program_.write("rec/associations.txt", "1 depth/0.png 1 rgb/0.png\n2 depth/1.png 2 rgb/1.png\n");
  EXPECT_EQ(layout_of(program_.path("rec")), DatasetLayout::icl_nuim);
  const auto check = [&] { return check_dataset(program_.path("rec"), find_recipe("icl_lr_kt0")); };
  EXPECT_THAT(check().problems, ElementsAre(HasSubstr("livingRoom0.gt.freiburg is missing, the true poses")));
  program_.write("rec/livingRoom0n.gt.freiburg", "1 0 0 0 0 0 0 1\n2 1 0 0 0 0 0 1\n");
  EXPECT_THAT(check().problems, IsEmpty()) << "that of the recording with noise";
  EXPECT_THAT(check().facts, AllOf(Contains("2 colour-depth pairs"), Contains("2 true poses")));
  EXPECT_THAT(check_dataset(program_.path("rec"), nullptr).problems, IsEmpty());
  fs::remove(path("depth/1.png"));
  EXPECT_THAT(check().problems, ElementsAre(HasSubstr("associations.txt lists 1 image that is missing: depth/1.png")));
}

/// Two frames in the package format of OpenLORIS-Scene; the source's own tests look at its content.
TEST_F(DatasetCheckTest, LooksAtOpenLoris) {
  std::string colour, depth;
  for (const char* folder : {"color", "aligned_depth"}) fs::create_directories(program_.path("cafe1-1") / folder);
  for (int i = 0; i < 2; ++i) {
    const std::string name = std::to_string(i) + ".png";
    cv::imwrite(program_.path("cafe1-1/color/" + name).string(), cv::Mat(48, 64, CV_8UC3, cv::Scalar::all(20 * i)));
    cv::imwrite(program_.path("cafe1-1/aligned_depth/" + name).string(), cv::Mat(48, 64, CV_16UC1, cv::Scalar(900)));
    colour += "10." + std::to_string(i) + " color/" + name + "\n";
    depth += "10." + std::to_string(i) + " aligned_depth/" + name + "\n";
  }
  program_.write("cafe1-1/color.txt", colour);
  program_.write("cafe1-1/aligned_depth.txt", depth);
  program_.write("cafe1-1/groundtruth.txt", "#Time px py pz qx qy qz qw\n10.0 0 0 0 0 0 0 1\n10.1 1 0 0 0 0 0 1\n");
  program_.write("cafe1-1/sensors.yaml",
                 "%YAML:1.0\nd400_color_optical_frame:\n  { fps: 30, width: 64, height: 48, model: pinhole,\n"
                 "    intrinsics: { data: [50, 32, 50, 24] }, distortion_model: none }\n");
  program_.write("cafe1-1/trans_matrix.yaml",
                 "trans_matrix:\n  - { parent_frame: base_link, child_frame: d400_color_optical_frame,\n"
                 "      matrix: { data: [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 1, 0, 0, 0, 1] } }\n");
  const fs::path folder = program_.path("cafe1-1");
  EXPECT_EQ(layout_of(folder), DatasetLayout::openloris);
  const auto check = [&] { return check_dataset(folder, nullptr); };
  EXPECT_THAT(check().problems, IsEmpty());
  EXPECT_THAT(check().facts, ElementsAre("2 colour-depth pairs", "camera of its own files: 64x48", "2 true poses"));
  EXPECT_EQ(dataset_pairs(folder, DatasetLayout::openloris, 0.02).size(), 2U);
  cv::imwrite((folder / "aligned_depth/1.png").string(), cv::Mat(24, 32, CV_16UC1, cv::Scalar(1)));
  EXPECT_THAT(check().problems, ElementsAre(HasSubstr("the depth camera lists 1 image of another size")));
  fs::remove(folder / "aligned_depth.txt");
  EXPECT_THAT(check().problems, ElementsAre(HasSubstr("aligned_depth.txt: is missing")));
}

/// A folder of NeRFCapture and one of Stray Scanner; the source's own tests look at their content.
TEST_F(DatasetCheckTest, LooksAtRecordingsOfPhones) {
  fs::create_directories(program_.path("capture/images"));
  fs::create_directories(program_.path("scan/depth"));
  fs::create_directories(program_.path("scan/confidence"));
  std::string frames, rows = "timestamp, frame, x, y, z, qx, qy, qz, qw\n";
  for (int i = 0; i < 2; ++i) {
    const std::string number = std::to_string(i);
    cv::imwrite(program_.path("capture/images/" + number + ".png").string(),
                cv::Mat(48, 64, CV_8UC3, cv::Scalar::all(9)));
    for (const std::string& name : {"capture/images/" + number + ".depth.png", "scan/depth/00000" + number + ".png"})
      cv::imwrite(program_.path(name).string(), cv::Mat(24, 32, CV_16UC1, cv::Scalar(900)));
    cv::imwrite(program_.path("scan/confidence/00000" + number + ".png").string(), cv::Mat(24, 32, CV_8UC1, 2));
    frames += std::string(i == 0 ? "" : ",") + R"({"file_path":"images/)" + number + R"(","depth_path":"images/)" +
              number + R"(.depth.png","transform_matrix":[[1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]]})";
    rows += "10." + number + ", 00000" + number + ", 0, 0, 0, 0, 0, 0, 1\n";
  }
  program_.write(
      "capture/transforms.json",
      R"({"fl_x":50,"fl_y":50,"cx":32,"cy":24,"w":64,"h":48,"integer_depth_scale":0.001,"frames":[)" + frames + "]}");
  program_.write("scan/odometry.csv", rows);
  program_.write("scan/camera_matrix.csv", "50, 0, 32\n0, 50, 24\n0, 0, 1\n");
  const std::string video = std::string("\0\0\0\x14", 4) + "ftypqt  ";
  program_.write("scan/rgb.mp4", video);
  for (const char* folder : {"capture", "scan"}) {
    EXPECT_EQ(layout_of(program_.path(folder)), DatasetLayout::phone);
    EXPECT_THAT(check_dataset(program_.path(folder), nullptr).problems, IsEmpty());
  }
  const auto check = [&](const char* folder) { return check_dataset(program_.path(folder), nullptr); };
  EXPECT_THAT(check("scan").facts, ElementsAre("2 colour-depth pairs", "camera of its own files: the size of its video",
                                               "of the video only the first bytes were checked", "2 true poses"));
  cv::imwrite(program_.path("scan/confidence/000001.png").string(), cv::Mat(12, 16, CV_8UC1, 2));
  EXPECT_THAT(check("scan").problems, ElementsAre(AllOf(HasSubstr("confidence/000001.png (line 3) has 16x12 pixels"),
                                                        HasSubstr("expected 32x24 of the depth camera"))));
  program_.write("scan/confidence/000001.png", "no image");
  EXPECT_THAT(check("scan").problems, ElementsAre(HasSubstr("the confidence of depth lists 1 image that is damaged")));
  fs::remove_all(program_.path("scan/confidence"));
  program_.write("scan/rgb.mp4", "no video");
  EXPECT_THAT(check("scan").problems, ElementsAre("rgb.mp4 is no MP4 video; copy the recording again"));
  fs::remove(program_.path("scan/rgb.mp4"));
  EXPECT_THAT(check("scan").problems, ElementsAre(HasSubstr("rgb.mp4 is missing, the video of the recording")));
  program_.write("capture/images/1.depth.png", "no image");
  EXPECT_THAT(check("capture").problems, ElementsAre(HasSubstr("1.depth.png")));
}

/// Depth of Nerfstudio is named by its transforms.json, with any extension; each file is looked at by its own.
TEST_F(DatasetCheckTest, LooksAtDepthByTheExtensionOfEachFile) {
  fs::create_directories(program_.path("capture"));
  const auto write = [&](const std::string& first, const std::string& second) {
    std::string frames;
    for (int i = 0; i < 2; ++i) {
      const std::string colour = std::to_string(i) + ".png";
      cv::imwrite(program_.path("capture/" + colour).string(), cv::Mat(48, 64, CV_8UC3, cv::Scalar::all(9)));
      frames += std::string(i == 0 ? "" : ",") + R"({"file_path":")" + colour + R"(","depth_file_path":")" +
                (i == 0 ? first : second) + R"(","transform_matrix":[[1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]]})";
    }
    program_.write("capture/transforms.json",
                   R"({"fl_x":50,"fl_y":50,"cx":32,"cy":24,"w":64,"h":48,"frames":[)" + frames + "]}");
  };
  const auto check = [&] { return check_dataset(program_.path("capture"), nullptr); };
  program_.write("capture/0.exr", "\x76\x2f\x31\x01 and so on");
  program_.write("capture/1.exr", "\x76\x2f\x31\x01");
  program_.write("capture/0.npy", "\x93NUMPY");
  write("0.exr", "1.exr");
  EXPECT_THAT(check().problems, IsEmpty());
  EXPECT_THAT(check().facts, Contains("of 2 OpenEXR images only the first bytes were checked"));
  write("0.exr", "0.npy");
  EXPECT_THAT(check().problems, ElementsAre(HasSubstr("the depth camera lists 1 image that is damaged: 0.npy")));
  write("0.npy", "0.npy");
  EXPECT_THAT(check().problems, ElementsAre(HasSubstr("lists 1 image that is damaged: 0.npy"))) << "each file once";
  program_.write("capture/1.exr", "v/1");
  write("0.exr", "1.exr");
  EXPECT_THAT(check().problems, ElementsAre(HasSubstr("lists 1 file .exr that is no OpenEXR image: 1.exr (line 1)")));
}

/// A sequence of three pairs in KITTI's layout; the source's own tests look at its content.
TEST_F(DatasetCheckTest, LooksAtStereoPairs) {
  for (const char* side : {"image_0", "image_1"}) {
    fs::create_directories(program_.path(std::string("04/") + side));
    for (int i = 0; i < 3; ++i)
      cv::imwrite(program_.path(std::string("04/") + side + "/00000" + std::to_string(i) + ".png").string(),
                  cv::Mat(48, 64, CV_8UC1, cv::Scalar(20 * i)));
  }
  program_.write("04/calib.txt", "P0: 50 0 32 0 0 50 24 0 0 0 1 0\nP1: 50 0 32 -25 0 50 24 0 0 0 1 0\n");
  EXPECT_EQ(layout_of(program_.path("04")), DatasetLayout::kitti);
  EXPECT_EQ(layout_of(program_.path("rec")), DatasetLayout::tum);
  const auto check = [&] { return check_dataset(program_.path("04"), nullptr); };
  EXPECT_THAT(check().problems, IsEmpty());
  EXPECT_THAT(check().facts, ElementsAre("3 stereo pairs", "camera of its own files: 64x48, baseline 0.500 m",
                                         "no true poses: there is nothing to measure an error by"));
  EXPECT_THAT(check_dataset(program_.path("04"), find_recipe("kitti_04")).problems,
              ElementsAre(HasSubstr("3 stereo pairs; expected 271")));
  program_.write("04/poses.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 0 0 1 0 0 0 0 1 1\n1 0 0 0 0 1 0 0 0 0 1 2\n");
  EXPECT_THAT(check().facts, Contains("3 true poses"));
  fs::remove(program_.path("04/image_1/000001.png"));
  cv::imwrite(program_.path("04/image_1/000002.png").string(), cv::Mat(24, 32, CV_8UC1, cv::Scalar(1)));
  EXPECT_THAT(check().problems,
              ElementsAre(HasSubstr("the right camera lists 1 image that is missing: image_1/000001.png; unpack"),
                          AllOf(HasSubstr("image_1/000002.png has 32x24 pixels"),
                                HasSubstr("expected 64x48 of the right camera"))));
  fs::remove(program_.path("04/calib.txt"));
  EXPECT_THAT(check_dataset(program_.path("04"), find_recipe("kitti_04")).problems,
              ElementsAre(HasSubstr("calib.txt: no such file")));
}

/// A drive of KITTI's raw data and a sequence of 4Seasons; the sources' own tests look at their content.
TEST_F(DatasetCheckTest, LooksAtDrives) {
  const cv::Mat image(48, 64, CV_8UC1, cv::Scalar(20));
  const std::string drive = "2011_09_30_drive_0018_sync", recording = "recording_2020-04-07_10-20-32";
  for (const char* side : {"image_00", "image_01"}) {
    fs::create_directories(program_.path(drive + "/" + side + "/data"));
    cv::imwrite(program_.path(drive + "/" + side + "/data/0000000000.png").string(), image);
  }
  for (const char* side : {"cam0", "cam1"}) {
    fs::create_directories(program_.path(recording + "/undistorted_images/" + side));
    cv::imwrite(program_.path(recording + "/undistorted_images/" + side + "/7.png").string(), image);
  }
  program_.write(recording + "/times.txt", "7 1.5 0.1\n");
  EXPECT_EQ(layout_of(program_.path(drive)), DatasetLayout::kitti);
  EXPECT_EQ(layout_of(program_.path(recording)), DatasetLayout::four_seasons);
  ASSERT_NE(recipe_of_folder(program_.path(drive)), nullptr);
  EXPECT_EQ(recipe_of_folder(program_.path(drive))->name, "kitti_raw_05");
  EXPECT_EQ(recipe_of_folder("dataset-room1_512_16")->name, "tum_vi_room1");
  EXPECT_EQ(recipe_of_folder("office1-7")->layout, DatasetLayout::openloris);
  const auto problems = [&](const std::string& folder) {
    return check_dataset(program_.path(folder), recipe_of_folder(program_.path(folder))).problems;
  };
  EXPECT_THAT(problems(drive), ElementsAre(HasSubstr("calib_cam_to_cam.txt: is missing")));
  EXPECT_THAT(problems(recording), ElementsAre(HasSubstr("calibration: is missing")));
  std::string cameras = "R_rect_00: 1 0 0 0 1 0 0 0 1\n";
  for (int i = 0; i < 4; ++i)
    cameras += "S_rect_0" + std::to_string(i) + ": 64 48\nP_rect_0" + std::to_string(i) + ": 50 0 32 " +
               std::to_string(i % 2 * -25) + " 0 50 24 0 0 0 1 0\n";
  program_.write("calib_cam_to_cam.txt", cameras);
  fs::create_directories(program_.path("calibration"));
  for (const char* name : {"calibration/undistorted_calib_0.txt", "calibration/undistorted_calib_1.txt"})
    program_.write(name, "Pinhole 50 50 32 24 0\n64 48\n");
  program_.write("calibration/undistorted_calib_stereo.txt", "1 0 0 -0.3 0 1 0 0 0 0 1 0 0 0 0 1\n");
  EXPECT_THAT(problems(drive), IsEmpty());
  EXPECT_THAT(problems(recording), IsEmpty());
  EXPECT_THAT(check_dataset(program_.path(recording), nullptr).facts,
              ElementsAre("1 stereo pair", "camera of its own files: 64x48, baseline 0.300 m",
                          "no true poses: there is nothing to measure an error by"));
}

TEST_F(DatasetCheckTest, IsACommand) {
  EXPECT_THAT(program_.run({"dataset", "list", "euroc_mh_01"}).output,
              AllOf(HasSubstr("3682 stereo pairs"), HasSubstr("mav0/cam0/"), HasSubstr("source    euroc")));
  EXPECT_THAT(program_.run({"dataset", "list", "kitti_raw_05"}).output,
              AllOf(HasSubstr("2011_09_30_drive_0018_sync"), HasSubstr("oxts/"), HasSubstr("source    kitti")));
  EXPECT_THAT(program_.run({"dataset", "list", "four_seasons_2020_04_07"}).output, HasSubstr("GNSSPoses.txt"));
  EXPECT_THAT(program_.run({"dataset", "list", "tum_vi_room1"}).output, HasSubstr("dso/camchain.yaml"));
  EXPECT_THAT(program_.run({"dataset", "list", "icl_of_kt3"}).output,
              AllOf(HasSubstr("fy 480 "), HasSubstr("traj3.gt.freiburg"), HasSubstr("source    icl_nuim")));
  EXPECT_THAT(program_.run({"dataset", "list"}).output,
              AllOf(HasSubstr("fr3_walking_xyz"), HasSubstr("bonn_crowd3"), HasSubstr("licence: CC BY 4.0")));
  EXPECT_THAT(program_.run({"dataset", "list", "fr1_xyz"}).output,
              AllOf(HasSubstr("fx 517.306408"), HasSubstr("798 colour, 798 depth, 792 pairs"),
                    HasSubstr("https://cvg.cit.tum.de")));
  const Outcome unknown = program_.run({"dataset", "list", "fr1_xzy"});
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_THAT(unknown.errors, HasSubstr("did you mean 'fr1_xyz'?"));

  EXPECT_EQ(program_.run({"dataset", "check", "rec"}).exit_code, 0);
  const Outcome other = program_.run({"dataset", "check", "rec", "--recipe", "fr1_xyz"});
  EXPECT_EQ(other.exit_code, 1);
  EXPECT_THAT(other.output, HasSubstr("rgb.txt lists 4 images; expected 798"));

  EXPECT_EQ(program_.run({"dataset", "associate", "rec"}).exit_code, 0);
  const std::string associations = program_.text("rec/associations.txt");
  EXPECT_THAT(associations, StartsWith("10.000000 rgb/0.png 10.000000 depth/0.png\n"));
  EXPECT_EQ(std::count(associations.begin(), associations.end(), '\n'), 4);
  const Outcome again = program_.run({"dataset", "associate", "rec"});
  EXPECT_EQ(again.exit_code, 1);
  EXPECT_THAT(again.errors, HasSubstr("is there already"));
}

/// The TUM recording freiburg1_xyz, and copies of its lists beside links to its images.
TEST(DatasetDataTest, KnowsARealRecordingAndItsDamages) {
  const char* data = std::getenv("HOLDFAST_DATA");
  const fs::path original = fs::path(data == nullptr ? "" : data) / "tum_fr1_xyz";
  if (data == nullptr || !fs::exists(original)) GTEST_SKIP() << "HOLDFAST_DATA names no folder with tum_fr1_xyz";
  const DatasetRecipe* recipe = find_recipe("fr1_xyz");
  const DatasetCheck whole = check_dataset(original, recipe);
  EXPECT_THAT(whole.problems, IsEmpty());
  EXPECT_THAT(whole.facts, Contains("792 colour-depth pairs, expected 792"));

  test::Program folder;
  fs::create_directories(folder.path("copy"));
  for (const char* list : {"rgb.txt", "depth.txt", "groundtruth.txt"})
    fs::copy_file(original / list, folder.path("copy") / list);
  fs::create_directory_symlink(original / "depth", folder.path("copy/depth"));
  EXPECT_THAT(check_dataset(folder.path("copy"), recipe).problems,
              ElementsAre(AllOf(HasSubstr("rgb.txt lists 798 images that are missing"), HasSubstr("795 more"))));
  fs::create_directory_symlink(original / "rgb", folder.path("copy/rgb"));
  EXPECT_THAT(check_dataset(folder.path("copy"), recipe).problems, IsEmpty());
  const std::string depth = folder.text("copy/depth.txt");
  folder.write("copy/depth.txt", depth.substr(0, depth.rfind('\n', depth.size() / 2) + 1));
  EXPECT_THAT(check_dataset(folder.path("copy"), recipe).problems,
              ElementsAre(HasSubstr("expected 798"), HasSubstr("expected 792")));
}

/// Sequences of a matrix by recipe, with the segmenter that reads masks.
class RecipeMatrixTest : public test::MatrixTest {
 protected:
  RunPlan plan(const std::string& text) {
    write("matrix.yaml", text);
    diagnostics_.clear();
    Registry registry = test::test_registry();
    test::add<Segmenter, test::MaskSettings>(registry, "precomputed");
    Matrix matrix = read_matrix(folder_ / "matrix.yaml", {}, diagnostics_);
    return make_run_plan(std::move(matrix), registry, test::test_sections(), diagnostics_);
  }
};

TEST_F(RecipeMatrixTest, FillsInWhatARecipeKnows) {
  const RunPlan with_recipe = plan("base: plain.yaml\nsequences:\n  walking: { recipe: fr3_walking_xyz, path: one }\n");
  EXPECT_THAT(problems(), IsEmpty());
  const MatrixSequence& sequence = with_recipe.matrix.sequences.at(0);
  EXPECT_EQ(sequence.camera->text, "tum_fr3");
  EXPECT_EQ(sequence.published, "fr3_walking_xyz");
  EXPECT_THAT(sequence.about, HasSubstr("https://cvg.cit.tum.de"));
  const RunPlan by_hand = plan(
      "base: plain.yaml\nsequences:\n  walking: { source: { tum: { path: one } }, camera: tum_fr3, published: "
      "fr3_walking_xyz }\n");
  EXPECT_EQ(with_recipe.runs.at(0).request, by_hand.runs.at(0).request);

  write("masked.yaml",
        "source: { tum: { path: nowhere } }\nfeatures: orb\noptimizer: ceres\n"
        "segmenter: { precomputed: { path: nowhere/mask } }\nfilters: [semantic_mask]\n");
  const RunPlan masked = plan("base: masked.yaml\nsequences:\n  w21: { recipe: w21, path: one }\n");
  EXPECT_THAT(problems(), IsEmpty());
  EXPECT_THAT(masked.runs.at(0).request, HasSubstr("/one/mask"));
}

TEST_F(RecipeMatrixTest, StereoPairsBringTheirCamera) {
  write("matrix.yaml", "base: plain.yaml\nsequences:\n  street: { recipe: kitti_04, path: one }\n");
  const Matrix matrix = read_matrix(folder_ / "matrix.yaml", {}, diagnostics_);
  EXPECT_THAT(problems(), IsEmpty());
  const MatrixSequence& sequence = matrix.sequences.at(0);
  ASSERT_NE(sequence.source.find("kitti"), nullptr);
  EXPECT_FALSE(sequence.camera.has_value());
  EXPECT_EQ(sequence.published, "kitti_04");
  EXPECT_TRUE(sequence.brings_camera);
}

TEST_F(RecipeMatrixTest, TurnsTheTruthOfBonnToTheCamera) {
  write("matrix.yaml", "base: plain.yaml\nsequences:\n  crowd: { recipe: bonn_crowd, path: one }\n");
  const Matrix matrix = read_matrix(folder_ / "matrix.yaml", {}, diagnostics_);
  const ConfigurationNode* tum = matrix.sequences.at(0).source.find("tum");
  ASSERT_NE(tum, nullptr);
  const auto matrix_of = [&](const char* key) {
    Eigen::Matrix4d result = Eigen::Matrix4d::Zero();
    const ConfigurationNode* rows = tum->find(key);
    for (std::size_t row = 0; rows != nullptr && row < rows->items.size(); ++row)
      for (std::size_t column = 0; column < 4; ++column)
        result(static_cast<int>(row), static_cast<int>(column)) = std::stod(rows->items[row].items.at(column).text);
    return result;
  };
  // As the page of the dataset gives them.
  Eigen::Matrix4d T_ros, T_m;
  T_ros << -1, 0, 0, 0, 0, 0, 1, 0, 0, 1, 0, 0, 0, 0, 0, 1;
  T_m << 1.0157, 0.1828, -0.2389, 0.0113, 0.0009, -0.8431, -0.6413, -0.0098, -0.3009, 0.6147, -0.8085, 0.0111, 0, 0, 0,
      1;
  EXPECT_EQ(matrix_of("truth_left"), T_ros);
  EXPECT_EQ(matrix_of("truth_right"), T_ros * T_m);
}

TEST_F(RecipeMatrixTest, ReadsIclNuimByItsOwnSource) {
  write("matrix.yaml", "base: plain.yaml\nsequences:\n  kt0: { recipe: icl_lr_kt0, path: one }\n");
  const Matrix matrix = read_matrix(folder_ / "matrix.yaml", {}, diagnostics_);
  EXPECT_THAT(problems(), IsEmpty());
  const MatrixSequence& sequence = matrix.sequences.at(0);
  ASSERT_NE(sequence.source.find("icl_nuim"), nullptr);
  EXPECT_NE(sequence.source.find("icl_nuim")->find("path"), nullptr);
  ASSERT_TRUE(sequence.camera.has_value());
  EXPECT_EQ(sequence.camera->text, "icl_nuim");
}

TEST_F(RecipeMatrixTest, SaysWhatIsWrongWithARecipe) {
  plan(
      "base: plain.yaml\nsequences:\n  a: { recipe: fr3_walking_xzy, path: one }\n  b: { recipe: w21 }\n"
      "  c: { source: { tum: { path: one } }, path: two }\n");
  EXPECT_THAT(problems(), Contains(HasSubstr("matrix.yaml:3:16: there is no recipe 'fr3_walking_xzy'; did you mean "
                                             "'fr3_walking_xyz'?")));
  EXPECT_THAT(problems(), Contains(HasSubstr("sequence 'b' needs 'path'")));
  EXPECT_THAT(problems(), Contains(HasSubstr("'path' of sequence 'c' goes with 'recipe'")));
}

}  // namespace
}  // namespace holdfast
