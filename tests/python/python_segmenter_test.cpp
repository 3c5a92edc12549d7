// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include "python/python_file.hpp"

namespace holdfast {
namespace {

using testing::ElementsAre;
using PythonSegmenter = test::PythonFiles;

TEST_F(PythonSegmenter, GivesWhatPythonReturned) {
  const auto segmenter = with_body(
      "labels = numpy.zeros(image.shape[:2], numpy.uint8); labels[1, 2] = 1; "
      "labels[3, 5] = 255; return labels");
  EXPECT_THAT(segmenter->classes(), ElementsAre("background", "person"));
  EXPECT_TRUE(segmenter->movable().empty());
  const Segmentation result = segmenter->segment(frame());
  ASSERT_EQ(result.labels.size(), cv::Size(6, 4));
  ASSERT_EQ(result.labels.type(), CV_8UC1);
  EXPECT_EQ(result.labels.at<std::uint8_t>(1, 2), 1);
  EXPECT_EQ(result.labels.at<std::uint8_t>(3, 5), 255);
  EXPECT_EQ(result.labels.at<std::uint8_t>(0, 0), 0);
  EXPECT_TRUE(result.confidence.empty());
}

TEST_F(PythonSegmenter, TakesConfidenceAndNone) {
  const auto sure =
      with_body("return numpy.ones(image.shape[:2], numpy.uint8), numpy.full(image.shape[:2], 77, numpy.uint8)");
  EXPECT_EQ(sure->segment(frame()).confidence.at<std::uint8_t>(2, 2), 77);
  EXPECT_TRUE(with_body("return None")->segment(frame()).empty());
}

TEST_F(PythonSegmenter, TakesInstances) {
  const auto segmenter = with_body(
      "labels = numpy.ones(image.shape[:2], numpy.uint8); labels[0] = 0; instances = labels * 7; instances[:, 3:] = 9; "
      "return labels, None, instances");
  const Segmentation result = segmenter->segment(frame());
  ASSERT_EQ(result.found.size(), 2U) << "none on the background";
  EXPECT_EQ(result.found[0].label, 1);
  EXPECT_EQ(result.found[1].box, cv::Rect2f(3, 1, 3, 3));
  EXPECT_EQ(result.instances.at<std::uint16_t>(2, 1), 1);
  EXPECT_EQ(result.instances.at<std::uint16_t>(2, 4), 2);
  EXPECT_EQ(result.instances.at<std::uint16_t>(0, 4), 0);
}

TEST_F(PythonSegmenter, GivesImagesInTheOrderThatWasAsked) {
  const std::string file = write(
      "import numpy\nclass Segmenter:\n  classes = [str(i) for i in range(250)]\n"
      "  def segment(self, image):\n"
      "    assert image.dtype == numpy.uint8 and image.shape == (4, 6, 3)\n"
      "    return image[:, :, 0]\n");
  EXPECT_EQ(make(file)->segment(frame()).labels.at<std::uint8_t>(0, 0), 200) << "red first";
  EXPECT_EQ(make(file, {{"colour_order", std::string("bgr")}})->segment(frame()).labels.at<std::uint8_t>(0, 0), 10);
}

TEST_F(PythonSegmenter, TakesArraysThatAreNotContiguous) {
  const auto segmenter = with_body(
      "labels = numpy.zeros((image.shape[1], image.shape[0]), numpy.uint8); labels[5, 1] = 1; return labels.T");
  const Segmentation result = segmenter->segment(frame());
  EXPECT_EQ(result.labels.at<std::uint8_t>(1, 5), 1);
  EXPECT_EQ(result.labels.at<std::uint8_t>(0, 0), 0);
}

TEST_F(PythonSegmenter, MayKeepAndChangeItsImage) {
  const auto segmenter = with_body("image[:] = 255; self.kept = image; return None");
  const SensorFrame given = frame();
  segmenter->segment(given);
  EXPECT_EQ(given.colour.at<cv::Vec3b>(0, 0), cv::Vec3b(10, 20, 200));
}

TEST_F(PythonSegmenter, HandsParametersToTheClass) {
  const std::string file = write(
      "class Segmenter:\n  def __init__(self, **given):\n"
      "    self.classes = [name + '=' + repr(value) for name, value in given.items()]\n"
      "    self.movable = self.classes[1:2]\n"
      "  def segment(self, image): return None\n");
  const TextMap parameters{
      {"count", "3"}, {"share", "0.25"}, {"wild", "true"}, {"model", "net.pt"}, {"version", "1.2.3"}};
  const auto segmenter = make(file, {{"parameters", parameters}});
  EXPECT_THAT(segmenter->classes(),
              ElementsAre("count=3", "share=0.25", "wild=True", "model='net.pt'", "version='1.2.3'"));
  EXPECT_THAT(segmenter->movable(), ElementsAre("share=0.25"));
}

TEST_F(PythonSegmenter, ImportsWhatLiesBesideTheFile) {
  write("names = ['background', 'cat']\n", "names_beside.py");
  const auto segmenter =
      make(write("import names_beside\nclass Segmenter:\n  classes = names_beside.names\n"
                 "  def segment(self, image): return None\n"));
  EXPECT_THAT(segmenter->classes(), ElementsAre("background", "cat"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "__pycache__")) << "nothing is left beside the user's files";
}

TEST_F(PythonSegmenter, TheExampleWorks) {
  const auto segmenter = make(HOLDFAST_SOURCE_DIR "/examples/python/brightness_segmenter.py",
                              {{"parameters", TextMap{{"threshold", "76"}}}});
  EXPECT_THAT(segmenter->movable(), ElementsAre("person"));
  const Segmentation result = segmenter->segment(frame());  // its mean is 76.7
  EXPECT_EQ(result.labels.at<std::uint8_t>(0, 0), 1);
  EXPECT_EQ(result.confidence.at<std::uint8_t>(0, 0), 2);
}

}  // namespace
}  // namespace holdfast
