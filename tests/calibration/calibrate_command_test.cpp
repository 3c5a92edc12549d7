// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>

#include "calibration/board_pictures.hpp"
#include "cli/program.hpp"

namespace holdfast {
namespace {

using test::Outcome;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// A folder with pictures of a board, of half the usual size so that finding it takes less time.
class CalibrateTest : public ::testing::Test {
 protected:
  static Camera small_camera() {
    Camera camera = test::usual_camera();
    camera.width = 320, camera.height = 240;
    camera.fx *= 0.5, camera.fy *= 0.5, camera.cx = 159.0, camera.cy = 121.0;
    return camera;
  }
  static const std::vector<cv::Mat>& pictures() {
    static const std::vector<cv::Mat> result = [] {
      const CalibrationBoard board;
      const test::BoardCamera photographer(board, small_camera());
      std::vector<cv::Mat> images;
      for (const Eigen::Isometry3d& pose : test::board_poses(board, small_camera(), 0.5))
        images.push_back(photographer.picture(pose, images.size() + 1));
      return images;
    }();
    return result;
  }
  void write_pictures() const {
    std::filesystem::create_directory(program_.path("board"));
    for (std::size_t i = 0; i < pictures().size(); ++i)
      cv::imwrite(program_.path("board/" + std::to_string(100 + i) + ".png").string(), pictures()[i]);
  }
  /// Arguments that every call has.
  static std::vector<std::string> words(std::vector<std::string> added) {
    added.insert(added.begin(), {"calibrate", "--square", "0.025", "--quiet"});
    return added;
  }
  test::Program program_;
};

TEST_F(CalibrateTest, WritesACameraThatCheckAccepts) {
  write_pictures();
  const Outcome outcome = program_.run({"calibrate", "board", "--square", "0.025", "--output", "camera.yaml", "--json",
                                        "report.json", "--plot", "plot.png"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_THAT(outcome.output, AllOf(HasSubstr("reprojection error 0."), HasSubstr("board/100.png")));
  program_.write("run.yaml",
                 program_.text("camera.yaml") +
                     "source: { folder: { path: board } }\nfeatures: orb\noptimizer: schur\nsensor: mono\n");
  const Outcome check = program_.run({"check", "run.yaml", "--without-data", "--print"});
  EXPECT_EQ(check.exit_code, 0) << check.errors;
  const auto json = nlohmann::json::parse(program_.text("report.json"));
  EXPECT_NEAR(json.at("camera").at("fx").get<double>(), small_camera().fx, 1.0);
  EXPECT_NEAR(json.at("camera").at("cx").get<double>(), small_camera().cx, 1.0);
  EXPECT_LT(json.at("rms").get<double>(), 0.15);
  EXPECT_FALSE(cv::imread(program_.path("plot.png").string()).empty());

  // The same on standard output, where nothing else is; and an existing file is not replaced.
  const Outcome printed = program_.run({"calibrate", "board", "--square", "0.025"});
  EXPECT_EQ(printed.output, program_.text("camera.yaml"));
  EXPECT_THAT(printed.errors, HasSubstr("reprojection error"));
  const Outcome again = program_.run(words({"board", "--output", "camera.yaml"}));
  EXPECT_EQ(again.exit_code, 1);
  EXPECT_THAT(again.errors, HasSubstr("camera.yaml: is there already"));
}

TEST_F(CalibrateTest, TakesAVideo) {
  cv::VideoWriter video(program_.path("board.avi").string(), cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 10.0,
                        pictures().front().size(), false);
  if (!video.isOpened()) GTEST_SKIP() << "OpenCV of this machine writes no videos";
  for (const cv::Mat& picture : pictures())
    for (int i = 0; i < 2; ++i) video.write(picture);  // a board that rests
  video.release();
  const Outcome outcome =
      program_.run(words({"board.avi", "--every", "1", "--json", "report.json", "--output", "camera.yaml"}));
  ASSERT_EQ(outcome.exit_code, 0) << outcome.errors;
  const auto json = nlohmann::json::parse(program_.text("report.json"));
  EXPECT_LE(json.at("views").size(), pictures().size()) << "a board that rests counts once";
  EXPECT_GE(json.at("views").size(), 10U);
  EXPECT_NEAR(json.at("camera").at("fx").get<double>(), small_camera().fx, 3.0) << "JPEG";
}

TEST_F(CalibrateTest, TakesTheSourceOfAConfiguration) {
  program_.write("scene.yaml",
                 "source: { simulated: { duration: 0.2 } }\ncamera: tum_fr1\nfeatures: orb\noptimizer: schur\n");
  const Outcome outcome = program_.run(words({"--config", "scene.yaml"}));
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.errors, HasSubstr("scene.yaml: found the board in 0 of"));
}

TEST_F(CalibrateTest, SaysWhatIsWrongWithImages) {
  write_pictures();
  const auto expect_error = [&](const std::vector<std::string>& arguments, const std::string& error) {
    const Outcome outcome = program_.run(words(arguments));
    EXPECT_EQ(outcome.exit_code, 1) << error;
    EXPECT_THAT(outcome.errors, HasSubstr(error));
    EXPECT_THAT(outcome.output, IsEmpty());
  };
  expect_error({"board", "--board", "8x6"}, "board: found the board in 0 of 18 images; expected it in at least 3");
  expect_error({"board/100.png", "board/101.png"}, "board/100.png: found the board in 2 of 2 images");
  expect_error({"nowhere"}, "nowhere: no such file or folder");
  std::filesystem::create_directory(program_.path("empty"));
  expect_error({"empty"}, "empty: has no images");
  program_.write("text.txt", "text");
  expect_error({"text.txt"}, "text.txt: cannot be read; expected an image (PNG, JPEG) or a video");
  cv::Mat larger;
  cv::resize(pictures().front(), larger, cv::Size(400, 300));
  cv::imwrite(program_.path("board/999.png").string(), larger);
  expect_error({"board"}, "board/999.png: found an image of 400x300 pixels; expected 320x240 as of board/100.png");
  const std::string cut = program_.text("board/100.png").substr(0, 2000);
  std::ofstream(program_.path("board/100.png"), std::ios::binary) << cut;
  expect_error({"board"}, "board/100.png: ");
}

TEST_F(CalibrateTest, RefusesViewsThatDetermineNothing) {
  const CalibrationBoard board;
  const test::BoardCamera photographer(board, small_camera());
  std::filesystem::create_directory(program_.path("board"));
  for (int i = 0; i < 4; ++i)
    cv::imwrite(program_.path("board/" + std::to_string(i) + ".png").string(),
                photographer.picture(test::board_pose(board, {0.03 * (i % 2), 0.02 * (i / 2), 0.45}, 0.0, 0.0)));
  const Outcome outcome = program_.run(words({"board"}));
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.errors, AllOf(HasSubstr("no camera was written"), HasSubstr("photograph the board turned")));
  EXPECT_THAT(outcome.output, IsEmpty());
}

TEST_F(CalibrateTest, PrintsBoards) {
  const Outcome board = program_.run(words({"--print-board", "-"}));
  EXPECT_EQ(board.exit_code, 0);
  EXPECT_EQ(board.output, board_svg(CalibrationBoard()));
  const Outcome wrong = program_.run(words({"board", "--board", "9"}));
  EXPECT_EQ(wrong.exit_code, 2);
  EXPECT_THAT(wrong.errors, HasSubstr("found '9' for --board; expected COLUMNSxROWS"));
  const Outcome nothing = program_.run({"calibrate"});
  EXPECT_EQ(nothing.exit_code, 2);
  EXPECT_THAT(nothing.errors, HasSubstr("expected either images"));
  const Outcome no_size = program_.run({"calibrate", "board"});
  EXPECT_EQ(no_size.exit_code, 2);
  EXPECT_THAT(no_size.errors, HasSubstr("--square is required"));
}

}  // namespace
}  // namespace holdfast
